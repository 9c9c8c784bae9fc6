//! What motion conserves: angular momentum and energy of a tumbling body, energy of a chain with what
//! forces take and give, momenta of tethered bodies; of lumped masses and of rigid and elastic links.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use std::f64::consts::PI;

use aerobot::engine::recording::frame::{Frame, MemorySink, StateRow};
use flight::{assert_below, fly};
use glam::{DQuat, DVec3};

/// Angular momentum R J omega (inertial frame) and energy omega' J omega / 2 of a body that nothing
/// turns are constant, whatever the tumbling. It starts about the middle axis, which is unstable: the
/// body turns over again and again.
#[test]
fn a_tumbling_body_keeps_angular_momentum_and_energy() {
    let inertia = DVec3::new(1.0, 2.0, 2.5);
    let sink = fly(
        r#"(
        name: "tumbling",
        environment: (gravity: Constant(0), atmosphere: Vacuum),
        entities: {
            "body": (
                Body: (mass_kg: 3, inertia: Tensor(xx_kg_m2: 1, yy_kg_m2: 2, zz_kg_m2: 2.5)),
                Pose: (position_m: (0, 0, 0), attitude: AxisAngle(axis: (1, 2, 3), angle_rad: 0.7)),
                Motion: (rate_rad_s: (0.1, 1, 0.1)),
            ),
        },
        run: (
            duration_s: 1000, output_every_s: 1,
            integrator: Adaptive(relative_tolerance: 1e-12),
        ),
    )"#,
        &[],
    );
    let at = |row: &StateRow| {
        let (attitude, rate) = row.rotation.expect("a body turns");
        (
            attitude * (inertia * rate),
            0.5 * rate.dot(inertia * rate),
            rate.y,
        )
    };
    let states: Vec<_> = sink.states("body").map(|(_, row)| at(row)).collect();
    let (momentum, energy, _) = states[0];
    let largest = |f: &dyn Fn(&(DVec3, f64, f64)) -> f64| states.iter().map(f).fold(0.0, f64::max);
    // It did turn over: the rate about the middle axis changes its sign.
    assert!(states.iter().any(|state| state.2 < -0.9));
    assert_below(
        "angular momentum",
        largest(&|s| (s.0 - momentum).length() / momentum.length()),
        1e-9,
    );
    assert_below(
        "rotational energy",
        largest(&|s| (s.1 / energy - 1.0).abs()),
        1e-9,
    );
}

/// A chain of five segments that swings from a fixed point; `air`, `tether` and `load` add what acts on
/// it. It starts straight at 0.6 rad, stretched by the load's weight.
fn swinging_chain(air: &str, tether: &str, load: &str, overrides: &[&str]) -> MemorySink {
    fly(
        &format!(
            r#"(
        name: "chain",
        environment: (gravity: Constant(8.87), {air}),
        entities: {{
            "pivot": (Fixed: (position_m: (0, 0, 100))),
            "load": (
                Body: (mass_kg: 2, inertia: Box(0.4, 0.3, 0.2)),
                Pose: (position_m: (5.66, 0, 91.75)),
                Motion: (velocity_m_s: (0, 1, 0)),
                {load}
            ),
            "chain": (
                Tether: (
                    from: ("pivot", Centre), to: ("load", (0.05, 0, 0.1)),
                    length_m: 10, nodes: 4, diameter_m: 0.008, density_kg_m3: 1000,
                    axial_stiffness_n: 2e4, slack: false, start: Straight, {tether}
                ),
            ),
        }},
        run: (
            duration_s: 10, output_every_s: 0.05,
            integrator: Adaptive(relative_tolerance: 1e-12), record: (channels: All),
        ),
    )"#
        ),
        overrides,
    )
}

/// Energy and work of non-conservative forces over time, J: (kinetic, mechanical, work).
fn energies(sink: &MemorySink) -> Vec<(f64, f64, f64)> {
    let channel = |name| sink.channel("system", name);
    let (kinetic, mechanical, work) = (
        channel("kinetic_energy_j"),
        channel("mechanical_energy_j"),
        channel("nonconservative_work_j"),
    );
    assert!(!work.is_empty());
    kinetic
        .iter()
        .zip(&mechanical)
        .zip(&work)
        .map(|((kinetic, mechanical), work)| (kinetic.1, mechanical.1, work.1))
        .collect()
}

/// Largest departure of E(t) - W(t) from its start, J.
fn largest_imbalance_j(energies: &[(f64, f64, f64)]) -> f64 {
    let start = energies[0].1 - energies[0].2;
    energies
        .iter()
        .map(|(_, mechanical, work)| (mechanical - work - start).abs())
        .fold(0.0, f64::max)
}

/// E = kinetic + m g z + elastic is constant in vacuum without damping, where nothing else does work.
#[test]
fn an_undamped_chain_in_vacuum_keeps_its_energy() {
    let energies = energies(&swinging_chain("atmosphere: Vacuum", "", "", &[]));
    let largest_kinetic = energies.iter().map(|e| e.0).fold(0.0, f64::max);
    // Some 30 J go back and forth, while the chain hums at up to 200 rad/s.
    assert!(largest_kinetic > 20.0, "{largest_kinetic} J");
    let work = energies.iter().map(|e| e.2.abs()).fold(0.0, f64::max);
    // Of 2.5 kg at 5 m/s an error of 1e-12 is 1e-11 J; a hundred such, and round-off.
    assert_below("energy, J", largest_imbalance_j(&energies), 1e-9);
    assert_below("work of nothing, J", work, 1e-12);
}

/// What is around the chain, along it and on its load, for work that is not conservative.
const AIR: &str =
    "atmosphere: Uniform(density_kg_m3: 1.5), wind: [Uniform(velocity_m_s: (1, 3, 0.5))]";
const LOSSES: &str = "damping_n_s_m: 5, drag: (normal: 1.2, tangential: 0.03)";
const DRAGGING: &str =
    "Sphere: (radius_m: 0.3), Buoyancy: (), AddedMass: (), Drag: Constant(coefficient: 0.47),";

/// E(t) - E(0) = W(t): what drag, dampers, buoyancy, added mass and wind take or give is found from the
/// forces, and the energy from the state, by different roads.
#[test]
fn what_drag_and_dampers_take_is_missing_from_the_energy() {
    let energies = energies(&swinging_chain(AIR, LOSSES, DRAGGING, &[]));
    let work = energies[energies.len() - 1].2;
    println!("work of non-conservative forces: {work:.3} J");
    assert!(work < -2.0, "drag and dampers take only {work} J");
    assert_below("energy less work, J", largest_imbalance_j(&energies), 1e-9);
}

/// The same on chains of rigid rods, of point masses on rigid links, and of elastic rods, whose constraint
/// forces, dampers and coupled ends must neither give nor take anything else.
#[test]
fn chains_of_links_keep_the_energy_less_the_work() {
    for links in [
        ["run.links=Rod", "run.elastic_links=false"],
        ["run.links=PointMass", "run.elastic_links=false"],
        ["run.links=Rod", "run.elastic_links=true"],
    ] {
        let overrides = [
            "run.formulation=Denoc",
            links[0],
            links[1],
            "run.duration_s=3",
            "run.integrator=Adaptive(relative_tolerance: 1e-11)",
        ];
        let quiet = energies(&swinging_chain("atmosphere: Vacuum", "", "", &overrides));
        let lossy = energies(&swinging_chain(AIR, LOSSES, DRAGGING, &overrides));
        let work = lossy[lossy.len() - 1].2;
        println!("{links:?}: work of non-conservative forces {work:.3} J");
        assert!(work < -1.0, "{links:?}: drag takes only {work} J");
        // Of some 3 kg at 5 m/s an error of 1e-11 is 1e-10 J; ten such.
        assert_below("energy in vacuum, J", largest_imbalance_j(&quiet), 1e-9);
        assert_below("energy less work, J", largest_imbalance_j(&lossy), 1e-9);
    }
}

/// Masses, inertias and offsets of the two tethered bodies below.
const PAIR_TETHER_KG: f64 = 0.8;
const FIRST: TumblingBody = TumblingBody {
    name: "first",
    mass_kg: 3.0,
    inertia_kg_m2: DVec3::new(0.5, 0.8, 1.1),
    offset_m: DVec3::new(0.3, 0.1, -0.2),
};
const SECOND: TumblingBody = TumblingBody {
    name: "second",
    mass_kg: 5.0,
    inertia_kg_m2: DVec3::new(1.5, 0.9, 1.2),
    offset_m: DVec3::new(-0.4, 0.2, 0.15),
};

struct TumblingBody {
    name: &'static str,
    mass_kg: f64,
    inertia_kg_m2: DVec3,
    offset_m: DVec3,
}

impl TumblingBody {
    /// Linear and angular momentum about the origin, with a carried point mass, kg m/s and kg m^2/s.
    fn momenta(&self, frame: &Frame, carried_kg: f64) -> (DVec3, DVec3) {
        let row = row(frame, self.name);
        let (attitude, rate): (DQuat, DVec3) = row.rotation.expect("a body turns");
        let (place, speed) = self.end_state(frame);
        let (own, carried) = (self.mass_kg * row.velocity_m_s, carried_kg * speed);
        let spin = attitude * (self.inertia_kg_m2 * rate);
        (
            own + carried,
            row.position_m.cross(own) + place.cross(carried) + spin,
        )
    }

    /// Position and velocity of the attachment.
    fn end_state(&self, frame: &Frame) -> (DVec3, DVec3) {
        let row = row(frame, self.name);
        let (attitude, rate) = row.rotation.expect("a body turns");
        (
            row.position_m + attitude * self.offset_m,
            row.velocity_m_s + attitude * rate.cross(self.offset_m),
        )
    }

    fn entity(&self, place: &str, velocity: &str, rate: &str) -> String {
        let (mass, j) = (self.mass_kg, self.inertia_kg_m2);
        format!(
            r#""{}": (
                Body: (mass_kg: {mass}, inertia: Tensor(xx_kg_m2: {}, yy_kg_m2: {}, zz_kg_m2: {})),
                Pose: (position_m: {place}),
                Motion: (velocity_m_s: {velocity}, rate_rad_s: {rate}),
            ),"#,
            self.name, j.x, j.y, j.z
        )
    }

    fn end(&self) -> String {
        let at = self.offset_m;
        format!(r#"("{}", ({}, {}, {}))"#, self.name, at.x, at.y, at.z)
    }
}

fn row<'a>(frame: &'a Frame, name: &str) -> &'a StateRow {
    frame
        .states
        .iter()
        .find(|row| &*row.entity == name)
        .expect("a row of every entity")
}

/// Two bodies on a tether of two segments, spinning about each other and tumbling, nothing around.
fn tethered_pair() -> MemorySink {
    let density = PAIR_TETHER_KG / (4.0 * PI * 0.005 * 0.005);
    fly(
        &format!(
            r#"(
        name: "pair",
        environment: (gravity: Constant(0), atmosphere: Vacuum),
        entities: {{
            {}
            {}
            "tether": (
                Tether: (
                    from: {}, to: {}, length_m: 4, nodes: 1,
                    diameter_m: 0.01, density_kg_m3: {density}, axial_stiffness_n: 500,
                    slack: false, start: Straight,
                ),
            ),
        }},
        run: (
            duration_s: 20, output_every_s: 0.1,
            integrator: Adaptive(relative_tolerance: 1e-12),
        ),
    )"#,
            FIRST.entity("(-3, 0, 0)", "(0.2, -2, 0.3)", "(0.4, -0.7, 0.9)"),
            SECOND.entity("(1.9, 0, 0)", "(0.1, 1.5, -0.4)", "(-0.6, 0.5, 1.2)"),
            FIRST.end(),
            SECOND.end(),
        ),
        &[],
    )
}

/// Without forces from outside the momentum sum m v and the angular momentum sum m x cross v + R J w
/// are constant, counted over bodies, the node, and the half segments of the tether that each body
/// carries at its attachment. They are kept only if a carried mass enters the equations of motion as it
/// enters these sums.
#[test]
fn two_tethered_bodies_keep_their_momenta() {
    let sink = tethered_pair();
    let (node_kg, end_kg) = (PAIR_TETHER_KG / 2.0, PAIR_TETHER_KG / 4.0);
    let total = |frame: &Frame| {
        let (first, second) = (FIRST.momenta(frame, end_kg), SECOND.momenta(frame, end_kg));
        let node = row(frame, "tether/1");
        let own = node_kg * node.velocity_m_s;
        (
            first.0 + second.0 + own,
            first.1 + second.1 + node.position_m.cross(own),
        )
    };
    let (linear, angular) = total(&sink.frames[0]);
    let (mut linear_error, mut angular_error) = (0.0_f64, 0.0_f64);
    for frame in &sink.frames {
        let now = total(frame);
        linear_error = linear_error.max((now.0 - linear).length() / linear.length());
        angular_error = angular_error.max((now.1 - angular).length() / angular.length());
    }
    // The tether works: the first body's own momentum turns over.
    let own = |frame: &Frame| FIRST.momenta(frame, 0.0).0;
    let turned = sink
        .frames
        .iter()
        .any(|frame| own(frame).dot(own(&sink.frames[0])) < 0.0);
    assert!(turned);
    assert_below("linear momentum", linear_error, 1e-9);
    assert_below("angular momentum", angular_error, 1e-9);
}

/// What the tumbling pair on rigid rods keeps, counted from the rows of bodies and joints.
struct Kept {
    linear: DVec3,
    /// About the common centre of mass.
    angular: DVec3,
    kinetic_j: f64,
}

const PAIR_RODS: usize = 3;

/// A uniform rod of mass m between points a and b that move with v and w has the momentum m/2 (v + w), the
/// angular momentum m/6 (2 a x v + a x w + b x v + 2 b x w) and the energy m/6 (v.v + v.w + w.w).
fn kept(frame: &Frame) -> Kept {
    let (mut linear, mut angular, mut kinetic_j) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    let mut moment = DVec3::ZERO;
    for body in [&FIRST, &SECOND] {
        let row = row(frame, body.name);
        let (own, own_angular) = body.momenta(frame, 0.0);
        let rate = row.rotation.expect("a body turns").1;
        linear += own;
        angular += own_angular;
        moment += body.mass_kg * row.position_m;
        kinetic_j += 0.5
            * (body.mass_kg * row.velocity_m_s.length_squared()
                + rate.dot(body.inertia_kg_m2 * rate));
    }
    let mut joints = vec![FIRST.end_state(frame)];
    for number in 1..PAIR_RODS {
        let row = row(frame, &format!("tether/{number}"));
        joints.push((row.position_m, row.velocity_m_s));
    }
    joints.push(SECOND.end_state(frame));
    let rod_kg = PAIR_TETHER_KG / PAIR_RODS as f64;
    for pair in joints.windows(2) {
        let ((a, v), (b, w)) = (pair[0], pair[1]);
        linear += 0.5 * rod_kg * (v + w);
        angular += rod_kg / 6.0 * (2.0 * a.cross(v) + a.cross(w) + b.cross(v) + 2.0 * b.cross(w));
        moment += 0.5 * rod_kg * (a + b);
        kinetic_j += rod_kg / 6.0 * (v.dot(v) + v.dot(w) + w.dot(w));
    }
    let centre = moment / (FIRST.mass_kg + SECOND.mass_kg + PAIR_TETHER_KG);
    Kept {
        linear,
        angular: angular - centre.cross(linear),
        kinetic_j,
    }
}

/// The pair on three rigid rods, drifting, tumbling and spinning about each other. The velocities of the
/// attachments differ across the tether only.
fn pair_on_rods(integrator: &str) -> MemorySink {
    let density = PAIR_TETHER_KG / (4.0 * PI * 0.005 * 0.005);
    fly(
        &format!(
            r#"(
        name: "pair-on-rods",
        environment: (gravity: Constant(0), atmosphere: Vacuum),
        entities: {{
            {}
            {}
            "tether": (
                Tether: (
                    from: {}, to: {}, length_m: 4, nodes: {},
                    diameter_m: 0.01, density_kg_m3: {density}, axial_stiffness_n: 500,
                    start: Straight,
                ),
            ),
        }},
        run: (
            formulation: Denoc, links: Rod, duration_s: 10, output_every_s: 0.1,
            integrator: {integrator}, record: (channels: All),
        ),
    )"#,
            FIRST.entity("(0, 0, 0)", "(0.2, -2, 0.3)", "(0.4, -0.7, 0.9)"),
            SECOND.entity(
                "(4.7, -0.1, -0.35)",
                "(0.415, 1.5, -0.4)",
                "(-0.6, 0.5, 1.2)"
            ),
            FIRST.end(),
            SECOND.end(),
            PAIR_RODS - 1,
        ),
        &[],
    )
}

/// Largest departures from the start, relative: linear momentum, angular momentum, energy.
fn drifts(sink: &MemorySink) -> [f64; 3] {
    let start = kept(&sink.frames[0]);
    let mut largest = [0.0_f64; 3];
    for frame in &sink.frames {
        let now = kept(frame);
        let drift = [
            (now.linear - start.linear).length() / start.linear.length(),
            (now.angular - start.angular).length() / start.angular.length(),
            (now.kinetic_j / start.kinetic_j - 1.0).abs(),
        ];
        for (largest, drift) in largest.iter_mut().zip(drift) {
            *largest = largest.max(drift);
        }
    }
    largest
}

/// Rigid links exert forces between the bodies and do no work: linear momentum, angular momentum about the
/// centre of mass and energy of the tumbling pair are constant. The sums here use where bodies and joints
/// are and how they move; the equations of motion were solved for joint coordinates.
#[test]
fn a_chain_of_rods_in_vacuum_keeps_momenta_and_energy() {
    let sink = pair_on_rods("Adaptive(relative_tolerance: 1e-11)");
    let start = kept(&sink.frames[0]);
    let own = |frame: &Frame| FIRST.momenta(frame, 0.0).0;
    let turned = |frame: &Frame| own(frame).dot(own(&sink.frames[0])) < 0.0;
    assert!(sink.frames.iter().any(turned));
    let [linear, angular, energy] = drifts(&sink);
    assert_below("linear momentum", linear, 1e-9);
    assert_below("angular momentum", angular, 1e-9);
    assert_below("energy", energy, 1e-9);
    for (row, (_, mechanical_j)) in sink
        .channel("system", "mechanical_energy_j")
        .into_iter()
        .enumerate()
    {
        let now = kept(&sink.frames[row]);
        // The channel, and this file's own sum, of the same state.
        assert!((mechanical_j - now.kinetic_j).abs() < 1e-12 * start.kinetic_j);
    }
}

/// With RK4 the drift is the method's error and falls at least with its fourth order.
#[test]
fn what_a_chain_of_rods_loses_falls_with_the_order_of_the_integrator() {
    let [coarse, fine] =
        [0.01, 0.005].map(|step_s| drifts(&pair_on_rods(&format!("Fixed(step_s: {step_s})"))));
    for (what, coarse, fine) in [
        ("linear momentum", coarse[0], fine[0]),
        ("angular momentum", coarse[1], fine[1]),
        ("energy", coarse[2], fine[2]),
    ] {
        let order = (coarse / fine).log2();
        println!("{what}: {coarse:.1e} and {fine:.1e}, order {order:.2}");
        assert!((3.8..5.3).contains(&order), "{what}: {order}");
    }
}
