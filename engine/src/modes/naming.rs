//! A name for a mode where its shares make one clear.

use super::participation::BodyMotion;
use super::{Motion, Share};

/// A share beyond this gives a mode its name.
const MOST: f64 = 0.5;
/// Bodies that move less than this part of the most moving one are not named.
const LEAST_AMPLITUDE: f64 = 0.1;
/// Horizontal motion is along an axis if this part of it is.
const ALONG_AXIS: f64 = 0.99;

/// The name, from shares that are sorted, the motions of bodies, and whether it oscillates.
pub(super) fn name(shares: &[Share], bodies: &[BodyMotion], oscillates: bool) -> String {
    let sum = |counts: &dyn Fn(&Share) -> bool| -> f64 {
        let counted = shares.iter().filter(|share| counts(share));
        counted.map(|share| share.part).sum()
    };
    let of = |motion: Motion| sum(&|share| share.motion == motion);
    let tether = of(Motion::Transverse) + of(Motion::Axial);
    if tether > MOST {
        return tether_wave(
            shares,
            of(Motion::Axial) > of(Motion::Transverse),
            oscillates,
        );
    }
    if let Some(share) = shares.first()
        && matches!(share.motion, Motion::Roll | Motion::Pitch | Motion::Yaw)
        && share.part > MOST
    {
        return format!("{} of `{}`", share.motion.word(), share.entity);
    }
    let (x, y, z) = (of(Motion::X), of(Motion::Y), of(Motion::Z));
    let horizontal = x + y;
    let moves = horizontal + z;
    if z + of(Motion::Axial) > MOST && z > horizontal {
        let verb = if oscillates { "bounce" } else { "rise" };
        return together(verb, "heave", 2, bodies, oscillates);
    }
    if horizontal > 0.5 * moves && horizontal + of(Motion::Transverse) > MOST {
        let axis = if x > ALONG_AXIS * horizontal {
            " in x"
        } else if y > ALONG_AXIS * horizontal {
            " in y"
        } else {
            ""
        };
        let verb = if oscillates { "swing" } else { "drift" };
        let axis_index = usize::from(y > x);
        let verb = format!("{verb}{axis}");
        return together(&verb, &verb, axis_index, bodies, oscillates);
    }
    "mixed".to_owned()
}

fn tether_wave(shares: &[Share], is_axial: bool, oscillates: bool) -> String {
    let kind = if is_axial { "axial" } else { "transverse" };
    let word = if oscillates { "wave" } else { "motion" };
    let largest = shares
        .iter()
        .find(|share| matches!(share.motion, Motion::Transverse | Motion::Axial));
    let who = largest.map_or("", |share| &share.entity);
    format!("{kind} {word} of `{who}`")
}

/// Which bodies move along an axis, and whether with or against each other: `all` if there are several
/// and all go together.
fn together(verb: &str, all: &str, axis: usize, bodies: &[BodyMotion], oscillates: bool) -> String {
    let amplitude = |body: &BodyMotion| body.linear.part(axis).norm_sqr().sqrt();
    let largest = bodies
        .iter()
        .max_by(|a, b| amplitude(a).total_cmp(&amplitude(b)));
    let Some(largest) = largest else {
        return verb.to_owned();
    };
    let moving = bodies
        .iter()
        .filter(|body| amplitude(body) > LEAST_AMPLITUDE * amplitude(largest));
    let phase =
        |body: &BodyMotion| (largest.linear.part(axis).conj() * body.linear.part(axis)).re >= 0.0;
    let (with, against): (Vec<&BodyMotion>, Vec<&BodyMotion>) =
        moving.partition(|body| phase(body));
    let names = |bodies: &[&BodyMotion]| -> String {
        let names: Vec<String> = bodies.iter().map(|b| format!("`{}`", b.name)).collect();
        names.join(", ")
    };
    if !against.is_empty() {
        return format!("{verb}: {} against {}", names(&with), names(&against));
    }
    let word = if with.len() > 1 && oscillates {
        all
    } else {
        verb
    };
    format!("{word} of {}", names(&with))
}
