//! What a run of rigid links writes: the rows and columns of a run of lumped masses, lengths that do not
//! change, an event and a warning when a link pushes, and the same bytes every time.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::f64::consts::PI;
use std::fs;

use flight::{assert_below, summary_of};
use program::{Scratch, aerobot, text};

const BRANCHED: &str = "scenes/examples/branched_chain.ron";

/// Runs a scene with the program into a new folder; gives it with what went to stderr.
fn run(scene: &str, arguments: &[&str]) -> (Scratch, String) {
    let out = Scratch::new();
    let output = aerobot(&[&["run", scene, "--out", out.text()], arguments].concat());
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    (out, message)
}

fn read(folder: &Scratch, file: &str) -> String {
    fs::read_to_string(folder.path(file)).unwrap()
}

/// Every row of a table: its first `keys` fields, and which of the others are empty.
fn shape(table: &str, keys: usize) -> Vec<(Vec<&str>, Vec<bool>)> {
    let rows = table.lines().map(|line| {
        let mut fields: Vec<&str> = line.split(',').collect();
        let values = fields.split_off(keys);
        (
            fields,
            values.iter().map(|field| field.is_empty()).collect(),
        )
    });
    rows.collect()
}

/// Whoever reads the files need not know the formulation: the same columns, the same rows at the same
/// times in the same order, empty fields where they were, and the same channels.
#[test]
fn links_and_lumped_masses_write_the_same_rows_and_columns() {
    let arguments = |formulation| {
        [
            "--formulation",
            formulation,
            "--until",
            "20",
            "--set",
            "run.record=(channels: All)",
        ]
    };
    let (links, _) = run(BRANCHED, &arguments("denoc"));
    let (lumped, _) = run(BRANCHED, &arguments("lumped-mass"));
    for (file, keys) in [("states.csv", 2), ("tethers.csv", 3), ("channels.csv", 3)] {
        let (links, lumped) = (read(&links, file), read(&lumped, file));
        assert_eq!(links.lines().next(), lumped.lines().next(), "{file}");
        assert!(links.lines().count() > 21, "{file}");
        assert!(shape(&links, keys) == shape(&lumped, keys), "{file}");
    }
    let summary: serde_json::Value = serde_json::from_str(&read(&links, "summary.json")).unwrap();
    assert_eq!(summary["formulation"], "denoc");
    assert_eq!(summary["final_states"].as_array().unwrap().len(), 4);
}

/// A link is as long as its tether over its number of links, at every output of 100 s with explicit and
/// implicit steps; a length is the difference of positions, which round-off of 56 km leaves good to 7e-12 m.
#[test]
fn rigid_links_keep_their_length() {
    for integrator in ["Auto()", "Implicit(accuracy_m: 1e-2)"] {
        let integrator = format!("run.integrator={integrator}");
        let (folder, _) = run(BRANCHED, &["--set", &integrator]);
        let table = read(&folder, "tethers.csv");
        let mut largest = 0.0_f64;
        for line in table.lines().skip(1) {
            let fields: Vec<&str> = line.split(',').collect();
            let length_m = match fields[1] {
                "tether" => 300.0 / 7.0,
                "line-a" => 120.0 / 5.0,
                "line-b" => 60.0 / 3.0,
                other => panic!("{other}"),
            };
            let found: f64 = fields[4].parse().unwrap();
            largest = largest.max((found / length_m - 1.0).abs());
        }
        assert_below(&format!("{integrator}: length, relative"), largest, 1e-9);
    }
}

/// The same scene gives the same bytes, and so does the scene in the results; with explicit and implicit
/// steps, and from another base.
#[test]
fn a_run_of_links_and_its_own_scene_give_the_same_bytes() {
    let arguments = [
        "--until",
        "40",
        "--seed",
        "7",
        "--set",
        "run.record=(channels: All)",
        "--set",
        "run.base=\"a\"",
    ];
    let (first, _) = run(BRANCHED, &arguments);
    let (second, _) = run(BRANCHED, &arguments);
    let (third, _) = run(&first.path("scene.ron"), &[]);
    for file in [
        "scene.ron",
        "states.csv",
        "tethers.csv",
        "channels.csv",
        "summary.json",
    ] {
        assert!(
            read(&first, file) == read(&second, file),
            "`{file}` differs"
        );
        assert!(
            read(&first, file) == read(&third, file),
            "`{file}` of its own scene differs"
        );
    }
}

/// A light probe below a heavy line, in a gust from below that carries the probe and the lowest links but
/// not the whole line.
const PUSHED: &str = r#"(
    name: "pushed",
    environment: (
        gravity: Constant(8.87),
        atmosphere: Uniform(density_kg_m3: 1.2),
        wind: [Step(velocity_m_s: (0, 0, 6), from_s: 2, until_s: 3)],
    ),
    entities: {
        "anchor": (Fixed: (position_m: (0, 0, 100))),
        "probe": (
            Body: (mass_kg: 0.5),
            Drag: Constant(coefficient: 1, area_m2: 0.5),
        ),
        "line": (Tether: (
            from: ("anchor", Centre), to: ("probe", Centre),
            length_m: 8, nodes: 3, diameter_m: 0.01, density_kg_m3: 2546.479089470325, // 1.6 kg
            axial_stiffness_n: 5000, damping_n_s_m: 5, drag: (normal: 1, tangential: 0.03),
        )),
    },
    run: (formulation: Denoc, duration_s: 2.5, output_every_s: 0.5),
)"#;

/// Tension of link 1 to 4 of a straight line at rest by statics: the weight below its middle, less the drag
/// of probe and line below it.
fn tension_by_hand_n(link: u32, wind_m_s: f64) -> f64 {
    let links_below = 4.0 - f64::from(link) + 0.5;
    let pressure = 0.5 * 1.2 * wind_m_s * wind_m_s;
    let skin = pressure * PI * 0.03 * 0.01 * 2.0;
    0.5 * 8.87 - pressure * 0.5 + links_below * (0.4 * 8.87 - skin)
}

/// Tensions before and in the gust are those of statics, negative ones too; the run says once for the tether
/// when a link first pushed and which, in the events, in the warnings of the summary, and on stderr.
#[test]
fn a_link_that_pushes_is_an_event_and_a_warning() {
    for links in ["Rod", "PointMass"] {
        let overrides = format!("run.links={links}");
        let (results, _) = summary_of(PUSHED, &[&overrides]);
        for (row, wind_m_s) in [(0, 0.0), (3, 0.0), (4, 6.0), (5, 6.0)] {
            let frame = &results.frames[row];
            for (segment, link) in frame.segments.iter().zip(1..) {
                let expected = tension_by_hand_n(link, wind_m_s);
                let what = format!("{links}, {} s, link {link}, N", frame.time_s);
                // The line hangs straight to where Newton's method leaves it.
                assert_below(&what, (segment.tension_n - expected).abs(), 1e-9);
            }
        }
    }
    // By hand it is the third link that pushes, and no link before the gust.
    assert!(tension_by_hand_n(2, 6.0) > 0.0 && tension_by_hand_n(3, 6.0) < 0.0);

    let scratch = Scratch::folder();
    let scene = scratch.file("pushed.ron", PUSHED);
    let (folder, message) = run(&scene, &["--quiet"]);
    let summary: serde_json::Value = serde_json::from_str(&read(&folder, "summary.json")).unwrap();
    assert_eq!(
        summary["events"],
        serde_json::json!([{"time_s": 2.0, "kind": "compression", "entity": "line/3"}])
    );
    let warnings = summary["warnings"].as_array().unwrap();
    let warning = warnings[0].as_str().unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(
        warning.contains("link 3 of `line` pushes at 2 s"),
        "{warning}"
    );
    assert!(message.contains(warning), "{message}");

    // Elastic links and lumped masses go slack instead.
    for other in ["run.elastic_links=true", "run.formulation=LumpedMass"] {
        let (results, summary) = summary_of(PUSHED, &[other]);
        let kinds: Vec<_> = summary.events.iter().map(|event| &*event.kind).collect();
        assert!(kinds.contains(&"slack"), "{kinds:?}");
        assert!(!kinds.contains(&"compression"), "{kinds:?}");
        let mut segments = results.frames.iter().flat_map(|frame| &frame.segments);
        assert!(segments.all(|segment| segment.tension_n >= 0.0));
    }
}

/// Free fall in vacuum: no link carries anything, and what round-off leaves of its force is no push.
#[test]
fn links_without_load_do_not_push() {
    let (results, summary) = summary_of(
        r#"(
        name: "falling",
        environment: (gravity: Constant(8.87), atmosphere: Vacuum),
        entities: {
            "upper": (Body: (mass_kg: 3), Pose: (position_m: (0.3, 0.1, 1000))),
            "lower": (Body: (mass_kg: 2), Pose: (position_m: (6.3, 8.1, 1000))),
            "line": (Tether: (
                from: ("upper", Centre), to: ("lower", Centre),
                length_m: 10, nodes: 4, diameter_m: 0.01, density_kg_m3: 1440,
                axial_stiffness_n: 5000, damping_n_s_m: 20, start: Straight,
            )),
        },
        run: (formulation: Denoc, duration_s: 10, output_every_s: 1),
    )"#,
        &[],
    );
    let segments = results.frames.iter().flat_map(|frame| &frame.segments);
    let largest = segments.map(|row| row.tension_n.abs()).fold(0.0, f64::max);
    // Weights are some 10 N; their round-off is 1e-15 N.
    assert_below("tension, N", largest, 1e-12);
    assert!(summary.events.is_empty(), "{:?}", summary.events);
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
}
