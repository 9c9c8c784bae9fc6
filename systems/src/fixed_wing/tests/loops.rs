//! Every loop of the autopilot against the bandwidth and damping it was asked for, as measured on the response
//! of the nonlinear, sampled flight to a step of its command.

use aerobot_components::fixed_wing::autopilot::{AutopilotSpec, LoopSpec};
use nalgebra::{Complex, DMatrix, DVector};

use super::flight::{Flight, aerosonde};
use crate::fixed_wing::autopilot::{Command, LateralCommand, VerticalCommand, course_rad};
use crate::fixed_wing::gains::exponential;
use crate::fixed_wing::north_east_down::from_roll_pitch_yaw;

const AIRSPEED_M_S: f64 = 25.0;

/// Which loop gets the step; the loops inside it are closed, those outside of it open.
#[derive(Clone, Copy, Debug)]
enum Stepped {
    Roll,
    Course,
    Pitch,
    Altitude,
    Airspeed,
}

/// The response to a small step, every period.
fn response(spec: AutopilotSpec, stepped: Stepped, duration_s: f64) -> Vec<f64> {
    let mut flight = Flight::starting_at(aerosonde(1.03, 8.87), AIRSPEED_M_S, spec);
    let trim = flight.autopilot().trim;
    let mut command = Command {
        lateral: LateralCommand::Roll(trim.roll_rad),
        vertical: VerticalCommand::Pitch(trim.pitch_rad),
        airspeed_m_s: AIRSPEED_M_S,
    };
    match stepped {
        Stepped::Roll => command.lateral = LateralCommand::Roll(trim.roll_rad + 0.01),
        Stepped::Course => command.lateral = LateralCommand::Course(0.005, 0.0),
        Stepped::Pitch => command.vertical = VerticalCommand::Pitch(trim.pitch_rad + 0.005),
        Stepped::Altitude => command.vertical = VerticalCommand::Altitude(0.2, 0.0),
        Stepped::Airspeed => command.airspeed_m_s += 0.05,
    }
    let read = |flight: &Flight| {
        let state = &flight.state;
        match stepped {
            Stepped::Roll => state.angles.x - trim.roll_rad,
            Stepped::Course => course_rad(from_roll_pitch_yaw(state.angles) * state.velocity),
            Stepped::Pitch => state.angles.y - trim.pitch_rad,
            Stepped::Altitude => -state.position.z,
            Stepped::Airspeed => state.velocity.length() - AIRSPEED_M_S,
        }
    };
    (0..(duration_s / spec.period_s).round() as usize)
        .map(|_| {
            flight.sample(&command);
            read(&flight)
        })
        .collect()
}

/// The pole of a series sampled every `interval_s` that is nearest to `guess`: the linear recurrence of `order`
/// that the series fulfils best (Prony), and the root of its polynomial that Newton's method finds from there.
fn measured_pole(
    series: &[f64],
    interval_s: f64,
    order: usize,
    guess: Complex<f64>,
) -> Complex<f64> {
    // Differences, so that a constant is no mode.
    let steps: Vec<f64> = series.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rows = steps.len() - order;
    let matrix = DMatrix::from_fn(rows, order, |row, k| steps[row + order - 1 - k]);
    let right = DVector::from_fn(rows, |row, _| steps[row + order]);
    let c = matrix.svd(true, true).solve(&right, 1e-13).unwrap();
    let mut z = exponential(guess * interval_s);
    for _ in 0..100 {
        // Horner, for z^n - c_1 z^(n-1) - .. and its derivative.
        let (mut value, mut slope) = (Complex::from(1.0), Complex::from(0.0));
        for coefficient in c.iter() {
            slope = slope * z + value;
            value = value * z - coefficient;
        }
        z -= value / slope;
    }
    Complex::new(z.norm().ln(), z.arg()) / interval_s
}

/// Natural frequency and damping of every loop, of the shipped bandwidths and of others, within 1 % and 0.01.
#[test]
fn every_loop_has_the_bandwidth_and_damping_it_is_asked_for() {
    let shipped = AutopilotSpec {
        // The ramp on the way to an altitude is no part of the loop.
        climb_limit_m_s: 1e6,
        ..AutopilotSpec::default()
    };
    let mut other = shipped;
    let with = |frequency_rad_s, damping| LoopSpec {
        frequency_rad_s,
        damping,
    };
    other.roll = with(14.0, 0.8);
    other.course = with(0.7, 0.7);
    other.pitch = with(24.0, 0.8);
    other.altitude = with(0.5, 0.8);
    other.airspeed = with(2.0, 0.7);
    for spec in [shipped, other] {
        for (stepped, asked) in [
            (Stepped::Roll, spec.roll),
            (Stepped::Course, spec.course),
            (Stepped::Pitch, spec.pitch),
            (Stepped::Altitude, spec.altitude),
            (Stepped::Airspeed, spec.airspeed),
        ] {
            let w = asked.frequency_rad_s;
            let interval_s = (0.25 / w / spec.period_s).ceil() * spec.period_s;
            let every = (interval_s / spec.period_s).round() as usize;
            let series = response(spec, stepped, 12.0 / w);
            let series: Vec<f64> = series.into_iter().step_by(every).collect();
            let guess = Complex::new(
                -asked.damping * w,
                w * (1.0 - asked.damping * asked.damping).sqrt(),
            );
            // Modes that are seen beside the pair of the loop: three to five.
            let pole = measured_pole(&series, interval_s, 7, guess);
            let frequency = pole.norm();
            let damping = -pole.re / frequency;
            println!(
                "{stepped:?}: {frequency:.4} rad/s, damping {damping:.4}; asked {w}, {}",
                asked.damping
            );
            assert!((frequency / w - 1.0).abs() < 0.01, "{stepped:?}");
            assert!((damping - asked.damping).abs() < 0.01, "{stepped:?}");
        }
    }
}
