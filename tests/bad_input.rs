//! What bad input gets: a message that names the place and what would be right, exit code 2 and
//! nothing written; or, when it happens during the run, exit code 3 and what was recorded.
//!
//! Each `tests/bad_scenes/NAME.ron` is refused with the text of `NAME.txt` on stderr, with the
//! arguments in `NAME.args` (one a line) if there is such a file. `AEROBOT_BLESS=1 cargo test --test
//! bad_input` writes the `.txt` files anew: do that after reading every message that changed and
//! finding it better than the old one, never to make the test pass.

#![allow(
    clippy::unwrap_used,
    reason = "a test stops at what it does not expect"
)]

mod program;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

use aerobot::engine::plugin::Simulator;
use program::{Scratch, aerobot, text};

fn stderr(output: &Output) -> String {
    text(&output.stderr)
}

/// Every file of a folder with its contents.
fn contents(folder: &Path) -> BTreeMap<String, String> {
    let files = fs::read_dir(folder)
        .unwrap()
        .filter(|entry| entry.as_ref().is_ok_and(|entry| entry.path().is_file()))
        .map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, fs::read_to_string(path).unwrap())
        });
    files.collect()
}

fn bad_scenes() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let files = fs::read_dir(folder).unwrap();
    let paths = files.map(|entry| entry.unwrap().path());
    let mut names: Vec<String> = paths
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn every_bad_scene_is_refused_with_its_message_and_nothing_is_written() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let bless = std::env::var_os("AEROBOT_BLESS").is_some();
    let mut wrong = Vec::new();
    for name in bad_scenes() {
        let scene = format!("tests/bad_scenes/{name}.ron");
        let expected_file = root.join(format!("tests/bad_scenes/{name}.txt"));
        let given = fs::read_to_string(root.join(format!("tests/bad_scenes/{name}.args")));
        let given = given.unwrap_or_default();
        let given: Vec<&str> = given.lines().collect();
        let out = Scratch::new();
        let check = aerobot(&[&["check", &scene], given.as_slice()].concat());
        let run = aerobot(&[&["run", &scene, "--out", out.text()], given.as_slice()].concat());
        let message = stderr(&check);
        if bless {
            fs::write(&expected_file, &message).unwrap();
        }
        let expected = fs::read_to_string(&expected_file).unwrap_or_default();
        if message != expected {
            wrong.push(format!("{name}: expected\n{expected}\nfound\n{message}"));
        }
        if stderr(&run) != message {
            let found = stderr(&run);
            wrong.push(format!(
                "{name}: `check` says\n{message}\n`run` says\n{found}"
            ));
        }
        let codes = (check.status.code(), run.status.code());
        if codes != (Some(2), Some(2)) {
            wrong.push(format!("{name}: exit codes {codes:?}"));
        }
        if out.0.exists() || !run.stdout.is_empty() {
            wrong.push(format!("{name}: something was written"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn every_expected_message_has_its_scene() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let scenes = bad_scenes();
    for file in contents(&folder).into_keys() {
        let (name, extension) = file.rsplit_once('.').unwrap();
        let known = extension == "csv" || scenes.iter().any(|scene| scene == name);
        assert!(known, "{file} belongs to no scene");
    }
}

/// A body that falls through the air below the end of the atmosphere at 0 m.
const FALLING: &str = include_str!("bad_scenes/while_running/falls_out_of_the_air.ron");

#[test]
fn an_output_folder_that_exists_is_left_as_it_is() {
    let scratch = Scratch::new();
    let scene = scratch.file("scene.ron", FALLING);
    let out = Scratch::new();
    out.file("states.csv", "the work of a week\n");
    let run = aerobot(&["run", &scene, "--until", "1", "--out", out.text()]);
    assert_eq!(run.status.code(), Some(2));
    let message = stderr(&run);
    assert!(message.contains(out.text()), "{message}");
    assert!(message.contains("`--force`"), "{message}");
    let kept = BTreeMap::from([("states.csv".to_owned(), "the work of a week\n".to_owned())]);
    assert_eq!(contents(&out.0), kept);

    let forced = aerobot(&[
        "run",
        &scene,
        "--until",
        "1",
        "--out",
        out.text(),
        "--force",
    ]);
    assert_eq!(forced.status.code(), Some(0), "{}", stderr(&forced));
    assert_ne!(contents(&out.0)["states.csv"], "the work of a week\n");
}

/// A scene that stops while it runs.
fn while_running(name: &str) -> String {
    format!("tests/bad_scenes/while_running/{name}.ron")
}

/// A scene of that folder stops with the text of its `.txt`, in which `OUT` is the output folder.
fn check_while_running(scene: &str, message: &str) {
    let Some(name) = scene.strip_prefix("tests/bad_scenes/while_running/") else {
        return;
    };
    let expected = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/bad_scenes/while_running")
        .join(name)
        .with_extension("txt");
    if std::env::var_os("AEROBOT_BLESS").is_some() {
        fs::write(&expected, message).unwrap();
    }
    assert_eq!(message, fs::read_to_string(&expected).unwrap());
}

/// Runs a scene that stops, and checks the message, the summary and that every number is finite.
/// Gives the message and the rows of `states.csv`.
fn run_until_it_stops(scene: &str, entity: &str) -> (String, Vec<Vec<f64>>) {
    let out = Scratch::new();
    let run = aerobot(&["run", scene, "--out", out.text()]);
    let message = stderr(&run);
    assert_eq!(run.status.code(), Some(3), "{message}");
    check_while_running(scene, &message.replace(out.text(), "OUT"));
    assert!(message.contains(&format!("`{entity}`")), "{message}");

    let files = contents(&out.0);
    for (name, text) in &files {
        let text = text.to_lowercase();
        let is_word = |word: &str| {
            text.split(|c: char| !c.is_alphanumeric())
                .any(|w| w == word)
        };
        assert!(!is_word("nan") && !is_word("inf"), "{name}:\n{text}");
    }
    let summary: serde_json::Value = serde_json::from_str(&files["summary.json"]).unwrap();
    assert_eq!(summary["outcome"], "stopped");
    assert_eq!(summary["stopped"]["entity"], entity);
    assert!(!summary["stopped"]["reason"].as_str().unwrap().is_empty());
    let time_s = summary["stopped"]["time_s"].as_f64().unwrap();
    let said = message.split("stopped at ").nth(1).unwrap();
    let said: f64 = said.split(' ').next().unwrap().parse().unwrap();
    // The reader of this test may be off by the last digit.
    assert!((said - time_s).abs() <= 1e-15 * time_s, "{message}");

    let mut lines = files["states.csv"].lines();
    let columns = lines.next().unwrap().split(',').count();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            assert_eq!(fields.len(), columns, "{line}");
            let numbers = fields.iter().enumerate().filter(|(column, _)| *column != 1);
            numbers.map(|(_, field)| field.parse().unwrap()).collect()
        })
        .collect();
    for row in &rows {
        assert!(row.iter().all(|number| number.is_finite()), "{row:?}");
        assert!(row[0] <= time_s, "a row after the stop: {row:?}");
    }
    let last_s = rows.last().unwrap()[0];
    assert!(
        last_s > time_s - 0.5 - 1e-9,
        "rows end at {last_s} s, it stopped at {time_s} s"
    );
    (message, rows)
}

#[test]
fn a_body_that_falls_out_of_the_atmosphere_stops_the_run() {
    let (message, rows) = run_until_it_stops(&while_running("falls_out_of_the_air"), "stone");
    assert!(message.contains("outside the atmosphere"), "{message}");
    let last_m = rows.last().unwrap()[3];
    assert!(
        (0.0..30.0).contains(&last_m),
        "the last row is at {last_m} m"
    );
}

#[test]
fn a_balloon_that_rises_beyond_its_table_stops_the_run() {
    let (message, rows) = run_until_it_stops(&while_running("rises_beyond_its_table"), "balloon");
    assert!(message.contains("54000"), "{message}");
    let last_m = rows.last().unwrap()[3];
    assert!(
        (53_980.0..=54_000.0).contains(&last_m),
        "the last row is at {last_m} m"
    );
}

#[test]
fn numbers_too_large_to_reckon_with_stop_the_run_and_reach_no_file() {
    let scratch = Scratch::new();
    for (path, value) in [
        ("entities.stone.Body.mass_kg", "1e-300"),
        ("entities.stone.Pose.position_m", "(1e300, -1e300, 200)"),
        (
            "entities.stone.Drag",
            "Constant(coefficient: 1e300, area_m2: 1e300)",
        ),
        ("entities.stone.Motion", "(velocity_m_s: (1e200, 0, 0))"),
        ("environment.gravity", "Constant(1e308)"),
    ] {
        let scene = scratch.file("scene.ron", FALLING);
        let out = Scratch::new();
        let set = format!("{path}={value}");
        let arguments = [
            "run",
            &scene,
            "--out",
            out.text(),
            "--until",
            "1",
            "--set",
            &set,
        ];
        let run = aerobot(&arguments);
        let code = run.status.code();
        let message = stderr(&run);
        assert!(matches!(code, Some(0 | 2 | 3)), "{set}: {code:?} {message}");
        assert_eq!(code == Some(0), message.is_empty(), "{set}: {message}");
        if code == Some(2) {
            assert!(!out.0.exists(), "{set}");
            continue;
        }
        for (name, text) in contents(&out.0) {
            let bad = text.contains("NaN") || text.contains(",inf") || text.contains("-inf");
            assert!(!bad, "{set}: {name}:\n{text}");
        }
    }
}

#[test]
fn wrong_arguments_are_refused() {
    for arguments in [
        &["run"][..],
        &["check"],
        &["fly", "scene.ron"],
        &["run", "scene.ron", "--fast"],
        &["run", "scene.ron", "--seed", "-1"],
        &["run", "scene.ron", "--until", "soon"],
        &["run", "scene.ron", "--formulation", "rigid"],
        &["check", "scene.ron", "--force"],
    ] {
        let output = aerobot(arguments);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(!message.is_empty(), "{arguments:?}");
    }
}

#[test]
fn a_scene_that_cannot_be_read_is_refused() {
    let out = Scratch::new();
    let scratch = Scratch::new();
    scratch.file("latin.ron", "");
    let latin = scratch.0.join("latin.ron");
    fs::write(&latin, b"(name: \"caf\xe9\")").unwrap();
    for file in ["tests/no_such_scene.ron", "tests", latin.to_str().unwrap()] {
        for arguments in [&["check", file][..], &["run", file, "--out", out.text()]] {
            let output = aerobot(arguments);
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
            assert!(message.contains(file), "{arguments:?}: {message}");
            assert!(!out.0.exists());
        }
    }
}

#[test]
fn what_is_wrong_with_one_scene_does_not_hide_the_others() {
    let output = aerobot(&[
        "check",
        "tests/bad_scenes/negative_mass.ron",
        "scenes/paper/comparison_900m.ron",
        "tests/bad_scenes/missing_unit.ron",
    ]);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("negative_mass.ron:"), "{message}");
    assert!(message.contains("missing_unit.ron:"), "{message}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("comparison-900m"));
}

/// The sample that is cut and changed, with few nodes so that building it costs little.
fn sample() -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/paper/comparison_900m.ron");
    fs::read_to_string(file)
        .unwrap()
        .replace("nodes: 10,", "nodes: 2,")
}

/// Loads a scene, and builds and trims it if it loads; only that it returns is asked.
fn must_return(simulator: &Simulator, text: String) -> bool {
    match simulator.load_text("sample.ron", text, Path::new("."), &[]) {
        Ok(scene) => {
            let built = simulator.build(&scene);
            built.and_then(|mut built| built.trim(&scene)).is_ok()
        }
        Err(error) => {
            assert!(error.text.starts_with("error: "), "{error}");
            false
        }
    }
}

#[test]
fn no_truncated_scene_panics() {
    let (simulator, text) = (Simulator::new(), sample());
    assert!(
        must_return(&simulator, text.clone()),
        "the sample itself is good"
    );
    for end in (0..text.len()).step_by(17) {
        if text.is_char_boundary(end) {
            assert!(
                !must_return(&simulator, text[..end].to_owned()),
                "cut at {end}"
            );
        }
    }
}

#[test]
fn no_scene_with_a_wrong_character_panics() {
    /// What a slip of the finger may leave behind, some of it of more than one byte.
    const CHARACTERS: [char; 24] = [
        '(', ')', '[', ']', '{', '}', ',', ':', '"', '\'', '-', '.', '0', '9', 'e', 'x', '_', '/',
        '\\', '#', '\n', '\0', 'é', '🎈',
    ];
    let (simulator, text) = (Simulator::new(), sample());
    let start = text.find("(\n    name").unwrap();
    let places: Vec<usize> = text
        .char_indices()
        .map(|(at, _)| at)
        .filter(|at| *at >= start)
        .collect();
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    let mut draw = |below: usize| {
        // xorshift64*
        random ^= random >> 12;
        random ^= random << 25;
        random ^= random >> 27;
        (random.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % below
    };
    for _ in 0..200 {
        let at = places[draw(places.len())];
        let end = at + text[at..].chars().next().map_or(0, char::len_utf8);
        let character = CHARACTERS[draw(CHARACTERS.len())];
        let mut changed = text.clone();
        match draw(3) {
            0 => changed.insert(at, character),
            1 => changed.replace_range(at..end, ""),
            _ => changed.replace_range(at..end, &character.to_string()),
        }
        must_return(&simulator, changed);
    }
}
