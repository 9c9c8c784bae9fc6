//! `aerobot trim` as a user meets it: what it prints, the scene that it writes, and what it refuses.
//!
//! Each `tests/bad_scenes/trimming/NAME.ron` can be built and not be trimmed, for the reason in `NAME.txt`;
//! `AEROBOT_BLESS=1` writes these anew, as in `bad_input.rs`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;
use std::path::Path;

use aerobot::components::state::{Acceleration, AngularAcceleration};
use aerobot::engine::plugin::Simulator;
use aerobot::engine::simulation::Simulation;
use program::{Scratch, aerobot};

/// What the program has printed, which is never NaN here.
fn text(bytes: &[u8]) -> String {
    let text = program::text(bytes);
    assert!(!text.contains("NaN"), "{text}");
    text
}

fn build(file: &str) -> Simulation {
    let simulator = Simulator::new();
    let scene = simulator.load(Path::new(file), &[]);
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The largest acceleration of anything, m/s^2 and rad/s^2.
fn largest_acceleration(mut simulation: Simulation) -> f64 {
    simulation.evaluate(1).unwrap();
    let world = simulation.world();
    let linear = world
        .iter_entities()
        .filter_map(|entity| entity.get::<Acceleration>());
    let angular = world
        .iter_entities()
        .filter_map(|entity| entity.get::<AngularAcceleration>());
    let linear = linear.map(|acceleration| acceleration.0.length());
    let angular = angular.map(|acceleration| acceleration.0.length());
    linear.chain(angular).fold(0.0, f64::max)
}

const IN_SHEAR: &str = "environment.wind=[VenusZonal, Shear(altitude_m: 55_000, gradient_per_s: 5e-4, \
                        direction: (0, 1, 0))]";

/// Comments survive, everything free has its place and its velocity, and nothing is accelerated; what is
/// trimmed already stays where it is.
#[test]
fn the_written_scene_starts_in_its_steady_state() {
    let scratch = Scratch::folder();
    let (once, twice) = (scratch.path("once.ron"), scratch.path("twice.ron"));
    let scene = "scenes/paper/comparison_900m.ron";
    let first = aerobot(&["trim", scene, "--set", IN_SHEAR, "--out", &once]);
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    assert!(first.stderr.is_empty(), "{}", text(&first.stderr));
    let said = text(&first.stdout);
    for part in [
        "drifts at",
        "gondola",
        "tilt",
        "largest tension",
        "from the vertical",
        "left over",
        &once,
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    let written = fs::read_to_string(&once).unwrap();
    assert!(written.contains("// gas included") && written.contains("// The comparison case"));
    assert_eq!(written.matches("Pose: (position_m:").count(), 2);
    assert_eq!(written.matches("Motion: (velocity_m_s:").count(), 3);
    assert_eq!(written.matches("start: Positions([").count(), 1);
    assert!(written.contains("radius: Equilibrium(altitude_m: 56_000)"));
    let left = largest_acceleration(build(&once));
    println!("largest acceleration {left:.1e}");
    assert!(left < 1e-6, "{left}");

    let second = aerobot(&["trim", &once, "--out", &twice, "--quiet"]);
    assert_eq!(second.status.code(), Some(0), "{}", text(&second.stderr));
    assert!(second.stdout.is_empty());
    let numbers = |file: &str| -> Vec<f64> {
        let text = fs::read_to_string(file).unwrap();
        let parts = text.split(|c: char| !"0123456789.-e".contains(c));
        parts.filter_map(|part| part.parse().ok()).collect()
    };
    let (before, after) = (numbers(&once), numbers(&twice));
    assert_eq!(before.len(), after.len());
    for (before, after) in before.iter().zip(&after) {
        assert!((before - after).abs() < 1e-8, "{before} became {after}");
    }
}

/// The radius of a balloon sized by its altitude is that of before, though it has a pose now.
#[test]
fn a_balloon_sized_by_its_altitude_keeps_its_radius() {
    let scratch = Scratch::folder();
    let out = scratch.path("heave.ron");
    let trim = aerobot(&["trim", "scenes/examples/balloon_heave.ron", "--out", &out]);
    assert_eq!(trim.status.code(), Some(0), "{}", text(&trim.stderr));
    let written = fs::read_to_string(&out).unwrap();
    assert!(
        written.contains("Pose: (position_m: (20, 0, 56000)"),
        "{written}"
    );
    let radius = |file: &str| {
        let said = text(&aerobot(&["check", file]).stdout);
        let line = said.lines().find(|line| line.contains("radius")).unwrap();
        line[line.find("radius").unwrap()..]
            .split(" m")
            .next()
            .unwrap()
            .to_owned()
    };
    assert_eq!(radius("scenes/examples/balloon_heave.ron"), radius(&out));
}

/// A motion of the scene's own gives way to the steady one.
#[test]
fn what_moved_is_written_at_rest() {
    let scratch = Scratch::folder();
    let scene = scratch.file(
        "pendulum.ron",
        &fs::read_to_string("scenes/examples/elastic_pendulum.ron")
            .unwrap()
            .replace("Pose: (", "Motion: (velocity_m_s: (1, 2, 0)), Pose: ("),
    );
    let trim = aerobot(&["trim", &scene, "--out", &scene, "--force"]);
    assert_eq!(trim.status.code(), Some(0), "{}", text(&trim.stderr));
    let written = fs::read_to_string(&scene).unwrap();
    assert!(
        written.contains("Motion: (velocity_m_s: (0, 0, 0))"),
        "{written}"
    );
    assert!(largest_acceleration(build(&scene)) < 1e-12);
}

/// A table beside the scene is found from another folder too.
#[test]
fn tables_are_found_from_the_new_place() {
    let scratch = Scratch::folder();
    let wind = "altitude_m,zonal_m_s\n0,0\n50000,60\n60000,80\n";
    scratch.file("tables/wind.csv", wind);
    scratch.file("trimmed/other.txt", "");
    let scene = fs::read_to_string("scenes/paper/comparison_900m.ron").unwrap();
    let start = scene.find("wind: [").unwrap();
    let end = start + scene[start..].find("],").unwrap() + 2;
    let scene = scene.replace(
        &scene[start..end],
        "wind: [Profile(file: \"tables/wind.csv\")],",
    );
    let scene = scratch.file("scene.ron", &scene);
    for (out, expected) in [
        ("beside.ron", "\"tables/wind.csv\""),
        ("trimmed/below.ron", "\"../tables/wind.csv\""),
        ("tables/there.ron", "\"wind.csv\""),
    ] {
        let out = scratch.path(out);
        let trim = aerobot(&["trim", &scene, "--out", &out]);
        assert_eq!(trim.status.code(), Some(0), "{}", text(&trim.stderr));
        let written = fs::read_to_string(&out).unwrap();
        assert!(written.contains(&format!("file: {expected}")), "{written}");
        assert!(largest_acceleration(build(&out)) < 1e-6);
    }
}

#[test]
fn a_file_that_exists_is_left_as_it_is() {
    let scratch = Scratch::folder();
    let out = scratch.file("kept.ron", "the work of a week\n");
    let scene = "scenes/examples/hanging_cable.ron";
    let refused = aerobot(&["trim", scene, "--out", &out]);
    assert_eq!(refused.status.code(), Some(2));
    let message = text(&refused.stderr);
    assert!(
        message.contains(&out) && message.contains("`--force`"),
        "{message}"
    );
    assert_eq!(fs::read_to_string(&out).unwrap(), "the work of a week\n");
    let forced = aerobot(&["trim", scene, "--out", &out, "--force"]);
    assert_eq!(forced.status.code(), Some(0), "{}", text(&forced.stderr));
    assert!(fs::read_to_string(&out).unwrap().contains("Positions(["));

    for out in [scratch.path("no/such/folder.ron"), scratch.path("")] {
        let refused = aerobot(&["trim", scene, "--out", &out, "--force"]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains("cannot write"));
    }
    assert_eq!(
        fs::read_dir(&scratch.0).unwrap().count(),
        1,
        "only the one file is there"
    );
}

#[test]
fn what_has_no_steady_state_is_refused_with_its_reason_and_nothing_is_written() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes/trimming");
    let bless = std::env::var_os("AEROBOT_BLESS").is_some();
    let mut wrong = Vec::new();
    let mut count = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "ron") {
            continue;
        }
        count += 1;
        let name = path.file_stem().unwrap().to_str().unwrap();
        let scene = format!("tests/bad_scenes/trimming/{name}.ron");
        let scratch = Scratch::folder();
        let check = aerobot(&["check", &scene]);
        assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
        let trim = aerobot(&["trim", &scene, "--out", &scratch.path("out.ron")]);
        let message = text(&trim.stderr);
        let expected_file = path.with_extension("txt");
        if bless {
            fs::write(&expected_file, &message).unwrap();
        }
        let expected = fs::read_to_string(&expected_file).unwrap_or_default();
        if message != expected {
            wrong.push(format!("{name}: expected\n{expected}\nfound\n{message}"));
        }
        if trim.status.code() != Some(2) || !trim.stdout.is_empty() {
            wrong.push(format!("{name}: exit code {:?}", trim.status.code()));
        }
        if fs::read_dir(&scratch.0).unwrap().next().is_some() {
            wrong.push(format!("{name}: something was written"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(count >= 8, "{count} scenes");
}

/// What is absurd is refused or comes out in numbers.
#[test]
fn no_number_beyond_reckoning_is_printed() {
    for set in [
        "entities.gondola.Body.mass_kg=1e-300",
        "entities.gondola.Body.mass_kg=1e300",
        "entities.tether.Tether.axial_stiffness_n=1e300",
        "entities.tether.Tether.drag.normal=1e300",
        "entities.gondola.Pose=(position_m: (1e6, 0, 50_000))",
        "environment.gravity=Constant(1e-6)",
        "environment.wind=[Uniform(velocity_m_s: (1e200, 0, 0))]",
        "environment.wind=[Shear(altitude_m: 0, gradient_per_s: 1e200)]",
        "environment.atmosphere=Exponential(density_kg_m3: 0.8, altitude_m: 56_000, scale_height_m: 1)",
    ] {
        let arguments = ["--set", "environment.wind=[VenusZonal]", "--set", set];
        let trim = aerobot(
            &[
                &["trim", "scenes/paper/comparison_900m.ron"],
                &arguments[..],
            ]
            .concat(),
        );
        assert!(matches!(trim.status.code(), Some(0 | 2)), "{set}");
        let said = text(&trim.stdout) + &text(&trim.stderr);
        assert!(
            !said.contains(" inf ") && !said.contains("(inf") && !said.contains("-inf"),
            "{said}"
        );
    }
}

/// A refusal leaves a simulation where it was.
#[test]
fn a_refusal_changes_nothing() {
    let simulator = Simulator::new();
    let file = "tests/bad_scenes/trimming/too_heavy.ron";
    let scene = simulator.load(Path::new(file), &[]).unwrap();
    let mut simulation = simulator.build(&scene).unwrap();
    let before = simulation.contents(&scene);
    assert!(simulation.trim(&scene).is_err());
    assert_eq!(simulation.contents(&scene), before);
}
