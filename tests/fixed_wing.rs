//! The fixed-wing drone in flight: against an integration of its equations that is written apart, energy,
//! symmetry, the other formulation; what its autopilot holds in gusts; and the chase of the paper.
//! (Trim, propeller, loops and guidance laws are tested where they are, `-p aerobot-systems fixed_wing`.)

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may fail loudly, its helpers too"
)]

mod fixed_wing {
    pub(crate) mod independent;
}
mod flight;

use aerobot::components::fixed_wing::FixedWing;
use aerobot::components::fixed_wing::controls::Controls;
use aerobot::components::state::{AngularVelocity, Attitude, Velocity};
use aerobot::engine::builtin::fixed_wing::DroneTrim;
use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::recording::summary::Summary;
use aerobot::engine::world::SceneEntities;
use aerobot::reproduce::Settings;
use aerobot::reproduce::chase::{DroneAir, fly};
use fixed_wing::independent::{State, fly as fly_apart};
use flight::{
    assert_below, channel, fly as fly_text, frame_at, load, owned, position, scene_file,
    summary_of, velocity,
};
use glam::DVec3;

/// A drone alone, without guidance: its controls stay as they are at the start.
const FREE: &str = r#"(
    name: "free-flight",
    about: "",
    environment: (gravity: Constant(8.87), atmosphere: Uniform(density_kg_m3: 1.03), wind: []),
    entities: {
        "drone": (
            Body: (mass_kg: 11, inertia: Tensor(xx_kg_m2: 0.8244, yy_kg_m2: 1.135, zz_kg_m2: 1.759, xz_kg_m2: 0.1204)),
            Pose: (position_m: (0, 0, 54_000)),
            FixedWing: (start: Trim(airspeed_m_s: 25)),
        ),
    },
    run: (duration_s: 10, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-11)),
)"#;

const GUST: &str = "environment.wind=[Uniform(velocity_m_s: (3, -4, 0)), \
                    Step(velocity_m_s: (-2, 3, 1.5), from_s: 1, until_s: 3)]";

/// Wind of [`GUST`] in north-east-down.
fn gust(time_s: f64) -> DVec3 {
    let steady = DVec3::new(3.0, 4.0, 0.0);
    if (1.0..3.0).contains(&time_s) {
        steady + DVec3::new(-2.0, -3.0, -1.5)
    } else {
        steady
    }
}

/// Climbing turns, to the left and to the right, through a gust across all axes, against an integration of
/// Beard and McLain's twelve equations in north-east-down that shares no code with the engine.
#[test]
fn val_a_flight_through_a_gust_is_that_of_the_twelve_equations() {
    for (climb_deg, turn_deg_s) in [(3.0, 8.0), (-2.0, -6.0)] {
        let start = format!(
            "entities.drone.FixedWing.start=Trim(airspeed_m_s: 25, course_deg: 40, climb_deg: {climb_deg:?}, \
             turn_deg_s: {turn_deg_s:?})"
        );
        let simulator = Simulator::new();
        let scene = load(&simulator, FREE, &[GUST, &start]);
        let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
        let world = simulation.world();
        let drone = world.resource::<SceneEntities>().get("drone").unwrap();
        let controls = *world.get::<Controls>(drone).unwrap();
        let trim = world.get::<DroneTrim>(drone).unwrap().flight;
        assert!(
            trim.roll_rad * turn_deg_s < 0.0,
            "a left turn hangs the left wing"
        );
        // The start as the engine has it, in the words of the other frame.
        let attitude = world.get::<Attitude>(drone).unwrap().0;
        let flip = |v: DVec3| DVec3::new(v.x, -v.y, -v.z);
        let through = world.get::<Velocity>(drone).unwrap().0;
        let body = flip(attitude.conjugate() * through);
        let nose = flip(attitude * DVec3::X);
        let right = flip(attitude * DVec3::NEG_Y);
        let down = flip(attitude * DVec3::NEG_Z);
        let start = State {
            position: DVec3::new(0.0, 0.0, -54_000.0),
            velocity: body,
            // phi, theta, psi of the rows of the rotation matrix (Beard and McLain, eq. 2.5).
            angles: DVec3::new(
                right.z.atan2(down.z),
                (-nose.z).asin(),
                nose.y.atan2(nose.x),
            ),
            rate: flip(world.get::<AngularVelocity>(drone).unwrap().0),
        };
        let mut results = MemorySink::default();
        let summary = simulation.run(&mut results, &mut |_| {});
        assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
        let apart = fly_apart(start, &controls, (1.03, 8.87), gust, &[1.0, 3.0, 10.0]);
        for (time_s, state) in apart {
            let off_m = (flip(position(&results, "drone", time_s)) - state.position).length();
            assert_below(&format!("position at {time_s} s, m"), off_m, 1e-6);
            let rows = &frame_at(&results, time_s).states;
            let (_, rate) = rows[0].rotation.unwrap();
            let off = (flip(rate) - state.rate).length();
            assert_below(&format!("rates at {time_s} s, rad/s"), off, 1e-8);
        }
    }
}

/// Nothing moves a drone in trim.
#[test]
fn a_drone_in_trim_stays_in_it() {
    let results = fly_text(FREE, &["run.duration_s=20"]);
    let (first, last) = (
        velocity(&results, "drone", 0.0),
        velocity(&results, "drone", 20.0),
    );
    assert_below("velocity, m/s", (first - last).length(), 1e-7);
    let way = position(&results, "drone", 20.0) - DVec3::new(500.0, 0.0, 54_000.0);
    assert_below("way, m", way.length(), 1e-6);
}

/// What the air and the motor do is all that changes the energy.
#[test]
fn energy_less_work_is_kept() {
    let record = "run.record=(channels: Only({\"system\": [\"mechanical_energy_j\", \
                  \"nonconservative_work_j\"]}))";
    let results = fly_text(FREE, &[GUST, record]);
    let left = |time_s| {
        let frame = frame_at(&results, time_s);
        channel(frame, "system", "mechanical_energy_j")
            - channel(frame, "system", "nonconservative_work_j")
    };
    let moved = channel(frame_at(&results, 10.0), "system", "nonconservative_work_j").abs();
    assert!(moved > 100.0, "{moved} J");
    assert_below("energy less work, J", (left(10.0) - left(0.0)).abs(), 1e-6);
}

/// All coefficients of the Aerosonde, the torque of its propeller as given.
fn written_out(reaction: bool) -> String {
    format!(
        "entities.drone.FixedWing.aircraft=Coefficients(\
         geometry: (wing_area_m2: 0.55, span_m: 2.8956, chord_m: 0.18994), \
         longitudinal: (lift_zero: 0.23, lift_alpha: 5.61, lift_q: 7.95, lift_elevator: 0.13, \
         drag: Line(zero: 0.043, alpha: 0.03), drag_elevator: 0.0135, pitch_zero: 0.0135, \
         pitch_alpha: -2.74, pitch_q: -38.21, pitch_elevator: -0.99, stall_rad: 0.47, stall_sharpness: 50), \
         lateral: (side: (beta: -0.98, aileron: 0.075, rudder: 0.19), \
         roll: (beta: -0.13, p: -0.51, r: 0.25, aileron: 0.17, rudder: 0.0024), \
         yaw: (beta: 0.073, p: -0.069, r: -0.095, aileron: -0.011, rudder: -0.069)), \
         propulsion: (diameter_m: 0.508, thrust: (0.09357, -0.06044, -0.1079), \
         torque: (0.00523, 0.00497, -0.01664), motor_constant_v_s: 0.06585722, resistance_ohm: 0.042, \
         no_load_current_a: 1.5, battery_v: 44.4, reaction: {reaction}))"
    )
}

/// Coefficients written out fly as the aircraft that is known by name; without the torque of the propeller a
/// flight and its mirror image are mirror images.
#[test]
fn written_coefficients_and_mirror_images() {
    let turn = |side: f64| {
        format!(
            "entities.drone.FixedWing.start=Trim(airspeed_m_s: 24, course_deg: {:?}, turn_deg_s: {:?})",
            30.0 * side,
            7.0 * side
        )
    };
    let named = fly_text(FREE, &[&turn(1.0)]);
    let written = fly_text(FREE, &[&turn(1.0), &written_out(true)]);
    assert_eq!(
        position(&named, "drone", 10.0),
        position(&written, "drone", 10.0)
    );
    let symmetric = written_out(false);
    let left = fly_text(FREE, &[&turn(1.0), &symmetric]);
    let right = fly_text(FREE, &[&turn(-1.0), &symmetric]);
    let (left, right) = (
        position(&left, "drone", 10.0),
        position(&right, "drone", 10.0),
    );
    let off = (left - DVec3::new(right.x, -right.y, right.z)).length();
    assert_below("mirror image, m", off, 1e-7);
    assert!(left.y > 50.0, "{left}");
}

/// A drone that hangs from nothing is a tree of its own among rigid links.
#[test]
fn both_formulations_fly_the_same() {
    let lumped = fly_text(FREE, &[GUST]);
    let links = fly_text(FREE, &[GUST, "run.formulation=Denoc"]);
    let off = position(&lumped, "drone", 10.0) - position(&links, "drone", 10.0);
    assert_below("formulations, m", off.length(), 1e-6);
}

const GUSTS: &str = "environment.wind=[Uniform(velocity_m_s: (60, 5, 0)), Gust(\
    zonal: (decay_per_s: 0.2, frequency_rad_s: 0.5, marginal: Normal(standard_deviation_m_s: 1)), \
    meridional: (decay_per_s: 0.2, frequency_rad_s: 0.5, marginal: Normal(standard_deviation_m_s: 1)), \
    vertical: (decay_per_s: 0.2, frequency_rad_s: 0.5, marginal: Normal(standard_deviation_m_s: 0.7)))]";
const AUTO: &str = "run.integrator=Auto(accuracy_m: 1e-3)";

/// Altitude within 2 m rms, course through the mean air within 2 deg rms, airspeed within 0.6 m/s rms, in gusts of
/// 1 m/s along the horizontal and 0.7 m/s along the vertical, after 30 s, for three seeds.
#[test]
fn altitude_course_and_airspeed_are_held_in_gusts() {
    let hold = "entities.drone.FixedWing.guidance=Hold(course_deg: 20, altitude_m: 54020, airspeed_m_s: 26)";
    for seed in ["run.seed=1", "run.seed=2", "run.seed=3"] {
        let overrides = [GUSTS, AUTO, hold, seed, "run.duration_s=150"];
        let results = fly_text(FREE, &overrides);
        let (mut altitude, mut course, mut airspeed, mut count) = (0.0, 0.0, 0.0, 0.0);
        for frame in results.frames.iter().filter(|frame| frame.time_s >= 30.0) {
            let row = &frame.states[0];
            let mean = DVec3::new(60.0, 5.0, 0.0);
            let path = row.velocity_m_s - mean;
            let off = path.y.atan2(path.x).to_degrees() - 20.0;
            let speed = channel(frame, "drone", "air_relative_speed_m_s") - 26.0;
            altitude += (row.position_m.z - 54_020.0).powi(2);
            course += off * off;
            airspeed += speed * speed;
            count += 1.0;
        }
        let rms = |sum: f64| (sum / count).sqrt();
        assert_below("altitude, m rms", rms(altitude), 2.0);
        assert_below("course, deg rms", rms(course), 2.0);
        assert_below("airspeed, m/s rms", rms(airspeed), 0.6);
    }
}

/// Distance of the drone from a moving line and a moving orbit, in a wind, at the end.
#[test]
fn moving_lines_and_orbits_are_followed() {
    let wind = "environment.wind=[Uniform(velocity_m_s: (6, -4, 0))]";
    let line = "entities.drone.FixedWing.guidance=Line(through: Point(position_m: (0, 150, 54030), \
                velocity_m_s: (2, 3, 0.5)), along: (3, 4, 0), airspeed_m_s: 25)";
    let results = fly_text(FREE, &[wind, AUTO, line, "run.duration_s=60"]);
    let through = DVec3::new(0.0, 150.0, 54_030.0) + 60.0 * DVec3::new(2.0, 3.0, 0.5);
    let off = position(&results, "drone", 60.0) - through;
    assert_below(
        "across the line, m",
        off.dot(DVec3::new(-0.8, 0.6, 0.0)).abs(),
        0.2,
    );
    assert_below("above the line, m", off.z.abs(), 0.2);

    let orbit = "entities.drone.FixedWing.guidance=Orbit(about: Point(position_m: (100, 200, 54000), \
                 velocity_m_s: (3, -2, 0)), radius_m: 150, airspeed_m_s: 25)";
    let results = fly_text(FREE, &[wind, AUTO, orbit, "run.duration_s=120"]);
    for time_s in [90.0, 100.0, 110.0, 120.0] {
        let centre = DVec3::new(100.0, 200.0, 54_000.0) + time_s * DVec3::new(3.0, -2.0, 0.0);
        let off = position(&results, "drone", time_s) - centre;
        assert_below(
            "off the orbit, m",
            (off.truncate().length() - 150.0).abs(),
            0.2,
        );
        // Its roll grows and falls along an orbit that moves through the air, and height with it.
        assert_below("above the orbit, m", off.z.abs(), 1.0);
    }
}

/// A target that flies straight at a speed of its own, and a drone that is sent after it.
fn pursue(target_m_s: &str, more: &str, overrides: &[&str]) -> (MemorySink, Summary) {
    let text = FREE.replace(
        "\"drone\": (",
        &format!(
            "\"target\": (Moving: (position_m: (150, 40, 54015), velocity_m_s: {target_m_s})),\n\"drone\": ("
        ),
    );
    let guidance = format!("entities.drone.FixedWing.guidance=Pursue(target: \"target\", {more})");
    let overrides = [&[AUTO, guidance.as_str(), "run.duration_s=60"], overrides].concat();
    summary_of(&text, &overrides)
}

fn told(summary: &Summary) -> Vec<&str> {
    let events = summary.events.iter();
    events.map(|event| event.kind.as_str()).collect()
}

#[test]
fn the_end_game_meets_a_target_that_flies_on() {
    let more = "end_game: (within_m: 120, airspeed_m_s: 27)";
    let (results, summary) = pursue("(18, 2, 0.5)", more, &["run.output_every_s=0.01"]);
    assert_eq!(told(&summary), ["end game", "target passed"]);
    let ranges = results.channel("drone", "range_m");
    let closest = ranges
        .iter()
        .map(|(_, range)| *range)
        .fold(f64::INFINITY, f64::min);
    assert_below("closest, m", closest, 0.5);
    let last = results.frames.last().unwrap();
    assert_eq!(channel(last, "drone", "chase_state"), 4.0);
}

/// Targets that cannot be reached: what is told, once, and a flight that goes on without a stall.
#[test]
fn unreachable_targets_are_said_to_be() {
    let climbing = ["entities.drone.FixedWing.autopilot=(pitch_limit_deg: 30)"];
    for (target_m_s, overrides, reason) in [
        (
            "(40, 0, 0)",
            &[][..],
            "faster than the drone in level flight",
        ),
        ("(5, 0, 0)", &[], "slower than the drone can fly"),
        ("(24, 0, 9)", &climbing, "out of thrust"),
    ] {
        let (results, summary) = pursue(target_m_s, "offset_m: (-20, 0, 0)", overrides);
        let told = told(&summary);
        println!("{target_m_s}: {told:?}");
        assert_eq!(
            told,
            [format!("target unreachable: {reason}")],
            "{target_m_s}"
        );
        let last = results.frames.last().unwrap();
        assert_eq!(channel(last, "drone", "chase_state"), 2.0);
        let airspeed = channel(last, "drone", "air_relative_speed_m_s");
        assert!((13.9..33.0).contains(&airspeed), "{airspeed}");
    }
}

/// The chase of the paper: y and z go to zero and x to the station in the drone's own wind; in the gondola's
/// and in still air the target is out of reach, and said to be.
#[test]
fn the_gondola_is_chased_as_the_paper_shows() {
    let flights = fly(&Simulator::new(), &Settings::default(), &mut |_, _| {}).unwrap();
    let of = |air| flights.iter().find(|flight| flight.air == air).unwrap();
    let own = of(DroneAir::Own);
    assert!(own.stopped.is_none());
    let (first, last) = (own.rows.first().unwrap(), own.rows.last().unwrap());
    println!("{first:?}\n{last:?}\n{:?}", own.events);
    assert!(first.error_m.x < -100.0 && first.error_m.y.abs() > 20.0);
    assert!(last.gondola_y_m < -3.0, "the sail has moved the gondola");
    assert_below("x, m", (last.error_m.x + 30.0).abs(), 0.5);
    assert_below("y, m", last.error_m.y.abs(), 0.3);
    assert_below("z, m", last.error_m.z.abs(), 0.3);
    assert_eq!(last.state, 1.0);
    // The scene says what the drone's wind is: the gondola's steady velocity less 25 m/s.
    assert_below(
        "airspeed asked for",
        (first.required_m_s - 25.0).abs(),
        0.02,
    );

    let gondolas = of(DroneAir::Gondolas);
    assert!(gondolas.gondola_through_air_m_s < gondolas.level_m_s.0);
    assert!(
        gondolas.events[0]
            .1
            .contains("slower than the drone can fly")
    );
    let still = of(DroneAir::Still);
    assert!(still.gondola_m_s > still.level_m_s.1);
    assert!(still.events[0].1.contains("faster than the drone"));
    for flight in [gondolas, still] {
        assert!(flight.stopped.is_none());
        assert_eq!(flight.rows.last().unwrap().state, 2.0);
    }
}

/// The scene starts in the steady state of balloon, tether and gondola, and that state has the drone's speed.
#[test]
fn the_scene_of_the_chase_starts_in_its_steady_state() {
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file("paper/mav_chase.ron"), &owned(&[]))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    let before = simulation.world();
    let gondola = before.resource::<SceneEntities>().get("gondola").unwrap();
    let started = before.get::<Velocity>(gondola).unwrap().0;
    let trim = simulation.trim(&scene).unwrap_or_else(|e| panic!("{e}"));
    let settled = trim.body("gondola").unwrap();
    assert_below(
        "velocity, m/s",
        (settled.velocity_m_s - started).length(),
        1e-6,
    );
    assert!(trim.body("drone").is_none());
    assert!(
        trim.notes
            .iter()
            .any(|note| note.contains("trim of `drone`"))
    );
    let drone: &FixedWing = scene.entity("drone").unwrap().get().unwrap();
    let wind_m_s = drone.wind.velocity_m_s(DVec3::ZERO);
    let cruise = settled.velocity_m_s - wind_m_s - DVec3::new(25.0, 0.0, 0.0);
    assert_below("cruise, m/s", cruise.length(), 1e-5);
}
