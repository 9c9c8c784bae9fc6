//! Docking as an impact: conserved quantities, weights and the other formulation.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::engine::recording::frame::Frame;
use flight::small_rotorcraft::{DENSITY, G, time_of};
use flight::{assert_below, assert_relative, channel, position, summary_of, velocity};
use glam::{DMat3, DVec3};

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

const FREE: &str = "Pose: (position_m: (0, 0, 1000)),
    Motion: (velocity_m_s: (-0.05, 0.1, 0), rate_rad_s: (0.01, 0, -0.05)),";
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
