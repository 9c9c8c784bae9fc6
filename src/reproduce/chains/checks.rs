//! What the chains are held against.

use aerobot_components::body::Body;
use aerobot_components::tether::Tether;
use aerobot_engine::modes::{Mode, Motion};
use aerobot_engine::recording::number::number_text;
use aerobot_engine::scene::Scene;

use super::super::check::{Check, Tolerance, largest};
use super::super::pendulums::mass_kg;
use super::{Architecture, BALLOON, ChainResult, GONDOLA, GUSTS_S, Load, MAGNETOMETER, tethers};

/// What each set of equal tethers carries: its share of all that hangs below.
pub(super) fn loads(scene: &Scene, architecture: Architecture) -> Vec<Load> {
    let gravity = scene.environment.gravity.acceleration_m_s2(0.0);
    let body_kg = |name: &str| {
        let body = scene.entity(name).and_then(|entity| entity.get::<Body>());
        body.map_or(f64::NAN, |body| body.mass_kg)
    };
    let bodies = architecture.bodies();
    let mut loads = Vec::new();
    for lower in &bodies[1..] {
        let upper = if *lower == GONDOLA { BALLOON } else { GONDOLA };
        let own: Vec<(&str, &Tether)> = tethers(scene, upper, lower).collect();
        let lines_kg: f64 = own.iter().map(|(_, tether)| tether.mass_kg()).sum();
        let hangs_kg = if upper == BALLOON {
            mass_kg(scene) - body_kg(BALLOON) - lines_kg
        } else {
            body_kg(lower)
        };
        let below_n = gravity * hangs_kg / own.len() as f64;
        loads.push(Load {
            tethers: own.iter().map(|(name, _)| (*name).to_owned()).collect(),
            above_n: below_n + gravity * lines_kg / own.len() as f64,
            below_n,
        });
    }
    loads
}

pub(super) fn checks(results: &[ChainResult]) -> Vec<Check> {
    let mut checks = Vec::new();
    for result in results {
        checks.extend(at_rest(result));
        if result.architecture == Architecture::MultiTether {
            checks.extend(symmetry(result));
            checks.extend(pair_modes(result));
        } else {
            checks.push(magnetometer(result));
        }
        if result.lumped.simulated_s > 2.0 * GUSTS_S.0 {
            checks.extend(limit(result));
        }
    }
    checks
}

/// The weights at rest, mean over the tethers of a set: only where the load is in the middle do they share it evenly.
fn at_rest(result: &ChainResult) -> Vec<Check> {
    let mut checks = Vec::new();
    for flight in result.flights() {
        for load in &result.loads {
            let mean = |channel| {
                let tensions = load.tethers.iter();
                let sum: f64 = tensions
                    .map(|tether| flight.first(tether, channel).unwrap_or(f64::NAN))
                    .sum();
                sum / load.tethers.len() as f64
            };
            let set = load.tethers.first().map_or("", |name| {
                name.split_once('/').map_or(name.as_str(), |(ring, _)| ring)
            });
            for (end, channel, expected_n, source) in [
                (
                    "above",
                    "tension_from_n",
                    load.above_n,
                    "the weight m g/n + w",
                ),
                ("below", "tension_to_n", load.below_n, "the weight m g/n"),
            ] {
                let what = format!(
                    "{}: pull on what is {end} `{set}` at rest, {}",
                    result.architecture.name(),
                    flight.formulation.name()
                );
                checks.push(Check::of(what, "N", mean(channel)).against(
                    expected_n,
                    // A ring that narrows pulls inward too: (0.5 m/50 m)^2/2.
                    Tolerance::Relative(2e-4),
                    source,
                ));
            }
        }
    }
    checks
}

/// As long as the wind is along x, the mirror image of the motion is the motion.
fn symmetry(result: &ChainResult) -> Vec<Check> {
    let of = |flight: &super::Flight| {
        let turned = flight.largest(GONDOLA, "heading_rad", GUSTS_S.1);
        let what = format!(
            "multi-tether: heading of the gondola in the gust along x, {}",
            flight.formulation.name()
        );
        Check::of(what, "rad", turned.unwrap_or(f64::NAN))
            .vanishes(1e-9, "mirror symmetry, to round-off")
    };
    result.flights().map(of).into()
}

/// The oscillating mode with the largest share of a motion of a body.
pub(super) fn mode_of<'a>(modes: &'a [Mode], body: &str, motion: Motion) -> Option<&'a Mode> {
    let own = modes.iter().filter(|mode| mode.oscillates());
    own.max_by(|a, b| a.share(body, motion).total_cmp(&b.share(body, motion)))
}

fn hz(result: &ChainResult, body: &str, motion: Motion) -> f64 {
    mode_of(&result.modes, body, motion).map_or(f64::NAN, Mode::frequency_hz)
}

fn pair_modes(result: &ChainResult) -> Vec<Check> {
    let swing = hz(result, GONDOLA, Motion::X);
    let yaw = hz(result, GONDOLA, Motion::Yaw);
    vec![
        Check::of(
            "multi-tether: swing of balloon against gondola",
            "Hz",
            swing,
        )
        .against(
            result.pair.swing_hz(),
            Tolerance::Relative(0.01),
            "the closed form of a dumbbell, massless tethers",
        ),
        Check::of(
            "multi-tether: yaw of the gondola against the balloon",
            "Hz",
            yaw,
        )
        .against(
            result.pair.yaw_hz(),
            Tolerance::Relative(0.01),
            "the closed form of a multifilar pendulum, massless tethers",
        ),
    ]
}

fn magnetometer(result: &ChainResult) -> Check {
    Check::of(
        "flight-chain: swing of the magnetometer",
        "Hz",
        hz(result, MAGNETOMETER, Motion::X),
    )
    .against(
        result.magnetometer_hz.unwrap_or(f64::NAN),
        Tolerance::Relative(0.01),
        "the closed form sqrt((g/l)(1 + m/M))/(2 pi)",
    )
}

/// The formulations must approach each other as 1/EA.
fn limit(result: &ChainResult) -> Vec<Check> {
    let name = result.architecture.name();
    let mut checks: Vec<Check> = result
        .limit
        .windows(2)
        .filter_map(|pair| match pair {
            [(less, before_m), (more, after_m)] => {
                let power = libm::log(before_m / after_m) / libm::log(more / less);
                let (less, more) = (number_text(*less), number_text(*more));
                let what = format!("{name}: power of 1/EA in which the formulations approach, EA x {less} to {more}");
                Some(Check::of(what, "", power).against(
                    1.0,
                    Tolerance::Absolute(0.1),
                    "first order in the stretch, which is as 1/EA",
                ))
            }
            _ => None,
        })
        .collect();
    let apart = result.architecture.bodies().iter();
    let apart = apart.map(|body| super::largest_difference_m(&result.lumped, &result.links, body));
    checks.push(
        Check::of(
            format!("{name}: largest difference of the formulations"),
            "m",
            largest(apart),
        )
        .vanishes(0.1, "the other formulation, inextensible"),
    );
    checks
}
