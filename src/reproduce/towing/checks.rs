//! What the towed line is held against, and what it comes to.

use super::super::check::{Check, Tolerance, largest};
use super::{TowingSettings, WindResult};

pub(super) const TITLE: &str =
    "A probe on 9.7 km of line: static against dynamic (sec. 5.1, figure 15)";

pub(super) const PAPER_SHOWS: &str = "Figure 15 lays the line of the dynamic simulation beside that of a static model. The text calls the result satisfying, \
puts the differences down to the approaches, and calls the dynamic one more exact for its inertia, elasticity and \
distributed loads. Diameter and stiffness of the line, the shear and the atmosphere are not given.";

/// The elastic cable in equilibrium by a separate program (shooting from the top, adaptive order 8 at 1e-10): wind at the
/// depth of the straight line (m/s), x and depth of the probe (m), tension at the top (N).
const SEPARATE: [(f64, f64, f64, f64); 2] = [
    (5.0, 4906.649, 52_000.0 - 43_714.633, 53.4911),
    (10.0, 6939.230, 52_000.0 - 45_413.413, 51.9502),
];

/// Length of the line, m.
const LENGTH_M: f64 = 9700.0;
/// Fewer nodes do not tell an order.
const ORDERLY_NODES: u32 = 50;
/// Shorter flights have not come to rest, s.
const SETTLED_S: f64 = 20_000.0;

pub(super) fn checks(settings: &TowingSettings, results: &[WindResult]) -> Vec<Check> {
    let mut checks = Vec::new();
    for result in results {
        checks.extend(continuous(result));
        let wind = result.wind_m_s;
        if settings.nodes >= ORDERLY_NODES {
            checks.push(
                Check::of(
                    format!("order in which the line at rest becomes the cable, {wind} m/s"),
                    "",
                    result.order(),
                )
                .against(
                    2.0,
                    Tolerance::Absolute(0.1),
                    "half of each segment's mass and drag to each of its ends",
                ),
            );
            let part = 100.0 * result.error_m() / LENGTH_M;
            checks.push(
                Check::of(
                    format!("line at rest from the continuous cable over its length, {wind} m/s"),
                    "%",
                    part,
                )
                .paper("\"differences due to the approaches\"")
                .vanishes(0.1, "the continuous cable"),
            );
        }
        if settings.duration_s >= SETTLED_S {
            checks.push(
                Check::of(
                    format!("end of the flight from the line at rest, {wind} m/s"),
                    "m",
                    result.unsettled_m(),
                )
                .paper("the dynamic one is \"more exact\"")
                .vanishes(0.01, "the static solution"),
            );
        }
    }
    checks
}

fn continuous(result: &WindResult) -> Vec<Check> {
    let mut checks = Vec::new();
    for (wind, x_m, depth_m, tension_n) in SEPARATE {
        if wind != result.wind_m_s {
            continue;
        }
        let cable = &result.continuous;
        let source = "a separate program, to its last digits";
        for (what, ours, expected) in [
            ("offset of the probe", cable.probe().x_m, x_m),
            ("depth of the probe", cable.depth_m(), depth_m),
        ] {
            let what = format!("{what}, continuous cable, {wind} m/s");
            checks.push(Check::of(what, "m", ours).against(
                expected,
                Tolerance::Absolute(0.01),
                source,
            ));
        }
        let what = format!("tension at the top, continuous cable, {wind} m/s");
        checks.push(Check::of(what, "N", cable.top_tension_n).against(
            tension_n,
            Tolerance::Absolute(1e-3),
            source,
        ));
    }
    checks
}

pub(super) fn sentence(settings: &TowingSettings, results: &[WindResult]) -> String {
    let error_m = largest(results.iter().map(WindResult::error_m));
    let mut flown = String::new();
    if settings.duration_s >= SETTLED_S {
        let apart_m = largest(results.iter().map(WindResult::unsettled_m));
        flown = format!(", and the flight ends within {apart_m:.3} m of it");
    }
    format!(
        "Static and dynamic model are one: the line at rest with {} nodes is within {error_m:.2} m of the continuous \
         cable{flown}. With the same forces the static solution is where the dynamic one rests: neither is the more exact, which \
         the paper claims of the dynamic one. Its curves cannot be had again without the diameter, the shear and the air.",
        settings.nodes
    )
}
