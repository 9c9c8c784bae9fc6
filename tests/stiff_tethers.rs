//! The implicit integrator against answers found without it: a separate program (explicit, of eighth
//! order, in 80-bit arithmetic), closed forms, and the explicit integrators of this one.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod flight;
#[path = "../benches/scenes/one_km_line.rs"]
mod one_km_line;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use flight::{
    assert_below, fly, fly_scene, largest_distance_m, owned, position, run_for_summary, scene_file,
    summary_of,
};
use glam::DVec3;
use one_km_line::one_km_line;

/// Nodes, axial stiffness in N, time in s, place of the probe in m.
type ProbeRow = (usize, f64, f64, [f64; 3]);

/// The probe of the 1 km line, from the separate program; good to 1e-10 m.
const ONE_KM_LINE: [ProbeRow; 8] = [
    (
        10,
        11.5e3,
        10.0,
        [221.8670396662, 12.2298230196, -973.3651464368],
    ),
    (
        10,
        11.5e3,
        60.0,
        [76.2058425779, 57.9563825561, -997.1974231277],
    ),
    (
        100,
        11.5e3,
        10.0,
        [221.9843899327, 12.2101052763, -973.3490470565],
    ),
    (
        100,
        11.5e3,
        60.0,
        [76.3838470190, 57.9896389484, -997.1608542347],
    ),
    (
        10,
        11.5e6,
        10.0,
        [220.9168148923, 12.2243733232, -970.3064026888],
    ),
    (
        10,
        11.5e6,
        60.0,
        [75.5376582289, 57.5550664471, -994.0993272965],
    ),
    (
        20,
        11.5e6,
        10.0,
        [220.9961845456, 12.2112404774, -970.2980932700],
    ),
    (
        20,
        11.5e6,
        60.0,
        [75.6544015347, 57.5731809587, -994.0753939505],
    ),
];

/// What is asked for is what comes out, loose and tight. A line a thousand times stiffer misses it by a
/// factor of three at 1 cm and of some twenty at 0.1 mm: there the strain sets the step.
#[test]
fn the_one_km_line_follows_the_separate_program() {
    for (accuracy, soft_m, stiff_m) in [
        ("0.1", 5e-2, 5e-2),
        ("0.01", 5e-3, 3e-2),
        ("1e-4", 1e-4, 5e-3),
    ] {
        let integrator = format!("run.integrator=Implicit(accuracy_m: {accuracy})");
        for (nodes, stiffness_n, time_s, expected) in ONE_KM_LINE {
            let until = format!("run.duration_s={time_s:?}");
            let text = one_km_line(nodes, stiffness_n, 10.0);
            let results = fly(&text, &[&integrator, &until]);
            let error = (position(&results, "probe", time_s) - DVec3::from(expected)).length();
            let bound = if stiffness_n > 1e5 { stiff_m } else { soft_m };
            assert_below(
                &format!("N = {nodes}, EA = {stiffness_n} N, {time_s} s, asked for {accuracy} m"),
                error,
                bound,
            );
        }
    }
}

/// The cost of stiffness is gone: neither the number of nodes nor a thousandfold stiffness at rest of
/// the nodes changes how the step is chosen.
#[test]
fn the_number_of_steps_does_not_depend_on_the_number_of_nodes() {
    for accuracy in ["0.1", "0.01", "0.001"] {
        let integrator = format!("run.integrator=Auto(accuracy_m: {accuracy})");
        let steps = [10, 50, 100, 400].map(|nodes| {
            let (_, summary) = summary_of(&one_km_line(nodes, 11.5e3, 60.0), &[&integrator]);
            assert_eq!(summary.implicit_steps, summary.steps);
            assert!(20 * summary.rejected_steps <= summary.steps);
            summary.steps as f64
        });
        println!("asked for {accuracy} m: {steps:?} steps for 10, 50, 100, 400 nodes");
        for count in steps {
            assert!((count / steps[2] - 1.0).abs() <= 0.1, "{steps:?}");
        }
    }
}

/// A body on three tethers, from the separate program: place, attitude (x, y, z, w), and the middle node
/// of the first tether, at 1 s and 10 s.
const SUSPENSION: [(f64, [f64; 3], [f64; 4], [f64; 3]); 2] = [
    (
        1.0,
        [0.027231162015, -0.000003671757, -10.416796598130],
        [
            -0.000527783316,
            -0.000896282607,
            -0.034061980185,
            0.999419181139,
        ],
        [0.763207441562, -0.016771246407, -5.007977334352],
    ),
    (
        10.0,
        [-0.044914904301, 0.000023815453, -10.430570934132],
        [
            0.000926854702,
            -0.002749171250,
            0.096345549534,
            0.995343718563,
        ],
        [0.721299967498, 0.047076820723, -5.013863510864],
    ),
];

/// Several tethers on one rigid body, off its centre, with the masses of half segments there.
#[test]
fn a_body_on_three_tethers_follows_the_separate_program() {
    let mut entities = String::new();
    for (number, turn) in [0.0, 120.0_f64, 240.0].into_iter().enumerate() {
        let (sin, cos) = turn.to_radians().sin_cos();
        entities += &format!(
            r#"
            "anchor{number}": (Fixed: (position_m: ({cos}, {sin}, 0))),
            "tether{number}": (Tether: (
                from: ("anchor{number}", Centre), to: ("body", ({}, {}, 0.4)),
                length_m: 10, nodes: 5, diameter_m: 0.002, density_kg_m3: {},
                axial_stiffness_n: 5e4, damping_n_s_m: 1, start: Straight,
            )),"#,
            0.5 * cos,
            0.5 * sin,
            0.005 / (std::f64::consts::PI * 1e-6),
        );
    }
    let text = format!(
        r#"(
            name: "suspension", environment: (atmosphere: Vacuum),
            entities: {{
                "body": (
                    Body: (mass_kg: 50, inertia: Tensor(xx_kg_m2: 4, yy_kg_m2: 5, zz_kg_m2: 6)),
                    Pose: (position_m: (0.05, 0, -10.396383), attitude: AxisAngle(axis: (0, 0, 1), angle_rad: 0.2)),
                ),{entities}
            }},
            run: (duration_s: 10, output_every_s: 1),
        )"#
    );
    for (integrator, bound) in [
        ("Implicit(accuracy_m: 1e-7)", 5e-6),
        ("Adaptive(relative_tolerance: 1e-9)", 1e-7),
    ] {
        let results = fly(&text, &[&format!("run.integrator={integrator}")]);
        for (time_s, place, attitude, node) in SUSPENSION {
            let distance = |entity: &str, expected: [f64; 3]| {
                (position(&results, entity, time_s) - DVec3::from(expected)).length()
            };
            assert_below(
                &format!("{integrator}, body at {time_s} s"),
                distance("body", place),
                bound,
            );
            assert_below(
                &format!("{integrator}, node at {time_s} s"),
                distance("tether0/3", node),
                bound,
            );
            let frame = results
                .frames
                .iter()
                .find(|f| (f.time_s - time_s).abs() < 1e-9)
                .unwrap();
            let body = frame
                .states
                .iter()
                .find(|row| &*row.entity == "body")
                .unwrap();
            let found = body.rotation.unwrap().0;
            let turn = found.angle_between(glam::DQuat::from_array(attitude));
            assert_below(
                &format!("{integrator}, attitude at {time_s} s"),
                turn,
                10.0 * bound,
            );
        }
    }
}

/// Third order, measured by halving a fixed step on the 1 km line.
#[test]
fn the_order_of_the_implicit_method_is_three() {
    let text = one_km_line(10, 11.5e3, 10.0);
    let end = |step: f64| {
        let integrator = format!("run.integrator=Fixed(step_s: {step:?}, method: Rosenbrock)");
        let results = fly(&text, &[&integrator, "run.duration_s=10"]);
        position(&results, "probe", 10.0)
    };
    let expected = DVec3::new(221.8670396662, 12.2298230196, -973.3651464368);
    let errors = [0.08, 0.04, 0.02].map(|step| (end(step) - expected).length());
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        println!(
            "errors {:.3e} and {:.3e} m: order {order:.2}",
            pair[0], pair[1]
        );
        assert!(order >= 2.8, "{errors:?}");
    }
}

/// L-stability: one long step takes all of a stiff vibration. A mass on a spring of 1e9 rad/s^2, pulled
/// down by 1 mm, is in its place after a step of 1 s.
#[test]
fn a_stiff_mode_is_gone_after_one_step() {
    let text = r#"(
        name: "stiff", environment: (atmosphere: Vacuum),
        entities: {
            "top": (Fixed: (position_m: (0, 0, 100))),
            "bob": (Body: (mass_kg: 1), Pose: (position_m: (0, 0, 88.999))),
            "line": (Tether: (
                from: ("top", Centre), to: ("bob", Centre), length_m: 11, nodes: 0, axial_stiffness_n: 1.1e10, slack: false,
            )),
        },
        run: (duration_s: 1, output_every_s: 1, integrator: Fixed(step_s: 1, method: Rosenbrock)),
    )"#;
    let left = (position(&fly(text, &[]), "bob", 1.0).z - 89.0).abs();
    assert_below("what is left of 1 mm after one step of 1 s", left, 1e-8);
}

/// Scenes that neither go slack nor draw at random: implicit and explicit agree to 1e-6 m over 60 s.
#[test]
fn implicit_and_explicit_agree_on_every_scene() {
    for (scene, implicit, explicit) in [
        ("examples/free_fall.ron", "1e-8", "1e-11"),
        ("examples/elastic_pendulum.ron", "1e-9", "1e-11"),
        ("examples/hanging_cable.ron", "1e-8", "1e-10"),
        ("examples/balloon_heave.ron", "1e-8", "1e-11"),
        ("paper/comparison_900m.ron", "4e-9", "1e-9"),
        ("paper/towing_9700m.ron", "1e-8", "1e-9"),
        ("paper/towing_free_balloon.ron", "1e-8", "1e-9"),
        ("paper/long_tethers.ron", "4e-9", "1e-9"),
    ] {
        let run = |integrator: String| {
            let integrator = format!("run.integrator={integrator}");
            let overrides = [&*integrator, "run.duration_s=60", "run.output_every_s=20"];
            let overrides = if scene.ends_with("free_fall.ron") {
                ["run.duration_s=10", "run.output_every_s=10", &*integrator]
            } else {
                overrides
            };
            fly_scene(scene, &overrides)
        };
        let found = run(format!("Implicit(accuracy_m: {implicit})"));
        let expected = run(format!("Adaptive(relative_tolerance: {explicit})"));
        assert_below(scene, largest_distance_m(&found, &expected), 1e-6);
    }
}

/// The towline keeps its equilibrium, and finds it from straight down.
#[test]
fn the_towline_finds_its_equilibrium_and_keeps_it() {
    let simulator = Simulator::new();
    let overrides = flight::owned(&[
        "entities.towline.Tether.nodes=50",
        "run.duration_s=600",
        "run.output_every_s=60",
    ]);
    let scene = simulator
        .load(&flight::scene_file("paper/towing_9700m.ron"), &overrides)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    simulation
        .settle_in_wind(&scene)
        .unwrap_or_else(|e| panic!("{e}"));
    let mut rest = MemorySink::default();
    let _ = simulation.run(&mut rest, &mut |_| {});
    let start = MemorySink {
        frames: vec![rest.frames[0].clone(); rest.frames.len()],
    };
    assert_below(
        "600 s from the equilibrium",
        largest_distance_m(&rest, &start),
        1e-6,
    );

    let flown = fly_scene(
        "paper/towing_9700m.ron",
        &[
            "entities.towline.Tether.nodes=50",
            "run.output_every_s=20000",
        ],
    );
    let last = MemorySink {
        frames: vec![flown.frames[flown.frames.len() - 1].clone()],
    };
    let first = MemorySink {
        frames: vec![rest.frames[0].clone()],
    };
    assert_below(
        "20 000 s from straight down",
        largest_distance_m(&last, &first),
        1e-3,
    );
}

/// `Auto` may be written alone, in a scene and on the command line, and is the default.
#[test]
fn auto_is_the_default_and_a_word_of_its_own() {
    let text = one_km_line(10, 11.5e3, 60.0);
    let written = text.replace("run: (", "run: (integrator: Auto, ");
    let ends = [
        fly(&text, &[]),
        fly(&written, &[]),
        fly(&text, &["run.integrator=Auto"]),
        fly(&text, &["run.integrator=Auto(accuracy_m: 0.001)"]),
    ]
    .map(|results| position(&results, "probe", 60.0));
    assert!(ends.iter().all(|end| *end == ends[0]), "{ends:?}");
}

/// Two light lines hang below a heavily loaded one, all 1000 times as stiff as in the scene: each is held to
/// its own tension. (Held to the largest of all, the light ones rattle: 0.16 m in 6200 steps.)
#[test]
fn a_light_line_below_a_heavy_one_does_not_rattle() {
    let mut stiff = owned(&["run.duration_s=60", "run.formulation=LumpedMass"]);
    for (line, stiffness_n) in [("tether", 2e8), ("line-a", 1e8), ("line-b", 1e8)] {
        let tether = format!("entities.{line}.Tether");
        stiff.push(format!("{tether}.axial_stiffness_n={stiffness_n}"));
        stiff.push(format!("{tether}.damping_n_s_m=316"));
    }
    let run = |integrator: &str| {
        let mut overrides = stiff.clone();
        overrides.push(format!("run.integrator={integrator}"));
        let simulator = Simulator::new();
        let scene = simulator
            .load(&scene_file("examples/branched_chain.ron"), &overrides)
            .unwrap();
        run_for_summary(&simulator, &scene)
    };
    let (expected, _) = run("Implicit(accuracy_m: 1e-6)");
    let (found, summary) = run("Implicit(accuracy_m: 1e-3)");
    let bodies = ["balloon", "gondola", "a", "b"].map(|name| {
        let pairs = found.states(name).zip(expected.states(name));
        pairs.map(|((_, a), (_, b))| a.position_m.distance(b.position_m))
    });
    let error = bodies.into_iter().flatten().fold(0.0, f64::max);
    println!("{} steps", summary.steps);
    assert_below("largest error of a body, m", error, 0.02);
    assert!(summary.steps < 2500, "{}", summary.steps);
}
