//! `aerobot report` and `aerobot plot`: figures beside what instruments recorded, pages without a network, long
//! runs, and what is refused. What a page does in a browser is in `tests/browser`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::{Frame, ResultSink, StateRow};
use aerobot_report::figure::thinning::MOST_POINTS;
use aerobot_report::figure::{Figure, Series};
use aerobot_report::page::run_page::run_page;
use aerobot_report::record::{Record, Tables};
use aerobot_report::run_figures::{KINDS, RunFigureKind};
use glam::{DQuat, DVec3};
use program::{Scratch, aerobot, text};

/// A scene in gusts with a drone, so that every kind of figure but that of a controller has something to show.
const DOCKING: &str = "scenes/mav_dock.ron";
const CHAIN: &str = "scenes/paper/flight_chain.ron";

fn run(scene: &str, folder: &str, more: &[&str]) {
    let run = aerobot(&[&["run", scene, "--out", folder, "--quiet"], more].concat());
    assert!(run.status.success(), "{}", text(&run.stderr));
}

fn record(folder: &str) -> Record {
    Record::read(&Simulator::new(), Path::new(folder)).unwrap()
}

fn figure(kind: &str, record: &Record) -> Figure {
    let kind = RunFigureKind::of(kind).unwrap();
    kind.figure(&Simulator::new(), &[record]).unwrap()
}

/// The series of a name in the panel whose ordinate begins so.
fn series<'a>(figure: &'a Figure, ordinate: &str, name: &str) -> &'a Series {
    let panel = figure
        .panels
        .iter()
        .find(|panel| panel.y.label.starts_with(ordinate));
    let panel = panel.unwrap_or_else(|| panic!("no panel `{ordinate}`"));
    panel
        .series
        .iter()
        .find(|series| series.name == name)
        .unwrap()
}

/// Largest difference of a series from a recorded channel, which has the same times.
fn from_channel(series: &Series, record: &Record, entity: &str, channel: &str) -> f64 {
    let track = record.tables.channel(entity, channel).unwrap();
    assert_eq!(series.x, track.times_s);
    let pairs = series.y.iter().zip(&track.values);
    pairs.fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
}

/// The air relative to the bodies is worked out anew from scene and seed; instruments saw it in the run.
#[test]
fn figures_show_what_instruments_recorded() {
    let folder = Scratch::new();
    run(DOCKING, folder.text(), &["--until", "20", "--seed", "5"]);
    let record = record(folder.text());
    let wind = figure("relative-wind", &record);
    let attitude = figure("attitude", &record);
    for body in ["balloon", "gondola", "drone"] {
        let speed = series(&wind, "relative wind, speed", body);
        let apart = from_channel(speed, &record, body, "airspeed_m_s");
        assert!(apart < 1e-12, "{body}: {apart} m/s");
        assert!(speed.y.iter().any(|speed| *speed > 0.5));
        let yaw = series(&attitude, "yaw", body);
        let radians = yaw.y.iter().map(|yaw| yaw.to_radians()).collect();
        let yaw = Series {
            y: radians,
            ..yaw.clone()
        };
        let apart = from_channel(&yaw, &record, body, "heading_rad");
        assert!(apart < 1e-12, "{body}: {apart} rad");
    }
}

/// Tensions at the ends of a hanging line: weight of all below the middle of the segment.
#[test]
fn tension_along_a_hanging_line_is_the_weight_below() {
    let folder = Scratch::new();
    let more = [
        "--until",
        "5",
        "--set",
        "run.output_every_s=1",
        "--set",
        "environment.wind=[]",
    ];
    run("scenes/paper/comparison_900m.ron", folder.text(), &more);
    let profile = figure("tension-profile", &record(folder.text()));
    let line = &profile.panels[0].series[0];
    let gravity_m_s2 = 8.87;
    let radius_m: f64 = 0.001;
    let line_kg_m = 1440.0 * std::f64::consts::PI * radius_m * radius_m;
    let segment_kg = line_kg_m * 900.0 / 11.0;
    for (index, tension_n) in line.y.iter().enumerate() {
        // Half a segment's mass is at either end of it.
        let below_kg = 100.0 + segment_kg * (10.5 - index as f64);
        let apart_n = (tension_n - gravity_m_s2 * below_kg).abs();
        assert!(
            apart_n < 1e-6,
            "segment {index}: {tension_n} N, {apart_n} N off"
        );
    }
    assert_eq!(line.x.len(), 11);
}

#[test]
fn parquet_and_csv_read_back_alike() {
    let (csv, parquet) = (Scratch::new(), Scratch::new());
    run(CHAIN, csv.text(), &["--until", "5"]);
    run(
        CHAIN,
        parquet.text(),
        &["--until", "5", "--format", "parquet"],
    );
    let (csv, parquet) = (record(csv.text()), record(parquet.text()));
    assert_eq!(csv.tables.states, parquet.tables.states);
    assert_eq!(csv.tables.tethers, parquet.tables.tethers);
    assert_eq!(csv.tables.channels, parquet.tables.channels);
    assert!(csv.tables.bodies().count() == 4 && csv.tables.tethers.len() == 6);
}

#[test]
fn every_kind_is_drawn_or_says_why_not() {
    let folder = Scratch::new();
    let more = ["--until", "30", "--set", "run.record.channels=All"];
    run(DOCKING, folder.text(), &more);
    for kind in KINDS {
        let file = folder.path(&format!("{}.svg", kind.name));
        let plot = aerobot(&["plot", folder.text(), kind.name]);
        if matches!(kind.name, "commands" | "modes") {
            assert_eq!(plot.status.code(), Some(2), "{}", kind.name);
            let said = text(&plot.stderr);
            assert!(
                said.contains(&format!("there is no figure `{}` of", kind.name)),
                "{said}"
            );
            assert!(!Path::new(&file).exists());
            continue;
        }
        assert!(
            plot.status.success(),
            "{}: {}",
            kind.name,
            text(&plot.stderr)
        );
        let svg = fs::read(&file).unwrap();
        assert!(text(&svg).trim_end().ends_with("</svg>"));
        // The same bytes when it is drawn again.
        assert!(
            aerobot(&["plot", folder.text(), kind.name])
                .status
                .success()
        );
        assert_eq!(fs::read(&file).unwrap(), svg);
    }
}

#[test]
fn a_report_stands_alone() {
    let folder = Scratch::folder();
    let (a, b) = (folder.path("lumped"), folder.path("links"));
    run(CHAIN, &a, &["--until", "12", "--report"]);
    run(CHAIN, &b, &["--until", "12", "--formulation", "denoc"]);
    let page = fs::read_to_string(format!("{a}/report.html")).unwrap();
    for part in [
        "flight-chain",
        "magnetometer",
        "Displacement from the start",
        "Auto (ROS34PW2",
        "scene as run",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Nothing is fetched: no source, no style and no picture from elsewhere.
    let outside = page.split('<').filter(|tag| {
        let head = tag.split('>').next().unwrap_or_default();
        ["script", "link ", "img", "iframe"]
            .iter()
            .any(|name| head.starts_with(name))
            && (head.contains("src=") || head.contains("href=\"http"))
    });
    assert_eq!(outside.count(), 0);

    let both = folder.path("both.html");
    let report = aerobot(&["report", &a, &b, "--out", &both, "--quiet"]);
    assert!(report.status.success(), "{}", text(&report.stderr));
    let both = fs::read_to_string(both).unwrap();
    assert!(both.contains("gondola, lumped") && both.contains("gondola, links"));
    assert!(both.contains("<th>lumped</th><th>links</th>"));
}

#[test]
fn what_is_no_run_is_refused() {
    let folder = Scratch::folder();
    let refused = |arguments: &[&str], parts: &[&str]| {
        let run = aerobot(arguments);
        let said = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{said}");
        for part in parts {
            assert!(said.contains(part), "`{part}` in {said}");
        }
    };
    let nowhere = folder.path("nowhere");
    refused(
        &["report", &nowhere],
        &["is not the folder of a run", "scene.ron", "aerobot run"],
    );
    refused(
        &["plot", &nowhere, "altitude"],
        &["is not the folder of a run"],
    );
    let good = folder.path("run");
    let standard = ["--until", "1", "--set", "run.record.channels=Standard"];
    run(CHAIN, &good, &standard);
    refused(
        &["plot", &good, "altitud"],
        &["no kind of figure `altitud`", "did you mean `altitude`?"],
    );
    refused(&["plot", &good], &["aerobot plot DIR KIND"]);
    refused(
        &["plot", &good, "energy"],
        &["was not recorded", "run.record.channels=All"],
    );
    refused(
        &["plot", &good, "envelope"],
        &["is not the folder of a finished campaign"],
    );
    let taken = folder.path("taken.svg");
    fs::write(&taken, "mine").unwrap();
    refused(
        &["plot", &good, "altitude", "--out", &taken],
        &["exists", "--force"],
    );
    refused(
        &["report", &good, "--out", &taken],
        &["is not a report", "--force"],
    );
    assert_eq!(fs::read_to_string(&taken).unwrap(), "mine");
    let unwritable = folder.path("no/such/folder.html");
    refused(
        &["report", &good, "--out", &unwritable],
        &["cannot write", "folder.html"],
    );
}

/// A table that was cut or edited is told with its line; a last line without its end is what a kill leaves.
#[test]
fn a_broken_table_is_told_with_its_line() {
    let folder = Scratch::new();
    run(CHAIN, folder.text(), &["--until", "1"]);
    let file = folder.path("states.csv");
    let whole = fs::read_to_string(&file).unwrap();
    let rows = record(folder.text()).tables.states[0].times_s.len();
    fs::write(&file, &whole[..whole.len() - 20]).unwrap();
    assert_eq!(record(folder.text()).tables.states[0].times_s.len(), rows);
    for (broken, reason) in [
        (
            whole.replacen("\n0,gondola,", "\nzero,gondola,", 1),
            "a field is not a number",
        ),
        (
            whole.replacen("\n0,gondola,", "\n0,gondola,NaN,", 1),
            "a number is not finite",
        ),
        (
            whole.replacen("x_m", "x", 1),
            "the header is not that of a run's table",
        ),
    ] {
        fs::write(&file, broken).unwrap();
        let run = aerobot(&["report", folder.text()]);
        let said = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{said}");
        assert!(
            said.contains("states.csv:") && said.contains(reason),
            "{said}"
        );
    }
}

/// Numbers of segments that no run writes do not take all memory; rows whose time goes back are no record.
#[test]
fn rows_out_of_order_are_refused_and_tables_that_were_cut_are_told() {
    let folder = Scratch::new();
    run(CHAIN, folder.text(), &["--until", "4"]);
    for (name, from, to, reason) in [
        (
            "tethers.csv",
            "\n2,single-line,5,",
            "\n2,single-line,99999999,",
            "in the order 1, 2",
        ),
        (
            "tethers.csv",
            "\n2,single-line,5,",
            "\n2,single-line,0,",
            "in the order 1, 2",
        ),
        ("states.csv", "\n2,camera,", "\n1,camera,", "time goes back"),
    ] {
        let file = folder.path(name);
        let whole = fs::read_to_string(&file).unwrap();
        assert!(whole.contains(from), "{from}");
        fs::write(&file, whole.replacen(from, to, 1)).unwrap();
        let report = aerobot(&["report", folder.text()]);
        let said = text(&report.stderr);
        assert_eq!(report.status.code(), Some(2), "{said}");
        assert!(
            said.contains(&format!("{name}:")) && said.contains(reason),
            "{said}"
        );
        fs::write(&file, whole).unwrap();
    }
    let file = folder.path("states.csv");
    let whole = fs::read_to_string(&file).unwrap();
    fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    assert!(aerobot(&["report", folder.text()]).status.success());
    let page = fs::read_to_string(folder.path("report.html")).unwrap();
    assert!(page.contains("the table `states` of") && page.contains("has been cut"));
    fs::write(&file, "").unwrap();
    assert_eq!(aerobot(&["report", folder.text()]).status.code(), Some(2));
}

/// Rows of what is not in the scene are no rows of its run; tables in Parquet are whole or are not read.
#[test]
fn tables_of_another_run_and_unfinished_ones_are_told() {
    let refused = |folder: &Scratch, reason: &str| {
        let report = aerobot(&["report", folder.text()]);
        let said = text(&report.stderr);
        assert_eq!(report.status.code(), Some(2), "{said}");
        assert!(said.contains(reason), "{said}");
    };
    let folder = Scratch::new();
    run(CHAIN, folder.text(), &["--until", "1"]);
    let file = folder.path("states.csv");
    let whole = fs::read_to_string(&file).unwrap();
    fs::write(&file, whole.replace(",camera,", ",kamera,")).unwrap();
    refused(&folder, "states.csv`: its entity `kamera` is not in");
    let folder = Scratch::new();
    run(
        CHAIN,
        folder.text(),
        &["--until", "1", "--format", "parquet"],
    );
    assert!(aerobot(&["report", folder.text()]).status.success());
    fs::remove_file(folder.path("summary.json")).unwrap();
    refused(&folder, "was killed or is under way");
}

/// Where nodes were not recorded there is no shape to show, and where bodies were not none of theirs.
#[test]
fn what_was_not_recorded_is_not_drawn() {
    let folder = Scratch::new();
    let more = ["--until", "2", "--set", "run.record.nodes=Never"];
    run("scenes/paper/comparison_900m.ron", folder.text(), &more);
    let plot = aerobot(&["plot", folder.text(), "shape"]);
    assert_eq!(plot.status.code(), Some(2));
    assert!(text(&plot.stderr).contains("run.record.nodes"));
}

/// A run that was killed has no summary; one that stopped says why.
#[test]
fn what_was_recorded_is_shown_however_the_run_ended() {
    let folder = Scratch::new();
    run(CHAIN, folder.text(), &["--until", "2"]);
    fs::remove_file(folder.path("summary.json")).unwrap();
    fs::remove_file(folder.path("timing.json")).unwrap();
    let report = aerobot(&["report", folder.text()]);
    assert!(report.status.success(), "{}", text(&report.stderr));
    let page = fs::read_to_string(folder.path("report.html")).unwrap();
    assert!(page.contains("killed, or under way") && page.contains("not known"));

    let stopped = Scratch::new();
    let falls = [
        "run",
        "scenes/examples/free_fall.ron",
        "--out",
        stopped.text(),
        "--report",
        "--quiet",
    ];
    let more = [
        "--until",
        "1e4",
        "--set",
        "environment.atmosphere=Vira",
        "--set",
        "run.output_every_s=10",
    ];
    let run = aerobot(&[&falls[..], &more].concat());
    assert_eq!(run.status.code(), Some(3), "{}", text(&run.stderr));
    let page = fs::read_to_string(stopped.path("report.html")).unwrap();
    assert!(page.contains("stopped at "));
}

/// 10^5 rows of one body, with one sample that stands out.
#[test]
fn a_long_record_thins_itself_and_keeps_its_peaks() {
    let folder = Scratch::new();
    run(
        "scenes/examples/elastic_pendulum.ron",
        folder.text(),
        &["--until", "1"],
    );
    let mut long = record(folder.text());
    let body = long.tables.bodies().last().unwrap().name.clone();
    long.tables = Tables::default();
    let rows = 100_000;
    for index in 0..rows {
        let x = if index == 54_321 {
            123.0
        } else {
            libm::sin(index as f64 * 2e-4)
        };
        let frame = Frame {
            time_s: index as f64 * 1e-2,
            states: vec![StateRow {
                entity: Arc::from(body.as_str()),
                position_m: DVec3::new(x, 0.0, 0.0),
                velocity_m_s: DVec3::ZERO,
                rotation: Some((DQuat::IDENTITY, DVec3::ZERO)),
            }],
            ..Frame::default()
        };
        long.tables.take(&frame).unwrap();
    }
    let thinned = figure("displacement", &long).thinned(MOST_POINTS);
    let x = series(&thinned, "x displacement", &body);
    assert!(x.x.len() <= MOST_POINTS, "{}", x.x.len());
    let peak = x.x.iter().position(|time_s| (time_s - 543.21).abs() < 1e-9);
    assert_eq!(peak.map(|place| x.y[place]), Some(123.0));
    let page = run_page(&Simulator::new(), &[long]).html();
    assert!(page.len() < 8_000_000, "{} bytes", page.len());
}
