//! Runs of the engine: what a setting costs and how far it is from the reference.

use std::path::Path;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::{Frame, MemorySink, NullSink, ResultSink};
use aerobot_engine::recording::summary::Summary;
use aerobot_engine::run_folder::thread_cpu_time;

use crate::cases::Case;
use crate::row::{Method, Row};

/// Passes over all settings of a case, of which the least CPU time counts, and how long a setting runs
/// at least in each, s.
const PASSES: u32 = 4;
const AT_LEAST_S: f64 = 0.05;
/// A run that takes more than this, s, is timed once.
const LONG_RUN_S: f64 = 2.0;
/// A method whose run has taken more than this, s, is not tried with finer settings.
const GIVE_UP_S: f64 = 20.0;
/// Accuracies in m of the methods that take one.
const ACCURACIES_M: [f64; 13] = [
    1.0, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6,
];
/// Relative tolerances of Dormand-Prince.
const TOLERANCES: [f64; 7] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];
/// Of the largest stable step of RK4, as it is tried beside the default.
const PART_OF_STABLE_STEP: f64 = 0.9;

/// A run: what was recorded, what it says of itself, and its CPU time.
struct Flight {
    frames: Vec<Frame>,
    summary: Summary,
    cpu_s: f64,
}

/// All rows of a case.
pub(crate) fn study(case: &Case) -> Vec<Row> {
    let simulator = Simulator::new();
    let tolerance = case.reference_tolerance;
    let exact = format!("Adaptive(relative_tolerance: {tolerance:?})");
    let reference = record(&simulator, case, &exact);
    let outcome = &reference.summary.outcome;
    assert_eq!(outcome, "done", "{:?}", reference.summary.stopped);
    eprintln!("{}: reference in {:.1} s", case.name, reference.cpu_s);
    let stable_step_s = reference.summary.stable_step_s.expect("there are tethers");
    let mut tried: Vec<(Row, String, Flight)> = Vec::new();
    for method in Method::ALL {
        for (setting, integrator) in settings(method, stable_step_s) {
            let flight = record(&simulator, case, &integrator);
            let row = judge(case, method, setting, &flight, &reference);
            let give_up = flight.cpu_s > GIVE_UP_S;
            eprintln!("  {}", row.line());
            tried.push((row, integrator, flight));
            if give_up {
                break;
            }
        }
    }
    // Interleaved, so that a slow moment of the machine does not hit one setting alone.
    for _ in 0..PASSES {
        for (row, integrator, flight) in &mut tried {
            if flight.cpu_s < LONG_RUN_S {
                let cpu_s = least_cpu_s(&simulator, case, integrator);
                let us = 1e6 * cpu_s / flight.summary.simulated_s;
                row.cpu_us_per_simulated_s = row.cpu_us_per_simulated_s.min(us);
            }
        }
    }
    tried.into_iter().map(|(row, ..)| row).collect()
}

/// What a method is tried with: as the table says it, and as a scene does.
fn settings(method: Method, stable_step_s: f64) -> Vec<(String, String)> {
    let by_accuracy = |name: &str| -> Vec<_> {
        let one = |accuracy_m: &f64| {
            (
                format!("accuracy {accuracy_m:?} m"),
                format!("{name}(accuracy_m: {accuracy_m:?})"),
            )
        };
        ACCURACIES_M.iter().map(one).collect()
    };
    match method {
        Method::Auto => by_accuracy("Auto"),
        Method::Implicit => by_accuracy("Implicit"),
        Method::DormandPrince => {
            let one = |tolerance: &f64| {
                (
                    format!("tolerance {tolerance:?}"),
                    format!("Adaptive(relative_tolerance: {tolerance:?})"),
                )
            };
            TOLERANCES.iter().map(one).collect()
        }
        Method::RungeKutta4 => {
            let step_s = PART_OF_STABLE_STEP * stable_step_s;
            vec![
                (
                    format!("step {step_s:.3e} s (0.9 of stable)"),
                    format!("Fixed(step_s: {step_s:?})"),
                ),
                ("step by default".to_owned(), "Fixed()".to_owned()),
            ]
        }
    }
}

fn judge(case: &Case, method: Method, setting: String, flight: &Flight, reference: &Flight) -> Row {
    let summary = &flight.summary;
    let (error_bodies_m, error_nodes_m) = if summary.outcome == "done" {
        largest_distances_m(&reference.frames, &flight.frames)
    } else {
        eprintln!(
            "  {} {setting} stopped: {:?}",
            method.name(),
            summary.stopped
        );
        (f64::NAN, f64::NAN)
    };
    Row {
        case: case.name.to_owned(),
        method,
        setting,
        steps: summary.steps,
        rejected: summary.rejected_steps,
        evaluations: summary.evaluations,
        error_bodies_m,
        error_nodes_m,
        cpu_us_per_simulated_s: 1e6 * flight.cpu_s / summary.simulated_s,
        reference: format!("Dormand-Prince {:?}", case.reference_tolerance),
    }
}

/// Runs a case with everything kept.
fn record(simulator: &Simulator, case: &Case, integrator: &str) -> Flight {
    let mut sink = MemorySink::default();
    let (summary, cpu_s) = fly(simulator, case, integrator, &mut sink);
    Flight {
        frames: sink.frames,
        summary,
        cpu_s,
    }
}

/// The least CPU time of a run with nothing kept, in one pass, s.
fn least_cpu_s(simulator: &Simulator, case: &Case, integrator: &str) -> f64 {
    let (mut least_s, mut sum_s) = (f64::INFINITY, 0.0);
    while sum_s < AT_LEAST_S {
        let (_, cpu_s) = fly(simulator, case, integrator, &mut NullSink);
        least_s = least_s.min(cpu_s);
        sum_s += cpu_s;
    }
    least_s
}

fn fly(
    simulator: &Simulator,
    case: &Case,
    integrator: &str,
    sink: &mut dyn ResultSink,
) -> (Summary, f64) {
    let overrides = [
        format!("run.integrator={integrator}"),
        format!("run.duration_s={:?}", case.duration_s),
        format!(
            "run.output_every_s={:?}",
            case.duration_s / f64::from(case.outputs)
        ),
    ];
    let text = case.scene.clone();
    let scene = simulator
        .load_text("work_precision.ron", text, Path::new("."), &overrides)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"));
    let start = thread_cpu_time();
    let summary = simulation.run(sink, &mut |_| {});
    (summary, (thread_cpu_time() - start).as_secs_f64())
}

/// Between the same bodies, and between the same nodes, at the same times.
fn largest_distances_m(a: &[Frame], b: &[Frame]) -> (f64, f64) {
    assert_eq!(a.len(), b.len());
    let (mut bodies_m, mut nodes_m) = (0.0_f64, 0.0_f64);
    for (a, b) in a.iter().zip(b) {
        for (a, b) in a.states.iter().zip(&b.states) {
            assert_eq!(a.entity, b.entity);
            let distance_m = (a.position_m - b.position_m).length();
            let largest_m = if a.entity.contains('/') {
                &mut nodes_m
            } else {
                &mut bodies_m
            };
            *largest_m = largest_m.max(distance_m);
        }
    }
    (bodies_m, nodes_m)
}
