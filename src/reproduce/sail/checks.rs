//! What the sail is held against, and what it comes to.

use std::f64::consts::PI;

use super::super::check::{Check, Tolerance};
use super::{BAND_M, SailStudy, Trim};

pub(super) const TITLE: &str = "A sail that steers the balloon (sec. 5.2, figures 17 to 19)";

pub(super) const PAPER_SHOWS: &str = "Figure 17 defines the angles of wing and rudder, figure 18 is the zonal wind over altitude, and figure 19 has the balloon \
come to y = 10 m and stay there, with some oscillations, as the text says, due to the proportional law. The area of \
the rudder, C_D0, masses, the side of the wing and the tether are not given.";

/// Wing 3 m2, 0.5 m from the centre of mass; rudder 0.5 m2, 4 m aft; aspect ratio 5.
const WING_M3: f64 = 0.5 * 3.0;
const RUDDER_M3: f64 = 4.0 * 0.5;
const ASPECT_RATIO: f64 = 5.0;

/// By hand, by lift alone: with the slope a, the downwash e' = 2 a/(pi AR), its sign t (+1 right, -1 as printed) and the
/// wing's side s (+1 ahead, -1 aft) the moments about the centre of mass balance at
///
/// ```text
/// alpha_w/delta = l_r S_r/(l_r S_r (1 - t e') - s l_w S_w)
/// F/(q delta) = -a (S_w alpha_w/delta + S_r ((1 - t e') alpha_w/delta - 1))
/// ```
struct ByHand {
    incidence: f64,
    force_m2_rad: f64,
    stiffness_m3_rad: f64,
}

impl ByHand {
    fn of(slope: f64, side: f64, sign: f64) -> Self {
        let kept = 1.0 - sign * 2.0 * slope / (PI * ASPECT_RATIO);
        let arms_m3 = RUDDER_M3 * kept - side * WING_M3;
        let incidence = RUDDER_M3 / arms_m3;
        Self {
            incidence,
            force_m2_rad: -slope * (3.0 * incidence + 0.5 * (kept * incidence - 1.0)),
            stiffness_m3_rad: slope * arms_m3,
        }
    }

    /// That of a sail by the words which tell it.
    fn of_words(words: &str) -> Self {
        let has = |word: &str| words.contains(word);
        let slope = 2.0 * PI
            / if has("2/AR") {
                1.0 + 2.0 / ASPECT_RATIO
            } else {
                1.0
            };
        let side = if has("ahead") { 1.0 } else { -1.0 };
        let sign = if has("as printed") { -1.0 } else { 1.0 };
        Self::of(slope, side, sign)
    }
}

pub(super) fn checks(found: &SailStudy) -> Vec<Check> {
    let mut checks: Vec<Check> = found
        .trims
        .iter()
        .flat_map(|(words, trim)| of_trim(words, trim))
        .collect();
    if let Some((words, response)) = found.flights.first()
        && let (Some(arrived_s), Some((end_s, ..))) = (response.arrived_s, response.rows.last())
        && *end_s >= 1000.0
    {
        checks.push(
            Check::of(
                format!(
                    "time after which the balloon stays within {BAND_M} m of its target, {words}"
                ),
                "s",
                arrived_s,
            )
            .paper("it is at its target")
            .as_in_paper("it arrives and stays", true),
        );
        let percent = 100.0 * response.overshoot;
        checks.push(
            Check::of(format!("overshoot, {words}"), "%", percent)
                .paper("some oscillations")
                .as_in_paper("above 0 %", percent > 0.0),
        );
    }
    checks.extend(found.separate.checks());
    checks
}

fn of_trim(words: &str, trim: &Trim) -> Vec<Check> {
    let expected = ByHand::of_words(words);
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let near = |what: &str, unit, ours: f64, expected: f64| {
        Check::of(format!("{what}: {words}"), unit, ours).against(
            expected,
            Tolerance::Relative(1e-9),
            "the balance of moments by hand",
        )
    };
    let mut checks = vec![
        near(
            "incidence over deflection",
            "",
            trim.incidence_per_deflection,
            expected.incidence,
        ),
        near(
            "side force over q delta",
            "m2/rad",
            trim.force_m2_rad,
            expected.force_m2_rad,
        ),
    ];
    let stability = |stiffness: f64| {
        if stiffness > 0.0 {
            "stable"
        } else {
            "unstable"
        }
    };
    let (ours, by_hand) = (
        stability(trim.stiffness_m3_rad),
        stability(expected.stiffness_m3_rad),
    );
    checks.push(
        Check::of(format!("stability in yaw: {words}"), "", ours).as_said(
            by_hand,
            ours == by_hand,
            "the sign of the moment by hand",
        ),
    );
    checks
}

pub(super) fn sentence(found: &SailStudy) -> String {
    let unstable = found
        .trims
        .iter()
        .filter(|(_, trim)| trim.stiffness_m3_rad <= 0.0)
        .count();
    let response = found
        .flights
        .first()
        .map_or_else(String::new, |(_, response)| {
            let percent = 100.0 * response.overshoot;
            match response.arrived_s {
                Some(arrived_s) => {
                    format!(" (overshoot {percent:.0} %, within {BAND_M} m after {arrived_s:.0} s)")
                }
                None => String::new(),
            }
        });
    format!(
        "As in the paper the proportional law brings the balloon to its target with oscillations{response}. Equation 5 has \
         the axes of lift and drag exchanged, and the downwash in the rudder's incidence has the wrong sign, which hides an \
         instability: with the right one {unstable} of {} sails, those with the wing ahead, turn away.",
        found.trims.len()
    )
}
