//! What a campaign costs: `cargo bench --bench campaigns` prints the table that docs/cost.md shows.
//!
//! 1000 runs of 100 s of `scenes/gust_response.ron` (gusts resolved at 0.1 s, 1 cm asked) as
//! `scenes/campaigns/gusts_1000.ron` has them, on one worker and on every core, in turn, five times each; release
//! build, otherwise idle machine. The efficiency is that of each core: the rate of all workers over so many times the
//! rate of one. Memory is the largest that the process has held.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench may fail loudly")]

use std::fs;
use std::path::{Path, PathBuf};
use std::thread::available_parallelism;
use std::time::Instant;

use aerobot_engine::campaign::definition::Campaign;
use aerobot_engine::campaign::preparation::prepare;
use aerobot_engine::campaign::running::{Work, run_shard};
use aerobot_engine::campaign::shards::Shard;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::{Frame, ResultSink};

const REPEATS: usize = 5;

fn main() {
    let simulator = Simulator::new();
    let cores = available_parallelism().map_or(1, usize::from);
    let mut rates = [Vec::new(), Vec::new()];
    let mut memory_mib = Vec::new();
    for _ in 0..REPEATS {
        for (rates, workers) in rates.iter_mut().zip([1, cores]) {
            rates.push(runs_per_second(&simulator, workers));
            memory_mib.push(largest_memory_mib());
        }
    }
    let efficiencies = rates[0].iter().zip(&rates[1]);
    let efficiencies: Vec<f64> = efficiencies
        .map(|(one, all)| all / (one * cores as f64))
        .collect();
    println!("| 1000 runs of 100 s of `gust_response.ron` | median of {REPEATS} | from | to |");
    println!("|---|---|---|---|");
    row("runs per second on one worker", &rates[0], 0);
    row(&format!("runs per second on {cores} workers"), &rates[1], 0);
    row("efficiency of each core", &efficiencies, 3);
    row("largest memory so far, MiB", &memory_mib, 1);
    row(
        "farthest from `Auto(accuracy_m: 1e-4)`, mm, five seeds",
        &farthest_mm(&simulator),
        1,
    );
}

fn row(what: &str, values: &[f64], digits: usize) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (sorted[0], sorted[sorted.len() - 1]);
    let median = sorted[sorted.len() / 2];
    println!("| {what} | {median:.digits$} | {first:.digits$} | {last:.digits$} |");
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

fn runs_per_second(simulator: &Simulator, workers: usize) -> f64 {
    let folder = std::env::temp_dir().join(format!("aerobot-bench-{}", std::process::id()));
    let file = scenes().join("campaigns/gusts_1000.ron");
    let prepared = prepare(simulator, &file, 1).expect("the campaign is valid");
    prepared.into_folder(&folder).expect("the folder is free");
    let campaign = Campaign::open(&folder).expect("the folder is a campaign's");
    let work = Work {
        workers,
        precision: None,
    };
    let shard = Shard {
        number: 1,
        count: 1,
    };
    let start = Instant::now();
    run_shard(simulator, &campaign, shard, &work, &mut |_, _| {}).expect("the campaign runs");
    let rate = campaign.plan.runs as f64 / start.elapsed().as_secs_f64();
    fs::remove_dir_all(&folder).expect("the folder is there");
    rate
}

/// The high-water mark of the resident set, MiB; NaN where the system does not tell.
fn largest_memory_mib() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kib.map_or(f64::NAN, |kib| kib / 1024.0)
}

/// Where all bodies and nodes are, at every output.
#[derive(Default)]
struct Places(Vec<[f64; 3]>);

impl ResultSink for Places {
    fn take(&mut self, frame: &Frame) -> std::io::Result<()> {
        let rows = frame.states.iter();
        self.0.extend(rows.map(|row| row.position_m.to_array()));
        Ok(())
    }
}

fn farthest_mm(simulator: &Simulator) -> Vec<f64> {
    let places = |seed: u32, accuracy: &str| {
        let changes = [
            format!("run.seed={seed}"),
            format!("run.integrator=Auto(accuracy_m: {accuracy})"),
        ];
        let scene = simulator
            .load(&scenes().join("gust_response.ron"), &changes)
            .expect("the scene is valid");
        let mut places = Places::default();
        let mut simulation = simulator.build(&scene).expect("the scene can be built");
        simulation.run(&mut places, &mut |_| {});
        places.0
    };
    (1..=5)
        .map(|seed| {
            let (found, fine) = (places(seed, "1e-2"), places(seed, "1e-4"));
            let apart = found.iter().zip(&fine).map(|(a, b)| {
                let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
                squares.sum::<f64>().sqrt()
            });
            apart.fold(0.0, f64::max) * 1e3
        })
        .collect()
}
