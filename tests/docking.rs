//! Rotorcraft and docking: against closed forms, conserved quantities and the other formulation.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::{Frame, MemorySink};
use aerobot::engine::recording::summary::Summary;
use flight::{
    assert_below, assert_relative, channel, fly, fly_scene, frame_at, owned, position,
    run_for_summary, scene_file, summary_of, velocity,
};
use glam::{DMat3, DVec3};

const G: f64 = 8.87;
/// Density at 54 km of VIRA, rounded, kg/m^3.
const DENSITY: f64 = 1.03;
/// Drag coefficient times area of the drone, m^2.
const DRAG_AREA_M2: f64 = 0.12;

/// The drone that all of these fly: 6 kg, four rotors of 0.5 m.
fn drone(course: &str, more: &str) -> String {
    format!(
        r#"Body: (mass_kg: 6, inertia: Tensor(xx_kg_m2: 0.2, yy_kg_m2: 0.2, zz_kg_m2: 0.35)),
            Drag: Constant(coefficient: 1, area_m2: {DRAG_AREA_M2}),
            Rotorcraft: (rotors: 4, rotor_diameter_m: 0.5, motor_power_w: 1200, {course}),
            {more}"#
    )
}

/// A drone alone in still air of one density.
fn alone(course: &str, more: &str, run: &str) -> String {
    let drone = drone(course, more);
    format!(
        r#"(
    name: "drone",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{"drone": ({drone})}},
    run: ({run}),
)"#
    )
}

const POSE: &str = "Pose: (position_m: (0, 0, 54_000)),";

fn tail(results: &MemorySink, name: &str) -> f64 {
    channel(results.frames.last().unwrap(), "drone", name)
}

/// In hover the thrust is the weight, the power that of momentum theory, T^(3/2) / (FM sqrt(2 rho A)): 470 W. The
/// drone starts trimmed and stays.
#[test]
fn hover_takes_the_weight_and_470_w() {
    let run = "duration_s: 5, output_every_s: 1";
    let results = fly(&alone("", POSE, run), &[]);
    let weight_n = 6.0 * G;
    let area_m2 = std::f64::consts::PI * 0.25;
    let power_w = weight_n.powf(1.5) / (0.65 * (2.0 * DENSITY * area_m2).sqrt());
    assert_relative("thrust", tail(&results, "thrust_n"), weight_n, 1e-9);
    assert_relative("power", tail(&results, "power_w"), power_w, 1e-9);
    assert_below("power from 470 W", (power_w - 470.0).abs(), 1.0);
    let moved = position(&results, "drone", 5.0) - position(&results, "drone", 0.0);
    assert_below("moved", moved.length(), 1e-9);
}

/// At a steady 4.5 m/s the thrust balances weight and drag: tilt = atan(1/2 rho C_d S V^2 / (m g)), between one
/// and two degrees, thrust = hypot of the two.
#[test]
fn steady_flight_tilts_against_its_drag() {
    let course = "course: Along(position_m: (0, 0, 54_000), velocity_m_s: (4.5, 0, 0))";
    let start = format!("{POSE} Motion: (velocity_m_s: (4.5, 0, 0)),");
    let run = "duration_s: 20, output_every_s: 5";
    let results = fly(&alone(course, &start, run), &[]);
    let drag_n = 0.5 * DENSITY * DRAG_AREA_M2 * 4.5 * 4.5;
    let tilt_rad = (drag_n / (6.0 * G)).atan();
    assert_relative("tilt", tail(&results, "tilt_rad"), tilt_rad, 1e-6);
    assert!((1.0..2.0).contains(&tilt_rad.to_degrees()), "{tilt_rad}");
    let thrust_n = drag_n.hypot(6.0 * G);
    assert_relative("thrust", tail(&results, "thrust_n"), thrust_n, 1e-9);
    let place = position(&results, "drone", 20.0) - DVec3::new(90.0, 0.0, 54_000.0);
    assert_below("off course", place.length(), 1e-6);
}

/// A command of a small tilt about y from a level start, held for ever: the attitude follows as
/// 1 - (1 + w t) e^(-w t), w = 2 / lag. A tilt limit of 0.05 rad with the place far away is such a command.
#[test]
fn the_attitude_answers_as_a_critically_damped_oscillator() {
    let course = "course: Along(position_m: (1000, 0, 54_000)), largest_tilt_rad: 0.05, period_s: 10, \
                  largest_torque_n_m: 100";
    let run =
        "duration_s: 0.5, output_every_s: 0.05, integrator: Adaptive(relative_tolerance: 1e-10)";
    let results = fly(&alone(course, POSE, run), &[]);
    let frequency = 2.0 / 0.15;
    for frame in &results.frames {
        let wt = frequency * frame.time_s;
        let expected = 0.05 * (1.0 - (1.0 + wt) * (-wt).exp());
        let found = channel(frame, "drone", "tilt_rad");
        assert_below("tilt", (found - expected).abs(), 1e-8);
    }
}

/// A command of more thrust than the motors give ends at what momentum theory leaves them, and the body climbs no
/// faster than that: m dv/dt = T - m g at the first instant.
#[test]
fn thrust_ends_where_the_motors_do() {
    let course = "course: Along(position_m: (0, 0, 55_000)), largest_speed_m_s: 50, thrust_lag_s: 1e-3, period_s: 10";
    let run = "duration_s: 0.05, output_every_s: 0.01";
    let results = fly(&alone(course, POSE, run), &[]);
    let discs = 2.0 * DENSITY * std::f64::consts::PI * 0.25;
    let largest_n = (0.65_f64 * 1200.0).powf(2.0 / 3.0) * discs.powf(1.0 / 3.0);
    assert_relative("thrust", tail(&results, "thrust_n"), largest_n, 1e-5);
    let gained = velocity(&results, "drone", 0.05).z - velocity(&results, "drone", 0.02).z;
    assert_relative("climb", gained / 0.03, largest_n / 6.0 - G, 5e-3);
}

/// It goes to a place 40 m off and stays, with no more speed than it may have, and overshoots little.
#[test]
fn it_goes_where_it_is_sent() {
    let course = "course: Along(position_m: (30, -20, 54_010), heading_rad: 1)";
    let run = "duration_s: 40, output_every_s: 0.5";
    let results = fly(&alone(course, POSE, run), &[]);
    let aim = DVec3::new(30.0, -20.0, 54_010.0);
    let way = (aim - DVec3::Z * 54_000.0).normalize();
    let (mut fastest, mut beyond) = (0.0_f64, 0.0_f64);
    for frame in &results.frames {
        fastest = fastest.max(velocity(&results, "drone", frame.time_s).length());
        beyond = beyond.max((position(&results, "drone", frame.time_s) - aim).dot(way));
    }
    assert_below("fastest", fastest, 3.0 * 1.05);
    assert_below("overshoot", beyond, 0.1);
    let end = (position(&results, "drone", 40.0) - aim).length();
    assert_below("at the end", end, 0.01);
    assert_relative("heading", tail(&results, "heading_rad"), 1.0, 1e-6);
}

/// What it hangs on or not, whatever moves the rest: beside a tethered system the drone flies the same way in both
/// formulations.
#[test]
fn the_drone_flies_the_same_in_both_formulations() {
    let drone = drone(
        "course: Along(position_m: (5, 2, 54_001), velocity_m_s: (1, 0, 0))",
        POSE,
    );
    let text = format!(
        r#"(
    name: "beside",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 10, 54_050))),
        "gondola": (Body: (mass_kg: 100, inertia: Box(1, 1, 1))),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("gondola", Top), length_m: 40, nodes: 3,
            diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 10,
        )),
        "drone": ({drone}),
    }},
    run: (duration_s: 5, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-9)),
)"#
    );
    let lumped = fly(&text, &[]);
    let links = fly(&text, &["run.formulation=Denoc"]);
    for time_s in [1.0, 3.0, 5.0] {
        let apart = position(&lumped, "drone", time_s) - position(&links, "drone", time_s);
        assert_below("apart", apart.length(), 1e-6);
    }
    assert!(frame_at(&lumped, 5.0).states.len() > 3);
}

/// A rider of 6 kg that turns and drifts against the port of a gondola of 100 kg, on a latch without guidance.
fn pair(environment: &str, gondola: &str, tether: &str, events: &str, run: &str) -> String {
    format!(
        r#"(
    name: "pair",
    environment: (gravity: {environment}),
    entities: {{
        "gondola": (
            Body: (mass_kg: 100, inertia: Box(1, 1.2, 0.8)), {gondola}
            DockingPort: (at_m: (-0.5, 0, -0.1), axis: (-1, 0, 0)),
        ),
        "rider": (
            Body: (mass_kg: 6, inertia: Tensor(
                xx_kg_m2: 0.2, yy_kg_m2: 0.25, zz_kg_m2: 0.35, xy_kg_m2: 0.02, xz_kg_m2: -0.01,
            )),
            Pose: (position_m: (-1.2, 0.04, 999.93)),
            Motion: (velocity_m_s: (0.35, -0.03, 0.02), rate_rad_s: (0.02, -0.03, 0.04)),
            Drag: Constant(coefficient: 1, area_m2: 0.1),
            DockingPort: (at_m: (0.3, 0, 0), axis: (1, 0, 0)),
            Latch: (to: "gondola"),
        ),
        {tether}
    }},
    events: [{events}],
    run: ({run}),
)"#
    )
}

const FREE: &str = "Pose: (position_m: (0, 0, 1000)), Motion: (velocity_m_s: (-0.05, 0.1, 0), rate_rad_s: (0.01, 0, -0.05)),";
const NOTHING: &str = "Constant(0), atmosphere: Vacuum";
const ENERGY: &str =
    r#"record: (channels: Only({"system": ["mechanical_energy_j", "nonconservative_work_j"]}))"#;

/// Mass, inertia about the centre of mass (body frame).
fn bodies() -> [(&'static str, f64, DMat3); 2] {
    let (a, b, c) = (1.0_f64, 1.2_f64, 0.8_f64);
    let gondola = 100.0 / 12.0 * DVec3::new(b * b + c * c, a * a + c * c, a * a + b * b);
    let rider = DMat3::from_cols(
        DVec3::new(0.2, 0.02, -0.01),
        DVec3::new(0.02, 0.25, 0.0),
        DVec3::new(-0.01, 0.0, 0.35),
    );
    [
        ("gondola", 100.0, DMat3::from_diagonal(gondola)),
        ("rider", 6.0, rider),
    ]
}

/// Momentum, angular momentum about a place nearby, and kinetic energy of gondola and rider.
fn sums(frame: &Frame) -> (DVec3, DVec3, f64) {
    let pivot = DVec3::new(0.0, 0.0, 1000.0);
    let mut sums = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for (name, mass_kg, inertia) in bodies() {
        let row = frame
            .states
            .iter()
            .find(|row| &*row.entity == name)
            .unwrap();
        let (attitude, rate) = row.rotation.unwrap();
        let momentum = mass_kg * row.velocity_m_s;
        sums.0 += momentum;
        sums.1 += (row.position_m - pivot).cross(momentum) + attitude * (inertia * rate);
        sums.2 += 0.5 * (momentum.dot(row.velocity_m_s) + rate.dot(inertia * rate));
    }
    sums
}

fn time_of(summary: &Summary, kind: &str) -> f64 {
    let found = summary.events.iter().find(|event| event.kind == kind);
    found
        .unwrap_or_else(|| panic!("{:?}", summary.events))
        .time_s
}

/// Two free bodies without weight and without air meet, ride together, and part again. Momentum and angular momentum
/// stay through all of it, energy falls when the latch closes and at no other time, and what it loses counts as work.
#[test]
fn momentum_stays_through_docking_and_undocking() {
    let run = format!(
        "duration_s: 6, output_every_s: 0.25, integrator: Adaptive(relative_tolerance: 1e-12), {ENERGY}"
    );
    let undock = "(at_s: 4, do: Undock(body: \"rider\"))";
    let text = pair(NOTHING, FREE, "", undock, &run);
    let (results, summary) = summary_of(&text, &[]);
    let docked_s = time_of(&summary, "docked");
    assert!(docked_s > 0.2 && docked_s < 2.0, "{docked_s}");
    assert_eq!(time_of(&summary, "released"), 4.0);
    let first = sums(&results.frames[0]);
    let energy = |frame: &Frame| channel(frame, "system", "mechanical_energy_j");
    let work = |frame: &Frame| channel(frame, "system", "nonconservative_work_j");
    let mut before_j = first.2;
    for frame in &results.frames {
        let now = sums(frame);
        let change = (now.0 - first.0).length() / first.0.length();
        assert_below("momentum", change, 1e-10);
        let change = (now.1 - first.1).length() / first.1.length();
        assert_below("angular momentum", change, 1e-10);
        assert_below("energy told", (energy(frame) - now.2).abs(), 1e-12);
        assert_below("energy gained", now.2 - before_j, 1e-12);
        assert_below(
            "energy less work",
            (energy(frame) - work(frame) - first.2).abs(),
            1e-10,
        );
        before_j = now.2;
    }
    let lost_j = first.2 - before_j;
    // The reduced mass at the speed of contact, in the order of size.
    assert!(lost_j > 0.1 && lost_j < 1.0, "{lost_j}");
    // Parted, nothing has moved against the other since.
    let apart =
        |time_s: f64| velocity(&results, "rider", time_s) - velocity(&results, "gondola", time_s);
    assert!(apart(5.0).length() > 1e-3, "they turn, and so part");
}

/// The rider stays where it was latched: distance and relative attitude do not change by more than round-off.
#[test]
fn the_latch_holds_place_and_attitude() {
    let run = "duration_s: 6, output_every_s: 0.5, integrator: Adaptive(relative_tolerance: 1e-10)";
    let (results, summary) = summary_of(&pair(NOTHING, FREE, "", "", run), &[]);
    let docked_s = time_of(&summary, "docked");
    let relative = |frame: &Frame| {
        let row = |name| {
            frame
                .states
                .iter()
                .find(|row| &*row.entity == name)
                .unwrap()
        };
        let (gondola, rider) = (row("gondola"), row("rider"));
        let to_gondola = gondola.rotation.unwrap().0.conjugate();
        let place = to_gondola * (rider.position_m - gondola.position_m);
        let turn = to_gondola * rider.rotation.unwrap().0;
        (place, turn.xyz() * turn.w.signum())
    };
    let mut after = results
        .frames
        .iter()
        .filter(|frame| frame.time_s >= docked_s);
    let first = relative(after.next().unwrap());
    for frame in after {
        let now = relative(frame);
        assert_below("place", now.0.distance(first.0), 1e-12);
        assert_below("attitude", now.1.distance(first.1), 1e-12);
    }
}

/// A gondola on a tether, with weight, hit by the rider while both are under way.
fn hanging(run: &str, events: &str) -> String {
    let tether = r#""anchor": (Fixed: (position_m: (0, 0, 1020.4))),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("gondola", Top), length_m: 20, nodes: 3, diameter_m: 0.002,
            density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 20, drag: (normal: 1, tangential: 0.03),
        )),"#;
    pair(
        &format!("Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})"),
        "Drag: Constant(coefficient: 1, area_m2: 1),",
        tether,
        events,
        run,
    )
    // Thrown up so slowly that it meets the port on its way.
    .replace(
        "velocity_m_s: (0.35, -0.03, 0.02)",
        "velocity_m_s: (0.35, -0.03, 0.4)",
    )
    .replace("(-1.2, 0.04, 999.93)", "(-0.95, 0.02, 999.9)")
}

/// In the mean over a long swing, in air that damps well, the tether carries the weight of both and the latch that of
/// the rider, whose torque about its port is that weight times its arm of 0.3 m: by Newton and Euler a mean differs
/// from that by what momentum changes over the time.
#[test]
fn weights_show_in_tether_and_latch() {
    let run = "duration_s: 200, output_every_s: 0.1, integrator: Auto()";
    for formulation in ["LumpedMass", "Denoc"] {
        let text = hanging(run, "")
            .replace("density_kg_m3: 1.03", "density_kg_m3: 65")
            .replace("area_m2: 1)", "area_m2: 20)");
        let formulation = format!("run.formulation={formulation}");
        let (results, summary) = summary_of(&text, &[&formulation]);
        time_of(&summary, "docked");
        let late: Vec<&Frame> = results
            .frames
            .iter()
            .filter(|frame| frame.time_s > 50.0)
            .collect();
        let mean = |of: &dyn Fn(&Frame) -> f64| {
            late.iter().map(|frame| of(frame)).sum::<f64>() / late.len() as f64
        };
        let line_kg = 1440.0 * std::f64::consts::PI * 1e-6 * 20.0;
        let top_n = mean(&|frame| channel(frame, "tether", "tension_from_n"));
        assert_relative("top of the tether", top_n, G * (106.0 + line_kg), 1e-4);
        let latch_n = mean(&|frame| channel(frame, "rider", "latch_force_n"));
        assert_relative("latch", latch_n, 6.0 * G, 1e-3);
        let arm_m = mean(&|frame| {
            let row = frame.states.iter().find(|row| &*row.entity == "rider");
            let arm = row.unwrap().rotation.unwrap().0 * DVec3::new(0.3, 0.0, 0.0);
            arm.x.hypot(arm.y)
        });
        let torque_n_m = mean(&|frame| channel(frame, "rider", "latch_torque_n_m"));
        assert_relative("latch torque", torque_n_m, 6.0 * G * arm_m, 1e-2);
    }
}

/// A rider docks to one end of a dumbbell whose line is taut and heavy, without weight and without air. In both
/// formulations momentum and angular momentum of everything stay through the impact, which links pass on at once and
/// springs do not, and no energy appears; rigid links keep their length.
#[test]
fn tethered_or_linked_momentum_stays_through_docking() {
    let tether = r#""balloon": (
            Body: (mass_kg: 40), Pose: (position_m: (0, 0, 1020.4)), Motion: (velocity_m_s: (0.3, 0.1, 0.02)),
        ),
        "tether": (
            Tether: (
                from: ("gondola", (0, 0, 0.4)), to: ("balloon", Centre), length_m: 20, nodes: 4, diameter_m: 0.01,
                density_kg_m3: 1440, axial_stiffness_n: 2e4, damping_n_s_m: 5, start: Straight,
            ),
            Motion: (velocity_m_s: (0.1, 0.1, 0)),
        ),"#;
    let gondola = "Pose: (position_m: (0, 0, 1000)), Motion: (velocity_m_s: (-0.05, 0.1, 0)),";
    let run = format!(
        "duration_s: 5, output_every_s: 0.25, links: PointMass, \
         integrator: Adaptive(relative_tolerance: 1e-11), {ENERGY}"
    );
    let undock = "(at_s: 4, do: Undock(body: \"rider\"))";
    // Upward it pulls at the line.
    let text = pair(NOTHING, gondola, tether, undock, &run)
        .replace(
            "velocity_m_s: (0.35, -0.03, 0.02)",
            "velocity_m_s: (0.35, -0.03, -0.1)",
        )
        .replace("(-1.2, 0.04, 999.93)", "(-1.2, 0.04, 1000)");
    let segment_kg = 1440.0 * std::f64::consts::PI * 25e-6 * 4.0;
    let all = |frame: &Frame| {
        let pivot = DVec3::new(0.0, 0.0, 1000.0);
        let mut total = sums(frame);
        let mut add = |mass_kg: f64, place: DVec3, velocity: DVec3| {
            total.0 += mass_kg * velocity;
            total.1 += (place - pivot).cross(mass_kg * velocity);
            total.2 += 0.5 * mass_kg * velocity.length_squared();
        };
        for row in &frame.states {
            match &*row.entity {
                "gondola" => {
                    let (attitude, rate) = row.rotation.unwrap();
                    let arm = DVec3::new(0.0, 0.0, 0.4);
                    let velocity = row.velocity_m_s + attitude * rate.cross(arm);
                    add(0.5 * segment_kg, row.position_m + attitude * arm, velocity);
                }
                "rider" => {}
                "balloon" => add(40.0 + 0.5 * segment_kg, row.position_m, row.velocity_m_s),
                _ => add(segment_kg, row.position_m, row.velocity_m_s),
            }
        }
        total
    };
    for formulation in ["LumpedMass", "Denoc"] {
        let formulation = format!("run.formulation={formulation}");
        let (results, summary) = summary_of(&text, &[&formulation]);
        let docked_s = time_of(&summary, "docked");
        assert!(docked_s > 0.2 && docked_s < 3.0, "{docked_s}");
        let first = all(&results.frames[0]);
        let told = |frame: &Frame, name: &str| channel(frame, "system", name);
        let balance = |frame: &Frame| {
            told(frame, "mechanical_energy_j") - told(frame, "nonconservative_work_j")
        };
        for frame in &results.frames {
            let now = all(frame);
            let change = (now.0 - first.0).length() / first.0.length();
            assert_below(&format!("{formulation}: momentum"), change, 1e-10);
            let change = (now.1 - first.1).length() / first.1.length();
            assert_below(&format!("{formulation}: angular momentum"), change, 1e-10);
            let gap = (balance(frame) - balance(&results.frames[0])).abs();
            assert_below(&format!("{formulation}: energy less work"), gap, 1e-6);
        }
        let end = results.frames.last().unwrap();
        let lost_j =
            told(&results.frames[0], "mechanical_energy_j") - told(end, "mechanical_energy_j");
        assert!(lost_j > 0.05, "{lost_j}");
        if formulation.ends_with("Denoc") {
            let longest = results.frames.iter().flat_map(|frame| &frame.segments);
            let error = longest
                .map(|row| (row.length_m - 4.0).abs())
                .fold(0.0, f64::max);
            assert_below("length of links", error, 1e-9);
        }
    }
}

/// A stiff tether and rigid links make the same of an impact: what is left between them falls with the compliance.
#[test]
fn both_formulations_dock_alike() {
    let run = "duration_s: 3, output_every_s: 1, integrator: Auto(accuracy_m: 1e-5)";
    let undock = "(at_s: 2, do: Undock(body: \"rider\"))";
    let text = hanging(run, undock);
    let (links, linked) = summary_of(&text, &["run.formulation=Denoc", "run.links=PointMass"]);
    let mut before_m = f64::INFINITY;
    for stiffness_n in [2e5, 2e6] {
        let stiffness = format!("entities.tether.Tether.axial_stiffness_n={stiffness_n}");
        let (lumped, summary) = summary_of(&text, &[&stiffness]);
        let docked_s = (time_of(&summary, "docked"), time_of(&linked, "docked"));
        assert_eq!(docked_s.0, docked_s.1);
        let apart_m = position(&lumped, "rider", 3.0).distance(position(&links, "rider", 3.0));
        println!("EA {stiffness_n} N: {apart_m:.2e} m apart after docking and undocking");
        assert!(apart_m < 0.4 * before_m, "{apart_m} {before_m}");
        before_m = apart_m;
    }
    assert_below("apart", before_m, 5e-3);
}

/// The scene, in gusts and with errors of navigation, for a few seeds in both formulations: docked within 120 s at less
/// than 0.5 m/s, after all phases in order; from then on the tether carries more, and no energy appears.
#[test]
fn drones_dock_with_a_swinging_gondola() {
    for (seed, formulation) in [(1, "LumpedMass"), (2, "LumpedMass"), (1, "Denoc")] {
        let overrides = [
            format!("run.seed={seed}"),
            format!("run.formulation={formulation}"),
            "run.integrator=Auto(accuracy_m: 1e-3)".to_owned(),
            format!("run.{}", ENERGY_AND_DRONE.replacen(": ", "=", 1)),
        ];
        let overrides = overrides.each_ref().map(String::as_str);
        let simulator = Simulator::new();
        let scene = simulator
            .load(&scene_file("mav_dock.ron"), &owned(&overrides))
            .unwrap_or_else(|error| panic!("{error}"));
        let (results, summary) = run_for_summary(&simulator, &scene);
        let kinds: Vec<&str> = summary.events.iter().map(|event| &*event.kind).collect();
        let expected = ["approach", "station-keeping", "contact", "docked"];
        assert_eq!(kinds, expected, "seed {seed}");
        let docked_s = time_of(&summary, "docked");
        let end = results.frames.last().unwrap();
        let speed_m_s = channel(end, "drone", "contact_speed_m_s");
        println!("{formulation}, seed {seed}: docked after {docked_s} s at {speed_m_s:.3} m/s");
        assert!(docked_s < 120.0 && speed_m_s < 0.5);
        assert_eq!(channel(end, "drone", "docking_phase"), 4.0);
        let balance = |frame: &Frame| {
            channel(frame, "system", "mechanical_energy_j")
                - channel(frame, "system", "nonconservative_work_j")
        };
        let first = balance(&results.frames[0]);
        for frame in &results.frames {
            // Of 135 kJ that drag and buoyancy take once the system sinks with the drone.
            assert_below("balance, J", (balance(frame) - first).abs(), 0.1);
        }
    }
}

const ENERGY_AND_DRONE: &str = r#"record.channels: Only({
    "system": ["mechanical_energy_j", "nonconservative_work_j"],
    "drone": ["docking_phase", "contact_speed_m_s"],
})"#;

/// Two seeds are two flights, and one seed is one.
#[test]
fn errors_of_navigation_follow_from_the_seed() {
    let fly = |seed: &str| fly_scene("mav_dock.ron", &["run.duration_s=8", seed]);
    let first = fly("run.seed=5");
    assert_eq!(first.frames, fly("run.seed=5").frames);
    assert_ne!(first.frames, fly("run.seed=6").frames);
}

/// A port on an anchor that moves at `velocity`, 40 m from the drone, without a sensor in the way.
fn chase(velocity: &str, rotorcraft: &str, docking: &str) -> (MemorySink, Summary) {
    let drone = drone(rotorcraft, POSE);
    let text = format!(
        r#"(
    name: "chase",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{
        "port": (
            Moving: (position_m: (40, 5, 54_000), velocity_m_s: {velocity}),
            DockingPort: (at_m: (0, 0, 0), axis: (-1, 0, 0)),
        ),
        "drone": (
            {drone}
            DockingPort: (at_m: (0.5, 0, 0), axis: (1, 0, 0)),
            Latch: (to: "port"),
            Docking: ({docking}),
        ),
    }},
    run: (duration_s: 120, output_every_s: 1, integrator: Auto(accuracy_m: 0.01)),
)"#
    );
    summary_of(&text, &[])
}

/// What can be caught is caught, and held by what moves it.
#[test]
fn a_steady_port_is_reached_and_holds_the_drone() {
    let (results, summary) = chase("(2, 1, 0)", "", "");
    let docked_s = time_of(&summary, "docked");
    assert!(docked_s < 60.0, "{docked_s}");
    let end = results.frames.last().unwrap();
    let moves = velocity(&results, "drone", 120.0) - DVec3::new(2.0, 1.0, 0.0);
    assert_below("against the port", moves.length(), 1e-12);
    let drag_n = 0.5 * DENSITY * DRAG_AREA_M2 * 5.0;
    let expected = drag_n.hypot(6.0 * G);
    assert_relative(
        "latch",
        channel(end, "drone", "latch_force_n"),
        expected,
        1e-9,
    );
}

/// What cannot be reached ends as a phase and as an event with its reason, a sentence in the summary, and numbers
/// that are finite: a port that is too fast, a drone that is too weak, a port out of sight, and a latch that cannot
/// close because the port is slower to accept it than the drone is to arrive.
#[test]
fn what_cannot_be_reached_is_told() {
    let seeing = "navigation: Measured(period_s: 0.05, delay_s: 0.05, noise_m_per_m: 0.005, least_noise_m: 0.01, \
                  most_noise_m: 0.5, range_m: 30, observer_rad_s: 3, observer_near_m: 30)";
    for (velocity, rotorcraft, docking, kind, words) in [
        ("(40, 0, 0)", "", "", "unreachable: too fast", "40.0 m/s"),
        (
            "(0, 0, 0)",
            "thrust_coefficient: 0.002",
            "",
            "unreachable: out of thrust",
            "give 36.4 N",
        ),
        ("(0, 0, 0)", "", seeing, "unreachable: not seen", "range"),
        (
            "(0, 0, 0)",
            "",
            "closing_speed_m_s: 1.5, attempts: 2",
            "unreachable: approaches missed",
            "2 approaches",
        ),
    ] {
        let (results, summary) = chase(velocity, rotorcraft, docking);
        assert!(time_of(&summary, kind) < 120.0);
        assert!(
            matches!(&summary.warnings[..], [told] if told.contains(words) && told.contains("`port`")),
            "{:?}",
            summary.warnings
        );
        assert_eq!(tail(&results, "docking_phase"), 6.0);
        assert!(!summary.events.iter().any(|event| event.kind == "docked"));
        for row in results.frames.iter().flat_map(|frame| &frame.states) {
            assert!(row.position_m.is_finite() && row.velocity_m_s.is_finite());
        }
    }
}

/// Released on command the drone backs off, keeps station in front of the port, and stays released.
#[test]
fn a_drone_is_released_on_command() {
    let overrides = [
        r#"events=[(at_s: 90, do: Undock(body: "drone"))]"#,
        "run.duration_s=115",
    ];
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file("mav_dock.ron"), &owned(&overrides))
        .unwrap_or_else(|error| panic!("{error}"));
    let (results, summary) = run_for_summary(&simulator, &scene);
    assert_eq!(time_of(&summary, "released"), 90.0);
    assert_eq!(tail(&results, "docking_phase"), 5.0);
    // 6 m in front, as near as the swing of the gondola after the release lets it be.
    let distance_m = tail(&results, "distance_m");
    assert!((5.0..7.0).contains(&distance_m), "{distance_m}");
    assert!(tail(&results, "thrust_n") > 45.0);
}
