//! Copies of entities: the same as entities written one by one.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::fs;

use aerobot::engine::plugin::Simulator;
use flight::{load, position};
use glam::DVec3;
use program::{Scratch, aerobot, text};

fn scene(entities: &str) -> String {
    format!(
        r#"(
            name: "copies",
            environment: (atmosphere: Vira, wind: [Uniform(velocity_m_s: (3, 0, 0))]),
            entities: {{ {entities} }},
            run: (duration_s: 5, output_every_s: 1, record: (channels: All)),
        )"#
    )
}

const ANCHOR: &str = r#""anchor": (Fixed: (position_m: (0, 0, 55000))),
    "lead": (Tether: (
        from: ("anchor", Centre), to: ("instrument/1", Top), length_m: 10, nodes: 0,
        axial_stiffness_n: 1e4,
    )),"#;

const INSTRUMENT: &str = "Body: (mass_kg: 2, inertia: SolidCylinder(radius_m: 0.1, height_m: 0.4)), \
                          Drag: Constant(coefficient: 1, area_m2: 0.1)";

/// A ring of two lines between two instruments.
fn link(from: &str, to: &str) -> String {
    format!(
        r#"Tethers: (
            count: 2, from_radius_m: 0.1, to_radius_m: 0.1, from: ("{from}", Bottom), to: ("{to}", Top),
            length_m: 10, nodes: 2, diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 1e4,
            damping_n_s_m: 1, drag: (normal: 1, tangential: 0.03),
        )"#
    )
}

/// Four instruments on three rings, as copies.
fn chain() -> String {
    let link = link("instrument/#", "instrument/#+1");
    scene(&format!(
        r#"{ANCHOR} "instrument": (Copies: (count: 4), {INSTRUMENT}),
        "link": (Copies: (count: 3), {link}),"#
    ))
}

/// The files of a run of this text.
fn files(scratch: &Scratch, name: &str, scene: &str) -> [String; 3] {
    let file = scratch.file(&format!("{name}.ron"), scene);
    let folder = scratch.path(name);
    let run = aerobot(&["run", &file, "--out", &folder]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    ["states.csv", "tethers.csv", "channels.csv"]
        .map(|file| fs::read_to_string(format!("{folder}/{file}")).unwrap())
}

#[test]
fn copies_are_the_entities_that_they_stand_for() {
    let scratch = Scratch::folder();
    let mut entities = ANCHOR.to_owned();
    for number in 1..=4 {
        entities.push_str(&format!("\"instrument/{number}\": ({INSTRUMENT}),"));
    }
    for number in 1..=3 {
        let [from, to] = [number, number + 1].map(|end| format!("instrument/{end}"));
        entities.push_str(&format!("\"link/{number}\": ({}),", link(&from, &to)));
    }
    let copies = files(&scratch, "copies", &chain());
    assert!(copies[0].contains("link/3/2/2"));
    assert_eq!(copies, files(&scratch, "written", &scene(&entities)));
}

#[test]
fn a_copy_with_a_place_is_a_step_from_the_one_before() {
    let row = scene(
        r#""mast": (Copies: (count: 3, step_m: (5, 0, -1)), Fixed: (position_m: (1, 2, 55000))),
        "probe": (
            Copies: (count: 3, step_m: (0, 7, 0)),
            Pose: (position_m: (0, 0, 55000)), Body: (mass_kg: 1),
        ),
        "line": (Copies: (count: 3, step_m: (5, 0, -1)), Tether: (
            from: ("mast/#", Centre), to: ("weight/#", Centre), length_m: 2, nodes: 1,
            diameter_m: 0.01, density_kg_m3: 1000, axial_stiffness_n: 1e4,
            start: Positions([(1, 2, 54999)]),
        )),
        "weight": (Copies: (count: 3), Body: (mass_kg: 1)),"#,
    );
    let sink = flight::fly(&row, &[]);
    for number in 0..3 {
        let copy = f64::from(number);
        let name = number + 1;
        let step = copy * DVec3::new(5.0, 0.0, -1.0);
        let mast = DVec3::new(1.0, 2.0, 55_000.0) + step;
        assert_eq!(position(&sink, &format!("mast/{name}"), 0.0), mast);
        assert_eq!(
            position(&sink, &format!("line/{name}/1"), 0.0),
            mast - DVec3::Z
        );
        let probe = DVec3::new(0.0, 7.0 * copy, 55_000.0);
        assert_eq!(position(&sink, &format!("probe/{name}"), 0.0), probe);
        let weight = position(&sink, &format!("weight/{name}"), 0.0);
        assert!((weight - mast).truncate().length() < 1e-9, "{weight}");
    }
}

/// Copies are written out, each where it has come to rest; a trim of what was written moves nothing.
#[test]
fn a_trimmed_chain_starts_where_its_copies_are_at_rest() {
    let scratch = Scratch::folder();
    let file = scratch.file("chain.ron", &chain());
    let [once, twice] = ["once.ron", "twice.ron"].map(|name| scratch.path(name));
    for (from, to) in [(&file, &once), (&once, &twice)] {
        let trim = aerobot(&["trim", from, "--out", to]);
        assert_eq!(trim.status.code(), Some(0), "{}", text(&trim.stderr));
    }
    let written = fs::read_to_string(&once).unwrap();
    assert_eq!(written.matches("Pose: (").count(), 4);
    assert_eq!(written.matches("start: Each([[").count(), 3);
    assert!(!written.contains("Copies") && !written.contains('#'));
    let simulator = Simulator::new();
    let start = |file: &str| {
        let scene = load(&simulator, &fs::read_to_string(file).unwrap(), &[]);
        flight::run(&simulator, &scene)
    };
    let (first, second) = (start(&once), start(&twice));
    assert!(flight::largest_distance_m(&first, &second) < 1e-7);
    let moved = (first.frames.iter().skip(1))
        .flat_map(|frame| frame.states.iter().zip(&first.frames[0].states))
        .map(|(now, then)| (now.position_m - then.position_m).length())
        .fold(0.0, f64::max);
    assert!(moved < 1e-7, "{moved}");
}

/// The names of the example, one of each kind, and that it starts at rest.
#[test]
fn the_example_has_the_names_that_it_promises() {
    let sink = flight::fly_scene("examples/instrument_chain.ron", &["run.duration_s=4"]);
    let places = ["instrument/3", "link/2/3/1"].map(|name| {
        let [start, end] = [0.0, 4.0].map(|time_s| position(&sink, name, time_s));
        assert!(
            (start - end).length() < 1e-6,
            "{name} moves from {start} to {end}"
        );
        start
    });
    assert!(places[0].z < places[1].z);
}
