//! Figures of campaigns set beside what their runs are known to give, and beside their summaries.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;
use std::path::Path;

use aerobot_report::campaign::{CampaignFigure, CampaignRecord, SearchRecord};
use aerobot_report::figure::{Figure, Mark, Panel, Series};
use program::searches::{THROW, optimised};
use program::{Scratch, aerobot, text};

/// A stone that is thrown in a vacuum and flies for 2 s: it ends at twice its velocity along x and y, and falls
/// 2 g below its start.
fn thrown(scratch: &Scratch, rest: &str) -> CampaignRecord {
    scratch.file(
        "throw.ron",
        r#"(
    name: "throw",
    environment: (gravity: Constant(8.87), atmosphere: Uniform(density_kg_m3: 0)),
    entities: {
        "stone": (
            Body: (mass_kg: 4, inertia: SolidSphere),
            Sphere: (radius_m: 0.05),
            Pose: (position_m: (0, 0, 50_000)),
            Motion: (velocity_m_s: (0, 0, 0)),
        ),
    },
    run: (duration_s: 2, output_every_s: 0.5, integrator: Auto()),
)"#,
    );
    let rest = format!("(name: \"throws\", scene: \"throw.ron\", seed: 3, {rest})");
    let file = scratch.file("throws.ron", &rest);
    let out = scratch.path("out");
    let run = aerobot(&["campaign", "run", &file, "--out", &out, "--quiet"]);
    // 3 where runs have failed, which is wanted here.
    assert_ne!(run.status.code(), Some(2), "{}", text(&run.stderr));
    CampaignRecord::read(Path::new(&out)).unwrap_or_else(|error| panic!("{error}"))
}

const METRICS: &str = r#"
    metrics: {
        "final_x_m": Final(entity: "stone", channel: "x_m"),
        "final_y_m": Final(entity: "stone", channel: "y_m"),
    },
    envelopes: {"x_m": (entity: "stone", channel: "x_m", every_s: 0.5)},
"#;

fn series<'a>(panel: &'a Panel, name: &str) -> Vec<&'a Series> {
    let all = panel.series.iter();
    all.filter(|series| series.name == name).collect()
}

fn draw(record: &CampaignRecord, kind: CampaignFigure) -> Figure {
    record
        .figure(kind)
        .unwrap_or_else(|why| panic!("{kind}: {why}"))
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b.abs()
}

/// 101 velocities from 0 to 10 m/s in steps: percentiles of the way are 20 m/s x t x percent / 100 / 2.
#[test]
fn percentiles_and_means_of_an_even_sample() {
    let scratch = Scratch::folder();
    let vary = r#"plan: Grid, vary: {
        "entities.stone.Motion.velocity_m_s.0": Levels(from: 0, to: 10, count: 101),
    },"#;
    let record = thrown(&scratch, &format!("{vary}{METRICS}"));
    assert_eq!(
        record.kinds(),
        [
            CampaignFigure::Envelope,
            CampaignFigure::Histogram,
            CampaignFigure::Tornado,
            CampaignFigure::Convergence
        ]
    );
    let envelope = &draw(&record, CampaignFigure::Envelope).panels[0];
    assert_eq!(envelope.y.label, "x [m]");
    let last = |name: &str| {
        let found = series(envelope, name)[0];
        let Mark::Band { to } = &found.mark else {
            return (found.y[4], found.y[4]);
        };
        (found.y[4], to[4])
    };
    assert_eq!(envelope.series[0].x, [0.0, 0.5, 1.0, 1.5, 2.0]);
    assert!(close(last("5 to 95 % (light)").0, 1.0) && close(last("5 to 95 % (light)").1, 19.0));
    assert!(close(last("25 to 75 % (dark)").0, 5.0) && close(last("25 to 75 % (dark)").1, 15.0));
    assert!(close(last("median").0, 10.0));
    let histogram = &draw(&record, CampaignFigure::Histogram).panels[0];
    assert_eq!(series(histogram, "runs")[0].y.iter().sum::<f64>(), 101.0);
    assert!(close(series(histogram, "mean")[0].x[0], 10.0));
    let marks = series(histogram, "5, 50, 95 %");
    let marks = marks.iter().map(|mark| mark.x[0]);
    assert!(
        marks
            .zip([1.0, 10.0, 19.0])
            .all(|(found, there)| close(found, there))
    );
    // Larger and larger: the mean of the first n is (n - 1) / 10.
    let convergence = &draw(&record, CampaignFigure::Convergence).panels[0];
    let mean = series(convergence, "mean")[0];
    let mut rows = mean.x.iter().zip(&mean.y);
    assert!(rows.clone().all(|(n, mean)| close(*mean, (n - 1.0) / 10.0)));
    let (n, mean) = rows.next_back().unwrap();
    assert_eq!(*n, 101.0);
    assert!(close(*mean, record.summary.metrics[0].mean.unwrap()));
    // What is in step has the rank correlation 1; y does not vary.
    let tornado = draw(&record, CampaignFigure::Tornado);
    assert_eq!(tornado.panels.len(), 1);
    assert_eq!(series(&tornado.panels[0], "rank correlation")[0].x, [1.0]);
}

/// x and y of the end are independent and normal, with deviations of 2 and 6 m about 20 and 0.
#[test]
fn ellipses_and_shares_of_normal_ends() {
    let scratch = Scratch::folder();
    let vary = r#"runs: 400, vary: {
        "entities.stone.Motion.velocity_m_s.0": Normal(mean: 10, standard_deviation: 1),
        "entities.stone.Motion.velocity_m_s.1": Normal(mean: 0, standard_deviation: 3),
    },"#;
    let record = thrown(&scratch, &format!("{vary}{METRICS}"));
    let figure = draw(&record, CampaignFigure::Ellipse);
    assert!(
        figure.caption.contains("39.3 and 86.5 %"),
        "{}",
        figure.caption
    );
    let panel = &figure.panels[0];
    assert!(panel.equal_axes);
    assert_eq!(series(panel, "runs")[0].x.len(), 400);
    let ellipse = series(panel, "2 sigma, 86.5 %")[0];
    let half = |values: &[f64]| {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        0.5 * (most - least)
    };
    // The box about it is twice the deviations, of which 1 / sqrt(2 n) is a standard error.
    assert!((half(&ellipse.x) / 4.0 - 1.0).abs() < 4.0 / libm::sqrt(800.0));
    assert!((half(&ellipse.y) / 12.0 - 1.0).abs() < 4.0 / libm::sqrt(800.0));
    for (axis, summary) in [&ellipse.x, &ellipse.y]
        .into_iter()
        .zip(&record.summary.metrics)
    {
        let deviation = summary.standard_deviation.unwrap();
        assert!(
            (half(axis) / (2.0 * deviation) - 1.0).abs() < 2e-3,
            "of its corners"
        );
    }
    // Each coordinate is all of its own metric's variance, and nothing of the other's.
    let tornado = draw(&record, CampaignFigure::Tornado);
    for (panel, own) in tornado
        .panels
        .iter()
        .zip(["velocity_m_s.0", "velocity_m_s.1"])
    {
        let bars = series(panel, "first order")[0];
        assert!(panel.y.names[1].ends_with(own), "{:?}", panel.y.names);
        assert!(bars.x[1] > 0.9 && bars.x[0].abs() < 0.25, "{:?}", bars.x);
    }
}

#[test]
fn runs_of_a_base_sample_count_once_and_failures_are_listed() {
    let scratch = Scratch::folder();
    let vary = r#"plan: Saltelli, base_samples: 16, set: {"run.seed": 1}, vary: {
        "entities.stone.Motion.velocity_m_s.0": Uniform(0, 10),
        "entities.stone.Motion.velocity_m_s.1": Uniform(0, 1),
    },"#;
    let record = thrown(&scratch, &format!("{vary}{METRICS}"));
    assert_eq!(
        (record.runs.indices.len(), record.values(0).len()),
        (64, 32)
    );
    let mean = &draw(&record, CampaignFigure::Convergence).panels[0];
    let last = *series(mean, "mean")[0].y.last().unwrap();
    assert!(close(last, record.summary.metrics[0].mean.unwrap()));
    let tornado = draw(&record, CampaignFigure::Tornado);
    assert_eq!(series(&tornado.panels[0], "total").len(), 1);
    assert!(record.failures().is_empty());

    let scratch = Scratch::folder();
    let vary = r#"runs: 12, vary: {"entities.stone.Sphere.radius_m": Uniform(-0.05, 0.1)},"#;
    let record = thrown(&scratch, &format!("{vary}{METRICS}"));
    let failures = record.failures();
    let of_summary = record.summary.failures.iter().map(|failure| failure.runs);
    assert_eq!(failures.len() as u64, of_summary.sum::<u64>());
    assert!(!failures.is_empty() && failures.len() < 12);
    let first = &failures[0];
    assert_eq!(first.outcome, "refused");
    let replay = format!(
        "aerobot campaign replay {} --run {}",
        scratch.path("out"),
        first.run
    );
    assert_eq!(first.replay, replay);
}

#[test]
fn what_is_no_finished_campaign_is_refused() {
    let scratch = Scratch::folder();
    let read = |folder: &str| CampaignRecord::read(Path::new(folder)).unwrap_err().text;
    let why = read(scratch.text());
    assert!(
        why.contains("is not the folder of a finished campaign: it has no `manifest.json`"),
        "{why}"
    );
    thrown(&scratch, &format!("runs: 3,{METRICS}"));
    let runs = scratch.path("out/runs.csv");
    let table = fs::read_to_string(&runs).unwrap();
    fs::write(&runs, table.replace("done", "done,x")).unwrap();
    let why = read(&scratch.path("out"));
    assert!(
        why.contains("runs.csv:2: the row has not as many fields as the header"),
        "{why}"
    );
    assert!(
        "pie"
            .parse::<CampaignFigure>()
            .unwrap_err()
            .contains("there is no figure `pie`")
    );
}

/// A throw of vx m/s is 10 vx m away after 10 s: as far as that may be, 450 m.
#[test]
fn the_best_of_a_search_so_far_ends_at_the_best() {
    let scratch = Scratch::folder();
    let body = r#"
    variables: {"entities.ball.Motion.velocity_m_s.0": (from: 1, to: 100)},
    objective: Maximise(Value("far_x_m")),
    constraints: {"away_x_m": (of: Value("far_x_m"), at_most: 450)},
    metrics: {"far_x_m": Final(entity: "ball", channel: "x_m")},
    search: (sample: 4, starts: 1),
"#;
    let best = optimised(&scratch, THROW, body);
    let record = SearchRecord::read(Path::new(&scratch.path("out"))).unwrap();
    let so_far = record.best_so_far();
    assert_eq!(so_far.last().unwrap().1, best.objective());
    assert!(so_far.windows(2).all(|pair| pair[0].1 <= pair[1].1));
    let figure = record.search();
    let [objective, away] = &figure.panels[..] else {
        panic!("{} panels", figure.panels.len());
    };
    assert_eq!(objective.y.label, "objective, the more the better [m]");
    assert_eq!(
        (away.y.label.as_str(), &series(away, "limit")[0].y),
        ("away x [m]", &vec![450.0; 2])
    );
    assert!(
        series(away, "feasible")[0]
            .y
            .iter()
            .all(|value| *value <= 450.0)
    );
    assert!(
        series(away, "infeasible")[0]
            .y
            .iter()
            .all(|value| *value > 450.0)
    );
    let [thrown] = &record.variables().panels[..] else {
        panic!("one variable, one panel")
    };
    let label = "entities.ball.Motion.velocity_m_s.0 [m/s]";
    assert_eq!(thrown.x.label, label);
    let points = thrown.series.iter().flat_map(|of| of.x.iter().zip(&of.y));
    let mut count = 0;
    for (speed_m_s, far_m) in points {
        assert!((far_m - 10.0 * speed_m_s).abs() < 1e-9);
        count += 1;
    }
    assert_eq!(count, record.evaluations.len());
}

/// A folder of a search has a report and figures of its own, and says which.
#[test]
fn a_search_has_a_report_and_says_which_figures_it_has() {
    let scratch = Scratch::folder();
    let body = r#"
    variables: {"entities.ball.Motion.velocity_m_s.0": (from: 1, to: 100)},
    objective: Minimise(Value("far_x_m")),
    constraints: {"away_x_m": (of: Value("far_x_m"), at_least: 450)},
    metrics: {"far_x_m": Final(entity: "ball", channel: "x_m")},
    search: (sample: 4, starts: 1),
"#;
    let best = optimised(&scratch, THROW, body);
    let out = scratch.path("out");
    let report = aerobot(&["report", &out]);
    assert_eq!(report.status.code(), Some(0), "{}", text(&report.stderr));
    let page = fs::read_to_string(format!("{out}/report.html")).unwrap();
    assert!(page.contains("The best design") && page.contains(&best.objective().to_string()));
    assert!(page.contains("search-variables") && page.contains("Every design has a value."));

    let refused = aerobot(&["plot", &out, "displacement"]);
    assert_eq!(refused.status.code(), Some(2));
    let told = text(&refused.stderr);
    assert!(
        told.contains("a design search") && told.contains("`search`, `search-variables`"),
        "{told}"
    );
    let drawn = aerobot(&["plot", &out, "search-variables"]);
    assert_eq!(drawn.status.code(), Some(0), "{}", text(&drawn.stderr));
    let beside = aerobot(&["report", &out, &out]);
    assert_eq!(beside.status.code(), Some(2));
    let png = format!("{out}/figure.png");
    let refused = aerobot(&["plot", &out, "search", "--out", &png]);
    assert!(refused.status.code() == Some(2) && text(&refused.stderr).contains("`.svg`"));
}
