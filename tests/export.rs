//! `aerobot export`: glTF and VTK files taken apart and set beside the animation they were made of, and what is
//! refused. The Khronos validator is in `tests/browser/validate_gltf.mjs`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

#[path = "exported/glb.rs"]
mod glb;
mod program;
#[path = "exported/vtp.rs"]
mod vtp;

use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::Path;

use aerobot::engine::plugin::Simulator;
use aerobot_report::animation::appearance::{Part, Role, Solid};
use aerobot_report::animation::{Animation, BodyMotion};
use aerobot_report::export::gltf;
use aerobot_report::record::Record;
use glam::{DQuat, DVec3};
use glb::Glb;
use program::{Scratch, aerobot, text};
use vtp::Vtp;

/// A line that is reeled in and out and then released, with bodies that fall apart.
const REELED: &str = "scenes/examples/reel_and_release.ron";

fn run(scene: &str, folder: &str, until: &str) {
    let arguments = ["run", scene, "--out", folder, "--until", until, "--quiet"];
    let run = aerobot(&arguments);
    assert!(run.status.success(), "{}", text(&run.stderr));
}

/// Runs the command, which must succeed; gives what it has printed.
fn export(arguments: &[&str]) -> String {
    let run = aerobot(&[&["export"], arguments].concat());
    assert!(run.status.success(), "{}", text(&run.stderr));
    text(&run.stdout)
}

fn record(folder: &Scratch, name: &str) -> Record {
    Record::read(&Simulator::new(), Path::new(&folder.path(name))).unwrap()
}

#[test]
fn every_segment_lies_between_its_points_in_every_frame() {
    let folder = Scratch::folder();
    let (run_folder, file) = (folder.path("run"), folder.path("run.glb"));
    run(REELED, &run_folder, "170");
    let said = export(&[&run_folder, "--gltf", &file, "--frames", "150"]);
    assert!(said.starts_with("glTF, 15"), "{said}");
    let glb = Glb::parse(&fs::read(&file).unwrap());
    let animation = Animation::of(&record(&folder, "run"), 150);
    assert_eq!(glb.times_s().len(), animation.times_s.len());
    // Single precision, of the farthest place: 2^-24 of it, and of quaternions that much of a segment.
    let (mut there, mut gone) = (0, 0);
    for tether in &animation.tethers {
        for segment in 0..tether.tensions_n[0].len() {
            let node = glb.node(&format!("{}/{}", tether.name, segment + 1));
            let motion = glb.motion(node);
            for (frame, (translation, rotation, scale)) in motion.iter().enumerate() {
                if frame > 0 {
                    assert!(
                        rotation.dot(motion[frame - 1].1) >= 0.0,
                        "the long way round"
                    );
                }
                if tether.tensions_n[frame][segment].is_none() {
                    assert_eq!(*scale, DVec3::ZERO);
                    gone += 1;
                    continue;
                }
                there += 1;
                let ends =
                    [-0.5, 0.5].map(|y| *translation + *rotation * (*scale * (y * DVec3::Y)));
                let points = &tether.points_m[frame][segment..=segment + 1];
                for (end, point) in ends.iter().zip(points) {
                    let place = glb.place_of(*point);
                    let allowed = 2e-7 * (place.length() + scale.y);
                    assert!((*end - place).length() <= allowed, "{end} is not {place}");
                }
            }
        }
    }
    assert!(there > 1000 && gone > 1000, "{there} there, {gone} gone");
}

/// x downwind, y left, z up becomes y up, z against x: turned left by a right angle, what pointed along x points
/// along y, which is -x there.
#[test]
fn a_body_that_is_turned_points_where_it_should() {
    let folder = Scratch::folder();
    run("scenes/examples/free_fall.ron", &folder.path("run"), "1");
    let summary = record(&folder, "run").summary;
    let nose = Part {
        solid: Solid::Box {
            size_m: [3.0, 2.0, 1.0],
        },
        at_m: [1.0, 0.0, 0.0],
        role: Role::Body,
        to_scale: true,
    };
    let animation = Animation {
        times_s: vec![10.0, 12.0],
        bodies: vec![BodyMotion {
            name: "body".to_owned(),
            parts: vec![nose],
            positions_m: vec![
                DVec3::new(0.0, 0.0, 55_000.0),
                DVec3::new(8.0, 4.0, 55_002.0),
            ],
            attitudes: vec![DQuat::IDENTITY, DQuat::from_rotation_z(FRAC_PI_2)],
            wind_m_s: Vec::new(),
        }],
        ..Animation::default()
    };
    let glb = Glb::parse(&gltf::binary(&animation, &summary).unwrap());
    assert_eq!(glb.times_s(), [0.0, 2.0]);
    assert_eq!(glb.json["asset"]["extras"]["start_s"], 10.0);
    assert_eq!(glb.json["asset"]["extras"]["seed"], summary.seed);
    let body = glb.motion(glb.node("body"));
    let (at, _, size) = glb.motion(glb.node("body part 1"))[1];
    assert_eq!(size, DVec3::new(2.0, 1.0, 3.0));
    let nose = |frame: usize| body[frame].1 * at;
    assert!((nose(0) - DVec3::NEG_Z).length() < 1e-6, "{}", nose(0));
    assert!((nose(1) - DVec3::NEG_X).length() < 1e-6, "{}", nose(1));
    let moved = body[1].0 - body[0].0;
    assert_eq!(moved, DVec3::new(-4.0, 2.0, -8.0));
    assert_eq!(body[0].0, glb.place_of(animation.bodies[0].positions_m[0]));
}

#[test]
fn a_file_keeps_to_its_format_and_has_the_same_bytes_each_time() {
    let folder = Scratch::folder();
    let run_folder = folder.path("run");
    run("scenes/paper/flight_chain.ron", &run_folder, "5");
    let [first, again] = ["first.glb", "again.glb"].map(|name| folder.path(name));
    export(&[&run_folder, "--gltf", &first]);
    export(&[&run_folder, "--gltf", &again]);
    let bytes = fs::read(&first).unwrap();
    assert_eq!(bytes, fs::read(&again).unwrap());
    let glb = Glb::parse(&bytes);
    let accessors = glb.json["accessors"].as_array().unwrap();
    let floats = accessors.iter().enumerate();
    let mut bounded = 0;
    for (place, accessor) in floats.filter(|(_, accessor)| accessor["componentType"] == 5126) {
        let rows = glb.rows(place);
        assert!(rows.iter().flatten().all(|value| value.is_finite()));
        if let (Some(least), Some(most)) = (accessor["min"].as_array(), accessor["max"].as_array())
        {
            bounded += 1;
            for column in 0..least.len() {
                let values = rows.iter().map(|row| row[column]);
                assert_eq!(least[column], values.clone().fold(f64::INFINITY, f64::min));
                assert_eq!(most[column], values.fold(f64::NEG_INFINITY, f64::max));
            }
        }
        if accessor["type"] == "VEC4" {
            let lengths = rows.iter().map(|row| DQuat::from_slice(row).length());
            assert!(
                lengths
                    .into_iter()
                    .all(|length| (length - 1.0).abs() < 1e-6)
            );
        }
    }
    // Times, and positions of spheres, boxes and cylinders.
    assert_eq!(bounded, 4);
}

#[test]
fn a_vtk_series_holds_what_was_recorded() {
    let folder = Scratch::folder();
    let (run_folder, file) = (folder.path("run"), folder.path("a & b.pvd"));
    run("scenes/mav_dock.ron", &run_folder, "2");
    export(&[&run_folder, "--vtk", &file]);
    let record = record(&folder, "run");
    let animation = Animation::of(&record, 1000);
    let collection = fs::read_to_string(&file).unwrap();
    for (frame, time_s) in animation.times_s.iter().enumerate() {
        let open = |block: &str| {
            let path = format!("a & b/{block}_{frame:05}.vtp");
            let named = path.replace('&', "&amp;");
            let line =
                format!("timestep=\"{time_s}\" part=\"{{}}\" name=\"{block}\" file=\"{named}\"/>");
            let (start, end) = line.split_once("{}").unwrap();
            assert!(
                collection.contains(start) && collection.contains(end),
                "{line}"
            );
            Vtp(fs::read_to_string(folder.path(&path)).unwrap())
        };
        let bodies = open("bodies");
        let names: Vec<&str> = animation
            .bodies
            .iter()
            .map(|body| body.name.as_str())
            .collect();
        assert_eq!(bodies.texts("name"), names);
        assert_eq!(
            bodies.corners("Verts"),
            (0..names.len()).collect::<Vec<_>>()
        );
        for (place, body) in animation.bodies.iter().enumerate() {
            let of = |name: &str| DVec3::from_slice(&bodies.reals(name)[3 * place..]);
            let track = record.tables.state(&body.name).unwrap();
            let row = track
                .times_s
                .iter()
                .position(|time| time == time_s)
                .unwrap();
            assert_eq!(of("Points"), track.positions_m[row]);
            assert_eq!(of("velocity_m_s"), track.velocities_m_s[row]);
            let attitude = DQuat::from_slice(&bodies.reals("attitude")[4 * place..]);
            assert_eq!(attitude, body.attitudes[frame]);
        }
        let (tethers, tether) = (open("tethers"), &animation.tethers[0]);
        let count = tether.tensions_n[frame].len();
        assert_eq!(tethers.count("NumberOfLines"), count);
        let lines = (0..count).flat_map(|segment| [segment, segment + 1]);
        assert_eq!(tethers.corners("Lines"), lines.collect::<Vec<_>>());
        let tensions = tether.tensions_n[frame].iter().flatten().copied();
        assert_eq!(tethers.reals("tension_n"), tensions.collect::<Vec<_>>());
        let points = tether.points_m[frame]
            .iter()
            .flat_map(|point| point.to_array());
        assert_eq!(tethers.reals("Points"), points.collect::<Vec<_>>());
        let solids = open("solids");
        let corners = solids.corners("Polys");
        assert_eq!(corners.len(), 3 * solids.count("NumberOfPolys"));
        assert!(
            corners
                .iter()
                .all(|corner| *corner < solids.count("NumberOfPoints"))
        );
    }
    // Fewer frames into the same place: nothing of the longer series is left.
    export(&[
        &run_folder,
        "--vtk",
        &file,
        "--frames",
        "2",
        "--force",
        "--quiet",
    ]);
    let files = fs::read_to_string(&file).unwrap().matches("file=").count();
    assert!(files < 3 * animation.times_s.len());
    assert_eq!(fs::read_dir(folder.path("a & b")).unwrap().count(), files);
}

#[test]
fn what_cannot_be_done_is_refused_and_nothing_is_written() {
    let folder = Scratch::folder();
    let run_folder = folder.path("run");
    run("scenes/examples/free_fall.ron", &run_folder, "1");
    let (glb, there) = (folder.path("new.glb"), folder.file("there.glb", "kept"));
    folder.file("series/kept.txt", "kept");
    let series = folder.path("series");
    let refused = |arguments: &[&str], why: &str| {
        let run = aerobot(&[&["export"], arguments].concat());
        let said = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{said}");
        assert!(said.contains(why), "{said}");
    };
    refused(&[&run_folder], "--gltf");
    let nowhere = folder.path("nowhere");
    refused(
        &[&nowhere, "--gltf", &glb],
        "is not the folder of a run: it has no `scene.ron`",
    );
    refused(
        &[&run_folder, "--gltf", &there],
        "there.glb` exists\n  = help:",
    );
    refused(
        &[&run_folder, "--gltf", &folder.path("new.gltf")],
        "does not end in `.glb`",
    );
    refused(
        &[&run_folder, "--gltf", &folder.path("no/new.glb")],
        "there is no folder",
    );
    refused(
        &[&run_folder, "--gltf", &glb, "--vtk", &series],
        "series` exists",
    );
    refused(
        &[
            &run_folder,
            "--gltf",
            &glb,
            "--vtk",
            &folder.path("series.pvd"),
        ],
        "series` exists",
    );
    refused(
        &[&run_folder, "--vtk", &folder.path("new.vtu")],
        "neither a folder nor a collection",
    );
    refused(&[&run_folder, "--gltf", &glb, "--frames", "1"], "--frames");
    let states = folder.path("run/states.csv");
    let table = fs::read_to_string(&states).unwrap();
    fs::write(&states, format!("{table}1,body,x\n")).unwrap();
    let line = table.lines().count() + 1;
    refused(
        &[&run_folder, "--gltf", &glb],
        &format!("states.csv:{line}: a field is not a number"),
    );
    let mut left: Vec<String> = fs::read_dir(&folder.0)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, ["run", "series", "there.glb"]);
    assert_eq!(fs::read_to_string(there).unwrap(), "kept");
}
