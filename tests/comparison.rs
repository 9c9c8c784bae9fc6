//! The comparison case (paper, sec. 4.2) against trajectories computed by a separate program (adaptive
//! order 8, tolerance 1e-10): uniform density, interior lumping, attachments at the centres of mass.
//!
//! A few values stand here; where `../shared/reference` exists, every second of it is compared too.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreadable_literal,
    reason = "a test fails by panicking, and its digits come from a table"
)]

mod flight;

use flight::{CENTRED_COMPARISON, fly, fly_scene, reference_displacements, scene_file};
use glam::DVec3;

/// Displacements from the start at 100 s, balloon then gondola, m.
const AT_100_S: [DVec3; 2] = [
    DVec3::new(52.034195, 42.198379, 65.066100),
    DVec3::new(52.294133, 44.439419, 65.071886),
];

fn largest_difference(integrator: &str) -> f64 {
    let mut overrides = CENTRED_COMPARISON.to_vec();
    overrides.push(integrator);
    let results = fly_scene("paper/comparison_900m.ron", &overrides);
    let balloon = results.positions("balloon");
    let gondola = results.positions("gondola");
    assert!((balloon[0].1.z - 56_000.0).abs() < 1e-9);
    assert!((gondola[0].1.z - 55_095.927_242_957).abs() < 1e-8);
    let displaced = |track: &[(f64, DVec3)], row: usize| track[row].1 - track[0].1;
    let mut largest = 0.0_f64;
    for (track, expected) in [&balloon, &gondola].into_iter().zip(AT_100_S) {
        let difference = displaced(track, 100) - expected;
        largest = largest.max(difference.abs().max_element());
    }
    let mut at_seconds = 0.0_f64;
    for (second, [balloon_m, gondola_m]) in reference_displacements("comparison_lumped.csv")
        .into_iter()
        .enumerate()
    {
        assert_eq!(balloon[second].0, second as f64);
        for (track, expected) in [(&balloon, balloon_m), (&gondola, gondola_m)] {
            let difference = displaced(track, second) - expected;
            at_seconds = at_seconds.max(difference.abs().max_element());
        }
    }
    println!("against six printed digits: {largest:.3e} m; every second: {at_seconds:.3e} m");
    largest.max(at_seconds)
}

/// The printed digits end at 1e-6; the trajectory is asked for to 1e-5.
#[test]
fn val_adaptive_follows_the_reference() {
    let difference = largest_difference("run.integrator=Adaptive(relative_tolerance: 1e-9)");
    println!("adaptive at 1e-9: {difference:.3e} m");
    assert!(difference < 1e-5, "{difference}");
}

#[test]
fn val_fixed_step_follows_the_reference() {
    let difference = largest_difference("run.integrator=Fixed()");
    println!("RK4 at its default step: {difference:.3e} m");
    assert!(difference < 1e-3, "{difference}");
}

/// A variant of the comparison case with displacements of balloon and gondola (m) at three times (s), as
/// a separate program found them: Python and scipy's DOP853 at 1e-11, in which a body with its carried
/// half segments is one rigid body with a shifted centre of mass.
struct Variant {
    overrides: &'static [&'static str],
    rows: [(usize, [f64; 3], [f64; 3]); 3],
}

const UNIFORM: &str = "environment.atmosphere=Uniform(density_kg_m3: 0.8183)";
const EXPONENTIAL: &str = "environment.atmosphere=Exponential(density_kg_m3: 0.8183, \
                           altitude_m: 56000, scale_height_m: 8200)";
const INTERIOR: &str = "entities.tether.Tether.lumping=Interior";
const ADDED_MASS: &str = "entities.balloon.AddedMass=()";

fn assert_follows(variant: &Variant) {
    let mut overrides = variant.overrides.to_vec();
    overrides.push("run.integrator=Adaptive(relative_tolerance: 1e-10)");
    let results = fly_scene("paper/comparison_900m.ron", &overrides);
    for (entity, which) in [("balloon", 0), ("gondola", 1)] {
        let track = results.positions(entity);
        for (second, balloon, gondola) in variant.rows {
            let expected = DVec3::from_array([balloon, gondola][which]);
            let difference = (track[second].1 - track[0].1).distance(expected);
            println!("{entity} at {second} s: {difference:.1e} m");
            assert!(difference < 1e-8, "{entity} at {second} s: {difference}");
        }
    }
}

#[test]
fn val_exponential_density() {
    assert_follows(&Variant {
        overrides: &[
            EXPONENTIAL,
            INTERIOR,
            CENTRED_COMPARISON[2],
            CENTRED_COMPARISON[3],
        ],
        rows: [
            (
                30,
                [36.047034009, 22.584892759, 0.001156796],
                [39.201483987, 8.583944983, 0.113452296],
            ),
            (
                60,
                [58.158557633, 46.166591830, 25.855652485],
                [56.489807654, 58.932292099, 25.922387777],
            ),
            (
                100,
                [51.622811411, 42.363582487, 44.885018254],
                [51.419685662, 44.644286659, 44.900585503],
            ),
        ],
    });
}

#[test]
fn val_offset_attachments() {
    assert_follows(&Variant {
        overrides: &[UNIFORM, INTERIOR],
        rows: [
            (
                30,
                [35.738258962, 22.533844059, -0.003665001],
                [38.536963042, 8.198823093, 0.112024694],
            ),
            (
                60,
                [58.132758115, 45.836171555, 26.017434796],
                [56.650290018, 59.080289883, 26.081270419],
            ),
            (
                100,
                [51.960236829, 42.218354159, 65.053958055],
                [52.257379914, 44.449990773, 65.059727141],
            ),
        ],
    });
}

#[test]
fn val_added_mass() {
    assert_follows(&Variant {
        overrides: &[
            UNIFORM,
            INTERIOR,
            CENTRED_COMPARISON[2],
            CENTRED_COMPARISON[3],
            ADDED_MASS,
        ],
        rows: [
            (
                30,
                [40.395822768, 18.988895285, -0.008447967],
                [34.395300723, 7.110245143, 0.088398761],
            ),
            (
                60,
                [60.550505763, 46.115668518, 21.567818625],
                [62.001048699, 61.651242460, 21.691919971],
            ),
            (
                100,
                [54.979644003, 51.508697790, 68.471945391],
                [59.839901225, 53.577645617, 68.493212909],
            ),
        ],
    });
}

#[test]
fn val_carried_masses_offsets_density_and_added_mass_together() {
    assert_follows(&Variant {
        overrides: &[EXPONENTIAL, ADDED_MASS],
        rows: [
            (
                30,
                [40.643243768, 19.064903281, -0.006725912],
                [35.014328512, 7.488021462, 0.083473706],
            ),
            (
                60,
                [60.532610553, 46.507641802, 21.497992834],
                [61.915548562, 61.547112427, 21.618671907],
            ),
            (
                100,
                [54.420080331, 52.003795302, 54.275230375],
                [59.444986356, 54.569700863, 54.310219970],
            ),
        ],
    });
}

/// A gondola hung off its axis that spins: everything about rotation takes part (tilts of 26 degrees).
#[test]
fn val_a_spinning_gondola_off_its_axis() {
    assert_follows(&Variant {
        overrides: &[
            UNIFORM,
            "entities.tether.Tether.to=(\"gondola\", (0.2, 0.1, 0.5))",
            "entities.gondola.Body.inertia=Box(1, 0.8, 0.6)",
            "entities.gondola.Motion=(rate_rad_s: (0, 0, 0.5))",
            "entities.balloon.Pose=(position_m: (0, 0, 56000))",
            "entities.gondola.Pose=(position_m: (0, 0, 55091.82396824148), attitude: \
             Quaternion(0.09334295411262875, -0.1866859082252575, 0.0, 0.9779751860797076))",
        ],
        rows: [
            (
                30,
                [35.756237076, 22.537431855, -0.003541183],
                [38.519745099, 8.204044883, 0.111938260],
            ),
            (
                60,
                [58.135469843, 45.829046037, 26.017394148],
                [56.664117676, 59.094149937, 26.081576896],
            ),
            (
                100,
                [51.941580711, 42.222814826, 65.048196753],
                [52.249718336, 44.457597734, 65.053990494],
            ),
        ],
    });
}

/// The same gondola without a pose starts with the attachment plumb above its centre of mass and the
/// heading that the shortest turn leaves it: the attitude worked out by hand in the test above.
#[test]
fn a_gondola_off_its_axis_starts_plumb() {
    let results = fly_scene(
        "paper/comparison_900m.ron",
        &[
            UNIFORM,
            "entities.tether.Tether.to=(\"gondola\", (0.2, 0.1, 0.5))",
            "run.duration_s=1",
        ],
    );
    let (_, start) = results.states("gondola").next().unwrap();
    let attitude = start.rotation.unwrap().0;
    let arm = attitude * DVec3::new(0.2, 0.1, 0.5);
    assert!(arm.truncate().length() < 1e-9, "{arm}");
    let by_hand = DVec3::new(0.09334295411262875, -0.1866859082252575, 0.0);
    assert!(
        (DVec3::new(attitude.x, attitude.y, attitude.z) - by_hand).length() < 1e-7,
        "{attitude}"
    );
    assert!((start.position_m.z - 55091.82396824148).abs() < 1e-6);
}

/// As shipped: attachments off the centres, half-segment lumping, VIRA. The balloon starts where it
/// floats, everything else below it, and nothing moves before the first gust.
#[test]
fn the_shipped_scene_rests_until_the_first_gust() {
    let results = fly_scene("paper/comparison_900m.ron", &["run.duration_s=10"]);
    for entity in ["balloon", "gondola", "tether/5"] {
        let track = results.positions(entity);
        for (time, position) in &track {
            let moved = position.distance(track[0].1);
            assert!(moved < 1e-8, "{entity} moved {moved} m by {time} s");
        }
    }
}

/// The force on the balloon is the weight of all below it (g = 8.87: 100 kg and the whole line), and
/// the one on the gondola its own weight; segment tensions are half a segment's weight away.
#[test]
fn attachment_tensions_balance_the_weight() {
    let results = fly_scene("paper/comparison_900m.ron", &["run.duration_s=1"]);
    let line = 1440.0 * 900.0 * std::f64::consts::PI * 1e-6;
    let from = results.channel("tether", "tension_from_n")[0].1;
    let to = results.channel("tether", "tension_to_n")[0].1;
    assert!(
        (from / (8.87 * (100.0 + line)) - 1.0).abs() < 1e-9,
        "{from}"
    );
    assert!((to / (8.87 * 100.0) - 1.0).abs() < 1e-9, "{to}");
    let top = results.frames[0].segments[0].tension_n;
    assert!(
        (top - 8.87 * (100.0 + line * (1.0 - 0.5 / 11.0))).abs() < 1e-6,
        "{top}"
    );
}

/// A scene file must be loadable from anywhere; `fly` and `fly_scene` agree.
#[test]
fn text_and_file_are_one_scene() {
    let text = std::fs::read_to_string(scene_file("paper/comparison_900m.ron")).unwrap();
    let from_text = fly(&text, &["run.duration_s=2"]);
    let from_file = fly_scene("paper/comparison_900m.ron", &["run.duration_s=2"]);
    assert_eq!(from_text.frames, from_file.frames);
}
