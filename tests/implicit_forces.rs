//! What the implicit integrator takes: forces of a user's own, with derivatives and without, closed loops
//! of tethers between free bodies, and first-order states. Held against the explicit integrator.

#![allow(clippy::panic, reason = "a test that cannot go on fails")]

mod flight;

use aerobot::components::derivatives::ForceDerivatives;
use aerobot::components::scene_component::{FieldReport, SceneComponent};
use aerobot::components::state::{Force, Position, Velocity};
use aerobot::engine::plugin::{Plugin, Simulator};
use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::schedule::Phase;
use bevy_ecs::component::Component;
use bevy_ecs::system::Query;
use flight::{assert_below, fly, largest_distance_m, load, run_for_summary};
use glam::{DMat3, DVec3};
use serde::Deserialize;

/// A spring and a damper that pull a body to a place: a user's force.
#[derive(Component, Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Leash {
    place_m: DVec3,
    stiffness_n_m: f64,
    damping_n_s_m: f64,
    /// Whether it says how it changes.
    derivatives: bool,
}

impl SceneComponent for Leash {
    const NAME: &'static str = "Leash";

    fn check(&self, report: &mut FieldReport) {
        report.non_negative("stiffness_n_m", self.stiffness_n_m);
    }
}

fn pull(mut bodies: Query<(&Leash, &Position, &Velocity, &mut Force)>) {
    for (leash, position, velocity, mut force) in &mut bodies {
        force.0 += leash.stiffness_n_m * (leash.place_m - position.0);
        force.0 -= leash.damping_n_s_m * velocity.0;
    }
}

fn pull_derivatives(mut bodies: Query<(&Leash, &mut ForceDerivatives)>) {
    for (leash, mut derivatives) in &mut bodies {
        if leash.derivatives {
            derivatives.by_position_n_m -= DMat3::from_diagonal(DVec3::splat(leash.stiffness_n_m));
            derivatives.by_velocity_n_s_m -=
                DMat3::from_diagonal(DVec3::splat(leash.damping_n_s_m));
        }
    }
}

struct LeashPlugin;

impl Plugin for LeashPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Leash>()
            .add_systems_for::<Leash, _, _>(Phase::Forces, || pull)
            .add_systems_for::<Leash, _, _>(Phase::Derivatives, || pull_derivatives);
    }
}

/// A stone on a line from an anchor, on a leash besides.
fn leashed(leash: &str, integrator: &str) -> (MemorySink, u64) {
    leashed_in("LumpedMass", 2e4, leash, integrator)
}

/// The same in a formulation, with a line of this stiffness in N.
fn leashed_in(
    formulation: &str,
    stiffness_n: f64,
    leash: &str,
    integrator: &str,
) -> (MemorySink, u64) {
    let mut simulator = Simulator::new();
    simulator.add_plugin(&LeashPlugin);
    // The line starts straight, as long as the pose wants it or as it is.
    let stone_z = if stiffness_n < 1e6 {
        54_901.0
    } else {
        55_000.0 - (99.0_f64 * 99.0 - 104.0).sqrt() - 0.2
    };
    let text = format!(
        r#"(
            name: "leashed", environment: (atmosphere: Vira, wind: [Uniform(velocity_m_s: (3, 1, 0))]),
            entities: {{
                "top": (Fixed: (position_m: (0, 0, 55000))),
                "stone": (
                    Body: (mass_kg: 5, inertia: Box(0.3, 0.2, 0.4)), Pose: (position_m: (10, 2, {stone_z})),
                    Drag: Constant(coefficient: 1, area_m2: 0.05), Leash: ({leash}),
                ),
                "line": (Tether: (
                    from: ("top", Centre), to: ("stone", Top), length_m: 99, nodes: 8, diameter_m: 0.002,
                    density_kg_m3: 1440, axial_stiffness_n: {stiffness_n}, damping_n_s_m: 5,
                    drag: (normal: 1, tangential: 0.03), start: Straight,
                )),
            }},
            run: (
                formulation: {formulation}, links: PointMass, duration_s: 20, output_every_s: 5,
                integrator: {integrator}, record: (channels: All),
            ),
        )"#
    );
    let scene = load(&simulator, &text, &[]);
    let (results, summary) = run_for_summary(&simulator, &scene);
    (results, summary.steps)
}

/// A force that says nothing of its derivatives is integrated with the full order.
#[test]
fn a_force_without_derivatives_is_integrated_to_any_accuracy() {
    let soft = "place_m: (0, 0, 54900), stiffness_n_m: 20, damping_n_s_m: 2, derivatives: false";
    let (expected, _) = leashed(soft, "Adaptive(relative_tolerance: 1e-10)");
    let (found, _) = leashed(soft, "Implicit(accuracy_m: 1e-8)");
    assert_below("a soft leash", largest_distance_m(&found, &expected), 1e-6);
}

/// With derivatives a force may be as stiff as it likes: the step does not see it.
#[test]
fn a_stiff_force_with_derivatives_costs_no_steps() {
    let place = "place_m: (10, 2, 54901.001), stiffness_n_m: 1e7, damping_n_s_m: 1e4";
    let (found, steps) = leashed(
        &format!("{place}, derivatives: true"),
        "Implicit(accuracy_m: 1e-3)",
    );
    let last = &found.frames[found.frames.len() - 1];
    let stone = last.states.iter().find(|row| &*row.entity == "stone");
    let away = stone.map_or(f64::NAN, |row| {
        (row.position_m - DVec3::new(10.0, 2.0, 54_901.001)).length()
    });
    println!("{steps} steps");
    // What the weight, the drag and the line can move it by.
    assert_below("a stiff leash", away, 1e-4);
    assert!(steps < 1000, "{steps}");
}

/// A user's force acts on what rigid links carry: either integrator, with derivatives and without, and
/// lumped masses on a line 10 000 times as stiff.
#[test]
fn a_force_acts_on_what_rigid_links_carry() {
    let leash = |derivatives: &str| {
        format!(
            "place_m: (0, 0, 54900), stiffness_n_m: 20, damping_n_s_m: 2, derivatives: {derivatives}"
        )
    };
    let links = |leash: &str, integrator: &str| leashed_in("Denoc", 2e8, leash, integrator).0;
    let expected = links(&leash("false"), "Adaptive(relative_tolerance: 1e-10)");
    for derivatives in ["false", "true"] {
        let found = links(&leash(derivatives), "Implicit(accuracy_m: 1e-8)");
        assert_below("implicit", largest_distance_m(&found, &expected), 1e-6);
    }
    let implicit = "Implicit(accuracy_m: 1e-4)";
    let (stretching, _) = leashed_in("LumpedMass", 2e8, &leash("true"), implicit);
    let stones = stretching.states("stone").zip(expected.states("stone"));
    let apart = stones.map(|((_, a), (_, b))| a.position_m.distance(b.position_m));
    assert_below("a line of 2e8 N", apart.fold(0.0, f64::max), 1e-3);
}

/// A stiff force stands without any tether too, and `Auto` finds that implicit steps pay.
#[test]
fn auto_goes_implicit_for_a_stiff_force_without_a_tether() {
    let mut simulator = Simulator::new();
    simulator.add_plugin(&LeashPlugin);
    let text = r#"(
        name: "leashed", environment: (atmosphere: Vacuum),
        entities: {
            "stone": (
                Body: (mass_kg: 5), Pose: (position_m: (0, 0, 100)),
                Leash: (
                    place_m: (0, 0, 100.001), stiffness_n_m: 1e6, damping_n_s_m: 1e4, derivatives: true,
                ),
            ),
        },
        run: (duration_s: 100, output_every_s: 100),
    )"#;
    let (results, summary) = run_for_summary(&simulator, &load(&simulator, text, &[]));
    println!(
        "{} steps, {} implicit",
        summary.steps, summary.implicit_steps
    );
    assert!(summary.implicit_steps > 0 && summary.steps < 500);
    // The weight over the stiffness below its place.
    let sag = 100.001 - flight::position(&results, "stone", 100.0).z - 5.0 * 8.87 / 1e6;
    assert_below("where the leash holds it", sag.abs(), 1e-6);
}

/// Two free bodies, a closed loop of two tethers between them and a third to an anchor: the elimination
/// has spikes, fill and a body of its own.
const LOOP: &str = r#"(
    name: "loop", environment: (atmosphere: Vira, wind: [Step(velocity_m_s: (2, 1, 0), from_s: 1, until_s: 4)]),
    entities: {
        "top": (Fixed: (position_m: (0, 0, 55000))),
        "ring": (
            Body: (mass_kg: 8, inertia: Box(2, 0.4, 0.2)), Pose: (position_m: (0, 0, 54949.9)),
            Drag: Constant(coefficient: 1, area_m2: 0.2),
        ),
        "gondola": (
            Body: (mass_kg: 40, inertia: Box(1, 1, 1)), Pose: (position_m: (0, 0, 54929.3)),
            Drag: Constant(coefficient: 1, area_m2: 1),
        ),
        "line": (Tether: (
            from: ("ring", Top), to: ("top", Centre), length_m: 49.9, nodes: 4, diameter_m: 0.003,
            density_kg_m3: 1440, axial_stiffness_n: 1e5, damping_n_s_m: 20, start: Straight,
        )),
        "left": (Tether: (
            from: ("ring", (-1, 0, -0.1)), to: ("gondola", (-0.5, 0, 0.5)), length_m: 19.98, nodes: 3,
            diameter_m: 0.003, density_kg_m3: 1440, axial_stiffness_n: 1e5, damping_n_s_m: 20, start: Straight,
        )),
        "right": (Tether: (
            from: ("gondola", (0.5, 0, 0.5)), to: ("ring", (1, 0, -0.1)), length_m: 19.98, nodes: 3,
            diameter_m: 0.003, density_kg_m3: 1440, axial_stiffness_n: 1e5, damping_n_s_m: 20, start: Straight,
        )),
    },
    run: (duration_s: 10, output_every_s: 1, record: (channels: All)),
)"#;

#[test]
fn a_closed_loop_of_free_bodies_agrees_with_the_explicit_integrator() {
    let expected = fly(
        LOOP,
        &["run.integrator=Adaptive(relative_tolerance: 1e-10)"],
    );
    let found = fly(LOOP, &["run.integrator=Implicit(accuracy_m: 1e-9)"]);
    assert_below("a closed loop", largest_distance_m(&found, &expected), 1e-6);
    let loose = fly(LOOP, &["run.integrator=Implicit(accuracy_m: 0.001)"]);
    assert_below(
        "the same asked for 1 mm, with its nodes",
        largest_distance_m(&loose, &expected),
        5e-3,
    );
}

/// A first-order state (here the work of drag and dampers) is integrated beside the motion.
#[test]
fn first_order_states_are_integrated_too() {
    let work = |integrator: &str| {
        let results = fly(LOOP, &[integrator]);
        let rows = results
            .frames
            .iter()
            .flat_map(|frame| frame.channels.clone());
        let last = rows
            .filter(|row| row.channel == "nonconservative_work_j")
            .last();
        last.map_or(f64::NAN, |row| row.value)
    };
    let expected = work("run.integrator=Adaptive(relative_tolerance: 1e-10)");
    let found = work("run.integrator=Implicit(accuracy_m: 1e-7)");
    println!("work: {found} J, expected {expected} J");
    assert_below("work", (found - expected).abs(), 1e-3 * expected.abs());
}
