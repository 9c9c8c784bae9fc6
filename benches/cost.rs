//! What a step costs: `cargo bench` prints the table that docs/cost.md shows.
//!
//! One core, release build. Every figure is the least of several repeats in one run, as the least is
//! what the code takes when nothing else disturbs it.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench may fail loudly")]

use std::path::Path;
use std::time::Instant;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::NullSink;
use aerobot_engine::simulation::Simulation;

const REPEATS: usize = 15;

fn main() {
    println!("| what | N | cost |");
    println!("|---|---|---|");
    for nodes in [10, 100, 1000] {
        let mut simulation = line(nodes, &[]);
        let mut links = line(nodes, &["run.formulation=Denoc"]);
        let calls = 200_000 / (nodes + 10);
        let forces_ns = least(|| {
            let start = Instant::now();
            simulation
                .evaluate(calls)
                .expect("the line can be evaluated");
            start.elapsed().as_nanos() as f64 / calls as f64
        });
        let [rates_ns, links_ns] = [&mut simulation, &mut links].map(|simulation| {
            least(|| {
                let start = Instant::now();
                simulation.rates(calls).expect("the line can be evaluated");
                start.elapsed().as_nanos() as f64 / calls as f64
            })
        });
        let segments = (nodes + 1) as f64;
        println!(
            "| force evaluation | {nodes} | {:.2} us, {:.1} ns per segment |",
            forces_ns / 1e3,
            forces_ns / segments
        );
        println!(
            "| the same with scatter and gather of the state | {nodes} | {:.2} us, {:.1} ns per segment |",
            rates_ns / 1e3,
            rates_ns / segments
        );
        println!(
            "| the same of rigid links | {nodes} | {:.2} us, {:.1} ns per segment |",
            links_ns / 1e3,
            links_ns / segments
        );
    }
    let rk4 = ["run.integrator=Fixed()", "run.duration_s=10"];
    let (step_us, _) = comparison(&rk4);
    println!("| RK4 step of the 900 m case | 10 | {step_us:.2} us |");
    let (step_us, _) = comparison(&[rk4[0], rk4[1], "run.formulation=Denoc"]);
    println!("| the same of rigid links | 10 | {step_us:.2} us |");
    let (_, speed) = comparison(&[]);
    println!(
        "| `comparison_900m.ron` as shipped, with nothing written | 10 | {speed:.0} simulated s per s |"
    );
}

/// A 1 km line in the air of Venus with a probe at its end: no body but that weighs in.
fn line(nodes: usize, overrides: &[&str]) -> Simulation {
    let scene = format!(
        r#"(
            name: "line",
            environment: (atmosphere: Vira, wind: [Uniform(velocity_m_s: (4, 3, 0))]),
            entities: {{
                "top": (Fixed: (position_m: (0, 0, 56000))),
                "probe": (
                    Body: (mass_kg: 4),
                    Drag: Constant(coefficient: 0.47, area_m2: 0.00785),
                ),
                "line": (Tether: (
                    from: ("top", Centre), to: ("probe", Centre),
                    length_m: 1000, nodes: {nodes}, diameter_m: 0.0005, density_kg_m3: 1500,
                    axial_stiffness_n: 11500, damping_n_s_m: 0.1,
                    drag: (normal: 1, tangential: 0.03),
                )),
            }},
            run: (duration_s: 1, output_every_s: 1, record: (channels: None)),
        )"#
    );
    build(scene, overrides)
}

/// Microseconds per step, and simulated seconds per second, of the comparison case.
fn comparison(overrides: &[&str]) -> (f64, f64) {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/paper/comparison_900m.ron"
    );
    let text = std::fs::read_to_string(file).expect("the scene is in the repository");
    let mut best = (f64::INFINITY, 0.0_f64);
    for _ in 0..5 {
        let mut simulation = build(text.clone(), overrides);
        let start = Instant::now();
        let summary = simulation.run(&mut NullSink, &mut |_| {});
        let wall_s = start.elapsed().as_secs_f64();
        best.0 = best.0.min(wall_s * 1e6 / summary.steps as f64);
        best.1 = best.1.max(summary.simulated_s / wall_s);
    }
    best
}

fn build(scene: String, overrides: &[&str]) -> Simulation {
    let simulator = Simulator::new();
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let scene = simulator
        .load_text("bench.ron", scene, Path::new("."), &overrides)
        .unwrap_or_else(|error| panic!("{error}"));
    simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"))
}

fn least(mut measure: impl FnMut() -> f64) -> f64 {
    (0..REPEATS)
        .map(|_| measure())
        .fold(f64::INFINITY, f64::min)
}
