//! Directions in which nothing restores a system: places and headings at which it would stay as well.

use glam::DVec3;

use super::sites::{Site, Sites};
use crate::placement::TetheredSystem;

/// A motion of a whole system, or of one body in it.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// Names of what moves and how, in words.
    pub(super) words: String,
    /// Velocity (inertial frame) and angular velocity (body frame) of every site.
    pub(super) motions: Vec<(DVec3, DVec3)>,
}

/// Motions of free systems as a whole, and turns of single bodies.
pub(super) fn candidates(
    sites: &Sites,
    systems: &[TetheredSystem],
    name: impl Fn(&Site) -> String,
) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for system in systems {
        let belongs = |site: &Site| {
            system.bodies.contains(&site.entity) || system.nodes.contains(&site.entity)
        };
        let bodies: Vec<&Site> = sites
            .all
            .iter()
            .filter(|site| system.bodies.contains(&site.entity))
            .collect();
        let Some(first) = bodies.first() else {
            continue;
        };
        if system.reference.is_some() {
            let reference = bodies
                .iter()
                .find(|site| Some(site.entity) == system.reference);
            let reference = reference.unwrap_or(first);
            let whole = if bodies.len() > 1 {
                format!("`{}` with all that is tethered to it", name(reference))
            } else {
                format!("`{}`", name(reference))
            };
            for (axis, along) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
                let motion = |site: &Site| if belongs(site) { axis } else { DVec3::ZERO };
                candidates.push(Candidate {
                    words: format!("{whole} along {along}"),
                    motions: all(sites, |site| (motion(site), DVec3::ZERO)),
                });
            }
            if bodies.len() > 1 {
                let centre = reference.position_m;
                candidates.push(Candidate {
                    words: format!("{whole} about the vertical"),
                    motions: all(sites, |site| {
                        if !belongs(site) {
                            return (DVec3::ZERO, DVec3::ZERO);
                        }
                        let arm = site.position_m - centre;
                        (DVec3::Z.cross(arm), heading(site))
                    }),
                });
            }
        }
        for body in bodies.iter().filter(|body| body.turns) {
            let attitude = body.attitude.conjugate();
            for (word, axis) in [
                ("heading", DVec3::Z),
                ("roll", DVec3::X),
                ("pitch", DVec3::Y),
            ] {
                let rate = |site: &Site| {
                    let turns = site.entity == body.entity;
                    if turns { attitude * axis } else { DVec3::ZERO }
                };
                candidates.push(Candidate {
                    words: format!("the {word} of `{}`", name(body)),
                    motions: all(sites, |site| (DVec3::ZERO, rate(site))),
                });
            }
        }
    }
    candidates
}

fn all(sites: &Sites, motion: impl Fn(&Site) -> (DVec3, DVec3)) -> Vec<(DVec3, DVec3)> {
    sites.all.iter().map(motion).collect()
}

/// A turn of 1 rad/s about the vertical, body frame.
fn heading(site: &Site) -> DVec3 {
    if site.turns {
        site.attitude.conjugate() * DVec3::Z
    } else {
        DVec3::ZERO
    }
}

/// Takes what earlier vectors have of a vector out of it; none if nothing is left.
pub(super) fn independent(mut vector: Vec<f64>, of: &[Vec<f64>]) -> Option<Vec<f64>> {
    let length = |vector: &[f64]| vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    let before = length(&vector);
    for _ in 0..2 {
        for other in of {
            let along: f64 = other.iter().zip(&vector).map(|(a, b)| a * b).sum();
            for (part, other) in vector.iter_mut().zip(other) {
                *part -= along * other;
            }
        }
    }
    let left = length(&vector);
    (left > 1e-6 * before && before > 0.0).then(|| {
        vector.iter_mut().for_each(|part| *part /= left);
        vector
    })
}
