//! What several tethers cost: `cargo bench --bench suspensions`.
//!
//! A body on a ring of three tethers with ten masses each, in yaw (the case of
//! `scenes/paper/multi_tether_yaw.ron`): CPU time of a simulated second, and the error of the frequency of its
//! yaw against a run with an accuracy of 1e-5 m. Eight bodies on twelve tethers with 400 nodes
//! (`scenes/examples/twelve_tethers.ron`) beside a single chain of 400 nodes in the same air and gust: CPU time for each
//! node and simulated second, and for each node and step. One core, release build; the least of five repeats,
//! cases interleaved.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench may fail loudly")]

use std::path::Path;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::{MemorySink, NullSink};
use aerobot_engine::recording::summary::Summary;
use aerobot_engine::run_folder::thread_cpu_time;
use aerobot_engine::scene::Scene;

const REPEATS: usize = 5;

/// A scene of the repository with what is set in it, and its name in the table.
struct Case {
    name: &'static str,
    scene: &'static str,
    set: Vec<String>,
}

fn main() {
    let yaw = |name, accuracy_m: f64| Case {
        name,
        scene: "paper/multi_tether_yaw.ron",
        set: vec![
            "entities.suspension.Tethers.nodes=10".to_owned(),
            "run.duration_s=240".to_owned(),
            "run.output_every_s=0.5".to_owned(),
            format!("run.integrator=Auto(accuracy_m: {accuracy_m:e})"),
        ],
    };
    let cases = [
        yaw("three tethers of ten masses, 1 mm", 1e-3),
        yaw("three tethers of ten masses, 1 cm", 1e-2),
    ];
    let exact = frequency_hz(&yaw("", 1e-5));
    println!("| case | steps | error of the frequency | CPU per simulated s |");
    println!("|---|---|---|---|");
    for (case, (cost_us, summary)) in cases.iter().zip(time(&cases)) {
        let error = (frequency_hz(case) / exact - 1.0).abs();
        let steps = summary.steps;
        println!(
            "| {} | {steps} | {error:.1e} | {:.3} ms |",
            case.name,
            1e-3 * cost_us
        );
    }
    println!();
    graphs();
}

/// Twelve tethers beside one.
fn graphs() {
    let graph = |name, formulation| Case {
        name,
        scene: "examples/twelve_tethers.ron",
        set: vec![format!("run.formulation={formulation}")],
    };
    let chain = |name, formulation| {
        Case {
        name,
        scene: "paper/comparison_900m.ron",
        set: vec![
            format!("run.formulation={formulation}"),
            "entities.tether.Tether.nodes=400".to_owned(),
            "environment.wind=[Step(velocity_m_s: (5, 0, 0), from_s: 5, until_s: 10)]".to_owned(),
            "environment.atmosphere=Exponential(density_kg_m3: 0.8183, altitude_m: 56_000, scale_height_m: 8200)"
                .to_owned(),
            "run.duration_s=30".to_owned(),
            "run.integrator=Auto()".to_owned(),
        ],
    }
    };
    let cases = [
        chain("one tether, lumped masses", "LumpedMass"),
        graph("twelve tethers, lumped masses", "LumpedMass"),
        chain("one tether, rigid links", "Denoc"),
        graph("twelve tethers, rigid links", "Denoc"),
    ];
    println!("| case, 400 nodes | steps | CPU per node and simulated s | CPU per node and step |");
    println!("|---|---|---|---|");
    let timed = time(&cases);
    for (case, (cost_us, summary)) in cases.iter().zip(&timed) {
        let tried = summary.steps + summary.rejected_steps;
        let per_step_us = cost_us * summary.simulated_s / tried as f64 / 400.0;
        let name = case.name;
        println!(
            "| {name} | {tried} | {:.3} us | {per_step_us:.3} us |",
            cost_us / 400.0
        );
    }
    for pair in timed.chunks(2) {
        println!("ratio {:.2}", pair[1].0 / pair[0].0);
    }
}

/// CPU time of a simulated second in us, with what the run says of itself.
fn time(cases: &[Case]) -> Vec<(f64, Summary)> {
    let simulator = Simulator::new();
    let mut best: Vec<Option<(f64, Summary)>> = vec![None; cases.len()];
    for _ in 0..REPEATS {
        for (case, best) in cases.iter().zip(&mut best) {
            let scene = load(&simulator, case);
            let built = simulator.build(&scene);
            let mut simulation = built.unwrap_or_else(|error| panic!("{error}"));
            let start = thread_cpu_time();
            let summary = simulation.run(&mut NullSink, &mut |_| {});
            assert_eq!(summary.outcome, "done");
            let cost_us = 1e6 * (thread_cpu_time() - start).as_secs_f64() / summary.simulated_s;
            if best.as_ref().is_none_or(|(least, _)| cost_us < *least) {
                *best = Some((cost_us, summary));
            }
        }
    }
    best.into_iter().map(|best| best.expect("timed")).collect()
}

/// Mean frequency of yaw between the first and the last upward crossing of zero, at 0.1 s.
fn frequency_hz(case: &Case) -> f64 {
    let simulator = Simulator::new();
    let mut scene = load(&simulator, case);
    scene.run.output_every_s = 0.1;
    let built = simulator.build(&scene);
    let mut results = MemorySink::default();
    built
        .unwrap_or_else(|error| panic!("{error}"))
        .run(&mut results, &mut |_| {});
    let headings: Vec<(f64, f64)> = results
        .frames
        .iter()
        .map(|frame| {
            let row = frame.states.iter().find(|row| &*row.entity == "body");
            let (attitude, _) = row.and_then(|row| row.rotation).expect("a body");
            (frame.time_s, 2.0 * libm::atan2(attitude.z, attitude.w))
        })
        .collect();
    let crossings: Vec<f64> = headings
        .windows(2)
        .filter(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0)
        .map(|pair| {
            let [(t, a), (u, b)] = [pair[0], pair[1]];
            t - a * (u - t) / (b - a)
        })
        .collect();
    (crossings.len() - 1) as f64 / (crossings[crossings.len() - 1] - crossings[0])
}

fn load(simulator: &Simulator, case: &Case) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(case.scene);
    simulator
        .load(&file, &case.set)
        .unwrap_or_else(|error| panic!("{error}"))
}
