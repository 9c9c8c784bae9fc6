//! What a simulated second of stiff tethers costs: `cargo bench --bench stiff_tethers`.
//!
//! The 1 km line of the comparison with MoorDyn in docs/cost.md (a 4 kg sphere on 0.237 kg of line in a wind of
//! 5 m/s, let go from a slant) at seven numbers of nodes, its stiffer sister, and the paper's cases. One
//! core, release build, CPU time of the run with its recording; the least of five repeats, cases
//! interleaved. The error is the largest distance of a body from a run a thousand times more accurate, at
//! the outputs of the scene (at every 5 s of the line). `-- --peer` prints the lines that `benches/peers/moordyn_line.py` reads.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench may fail loudly")]

#[path = "scenes/one_km_line.rs"]
mod one_km_line;

use std::path::Path;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::{MemorySink, NullSink};
use aerobot_engine::recording::summary::Summary;
use aerobot_engine::run_folder::thread_cpu_time;
use aerobot_engine::scene::Scene;
use one_km_line::one_km_line;

const REPEATS: usize = 5;
const SIZES: [usize; 7] = [10, 20, 50, 100, 200, 500, 1000];

/// A case to be timed.
struct Case {
    name: String,
    nodes: usize,
    scene: String,
    /// The integrator that is timed, and the one that says what is right.
    integrator: String,
    exact: String,
    /// When its bodies are looked at, s, if not at the outputs.
    watched_every_s: Option<f64>,
}

/// What a case takes.
struct Timed {
    us_per_simulated_s: f64,
    summary: Summary,
    error_m: f64,
}

fn main() {
    let only_peer = std::env::args().any(|argument| argument == "--peer");
    let lines: Vec<Case> = SIZES
        .iter()
        .map(|nodes| {
            case(
                "1 km line",
                *nodes,
                one_km_line(*nodes, 11.5e3, 60.0),
                LINE_ACCURACY_M,
            )
        })
        .collect();
    let timed = time(&lines);
    if only_peer {
        for (case, timed) in lines.iter().zip(&timed) {
            println!(
                "peer,{},{},{:.3},{:.2e}",
                case.nodes, timed.summary.steps, timed.us_per_simulated_s, timed.error_m
            );
        }
        return;
    }
    println!(
        "| case | N | accuracy asked | steps (implicit, rejected) | largest error of a body | CPU per simulated s |"
    );
    println!("|---|---|---|---|---|---|");
    print(&lines, &timed);
    let (first, last) = (&timed[3], &timed[6]);
    let exponent = libm::log10(last.us_per_simulated_s / first.us_per_simulated_s);
    let others = [
        case(
            "1 km line, EA x 1000",
            100,
            one_km_line(100, 11.5e6, 60.0),
            0.01,
        ),
        case("900 m, three gusts", 10, paper("comparison_900m"), 0.001),
        case("9.7 km towline", 100, paper("towing_9700m"), 0.003),
    ];
    let timed = time(&others);
    print(&others, &timed);
    println!();
    println!("exponent of cost against N from 100 to 1000: {exponent:.3}");
}

/// With this the line's end keeps within 1 cm of where it should be over all of its 60 s.
const LINE_ACCURACY_M: f64 = 0.05;

fn case(name: &str, nodes: usize, scene: String, accuracy_m: f64) -> Case {
    Case {
        name: name.to_owned(),
        nodes,
        scene,
        integrator: format!("Auto(accuracy_m: {accuracy_m:?})"),
        exact: format!("Auto(accuracy_m: {:?})", 1e-3 * accuracy_m),
        watched_every_s: name.starts_with("1 km").then_some(5.0),
    }
}

fn print(cases: &[Case], timed: &[Timed]) {
    for (case, timed) in cases.iter().zip(timed) {
        let summary = &timed.summary;
        println!(
            "| {} | {} | {} | {} ({}, {}) | {:.1} mm | {:.1} us |",
            case.name,
            case.nodes,
            case.integrator,
            summary.steps,
            summary.implicit_steps,
            summary.rejected_steps,
            1e3 * timed.error_m,
            timed.us_per_simulated_s
        );
    }
}

/// Times all cases, interleaved.
fn time(cases: &[Case]) -> Vec<Timed> {
    let simulator = Simulator::new();
    let mut best: Vec<Option<(f64, Summary)>> = vec![None; cases.len()];
    for _ in 0..REPEATS {
        for (case, best) in cases.iter().zip(&mut best) {
            let scene = load(&simulator, case, &case.integrator, &[]);
            let mut simulation = simulator
                .build(&scene)
                .unwrap_or_else(|error| panic!("{error}"));
            let start = thread_cpu_time();
            let summary = simulation.run(&mut NullSink, &mut |_| {});
            let cpu_s = (thread_cpu_time() - start).as_secs_f64();
            let cost = 1e6 * cpu_s / summary.simulated_s;
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                *best = Some((cost, summary));
            }
        }
    }
    let finish = |(case, best): (&Case, Option<(f64, Summary)>)| {
        let (us_per_simulated_s, summary) = best.expect("every case was run");
        let (exact, _) = fly(&simulator, case, &case.exact);
        let (found, _) = fly(&simulator, case, &case.integrator);
        Timed {
            us_per_simulated_s,
            summary,
            error_m: largest_distance_m(&exact, &found),
        }
    };
    cases.iter().zip(best).map(finish).collect()
}

fn load(simulator: &Simulator, case: &Case, integrator: &str, more: &[String]) -> Scene {
    let mut overrides = vec![format!("run.integrator={integrator}")];
    overrides.extend_from_slice(more);
    simulator
        .load_text("bench.ron", case.scene.clone(), Path::new("."), &overrides)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Runs a case with its bodies kept.
fn fly(simulator: &Simulator, case: &Case, integrator: &str) -> (MemorySink, Summary) {
    let watched: Vec<String> = case
        .watched_every_s
        .map(|period_s| format!("run.output_every_s={period_s:?}"))
        .into_iter()
        .collect();
    let scene = load(simulator, case, integrator, &watched);
    let mut simulation = simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut sink = MemorySink::default();
    let summary = simulation.run(&mut sink, &mut |_| {});
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    (sink, summary)
}

/// Between the same bodies at the same times.
fn largest_distance_m(a: &MemorySink, b: &MemorySink) -> f64 {
    let rows = |sink: &MemorySink| -> Vec<_> {
        let rows = sink.frames.iter().flat_map(|frame| frame.states.clone());
        rows.filter(|row| !row.entity.contains('/')).collect()
    };
    let (a, b) = (rows(a), rows(b));
    assert_eq!(a.len(), b.len());
    let distances = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (a.position_m - b.position_m).length());
    distances.fold(0.0, f64::max)
}

fn paper(name: &str) -> String {
    let file = format!("{}/scenes/paper/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(file).expect("the scene is in the repository")
}
