//! Shooting: from a guess of the body's altitude along the line to its top, and the altitude of the
//! body for which the top comes out where it is held.

use super::bracketed_root::{self, Sample};
use super::runge_kutta::{Integration, Obstacle, Steps};
use super::{Conditions, Surroundings, TowedCable, TowedCableError};

/// Error of a step of the integration, in parts of the length, of the tension at the body and of 1 rad.
const STEP_TOLERANCE: f64 = 1e-13;
/// First and longest step, in parts of the length: a layer of wind is not stepped over unseen.
const FIRST_STEP: f64 = 1e-4;
const LONGEST_STEP: f64 = 1.0 / 128.0;
/// Steps below this part of the length are too short to go on with.
const SHORTEST_STEP: f64 = 1e-13;
/// Tension below which a line that cannot be followed is slack, in parts of the tension at the body.
const SLACK: f64 = 1e-6;
/// Width of the last bracket, in parts of the length.
const BRACKET_TOLERANCE: f64 = 1e-13;
/// Distance of the top from where it is held that is accepted, in parts of the length.
const MISS_TOLERANCE: f64 = 1e-10;
/// Strides of the search for a change of sign, in parts of the length, and how many of them: a line
/// may stretch to many times its length.
const STRIDE: f64 = 1.0 / 16.0;
const STRIDES: u32 = 16 * 16;

/// The line at one place, seen from the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) x_m: f64,
    pub(super) above_body_m: f64,
    pub(super) tension_n: f64,
    pub(super) angle_rad: f64,
}

impl State {
    fn from_array([x_m, above_body_m, tension_n, angle_rad]: [f64; 4]) -> Self {
        Self {
            x_m,
            above_body_m,
            tension_n,
            angle_rad,
        }
    }

    fn to_array(self) -> [f64; 4] {
        [self.x_m, self.above_body_m, self.tension_n, self.angle_rad]
    }
}

/// A towed cable in its surroundings.
pub(super) struct Shooting<'a> {
    pub(super) cable: &'a TowedCable,
    pub(super) surroundings: &'a dyn Surroundings,
}

impl Shooting<'_> {
    /// The altitude of the body in equilibrium, m.
    pub(super) fn body_altitude_m(&self) -> Result<f64, TowedCableError> {
        let top_m = self.cable.top_altitude_m;
        let length_m = self.cable.line.length_m;
        let (low, high) = self.bracket()?;
        let tolerance = (BRACKET_TOLERANCE * length_m).max(2.0 * f64::EPSILON * top_m.abs());
        let found = bracketed_root::find(low, high, tolerance, &mut |place| self.miss_m(place))?;
        if found.value.abs() <= MISS_TOLERANCE * length_m {
            Ok(found.place)
        } else if found.value.is_finite() {
            // The body's drag jumps there from too little to too much.
            Err(TowedCableError::NoEquilibrium {
                lowest_m: low.place,
                highest_m: high.place,
            })
        } else {
            // The line leaves the known air one way from here and the other way from just beside it.
            Err(TowedCableError::Unknown {
                altitude_m: found.place,
            })
        }
    }

    /// Strides from the top, downwards if a body there would be too high, to the first change of sign.
    ///
    /// From there and not from the depth of the straight line, which the line may never come near:
    /// the air is dense and the wind strong there.
    fn bracket(&self) -> Result<(Sample, Sample), TowedCableError> {
        let top_m = self.cable.top_altitude_m;
        let sample = |place: f64| {
            let value = self.miss_m(place)?;
            Ok(Sample { place, value })
        };
        let mut near = sample(top_m)?;
        let stride_m = STRIDE * self.cable.line.length_m * -f64::signum(near.value);
        for count in 1..=STRIDES {
            let far = sample(top_m + f64::from(count) * stride_m)?;
            if far.value * stride_m >= 0.0 {
                return Ok(if stride_m < 0.0 {
                    (far, near)
                } else {
                    (near, far)
                });
            }
            near = far;
        }
        Err(TowedCableError::NoEquilibrium {
            lowest_m: top_m.min(near.place),
            highest_m: top_m.max(near.place),
        })
    }

    /// How far above its place the top comes out for a body at an altitude, m; infinite where the
    /// line leaves the known air, with the sign of where it leaves it.
    fn miss_m(&self, body_altitude_m: f64) -> Result<f64, TowedCableError> {
        let top_m = self.cable.top_altitude_m;
        match self.fly(body_altitude_m, &[]) {
            Ok((_, _, end)) => Ok(body_altitude_m - top_m + end.above_body_m),
            Err(TowedCableError::Unknown { altitude_m }) if altitude_m > top_m => Ok(f64::INFINITY),
            Err(TowedCableError::Unknown { .. }) => Ok(f64::NEG_INFINITY),
            Err(error) => Err(error),
        }
    }

    /// Follows the line from a body at an altitude to the top: the state at the body, at `stops`
    /// (arc lengths from the body in m, not decreasing), and at the top.
    pub(super) fn fly(
        &self,
        body_altitude_m: f64,
        stops: &[f64],
    ) -> Result<(State, Vec<State>, State), TowedCableError> {
        let length_m = self.cable.line.length_m;
        let start = self.at_body(body_altitude_m)?;
        let tolerance = [
            STEP_TOLERANCE * length_m,
            STEP_TOLERANCE * length_m,
            STEP_TOLERANCE * start.tension_n,
            STEP_TOLERANCE,
        ];
        let steps = Steps {
            first: FIRST_STEP * length_m,
            longest: LONGEST_STEP * length_m,
            shortest: SHORTEST_STEP * length_m,
        };
        let mut run = Integration::new(start.to_array(), tolerance, steps);
        let mut slopes = |state: &[f64; 4]| self.slopes(body_altitude_m, State::from_array(*state));
        let mut passed = Vec::with_capacity(stops.len());
        for stop in stops.iter().copied().chain([length_m]) {
            match run.advance_to(stop, &mut slopes) {
                Ok(()) => passed.push(State::from_array(run.state)),
                Err(Obstacle::Derivative(error)) => return Err(error),
                Err(Obstacle::TooShort) => return Err(cannot_follow(&run, start.tension_n)),
            }
        }
        let end = passed.pop().unwrap_or(start);
        Ok((start, passed, end))
    }

    /// The end of the line that carries the body.
    fn at_body(&self, altitude_m: f64) -> Result<State, TowedCableError> {
        let body = &self.cable.body;
        let air = self.conditions(altitude_m)?;
        let dynamic = 0.5 * air.density_kg_m3 * air.wind_m_s * air.wind_m_s.abs();
        let drag_n = dynamic * body.drag_area_m2;
        let weight_n =
            (body.mass_kg - air.density_kg_m3 * body.displaced_volume_m3) * air.gravity_m_s2;
        let tension_n = libm::hypot(drag_n, weight_n);
        if tension_n > 0.0 {
            Ok(State {
                x_m: 0.0,
                above_body_m: 0.0,
                tension_n,
                angle_rad: libm::atan2(drag_n, weight_n),
            })
        } else {
            Err(TowedCableError::Slack { from_body_m: 0.0 })
        }
    }

    /// The equations at the head of the module.
    fn slopes(&self, body_altitude_m: f64, state: State) -> Result<[f64; 4], TowedCableError> {
        if state.tension_n <= 0.0 {
            // A step too far, or the end of the taut line: shorter steps will tell.
            return Ok([f64::NAN; 4]);
        }
        let line = &self.cable.line;
        let air = self.conditions(body_altitude_m + state.above_body_m)?;
        let (sin, cos) = libm::sincos(state.angle_rad);
        let stretch = 1.0 + state.tension_n / line.axial_stiffness_n;
        let weight_n_m = line.mass_per_length_kg_m * air.gravity_m_s2;
        let pressure_n_m =
            0.5 * air.density_kg_m3 * line.diameter_m * air.wind_m_s * air.wind_m_s.abs() * stretch;
        let along_n_m =
            std::f64::consts::PI * line.tangential_drag * pressure_n_m * sin * sin.abs();
        let across_n_m = line.normal_drag * pressure_n_m * cos * cos.abs();
        Ok([
            -stretch * sin,
            stretch * cos,
            weight_n_m * cos + along_n_m,
            (across_n_m - weight_n_m * sin) / state.tension_n,
        ])
    }

    fn conditions(&self, altitude_m: f64) -> Result<Conditions, TowedCableError> {
        self.surroundings
            .at(altitude_m)
            .ok_or(TowedCableError::Unknown { altitude_m })
    }
}

/// What it means that steps became too short.
fn cannot_follow(run: &Integration<4>, tension_at_body_n: f64) -> TowedCableError {
    let from_body_m = run.place;
    if State::from_array(run.state).tension_n < SLACK * tension_at_body_n {
        TowedCableError::Slack { from_body_m }
    } else {
        TowedCableError::TooAbrupt { from_body_m }
    }
}
