//! Modes of small motion against closed forms, one solver against the other, one formulation against the
//! other, and a run.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use std::f64::consts::{PI, TAU};

use aerobot::engine::modes::{Mode, ModeSolver, Modes, ModesRequest, Motion};
use aerobot::engine::plugin::Simulator;
use aerobot::engine::scene::Scene;
use flight::{CENTRED_COMPARISON, assert_relative, fly_scene, load, owned, scene_file};

const G: f64 = 8.87;

fn find(simulator: &Simulator, scene: &Scene, solver: ModeSolver) -> Modes {
    let mut simulation = simulator.build(scene).unwrap_or_else(|e| panic!("{e}"));
    let request = ModesRequest { count: 12, solver };
    let found = simulation.modes(scene, &request);
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    for mode in &found.modes {
        println!(
            "{:.9} Hz {:.3e} {}",
            mode.frequency_hz(),
            mode.damping_ratio(),
            mode.name
        );
        let sum: f64 = mode.shares.iter().map(|share| share.part).sum();
        assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    }
    found
}

fn modes_of_text(text: &str, overrides: &[&str]) -> Modes {
    let simulator = Simulator::new();
    find(
        &simulator,
        &load(&simulator, text, overrides),
        ModeSolver::Automatic,
    )
}

fn modes_of_scene(name: &str, overrides: &[&str], solver: ModeSolver) -> Modes {
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file(name), &owned(overrides))
        .unwrap_or_else(|error| panic!("{error}"));
    find(&simulator, &scene, solver)
}

/// The slowest mode of which an entity has most by one motion.
fn mode_of<'a>(found: &'a Modes, entity: &str, motion: Motion) -> &'a Mode {
    let mut modes = found.modes.iter();
    modes
        .find(|mode| mode.share(entity, motion) > 0.5)
        .unwrap_or_else(|| panic!("no {} of `{entity}`", motion.word()))
}

/// `what` hung from an anchor at 56 km in vacuum, with more entities.
fn hung(entities: &str) -> String {
    format!(
        "(name: \"test\", environment: (gravity: Constant({G}), atmosphere: Vacuum), entities: {{\
         \"anchor\": (Fixed: (position_m: (0, 0, 56_000))), {entities}}}, \
         run: (duration_s: 10, output_every_s: 1))"
    )
}

/// omega^2 = g / H, and g / (1.5 H) with half the displaced mass added.
#[test]
fn balloons_heave_in_exponential_air() {
    let found = modes_of_scene("examples/balloon_heave.ron", &[], ModeSolver::Automatic);
    let slope = G / 8200.0;
    for (name, expected) in [
        ("balloon", slope.sqrt()),
        ("balloon_with_added_mass", (slope / 1.5).sqrt()),
    ] {
        let mode = mode_of(&found, name, Motion::Z);
        assert_relative(name, mode.angular_frequency_rad_s, expected, 1e-8);
        assert!(mode.damping_ratio().abs() < 1e-8);
        assert_eq!(mode.name, format!("bounce of `{name}`"));
    }
    assert_eq!(found.modes.len(), 2);
    // Each may be anywhere along x and y, and turned in any way.
    assert_eq!(found.neutral.len(), 10, "{:?}", found.neutral);
}

/// omega^2 = g / L of the pendulum, EA / (L m) of the bounce with zeta = c / (2 sqrt(k m)).
#[test]
fn a_point_on_a_spring_swings_and_bounces() {
    let scene = "examples/elastic_pendulum.ron";
    let damped = ["entities.line.Tether.damping_n_s_m=20"];
    let found = modes_of_scene(scene, &damped, ModeSolver::Automatic);
    assert_eq!(found.modes.len(), 3);
    for (motion, name) in [(Motion::X, "swing in x"), (Motion::Y, "swing in y")] {
        let swing = mode_of(&found, "bob", motion);
        let expected = (G / 10.00887_f64).sqrt();
        assert_relative(name, swing.angular_frequency_rad_s, expected, 1e-9);
        assert!(swing.share("bob", motion) > 1.0 - 1e-12);
        assert_eq!(swing.name, format!("{name} of `bob`"));
    }
    let bounce = mode_of(&found, "bob", Motion::Z);
    assert_relative("bounce", bounce.rate_per_s(), 1000.0_f64.sqrt(), 1e-9);
    let ratio = 20.0 / (2.0 * 1000.0_f64.sqrt());
    assert_relative("damping", bounce.damping_ratio(), ratio, 1e-9);
    assert!(found.neutral.is_empty(), "{:?}", found.neutral);
}

/// The mean period between upward zero crossings of a small swing that is flown.
#[test]
fn a_run_swings_at_the_frequency_found() {
    let scene = "examples/elastic_pendulum.ron";
    let found = modes_of_scene(scene, &[], ModeSolver::Automatic);
    let expected_s = mode_of(&found, "bob", Motion::X).period_s().unwrap();
    let place = "entities.bob.Pose.position_m=(0.010008868331855084, 0, -10.008864995565418)";
    let flown = fly_scene(scene, &[place, "run.duration_s=30"]);
    let x: Vec<f64> = flown.positions("bob").iter().map(|p| p.1.x).collect();
    let crossings: Vec<f64> = x
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0] < 0.0 && pair[1] >= 0.0)
        .map(|(k, pair)| 0.02 * (k as f64 - pair[0] / (pair[1] - pair[0])))
        .collect();
    let swings = (crossings.len() - 1) as f64;
    let period_s = (crossings.last().unwrap() - crossings[0]) / swings;
    // Crossings are interpolated between samples 0.02 s apart.
    assert_relative("period", period_s, expected_s, 1e-6);
}

/// A body of moment I hung at a above its centre of mass on a massless line l: the roots of
/// `(m g l - m l^2 w)(m g a - (I + m a^2) w) = (m l a w)^2`, w = omega^2.
fn double_pendulum(m: f64, l: f64, a: f64, moment: f64) -> [f64; 2] {
    let (p, q, r) = (m * l * l, moment + m * a * a, m * l * a);
    let (u, v) = (m * G * l, m * G * a);
    let (second, first, zeroth) = (p * q - r * r, -(u * q + v * p), u * v);
    let root = (first * first - 4.0 * second * zeroth).sqrt();
    let larger = (-first + root) / (2.0 * second);
    [zeroth / (second * larger), larger]
}

const ROD: &str = "\"rod\": (Body: (mass_kg: 3, inertia: Tensor(xx_kg_m2: 2, yy_kg_m2: 2.5, \
                   zz_kg_m2: 0.5))), \"line\": (Tether: (from: (\"anchor\", Centre), \
                   to: (\"rod\", (0, 0, 0.8)), length_m: 4, nodes: 0, axial_stiffness_n: 1e5)),";

#[test]
fn a_body_on_a_line_is_a_double_pendulum() {
    for (formulation, length_m) in [("LumpedMass", 4.0 * (1.0 + 3.0 * G / 1e5)), ("Denoc", 4.0)] {
        let formulation = format!("run.formulation={formulation}");
        let found = modes_of_text(&hung(ROD), &[&formulation]);
        // About y it swings in x, about x in y.
        for (moment, along, about) in [
            (2.5, Motion::X, Motion::Pitch),
            (2.0, Motion::Y, Motion::Roll),
        ] {
            let expected = double_pendulum(3.0, length_m, 0.8, moment);
            let planar = |mode: &&Mode| mode.share("rod", along) + mode.share("rod", about) > 0.999;
            let planar: Vec<&Mode> = found.modes.iter().filter(planar).collect();
            assert_eq!(planar.len(), 2);
            for (mode, expected) in planar.iter().zip(expected) {
                let square = mode.angular_frequency_rad_s.powi(2);
                assert_relative(&formulation, square, expected, 1e-7);
            }
        }
        assert_eq!(found.neutral, ["the heading of `rod`"]);
    }
}

/// Hung below its centre of mass it topples: one root is negative.
#[test]
fn what_is_unstable_says_so() {
    let below = "entities.line.Tether.to=(\"rod\", (0, 0, -0.8))";
    let upright = "entities.rod.Pose=(position_m: (0, 0, 55_996.8))";
    let found = modes_of_text(&hung(ROD), &[below, upright]);
    let expected = double_pendulum(3.0, 4.0 * (1.0 + 3.0 * G / 1e5), -0.8, 2.5);
    let negative = expected.iter().copied().fold(0.0, f64::min);
    let growing: Vec<&Mode> = found
        .modes
        .iter()
        .filter(|mode| mode.is_unstable())
        .collect();
    assert_eq!(growing.len(), 2, "in both planes");
    let near = |mode: &&&Mode| (mode.growth_per_s.powi(2) / -negative - 1.0).abs() < 1e-7;
    assert_eq!(growing.iter().filter(near).count(), 1);
    assert!(growing.iter().all(|mode| !mode.oscillates()));
}

/// omega^2 = m g r^2 / (L Izz) on three vertical lines at the radius r.
#[test]
fn a_body_on_three_lines_yaws_as_a_trifilar_pendulum() {
    let (mass_kg, radius_m, moment) = (20.0, 1.0, 61.0);
    let lines: String = (0..3)
        .map(|k| {
            let (sin, cos) = libm::sincos(f64::from(k) * TAU / 3.0);
            format!(
                "\"line{k}\": (Tether: (from: (\"anchor\", ({cos:?}, {sin:?}, 0)), \
                 to: (\"ring\", ({cos:?}, {sin:?}, 0)), length_m: 10, nodes: 0, \
                 axial_stiffness_n: 1e7)),"
            )
        })
        .collect();
    let ring = "\"ring\": (Body: (mass_kg: 20, inertia: HollowCylinder(outer_radius_m: 2.1, \
                inner_radius_m: 1.3, height_m: 0.2)), Pose: (position_m: (0, 0, 55_990))),";
    let found = modes_of_text(&hung(&format!("{ring}{lines}")), &[]);
    let yaw = mode_of(&found, "ring", Motion::Yaw);
    let length_m = 10.0 * (1.0 + mass_kg * G / 3.0 / 1e7);
    let expected = (mass_kg * G * radius_m * radius_m / (length_m * moment)).sqrt();
    // Tensions have the round-off of altitudes times stiffness.
    assert_relative("yaw", yaw.angular_frequency_rad_s, expected, 1e-6);
    assert_eq!(yaw.name, "yaw of `ring`");
    assert!(found.neutral.is_empty(), "{:?}", found.neutral);
}

/// N beads on a line between two anchors, all but without weight: omega_k = 2 sqrt(T / (m l)) sin(k pi /
/// (2 (N + 1))) across, and with k in place of T / l along.
#[test]
fn waves_on_a_taut_line_are_those_of_a_string_of_beads() {
    let text = "(name: \"string\", environment: (gravity: Constant(1e-9), atmosphere: Vacuum), \
                entities: { \"a\": (Fixed: (position_m: (0, 0, 0))), \
                \"b\": (Fixed: (position_m: (0, 0, -10.01))), \"line\": (Tether: (\
                from: (\"a\", Centre), to: (\"b\", Centre), length_m: 10, nodes: 9, \
                diameter_m: 0.002, density_kg_m3: 1000, axial_stiffness_n: 1e5, start: Straight))}, \
                run: (duration_s: 10, output_every_s: 1))";
    let found = modes_of_text(text, &[]);
    let bead_kg = PI * 0.001 * 0.001 * 1000.0;
    let rate = 2.0 * (1e5 * 0.001 / (bead_kg * 1.001)).sqrt();
    for (index, mode) in found.modes.iter().enumerate() {
        let k = (index / 2 + 1) as f64;
        let expected = rate * libm::sin(k * PI / 20.0);
        assert_relative("wave", mode.angular_frequency_rad_s, expected, 1e-7);
        assert_eq!(mode.name, "transverse wave of `line`");
    }
}

/// In a wind V across it a bob on a line has, across wind and line, `m l^2 + c l + T / L = 0` with
/// c = rho Cd S V / 2 and T^2 = (m g)^2 + (c V)^2: linear in v, as the airspeed is not zero.
#[test]
fn drag_in_a_steady_wind_damps_the_swing() {
    let entities = "\"bob\": (Body: (mass_kg: 2), Drag: Constant(coefficient: 0.5, area_m2: 0.4)), \
                    \"line\": (Tether: (from: (\"anchor\", Centre), to: (\"bob\", Centre), \
                    length_m: 6, nodes: 0, axial_stiffness_n: 1e8)),";
    let wind = [
        "environment.atmosphere=Uniform(density_kg_m3: 0.9)",
        "environment.wind=[Uniform(velocity_m_s: (5, 0, 0))]",
    ];
    for formulation in ["run.formulation=LumpedMass", "run.formulation=Denoc"] {
        let found = modes_of_text(&hung(entities), &[wind[0], wind[1], formulation]);
        let mode = mode_of(&found, "bob", Motion::Y);
        let damping = 0.5 * 0.9 * 0.5 * 0.4 * 5.0;
        let tension = libm::hypot(2.0 * G, damping * 5.0);
        let length = 6.0;
        let expected = (tension / (2.0 * length)).sqrt();
        assert_relative("swing", mode.rate_per_s(), expected, 1e-6);
        let ratio = damping / (2.0 * 2.0 * expected);
        assert_relative("damping", mode.damping_ratio(), ratio, 1e-6);
    }
    // In still air the law has no slope.
    let still = modes_of_text(&hung(entities), &[wind[0]]);
    let mode = mode_of(&still, "bob", Motion::Y);
    assert!(
        mode.damping_ratio().abs() < 1e-7,
        "{}",
        mode.damping_ratio()
    );
}

/// Full matrices and all eigenvalues, against blocks and the slowest: of a balloon, a tether and a gondola
/// in wind.
#[test]
fn both_solvers_agree() {
    let scene = "paper/comparison_900m.ron";
    let windy = ["environment.wind=[Shear(altitude_m: 55_000, gradient_per_s: 2e-3)]"];
    let complete = modes_of_scene(scene, &windy, ModeSolver::Complete);
    let sparse = modes_of_scene(scene, &windy, ModeSolver::Slowest);
    assert_eq!(complete.neutral, sparse.neutral);
    assert_eq!(complete.modes.len(), 12);
    for (a, b) in complete.modes.iter().zip(&sparse.modes) {
        let difference = (a.growth_per_s - b.growth_per_s)
            .hypot(a.angular_frequency_rad_s - b.angular_frequency_rad_s);
        assert!(difference < 1e-7 * a.rate_per_s(), "{a:?} {b:?}");
    }
}

/// Rigid links by differences of the recursion, springs by matrices: alike as EA grows, and links that
/// stretch alike at once.
#[test]
fn both_formulations_agree() {
    let scene = "paper/comparison_900m.ron";
    let modes = |more: &[&str]| {
        let mut overrides = CENTRED_COMPARISON.to_vec();
        overrides.extend(["environment.wind=[]", "run.links=PointMass"]);
        overrides.extend(more);
        modes_of_scene(scene, &overrides, ModeSolver::Automatic)
    };
    let lumped = modes(&[]);
    let elastic = modes(&["run.formulation=Denoc", "run.elastic_links=true"]);
    let rigid = modes(&["run.formulation=Denoc"]);
    let stiff = modes(&["entities.tether.Tether.axial_stiffness_n=2e9"]);
    for k in 0..6 {
        let rate = |found: &Modes| found.modes[k].rate_per_s();
        assert_relative("elastic links", rate(&elastic), rate(&lumped), 1e-9);
        assert_relative("rigid links", rate(&rigid), rate(&stiff), 1e-6);
    }
    assert_eq!(lumped.neutral, rigid.neutral);
}

/// Loops of rigid links move only as they stay closed: the paper's rings have the modes of stiff lumped
/// tethers, and nothing grows.
#[test]
fn closed_loops_of_rigid_links_have_the_modes_of_stiff_tethers() {
    for (scene, ring) in [
        ("paper/mojave_test.ron", "suspension"),
        ("paper/multi_tether.ron", "suspension"),
        ("paper/multi_tether_yaw.ron", "suspension"),
    ] {
        let field = |name: &str| format!("entities.{ring}.Tethers.{name}");
        let stiffness = field("axial_stiffness_n=2e6");
        let lumping = field("lumping=Interior");
        let modes = |more: &[&str]| {
            let mut overrides = vec!["run.links=PointMass", lumping.as_str()];
            if scene != "paper/multi_tether_yaw.ron" {
                overrides.push("environment.wind=[]");
            }
            overrides.extend(more);
            modes_of_scene(scene, &overrides, ModeSolver::Automatic)
        };
        let rigid = modes(&["run.formulation=Denoc"]);
        let stiff = modes(&["run.formulation=LumpedMass", &stiffness]);
        for k in 0..3 {
            let rate = |found: &Modes| found.modes[k].rate_per_s();
            assert_relative(scene, rate(&rigid), rate(&stiff), 1e-4);
            assert!(!rigid.modes[k].is_unstable(), "{scene}, mode {k}");
        }
    }
}

/// A winch that stands still on an anchor changes nothing: its segment is a spring like the others.
#[test]
fn a_winch_at_rest_changes_no_mode() {
    let line = |winch: &str| {
        hung(&format!(
            "\"p\": (Body: (mass_kg: 10)), \"line\": (Tether: (from: (\"anchor\", Centre), to: (\"p\", Centre), \
             length_m: 20, nodes: 3, diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 1e5, \
             damping_n_s_m: 1), {winch})"
        ))
    };
    for overrides in [
        &[][..],
        &["run.formulation=Denoc", "run.elastic_links=true"],
        &["run.formulation=Denoc"],
    ] {
        let [with, without] =
            ["Winch: (stored_m: 50)", ""].map(|winch| modes_of_text(&line(winch), overrides));
        for (a, b) in with.modes.iter().zip(&without.modes).take(5) {
            let (found, expected) = (a.angular_frequency_rad_s, b.angular_frequency_rad_s);
            assert_relative("with a winch", found, expected, 1e-7);
        }
    }
}
