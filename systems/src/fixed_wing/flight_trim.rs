//! Steady flight without sideslip: straight or turning, level or climbing.
//!
//! ```text
//! 0 = F/m + R^T g - omega x v        0 = M - omega x J omega        v = V (cos alpha, 0, sin alpha)
//! omega = psi' (-sin theta, sin phi cos theta, cos phi cos theta)
//! sin gamma = cos alpha sin theta - sin alpha cos phi cos theta
//! ```
//!
//! Six equations for angle of attack alpha, roll phi, elevator, aileron, rudder and throttle, at an airspeed V
//! (m/s), an angle of climb gamma and a rate of turn psi' given; theta pitch from the last equation (Stevens
//! and Lewis, "Aircraft Control and Simulation", 2nd ed. 2003, eq. 3.6-3). F, M aerodynamic and propulsive
//! force and moment (N, N m), m mass (kg), J tensor of inertia (kg m^2), g gravity (m/s^2); body axes
//! forward-right-down, angles rad. Newton's method with central differences.

use aerobot_components::fixed_wing::aircraft::Aircraft;
use aerobot_components::fixed_wing::controls::Controls;
use glam::{DMat3, DVec3};
use nalgebra::{SMatrix, SVector};
use thiserror::Error;

use super::loads::{Loads, loads};
use super::north_east_down::from_roll_pitch_yaw;
use super::propeller::thrust;

/// An aircraft with its mass, in air, under gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flier {
    /// The coefficients.
    pub aircraft: Aircraft,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Tensor of inertia about the centre of mass, forward-right-down, kg m^2.
    pub inertia_kg_m2: DMat3,
    /// Density of the air, kg/m^3.
    pub density_kg_m3: f64,
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
}

/// The steady flight that is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteadyFlight {
    /// Airspeed, m/s.
    pub airspeed_m_s: f64,
    /// Angle of the path above the horizontal, rad.
    pub climb_rad: f64,
    /// Rate of turn, to the right as seen from above, rad/s.
    pub turn_rad_s: f64,
}

/// A steady flight with what keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrimmedFlight {
    /// What was asked for.
    pub flight: SteadyFlight,
    /// Angle of attack, rad.
    pub alpha_rad: f64,
    /// Roll, rad.
    pub roll_rad: f64,
    /// Pitch, rad.
    pub pitch_rad: f64,
    /// Controls.
    pub controls: Controls,
    /// Thrust, N.
    pub thrust_n: f64,
    /// Rates, forward-right-down, rad/s.
    pub rate_rad_s: DVec3,
}

/// Why there is no such flight.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoTrim {
    /// Newton's method found none.
    #[error("no balance of forces was found at {airspeed_m_s} m/s")]
    NoBalance {
        /// Airspeed, m/s.
        airspeed_m_s: f64,
    },
    /// The wing would have to stall.
    #[error(
        "at {airspeed_m_s} m/s it would need an angle of attack of {alpha_deg:.1} deg, and the wing stalls \
         at {stall_deg:.1} deg"
    )]
    Stalled {
        /// Airspeed, m/s.
        airspeed_m_s: f64,
        /// Angle of attack, deg.
        alpha_deg: f64,
        /// Where the wing begins to stall, deg.
        stall_deg: f64,
    },
    /// The motor has not the power, or has too much at idle.
    #[error("at {airspeed_m_s} m/s it would need {percent:.0} % of the throttle")]
    Throttle {
        /// Airspeed, m/s.
        airspeed_m_s: f64,
        /// Throttle, %.
        percent: f64,
    },
    /// A control surface does not go so far.
    #[error(
        "at {airspeed_m_s} m/s it would need {degrees:.1} deg of {surface}, and has {limit_deg} deg"
    )]
    Surface {
        /// Airspeed, m/s.
        airspeed_m_s: f64,
        /// Which.
        surface: &'static str,
        /// Deflection, deg.
        degrees: f64,
        /// Its limit, deg.
        limit_deg: f64,
    },
}

/// Angle of attack at which the wing begins to stall, rad: 5 % of it has.
#[must_use]
pub fn beginning_stall_rad(aircraft: &Aircraft) -> f64 {
    aircraft.longitudinal.stall_rad - 3.0 / aircraft.longitudinal.stall_sharpness
}

/// The unknowns.
type Unknowns = [f64; 6];

impl TrimmedFlight {
    /// Velocity through the air, forward-right-down, m/s.
    #[must_use]
    pub fn velocity_m_s(&self) -> DVec3 {
        let (sin, cos) = libm::sincos(self.alpha_rad);
        self.flight.airspeed_m_s * DVec3::new(cos, 0.0, sin)
    }
}

impl Flier {
    /// Linear and angular acceleration, forward-right-down, m/s^2 and rad/s^2, of a motion through steady
    /// air: velocity (m/s), rates (rad/s), roll and pitch (rad).
    #[must_use]
    pub fn accelerations(
        &self,
        velocity_m_s: DVec3,
        rate_rad_s: DVec3,
        (roll_rad, pitch_rad): (f64, f64),
        controls: &Controls,
    ) -> (DVec3, DVec3) {
        let Loads {
            force_n,
            moment_n_m,
        } = loads(
            &self.aircraft,
            self.density_kg_m3,
            velocity_m_s,
            rate_rad_s,
            controls,
        );
        let attitude = from_roll_pitch_yaw(DVec3::new(roll_rad, pitch_rad, 0.0));
        let gravity = attitude.conjugate() * (self.gravity_m_s2 * DVec3::Z);
        let linear = force_n / self.mass_kg + gravity - rate_rad_s.cross(velocity_m_s);
        let gyroscopic = rate_rad_s.cross(self.inertia_kg_m2 * rate_rad_s);
        let angular = self.inertia_kg_m2.inverse() * (moment_n_m - gyroscopic);
        (linear, angular)
    }

    /// Trim for a steady flight.
    ///
    /// # Errors
    /// [`NoTrim`]: no balance, or one beyond stall, throttle or the limits of a surface.
    pub fn trim(&self, flight: SteadyFlight) -> Result<TrimmedFlight, NoTrim> {
        let trimmed = self.balance(flight)?;
        self.within_limits(&trimmed)?;
        Ok(trimmed)
    }

    /// Balance, whatever it takes.
    fn balance(&self, flight: SteadyFlight) -> Result<TrimmedFlight, NoTrim> {
        let failed = NoTrim::NoBalance {
            airspeed_m_s: flight.airspeed_m_s,
        };
        let mut x = self.guess(&flight);
        let mut residual = self.residual(&flight, &x);
        for _ in 0..60 {
            let size = norm(&residual);
            if !size.is_finite() {
                return Err(failed);
            }
            if size < 1e-13 * self.gravity_m_s2.max(1.0) {
                break;
            }
            let step = self.newton_step(&flight, &x, &residual).ok_or(failed)?;
            let mut part = 1.0;
            loop {
                let next: Unknowns = std::array::from_fn(|i| x[i] - part * step[i]);
                let there = self.residual(&flight, &next);
                if norm(&there) < size {
                    (x, residual) = (next, there);
                    break;
                }
                part *= 0.5;
                if part < 1e-6 {
                    // Round-off is all that is left, or nothing helps.
                    if size < 1e-9 {
                        return Ok(self.trimmed(flight, &x));
                    }
                    return Err(failed);
                }
            }
        }
        if norm(&residual) < 1e-9 {
            Ok(self.trimmed(flight, &x))
        } else {
            Err(failed)
        }
    }

    fn guess(&self, flight: &SteadyFlight) -> Unknowns {
        let wing = &self.aircraft.longitudinal;
        let speed = flight.airspeed_m_s;
        let roll = libm::atan(speed * flight.turn_rad_s / self.gravity_m_s2.max(1e-3));
        let pressure = 0.5 * self.density_kg_m3 * speed * speed;
        let lift = self.mass_kg * self.gravity_m_s2
            / libm::cos(roll)
            / (pressure * self.aircraft.geometry.wing_area_m2);
        let alpha = ((lift - wing.lift_zero) / wing.lift_alpha)
            .clamp(-0.2, beginning_stall_rad(&self.aircraft));
        let elevator = -(wing.pitch_zero + wing.pitch_alpha * alpha) / wing.pitch_elevator;
        [alpha, roll, elevator, 0.0, 0.0, 0.6]
    }

    fn newton_step(
        &self,
        flight: &SteadyFlight,
        x: &Unknowns,
        residual: &Unknowns,
    ) -> Option<SVector<f64, 6>> {
        const DIFFERENCE: f64 = 1e-6;
        let mut jacobian = SMatrix::<f64, 6, 6>::zeros();
        for column in 0..6 {
            let at = |sign: f64| {
                let mut moved = *x;
                moved[column] += sign * DIFFERENCE;
                self.residual(flight, &moved)
            };
            let (above, below) = (at(1.0), at(-1.0));
            for row in 0..6 {
                jacobian[(row, column)] = (above[row] - below[row]) / (2.0 * DIFFERENCE);
            }
        }
        jacobian.lu().solve(&SVector::from(*residual))
    }

    fn residual(&self, flight: &SteadyFlight, x: &Unknowns) -> Unknowns {
        let trimmed = self.trimmed(*flight, x);
        let (linear, angular) = self.accelerations(
            trimmed.velocity_m_s(),
            trimmed.rate_rad_s,
            (trimmed.roll_rad, trimmed.pitch_rad),
            &trimmed.controls,
        );
        [
            linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
        ]
    }

    fn trimmed(&self, flight: SteadyFlight, x: &Unknowns) -> TrimmedFlight {
        let [
            alpha_rad,
            roll_rad,
            elevator_rad,
            aileron_rad,
            rudder_rad,
            throttle,
        ] = *x;
        let pitch_rad = pitch_of_climb_rad(alpha_rad, roll_rad, flight.climb_rad);
        let (sin_roll, cos_roll) = libm::sincos(roll_rad);
        let (sin_pitch, cos_pitch) = libm::sincos(pitch_rad);
        let propulsion = &self.aircraft.propulsion;
        let (density, speed) = (self.density_kg_m3, flight.airspeed_m_s);
        TrimmedFlight {
            flight,
            alpha_rad,
            roll_rad,
            pitch_rad,
            controls: Controls {
                aileron_rad,
                elevator_rad,
                rudder_rad,
                throttle,
            },
            thrust_n: thrust(propulsion, density, speed, throttle).thrust_n,
            rate_rad_s: flight.turn_rad_s
                * DVec3::new(-sin_pitch, sin_roll * cos_pitch, cos_roll * cos_pitch),
        }
    }

    fn within_limits(&self, trimmed: &TrimmedFlight) -> Result<(), NoTrim> {
        let airspeed_m_s = trimmed.flight.airspeed_m_s;
        let stall_rad = beginning_stall_rad(&self.aircraft);
        if trimmed.alpha_rad > stall_rad || trimmed.alpha_rad < -stall_rad {
            return Err(NoTrim::Stalled {
                airspeed_m_s,
                alpha_deg: trimmed.alpha_rad.to_degrees(),
                stall_deg: stall_rad.to_degrees(),
            });
        }
        let controls = &trimmed.controls;
        if !(0.0..=1.0).contains(&controls.throttle) {
            return Err(NoTrim::Throttle {
                airspeed_m_s,
                percent: 100.0 * controls.throttle,
            });
        }
        let limits = &self.aircraft.limits;
        for (surface, angle_rad, limit_deg) in [
            ("elevator", controls.elevator_rad, limits.elevator_deg),
            ("aileron", controls.aileron_rad, limits.aileron_deg),
            ("rudder", controls.rudder_rad, limits.rudder_deg),
        ] {
            if angle_rad.abs() > limit_deg.to_radians() {
                return Err(NoTrim::Surface {
                    airspeed_m_s,
                    surface,
                    degrees: angle_rad.to_degrees(),
                    limit_deg,
                });
            }
        }
        Ok(())
    }

    /// The airspeeds between which level straight flight is possible, m/s, found outward from one at which
    /// it is: to 1e-6 m/s, as far as a hundredth and three times it.
    ///
    /// # Errors
    /// [`NoTrim`] at `airspeed_m_s` itself.
    pub fn level_airspeeds_m_s(&self, airspeed_m_s: f64) -> Result<(f64, f64), NoTrim> {
        let level = |airspeed_m_s| {
            self.trim(SteadyFlight {
                airspeed_m_s,
                ..SteadyFlight::default()
            })
        };
        level(airspeed_m_s)?;
        let last = |factor: f64, end: f64| {
            let mut inside = airspeed_m_s;
            let mut outside = inside * factor;
            while level(outside).is_ok() {
                inside = outside;
                outside *= factor;
                if (outside - end) * (factor - 1.0) > 0.0 {
                    return inside;
                }
            }
            while (outside - inside).abs() > 1e-6 {
                let middle = 0.5 * (inside + outside);
                if level(middle).is_ok() {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside
        };
        Ok((
            last(1.0 / 1.05, 0.01 * airspeed_m_s),
            last(1.05, 3.0 * airspeed_m_s),
        ))
    }
}

/// Pitch of a path that climbs at `climb_rad`, without sideslip.
fn pitch_of_climb_rad(alpha_rad: f64, roll_rad: f64, climb_rad: f64) -> f64 {
    let (sin_alpha, a) = libm::sincos(alpha_rad);
    let b = libm::cos(roll_rad) * sin_alpha;
    let s = libm::sin(climb_rad);
    let root = (a * a - s * s + b * b).max(0.0).sqrt();
    libm::atan2(a * b + s * root, a * a - s * s)
}

fn norm(x: &Unknowns) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}
