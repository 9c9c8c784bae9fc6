//! What a simulated second of stiff tethers costs: `cargo bench --bench stiff_tethers`.
//!
//! The 1 km line of the README's comparison with MoorDyn (a 4 kg sphere on 0.237 kg of line in a wind of
//! 5 m/s, let go from a slant), its stiff variant, and the paper's cases. One core, release build; the
//! least of several repeats, cases interleaved. With `-- --peer` only the lines that
//! `benches/peers/moordyn_line.py` reads.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench may fail loudly")]

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::MemorySink;
use aerobot_engine::recording::summary::Summary;
use aerobot_engine::simulation::Simulation;

const REPEATS: usize = 1;
const DURATION_S: f64 = 60.0;

fn main() {
    let sizes: Vec<usize> = std::env::var("SIZES")
        .map_or(vec![10, 20, 50, 100, 200, 500, 1000], |v| {
            v.split(",").map(|x| x.parse().unwrap()).collect()
        });
    let args: Vec<String> = std::env::args().collect();
    let accuracy: f64 = args
        .iter()
        .position(|a| a == "--accuracy")
        .and_then(|i| args.get(i + 1))
        .and_then(|a| a.parse().ok())
        .unwrap_or(0.01);
    let auto = args
        .iter()
        .find(|a| a.as_str() == "--auto")
        .map_or("Implicit", |_| "Auto");
    let stiff = if args.iter().any(|a| a == "--stiff") {
        1.15e7
    } else {
        11500.0
    };
    for nodes in sizes {
        let scene = line(nodes, stiff);
        let exact = end(&run(&scene, "Auto(accuracy_m: 1e-1)").1);
        let mut best = f64::INFINITY;
        let mut last = None;
        for _ in 0..REPEATS {
            let (wall_s, sink, summary) = {
                let r = run(&scene, &format!("{auto}(accuracy_m: {accuracy})"));
                (r.0, r.1, r.2)
            };
            best = best.min(wall_s);
            last = Some((end(&sink), summary));
        }
        let (found, summary) = last.expect("it ran");
        let error = exact
            .iter()
            .zip(&found)
            .map(|(a, b)| distance(*a, *b))
            .fold(0.0, f64::max);
        println!(
            "peer,{nodes},{},{:.2},{error:.2e}  rejected {} implicit {} us/step/node {:.3}",
            summary.steps,
            best * 1e6 / DURATION_S,
            summary.rejected_steps,
            summary.implicit_steps,
            best * 1e9 / (summary.steps as f64 * nodes as f64)
        );
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn end(sink: &MemorySink) -> Vec<[f64; 3]> {
    sink.frames
        .iter()
        .flat_map(|frame| &frame.states)
        .filter(|row| &*row.entity == "probe")
        .map(|row| row.position_m.to_array())
        .collect()
}

fn run(scene: &str, integrator: &str) -> (f64, MemorySink, Summary) {
    let mut simulation = build(scene, &[format!("run.integrator={integrator}")]);
    let mut sink = MemorySink::default();
    let start = Instant::now();
    let summary = simulation.run(&mut sink, &mut |_| {});
    let wall_s = start.elapsed().as_secs_f64();
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    (wall_s, sink, summary)
}

/// The line, let go at rest and straight, tilted by 0.3 rad towards +x, stretched by what it carries.
fn line(nodes: usize, stiffness: f64) -> String {
    let (length, line_mass, g) = (1000.0, 0.237, 8.87);
    let segments = nodes as f64 + 1.0;
    let node = line_mass / nodes as f64;
    let k = stiffness / length * segments;
    let damping = 0.2 * (k * node).sqrt() / segments;
    let diameter: f64 = 0.458e-3;
    let density = 2.37e-4 / (0.25 * std::f64::consts::PI * diameter * diameter);
    let (sin, cos) = 0.3_f64.sin_cos();
    let mut along = 0.0;
    let mut positions = String::new();
    for index in 1..=nodes + 1 {
        let below = 4.0 + node * (nodes + 1 - index) as f64;
        along += length / segments + below * g * cos / k;
        if index <= nodes {
            let _ = write!(positions, "({}, 0, {}),", along * sin, -along * cos);
        }
    }
    format!(
        r#"(
            name: "line",
            environment: (
                atmosphere: Uniform(density_kg_m3: 1), wind: [Uniform(velocity_m_s: (4, 3, 0))],
            ),
            entities: {{
                "top": (Fixed: (position_m: (0, 0, 0))),
                "probe": (
                    Body: (mass_kg: 4), Sphere: (radius_m: 0.05), Drag: Constant(coefficient: 0.47),
                    Pose: (position_m: ({}, 0, {})),
                ),
                "line": (Tether: (
                    from: ("top", Centre), to: ("probe", Centre),
                    length_m: {length}, nodes: {nodes}, diameter_m: {diameter}, density_kg_m3: {density},
                    axial_stiffness_n: {stiffness}, damping_n_s_m: {damping}, lumping: Interior,
                    drag: (normal: 1, tangential: 0.03), start: Positions([{positions}]),
                )),
            }},
            run: (
                duration_s: {DURATION_S}, output_every_s: {DURATION_S},
                record: (nodes: Never, tethers: Never, channels: None),
            ),
        )"#,
        along * sin,
        -along * cos
    )
}

fn build(scene: &str, overrides: &[String]) -> Simulation {
    let simulator = Simulator::new();
    let scene = simulator
        .load_text("bench.ron", scene.to_owned(), Path::new("."), overrides)
        .unwrap_or_else(|error| panic!("{error}"));
    simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"))
}
