//! The stiffest axial motion of a world's tethers, and the step it allows.
//!
//! In segment space the axial stretching modes are the eigenvectors of
//! `B_st = sqrt(k_s k_t) g_s' W g_t`: g_s the direction of segment s on the points at its ends and W
//! their mobility, 1/m for a node, `I/M - [r] J^-1 [r]` for a place r on a rigid body, nothing at an
//! anchor. Its largest eigenvalue is lambda = omega^2 (1/s^2); with dampers c_s in place of k_s it is
//! the largest damping rate gamma (1/s). Both by power iteration, O(N) each.

use glam::{DMat3, DVec3};

/// A segment as the analysis sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffSegment {
    /// Index of the point at `from`; the one at `to` is the next.
    pub from_point: usize,
    /// Unit vector along the segment.
    pub direction: DVec3,
    /// Stiffness, N/m.
    pub stiffness_n_m: f64,
    /// Damping, N s/m.
    pub damping_n_s_m: f64,
}

/// How a tether point answers to a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mobility {
    /// A node of this inverse mass, 1/kg.
    Node(f64),
    /// A place on a body: the body's index and the place from its centre of mass, inertial axes, m.
    OnBody {
        /// Index among the bodies.
        body: usize,
        /// Place from the centre of mass, m.
        arm_m: DVec3,
    },
    /// An anchor.
    Held,
}

/// How a body answers: inverse mass (1/kg) and inverse inertia in inertial axes (1/(kg m^2)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMobility {
    /// Inverse mass, 1/kg.
    pub inverse_mass: f64,
    /// Inverse inertia, inertial axes, 1/(kg m^2).
    pub inverse_inertia: DMat3,
}

/// The largest eigenvalue of the stretching modes and where it is at home.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stiffest {
    /// lambda in 1/s^2 or gamma in 1/s.
    pub eigenvalue: f64,
    /// The segment that takes the largest part in the mode.
    pub segment: usize,
}

const ITERATIONS: usize = 300;

/// The largest eigenvalue with the `strength` of each segment as its weight: the squared frequency of
/// axial motion (1/s^2) by stiffness in N/m, the damping rate (1/s) by damping in N s/m.
#[must_use]
pub fn stiffest(
    segments: &[StiffSegment],
    points: &[Mobility],
    bodies: &[BodyMobility],
    strength: impl Fn(&StiffSegment) -> f64,
) -> Stiffest {
    let weights: Vec<f64> = segments
        .iter()
        .map(|segment| strength(segment).sqrt())
        .collect();
    power_iteration(segments, points, bodies, &weights)
}

fn power_iteration(
    segments: &[StiffSegment],
    points: &[Mobility],
    bodies: &[BodyMobility],
    weights: &[f64],
) -> Stiffest {
    if segments.is_empty() || weights.iter().all(|weight| *weight == 0.0) {
        return Stiffest::default();
    }
    // Neighbours out of phase, unevenly: close to the stiffest mode and orthogonal to none.
    let mut mode: Vec<f64> = (0..segments.len())
        .map(|k| if k % 2 == 0 { 1.0 } else { -1.0 } * (1.0 + 0.1 / (k as f64 + 1.0)))
        .collect();
    let mut next = vec![0.0; mode.len()];
    let mut forces = vec![DVec3::ZERO; points.len()];
    let mut motion = vec![(DVec3::ZERO, DVec3::ZERO); bodies.len()];
    let mut eigenvalue = 0.0;
    for _ in 0..ITERATIONS {
        let norm = mode.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm == 0.0 {
            return Stiffest::default();
        }
        mode.iter_mut().for_each(|x| *x /= norm);
        apply(
            segments,
            points,
            bodies,
            weights,
            &mode,
            (&mut forces, &mut motion),
            &mut next,
        );
        eigenvalue = mode.iter().zip(&next).map(|(a, b)| a * b).sum();
        std::mem::swap(&mut mode, &mut next);
    }
    let largest = mode
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .map_or(0, |(index, _)| index);
    // A power iteration approaches from below; on long chains by less than this.
    Stiffest {
        eigenvalue: eigenvalue * 1.001,
        segment: largest,
    }
}

/// `out = B mode`; forces on points and motion of bodies are scratch.
fn apply(
    segments: &[StiffSegment],
    points: &[Mobility],
    bodies: &[BodyMobility],
    weights: &[f64],
    mode: &[f64],
    (forces, motion): (&mut [DVec3], &mut [(DVec3, DVec3)]),
    out: &mut [f64],
) {
    forces.fill(DVec3::ZERO);
    motion.fill((DVec3::ZERO, DVec3::ZERO));
    for ((segment, weight), amplitude) in segments.iter().zip(weights).zip(mode) {
        let pull = weight * amplitude * segment.direction;
        forces[segment.from_point] += pull;
        forces[segment.from_point + 1] -= pull;
    }
    for (point, force) in points.iter().zip(&*forces) {
        if let Mobility::OnBody { body, arm_m } = point {
            motion[*body].0 += *force;
            motion[*body].1 += arm_m.cross(*force);
        }
    }
    for (motion, body) in motion.iter_mut().zip(bodies) {
        *motion = (
            body.inverse_mass * motion.0,
            body.inverse_inertia * motion.1,
        );
    }
    let answer = |index: usize| match points[index] {
        Mobility::Node(inverse_mass) => inverse_mass * forces[index],
        Mobility::OnBody { body, arm_m } => motion[body].0 + motion[body].1.cross(arm_m),
        Mobility::Held => DVec3::ZERO,
    };
    for ((out, segment), weight) in out.iter_mut().zip(segments).zip(weights) {
        let stretch = answer(segment.from_point) - answer(segment.from_point + 1);
        *out = weight * segment.direction.dot(stretch);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_stiffness(segment: &StiffSegment) -> f64 {
        segment.stiffness_n_m
    }

    fn segment(from_point: usize, stiffness_n_m: f64) -> StiffSegment {
        StiffSegment {
            from_point,
            direction: DVec3::Z,
            stiffness_n_m,
            damping_n_s_m: 0.0,
        }
    }

    /// A uniform chain between walls: omega^2 = 4 k/m sin^2(n pi / (2 (n + 1))).
    #[test]
    fn a_uniform_chain_has_its_closed_form() {
        let n = 12;
        let (k, m) = (250.0, 0.3);
        let segments: Vec<_> = (0..=n).map(|index| segment(index, k)).collect();
        let mut points = vec![Mobility::Node(1.0 / m); n + 2];
        points[0] = Mobility::Held;
        points[n + 1] = Mobility::Held;
        let angle = n as f64 * std::f64::consts::PI / (2.0 * (n as f64 + 1.0));
        let expected = 4.0 * k / m * angle.sin().powi(2);
        let found = stiffest(&segments, &points, &[], by_stiffness).eigenvalue;
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }

    /// A rod of mass m and inertia J pulled at an arm r across: 1/m + r^2/J.
    #[test]
    fn an_arm_makes_a_body_lighter() {
        let bodies = [BodyMobility {
            inverse_mass: 1.0 / 4.0,
            inverse_inertia: DMat3::from_diagonal(DVec3::splat(1.0 / 2.0)),
        }];
        let points = [
            Mobility::Held,
            Mobility::OnBody {
                body: 0,
                arm_m: DVec3::new(3.0, 0.0, 0.0),
            },
        ];
        let found = stiffest(&[segment(0, 100.0)], &points, &bodies, by_stiffness).eigenvalue;
        let expected = 100.0 * (0.25 + 9.0 / 2.0);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
}
