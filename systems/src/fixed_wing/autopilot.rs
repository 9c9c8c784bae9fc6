//! The autopilot: what the controls are from one sample to the next.
//!
//! ```text
//! aileron  = aileron*  + k_p (phi_c - phi) - k_d p         phi_c   = phi_t + k_p (chi_c - chi) + k_i int
//! elevator = elevator* + k_p (theta_c - theta) - k_d q     theta_c = theta* + k_p (h_c - h) + k_i int
//! throttle = throttle* + k_p (V_c - V) + k_i int           rudder  = rudder* + k (r - r_slow)
//! phi_t    = atan(V chi_c'/g)
//! ```
//!
//! Starred values are those of trim; phi, theta roll and pitch (rad), p, q, r rates (rad/s), chi course through
//! the steady air (rad), h altitude (m), V airspeed (m/s); r_slow is r through a low pass, so that the rudder
//! damps what is fast and leaves a turn alone; chi_c' rate at which the course asked for turns. Forward-right-down
//! and north-east-down. Source: Beard and McLain (2012), ch. 6.
//!
//! Integrals are of the trapezium, and stand still while what they feed is at a limit and would be driven further.
//! An altitude far away is approached at a limited rate of climb. Where the throttle is open and the airspeed below
//! what is safe, speed goes before height: the largest pitch is taken back, by 5 deg/s, until it is not.
//!
//! Assumptions: the drone knows its state, its airspeed, and the wind averaged over a time.

use std::f64::consts::{PI, TAU};

use aerobot_components::fixed_wing::aircraft::SurfaceLimits;
use aerobot_components::fixed_wing::autopilot::AutopilotSpec;
use aerobot_components::fixed_wing::controls::Controls;
use glam::{DQuat, DVec3};

use super::flight_trim::TrimmedFlight;
use super::gains::Gains;
use super::north_east_down::roll_pitch_yaw;

/// Rate at which the largest pitch is taken back, rad/s.
const HOLDING_BACK_RAD_S: f64 = 0.087;

/// What the autopilot senses, forward-right-down and north-east-down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    /// Attitude, body to inertial.
    pub attitude: DQuat,
    /// Rates, rad/s.
    pub rate_rad_s: DVec3,
    /// Velocity over the ground, m/s.
    pub velocity_m_s: DVec3,
    /// Velocity of the air at the drone, m/s.
    pub wind_m_s: DVec3,
    /// Altitude, m.
    pub altitude_m: f64,
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
}

/// What it is asked for along the horizontal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LateralCommand {
    /// A roll, rad.
    Roll(f64),
    /// A course through the steady air, rad, that turns at a rate, rad/s.
    Course(f64, f64),
}

/// What it is asked for along the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VerticalCommand {
    /// A pitch, rad.
    Pitch(f64),
    /// An altitude, m, that changes at a rate, m/s.
    Altitude(f64, f64),
}

/// What it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Along the horizontal.
    pub lateral: LateralCommand,
    /// Along the vertical.
    pub vertical: VerticalCommand,
    /// Airspeed, m/s.
    pub airspeed_m_s: f64,
}

/// What it remembers from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    course: Integral,
    altitude: Integral,
    airspeed: Integral,
    /// Rate of yaw through the low pass, rad/s.
    slow_yaw_rad_s: f64,
    /// The wind that is taken as steady, north-east-down, m/s.
    pub steady_wind_m_s: DVec3,
    /// The altitude that is asked for now, on the way to where it is to be, m.
    altitude_m: Option<f64>,
    /// By how much the largest pitch is taken back for the sake of airspeed, rad.
    held_back_rad: f64,
    /// Whether the pitch asked for is at a limit.
    pub at_pitch_limit: bool,
}

/// The integral of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Integral {
    value: f64,
    last: Option<f64>,
}

impl Integral {
    /// Goes on by a sample; `at_limit` is the sign of the way in which the integral must not grow.
    fn advance(&mut self, error: f64, period_s: f64, at_limit: f64) -> f64 {
        let last = self.last.replace(error).unwrap_or(error);
        if error * at_limit <= 0.0 {
            self.value += 0.5 * (error + last) * period_s;
        }
        self.value
    }
}

/// An autopilot with its gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Autopilot {
    /// Limits and period.
    pub spec: AutopilotSpec,
    /// Gains.
    pub gains: Gains,
    /// The trim about which it works.
    pub trim: TrimmedFlight,
    /// How far surfaces go.
    pub limits: SurfaceLimits,
    /// Airspeed below which speed goes before height, m/s.
    pub safe_airspeed_m_s: f64,
}

impl Memory {
    /// At the start, in a wind in m/s, north-east-down, that counts as steady.
    #[must_use]
    pub fn starting_in(wind_m_s: DVec3) -> Self {
        Self {
            steady_wind_m_s: wind_m_s,
            ..Self::default()
        }
    }

    /// Moves the steady wind towards that of now, over a time in s, by a period in s.
    pub fn average_wind(&mut self, wind_m_s: DVec3, over_s: f64, period_s: f64) {
        let part = 1.0 - libm::exp(-period_s / over_s);
        self.steady_wind_m_s += part * (wind_m_s - self.steady_wind_m_s);
    }
}

/// The course of a velocity, rad, from north to the east.
#[must_use]
pub fn course_rad(velocity_m_s: DVec3) -> f64 {
    libm::atan2(velocity_m_s.y, velocity_m_s.x)
}

/// An angle as it lies in (-pi, pi].
#[must_use]
pub fn wrapped(angle_rad: f64) -> f64 {
    let turned = angle_rad - TAU * ((angle_rad + PI) / TAU).floor();
    if turned == -PI { PI } else { turned }
}

impl Autopilot {
    /// The controls from now to the next sample.
    #[must_use]
    pub fn sample(&self, memory: &mut Memory, sensed: &Sensed, command: &Command) -> Controls {
        let through_air = sensed.velocity_m_s - sensed.wind_m_s;
        let airspeed = through_air.length();
        let angles = roll_pitch_yaw(sensed.attitude);
        let roll_c = self.roll_command(memory, sensed, airspeed, command.lateral);
        self.hold_back(memory, airspeed, command.airspeed_m_s);
        let pitch_c = self.pitch_command(memory, sensed, command.vertical);
        let trim = &self.trim.controls;
        let (gains, rate) = (&self.gains, sensed.rate_rad_s);
        let aileron = trim.aileron_rad + gains.roll.proportional * wrapped(roll_c - angles.x)
            - gains.roll.second * rate.x;
        let elevator = trim.elevator_rad + gains.pitch.proportional * (pitch_c - angles.y)
            - gains.pitch.second * rate.y;
        let limit = |angle_rad: f64, limit_deg: f64| {
            let limit_rad = limit_deg.to_radians();
            angle_rad.clamp(-limit_rad, limit_rad)
        };
        Controls {
            aileron_rad: limit(aileron, self.limits.aileron_deg),
            elevator_rad: limit(elevator, self.limits.elevator_deg),
            rudder_rad: limit(self.rudder(memory, rate.z), self.limits.rudder_deg),
            throttle: self.throttle(memory, command.airspeed_m_s - airspeed),
        }
    }

    fn rudder(&self, memory: &mut Memory, yaw_rad_s: f64) -> f64 {
        let damper = &self.spec.yaw_damper;
        let part = 1.0 - libm::exp(-self.spec.period_s * damper.washout_rad_s);
        memory.slow_yaw_rad_s += part * (yaw_rad_s - memory.slow_yaw_rad_s);
        self.trim.controls.rudder_rad + damper.gain_s * (yaw_rad_s - memory.slow_yaw_rad_s)
    }

    fn throttle(&self, memory: &mut Memory, error_m_s: f64) -> f64 {
        let (gains, trim) = (&self.gains.airspeed, self.trim.controls.throttle);
        let wanted = trim + gains.proportional * error_m_s + gains.second * memory.airspeed.value;
        let beyond = sign_beyond(wanted, 0.0, 1.0);
        let integral = memory
            .airspeed
            .advance(error_m_s, self.spec.period_s, beyond);
        (trim + gains.proportional * error_m_s + gains.second * integral).clamp(0.0, 1.0)
    }

    fn roll_command(
        &self,
        memory: &mut Memory,
        sensed: &Sensed,
        airspeed_m_s: f64,
        command: LateralCommand,
    ) -> f64 {
        let limit = self.spec.roll_limit_deg.to_radians();
        let (course_c, turn) = match command {
            LateralCommand::Roll(roll) => {
                memory.course = Integral::default();
                return roll.clamp(-limit, limit);
            }
            LateralCommand::Course(course, turn) => (course, turn),
        };
        let course = course_rad(sensed.velocity_m_s - memory.steady_wind_m_s);
        let error = wrapped(course_c - course);
        let turning = libm::atan(airspeed_m_s * turn / sensed.gravity_m_s2.max(1e-3));
        let gains = &self.gains.course;
        let base = self.trim.roll_rad + turning + gains.proportional * error;
        let beyond = sign_beyond(base + gains.second * memory.course.value, -limit, limit);
        let integral = memory.course.advance(error, self.spec.period_s, beyond);
        (base + gains.second * integral).clamp(-limit, limit)
    }

    /// Takes back the largest pitch while the throttle is open and the airspeed is not safe.
    fn hold_back(&self, memory: &mut Memory, airspeed_m_s: f64, wanted_m_s: f64) {
        let (gains, trim) = (&self.gains.airspeed, self.trim.controls.throttle);
        let missing_m_s = wanted_m_s - airspeed_m_s;
        let throttle =
            trim + gains.proportional * missing_m_s + gains.second * memory.airspeed.value;
        let starves = throttle >= 1.0 && airspeed_m_s < self.safe_airspeed_m_s;
        let way = if starves { 1.0 } else { -1.0 };
        let step = way * HOLDING_BACK_RAD_S * self.spec.period_s;
        let most = 2.0 * self.spec.pitch_limit_deg.to_radians();
        memory.held_back_rad = (memory.held_back_rad + step).clamp(0.0, most);
    }

    fn pitch_command(&self, memory: &mut Memory, sensed: &Sensed, command: VerticalCommand) -> f64 {
        let (trim, limit) = (self.trim.pitch_rad, self.spec.pitch_limit_deg.to_radians());
        let least = trim - limit;
        let most = (trim + limit - memory.held_back_rad).max(least);
        let (wanted_m, rate_m_s) = match command {
            VerticalCommand::Pitch(pitch) => {
                memory.altitude = Integral::default();
                memory.altitude_m = None;
                memory.at_pitch_limit = sign_beyond(pitch, least, most) != 0.0;
                return pitch.clamp(least, most);
            }
            VerticalCommand::Altitude(altitude, rate) => (altitude, rate),
        };
        let period_s = self.spec.period_s;
        // The way that is asked for moves with the target, and towards it at the limited rate.
        let way = memory.altitude_m.unwrap_or(sensed.altitude_m);
        let most_m = self.spec.climb_limit_m_s * period_s;
        let on_the_way = way + rate_m_s * period_s;
        let target = on_the_way + (wanted_m - on_the_way).clamp(-most_m, most_m);
        memory.altitude_m = Some(target);
        let error = target - sensed.altitude_m;
        let gains = &self.gains.altitude;
        let base = trim + gains.proportional * error;
        let beyond = sign_beyond(base + gains.second * memory.altitude.value, least, most);
        let integral = memory.altitude.advance(error, period_s, beyond);
        memory.at_pitch_limit = beyond != 0.0;
        (base + gains.second * integral).clamp(least, most)
    }
}

/// 1 above the interval, -1 below it, 0 inside.
fn sign_beyond(value: f64, least: f64, most: f64) -> f64 {
    if value > most {
        1.0
    } else if value < least {
        -1.0
    } else {
        0.0
    }
}
