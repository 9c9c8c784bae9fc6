//! Gains of the autopilot from the bandwidths that are asked for.
//!
//! A loop is asked for a pair of poles s_d = -zeta w + i w sqrt(1 - zeta^2). With the loops inside it closed,
//! those outside it open, and G the transfer functions that it then sees, its two gains solve the complex
//! equation
//!
//! ```text
//! roll, pitch                 1 + H (k_p G_angle(s_d) + k_d G_rate(s_d)) = 0
//! course, altitude, airspeed  1 + H (k_p + k_i/s_d) G(s_d)              = 0
//! H = (1 - e^(-s T))/(s T)
//! ```
//!
//! H is the hold of a sampled loop of period T. w natural frequency (rad/s), zeta damping ratio.
//!
//! Source: successive loop closure, Beard and McLain (2012), ch. 6. Theirs takes G from transfer functions of
//! second order in which the axes do not couple; here G is that of all ten states, so that the poles are where
//! they are asked for and not near it. With their simplified G this is their eqs. 6.2 to 6.24.
//!
//! Assumptions: gains hold at the airspeed and density of the trim; the integrals of sampled loops are as good
//! as 1/s.

use aerobot_components::fixed_wing::autopilot::{AutopilotSpec, LoopSpec};
use nalgebra::{Complex, Matrix2, Vector2};
use thiserror::Error;

use super::linear_model::{Feedback, Input, LinearModel, Output};

/// Gains of one loop: proportional, and of the rate (roll, pitch) or of the integral (the others).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopGains {
    /// On the error.
    pub proportional: f64,
    /// On the rate, taken off; or on the integral of the error.
    pub second: f64,
}

/// All gains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains {
    /// Roll to aileron; on roll (1) and its rate (s).
    pub roll: LoopGains,
    /// Course to roll; 1 and 1/s.
    pub course: LoopGains,
    /// Pitch to elevator; 1 and s.
    pub pitch: LoopGains,
    /// Altitude to pitch; rad/m and rad/(m s).
    pub altitude: LoopGains,
    /// Airspeed to throttle; s/m and 1/m.
    pub airspeed: LoopGains,
}

/// A loop that cannot have what is asked for.
#[derive(Clone, Debug, PartialEq, Error)]
#[error(
    "the loop `{name}` cannot have {frequency_rad_s} rad/s with a damping of {damping}: {reason}"
)]
pub struct NoGains {
    /// The loop.
    pub name: &'static str,
    /// Natural frequency asked for, rad/s.
    pub frequency_rad_s: f64,
    /// Damping ratio asked for.
    pub damping: f64,
    /// Why.
    pub reason: &'static str,
}

/// What all loops have in common.
struct Design<'a> {
    model: &'a LinearModel,
    spec: &'a AutopilotSpec,
}

/// The gains for an aircraft about its trim.
///
/// # Errors
/// A loop that would have to push the wrong way to have its poles there.
pub fn design(model: &LinearModel, spec: &AutopilotSpec) -> Result<Gains, NoGains> {
    let design = Design { model, spec };
    let mut gains = Gains::default();
    let on_surface = |name, of: LoopSpec, input, outputs: [Output; 2], inner: &Gains| {
        let s = pole(of);
        let hold = design.hold(s);
        let seen = design.seen(s, inner, input, &outputs);
        let seen = seen.ok_or_else(|| refused(name, of, AT_A_POLE))?;
        two_gains(name, of, hold * seen[0], hold * seen[1])
    };
    let roll = [Output::Roll, Output::RollRate];
    gains.roll = on_surface("roll", spec.roll, Input::Aileron, roll, &gains)?;
    let pitch = [Output::Pitch, Output::PitchRate];
    gains.pitch = on_surface("pitch", spec.pitch, Input::Elevator, pitch, &gains)?;

    let on_error = |name, of: LoopSpec, input, output, drive: f64, inner: &Gains| {
        let s = pole(of);
        let hold = design.hold(s) * drive;
        let seen = design.seen(s, inner, input, &[output]);
        let seen = seen.ok_or_else(|| refused(name, of, AT_A_POLE))?;
        let seen = hold * seen[0];
        two_gains(name, of, seen, seen / s)
    };
    gains.course = on_error(
        "course",
        spec.course,
        Input::Aileron,
        Output::Course,
        gains.roll.proportional,
        &gains,
    )?;
    gains.airspeed = on_error(
        "airspeed",
        spec.airspeed,
        Input::Throttle,
        Output::Airspeed,
        1.0,
        &gains,
    )?;
    gains.altitude = on_error(
        "altitude",
        spec.altitude,
        Input::Elevator,
        Output::Altitude,
        gains.pitch.proportional,
        &gains,
    )?;
    Ok(gains)
}

/// e^z, the same bits on any machine.
pub(super) fn exponential(z: Complex<f64>) -> Complex<f64> {
    let (sin, cos) = libm::sincos(z.im);
    Complex::new(cos, sin) * libm::exp(z.re)
}

/// The pole in the upper half plane that a loop is asked for.
fn pole(of: LoopSpec) -> Complex<f64> {
    let (w, zeta) = (of.frequency_rad_s, of.damping);
    Complex::new(-zeta * w, w * (1.0 - zeta * zeta).sqrt())
}

impl Design<'_> {
    fn hold(&self, s: Complex<f64>) -> Complex<f64> {
        let t = self.spec.period_s;
        (1.0 - exponential(-s * t)) / (s * t)
    }

    /// Transfer functions at s with the inner loops of the same axis closed whose gains are known, and the yaw
    /// damper. (A loop of the other axis that has its poles at s too would hide these.) An altitude or course
    /// loop is never inside another.
    fn seen(
        &self,
        s: Complex<f64>,
        inner: &Gains,
        input: Input,
        outputs: &[Output],
    ) -> Option<Vec<Complex<f64>>> {
        let hold = self.hold(s);
        let damper = &self.spec.yaw_damper;
        let washout = s / (s + damper.washout_rad_s);
        let real = |gain: f64| hold * gain;
        let airspeed = inner.airspeed.proportional + inner.airspeed.second / s;
        let loops = [
            (Input::Aileron, Output::Roll, real(inner.roll.proportional)),
            (Input::Aileron, Output::RollRate, real(inner.roll.second)),
            // The rudder is positive to the left: it is to add to a rate of yaw to the right.
            (
                Input::Rudder,
                Output::YawRate,
                hold * washout * -damper.gain_s,
            ),
            (
                Input::Elevator,
                Output::Pitch,
                real(inner.pitch.proportional),
            ),
            (Input::Elevator, Output::PitchRate, real(inner.pitch.second)),
            (Input::Throttle, Output::Airspeed, hold * airspeed),
        ]
        .map(|(input, output, gain)| Feedback {
            input,
            output,
            gain,
        });
        let is_lateral = |input| matches!(input, Input::Aileron | Input::Rudder);
        let same_axis = loops
            .into_iter()
            .filter(|feedback| is_lateral(feedback.input) == is_lateral(input));
        let loops: Vec<Feedback> = same_axis.collect();
        self.model.transfer(s, &loops, input, outputs)
    }
}

const AT_A_POLE: &str = "the aircraft has a pole there already";

fn refused(name: &'static str, of: LoopSpec, reason: &'static str) -> NoGains {
    NoGains {
        name,
        frequency_rad_s: of.frequency_rad_s,
        damping: of.damping,
        reason,
    }
}

/// Gains x and y with x a + y b = -1.
fn two_gains(
    name: &'static str,
    of: LoopSpec,
    a: Complex<f64>,
    b: Complex<f64>,
) -> Result<LoopGains, NoGains> {
    let matrix = Matrix2::new(a.re, b.re, a.im, b.im);
    let found = matrix
        .lu()
        .solve(&Vector2::new(-1.0, 0.0))
        .ok_or_else(|| refused(name, of, "its two gains would do the same there"))?;
    let gains = LoopGains {
        proportional: found[0],
        second: found[1],
    };
    // Elevators pitch down when positive: there the gain is negative, and the sign is that of G at rest.
    let is_integral = matches!(name, "course" | "altitude" | "airspeed");
    if is_integral && !(gains.proportional > 0.0 && gains.second > 0.0) {
        let reason = "it would have to push the wrong way; faster loops inside of it, or another bandwidth, may do";
        return Err(refused(name, of, reason));
    }
    Ok(gains)
}
