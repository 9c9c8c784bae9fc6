//! Small motions about a trimmed flight: x' = A x + B u, and transfer functions with loops closed.
//!
//! ```text
//! x = (u, v, w, p, q, r, phi, theta, psi, h)     u = (aileron, elevator, rudder, throttle)
//! G(s) = c (s I - A + sum b_i k_i(s) c_i)^-1 b
//! ```
//!
//! u, v, w velocity through the air and p, q, r rates (m/s, rad/s, forward-right-down), phi, theta, psi roll,
//! pitch, yaw (rad), h altitude (m); s complex frequency (rad/s); b a column of B, c a row that reads an
//! output; k_i(s) the gain from the output c_i to the input b_i of a loop that is closed. A and B are central
//! differences of the equations of motion (Beard and McLain, eqs. 5.1 to 5.12), so that nothing of the
//! coupling between the axes is left out. Assumptions: steady air of the density of the trim.

use aerobot_components::fixed_wing::controls::Controls;
use glam::DVec3;
use nalgebra::{Complex, SMatrix, SVector};

use super::flight_trim::{Flier, TrimmedFlight};
use super::north_east_down::from_roll_pitch_yaw;

/// States of the model.
pub const STATES: usize = 10;
/// A state, or a row that reads an output.
pub type Row = [f64; STATES];

/// An input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Aileron, rad.
    Aileron,
    /// Elevator, rad.
    Elevator,
    /// Rudder, rad.
    Rudder,
    /// Throttle.
    Throttle,
}

/// An output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Rate of roll, rad/s.
    RollRate,
    /// Rate of pitch, rad/s.
    PitchRate,
    /// Rate of yaw, rad/s.
    YawRate,
    /// Roll, rad.
    Roll,
    /// Pitch, rad.
    Pitch,
    /// Course through the air, to the right, rad.
    Course,
    /// Altitude, m.
    Altitude,
    /// Airspeed, m/s.
    Airspeed,
}

/// A loop that is closed: input = -gain x output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// What it moves.
    pub input: Input,
    /// What it reads.
    pub output: Output,
    /// Its gain at the frequency in question.
    pub gain: Complex<f64>,
}

/// The linear model about one trim.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModel {
    /// A, by rows.
    pub a: [Row; STATES],
    /// B, by columns: aileron, elevator, rudder, throttle.
    pub b: [Row; 4],
    course: Row,
    airspeed: Row,
}

impl LinearModel {
    /// The model about a trim.
    #[must_use]
    pub fn about(flier: &Flier, trim: &TrimmedFlight) -> Self {
        let (velocity, rate) = (trim.velocity_m_s(), trim.rate_rad_s);
        let state: Row = [
            velocity.x,
            velocity.y,
            velocity.z,
            rate.x,
            rate.y,
            rate.z,
            trim.roll_rad,
            trim.pitch_rad,
            0.0,
            0.0,
        ];
        let mut model = Self {
            a: [[0.0; STATES]; STATES],
            b: [[0.0; STATES]; 4],
            course: [0.0; STATES],
            airspeed: [0.0; STATES],
        };
        for column in 0..STATES {
            let at = |sign: f64| {
                let mut moved = state;
                moved[column] += sign * DIFFERENCE;
                moved
            };
            let (above, below) = (at(1.0), at(-1.0));
            let slopes = slope(
                rates(flier, &above, &trim.controls),
                rates(flier, &below, &trim.controls),
            );
            for (row, slope) in model.a.iter_mut().zip(slopes) {
                row[column] = slope;
            }
            model.course[column] = (course_rad(&above) - course_rad(&below)) / (2.0 * DIFFERENCE);
            model.airspeed[column] =
                (velocity_of(&above).length() - velocity_of(&below).length()) / (2.0 * DIFFERENCE);
        }
        for (column, b) in model.b.iter_mut().enumerate() {
            let at = |sign: f64| {
                let mut moved = trim.controls;
                let control = match column {
                    0 => &mut moved.aileron_rad,
                    1 => &mut moved.elevator_rad,
                    2 => &mut moved.rudder_rad,
                    _ => &mut moved.throttle,
                };
                *control += sign * DIFFERENCE;
                rates(flier, &state, &moved)
            };
            *b = slope(at(1.0), at(-1.0));
        }
        model
    }

    /// The row that reads an output.
    #[must_use]
    pub fn row(&self, output: Output) -> Row {
        let unit = |place: usize| std::array::from_fn(|i| f64::from(u8::from(i == place)));
        match output {
            Output::RollRate => unit(3),
            Output::PitchRate => unit(4),
            Output::YawRate => unit(5),
            Output::Roll => unit(6),
            Output::Pitch => unit(7),
            Output::Course => self.course,
            Output::Altitude => unit(9),
            Output::Airspeed => self.airspeed,
        }
    }

    /// Transfer function from an input to outputs at the frequency s, with loops closed; `None` at a pole.
    #[must_use]
    pub fn transfer(
        &self,
        s: Complex<f64>,
        loops: &[Feedback],
        input: Input,
        outputs: &[Output],
    ) -> Option<Vec<Complex<f64>>> {
        let mut matrix = SMatrix::<Complex<f64>, STATES, STATES>::from_fn(|row, column| {
            Complex::from(-self.a[row][column])
        });
        for i in 0..STATES {
            matrix[(i, i)] += s;
        }
        for feedback in loops {
            let (b, c) = (&self.b[feedback.input as usize], self.row(feedback.output));
            for (row, b) in b.iter().enumerate() {
                for (column, c) in c.iter().enumerate() {
                    matrix[(row, column)] += feedback.gain * (b * c);
                }
            }
        }
        let b = &self.b[input as usize];
        let right = SVector::<Complex<f64>, STATES>::from_fn(|row, _| Complex::from(b[row]));
        let state = matrix.lu().solve(&right)?;
        let read = |output: &Output| {
            let row = self.row(*output);
            row.iter().zip(&state).map(|(c, x)| x * *c).sum()
        };
        Some(outputs.iter().map(read).collect())
    }
}

/// Step of differences, in the unit of what is moved.
const DIFFERENCE: f64 = 1e-5;

fn slope(above: Row, below: Row) -> Row {
    std::array::from_fn(|i| (above[i] - below[i]) / (2.0 * DIFFERENCE))
}

fn velocity_of(x: &Row) -> DVec3 {
    DVec3::new(x[0], x[1], x[2])
}

/// Velocity through the air, north-east-down.
fn over_ground(x: &Row) -> DVec3 {
    from_roll_pitch_yaw(DVec3::new(x[6], x[7], x[8])) * velocity_of(x)
}

fn course_rad(x: &Row) -> f64 {
    let velocity = over_ground(x);
    libm::atan2(velocity.y, velocity.x)
}

/// x' of the equations of motion.
fn rates(flier: &Flier, x: &Row, controls: &Controls) -> Row {
    let rate = DVec3::new(x[3], x[4], x[5]);
    let (linear, angular) = flier.accelerations(velocity_of(x), rate, (x[6], x[7]), controls);
    let (sin_roll, cos_roll) = libm::sincos(x[6]);
    let (sin_pitch, cos_pitch) = libm::sincos(x[7]);
    let about_down = rate.y * sin_roll + rate.z * cos_roll;
    [
        linear.x,
        linear.y,
        linear.z,
        angular.x,
        angular.y,
        angular.z,
        rate.x + about_down * sin_pitch / cos_pitch,
        rate.y * cos_roll - rate.z * sin_roll,
        about_down / cos_pitch,
        -over_ground(x).z,
    ]
}
