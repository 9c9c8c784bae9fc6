//! A drone that flies alone in uniform air, on its autopilot.

use aerobot_components::fixed_wing::aircraft::{AEROSONDE, Aircraft};
use aerobot_components::fixed_wing::autopilot::AutopilotSpec;
use aerobot_components::fixed_wing::controls::Controls;
use glam::{DMat3, DVec3};

use crate::fixed_wing::autopilot::{Autopilot, Command, Memory, Sensed};
use crate::fixed_wing::flight_trim::{Flier, SteadyFlight};
use crate::fixed_wing::gains::design;
use crate::fixed_wing::linear_model::LinearModel;
use crate::fixed_wing::north_east_down::from_roll_pitch_yaw;

/// The Aerosonde in air of a density, kg/m^3, under gravity, m/s^2.
pub(super) fn aerosonde(density_kg_m3: f64, gravity_m_s2: f64) -> Flier {
    flier(AEROSONDE, density_kg_m3, gravity_m_s2)
}

pub(super) fn flier(aircraft: Aircraft, density_kg_m3: f64, gravity_m_s2: f64) -> Flier {
    Flier {
        aircraft,
        mass_kg: 11.0,
        inertia_kg_m2: DMat3::from_cols(
            DVec3::new(0.8244, 0.0, -0.1204),
            DVec3::new(0.0, 1.135, 0.0),
            DVec3::new(-0.1204, 0.0, 1.759),
        ),
        density_kg_m3,
        gravity_m_s2,
    }
}

/// Level straight flight.
pub(super) fn level(airspeed_m_s: f64) -> SteadyFlight {
    SteadyFlight {
        airspeed_m_s,
        ..SteadyFlight::default()
    }
}

/// Velocity through the air, rates, angles, position north-east-down.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) velocity: DVec3,
    pub(super) rate: DVec3,
    pub(super) angles: DVec3,
    pub(super) position: DVec3,
}

impl State {
    fn plus(self, h: f64, rates: Self) -> Self {
        Self {
            velocity: self.velocity + h * rates.velocity,
            rate: self.rate + h * rates.rate,
            angles: self.angles + h * rates.angles,
            position: self.position + h * rates.position,
        }
    }
}

/// A drone in flight.
pub(super) struct Flight {
    flier: Flier,
    autopilot: Autopilot,
    memory: Memory,
    pub(super) state: State,
}

impl Flight {
    pub(super) fn starting_at(flier: Flier, airspeed_m_s: f64, spec: AutopilotSpec) -> Self {
        let trim = flier.trim(level(airspeed_m_s)).unwrap();
        let gains = design(&LinearModel::about(&flier, &trim), &spec).unwrap();
        Self {
            flier,
            autopilot: Autopilot {
                spec,
                gains,
                trim,
                limits: flier.aircraft.limits,
                safe_airspeed_m_s: 16.0,
            },
            memory: Memory::default(),
            state: State {
                velocity: trim.velocity_m_s(),
                rate: DVec3::ZERO,
                angles: DVec3::new(trim.roll_rad, trim.pitch_rad, 0.0),
                position: DVec3::ZERO,
            },
        }
    }

    pub(super) fn autopilot(&self) -> &Autopilot {
        &self.autopilot
    }

    /// One period on a command; gives the controls that were held.
    pub(super) fn sample(&mut self, command: &Command) -> Controls {
        let state = &self.state;
        let attitude = from_roll_pitch_yaw(state.angles);
        let sensed = Sensed {
            attitude,
            rate_rad_s: state.rate,
            velocity_m_s: attitude * state.velocity,
            wind_m_s: DVec3::ZERO,
            altitude_m: -state.position.z,
            gravity_m_s2: self.flier.gravity_m_s2,
        };
        let controls = self.autopilot.sample(&mut self.memory, &sensed, command);
        let h = 0.5 * self.autopilot.spec.period_s;
        for _ in 0..2 {
            let k1 = self.rates(self.state, &controls);
            let k2 = self.rates(self.state.plus(0.5 * h, k1), &controls);
            let k3 = self.rates(self.state.plus(0.5 * h, k2), &controls);
            let k4 = self.rates(self.state.plus(h, k3), &controls);
            let state = self.state.plus(h / 6.0, k1).plus(h / 3.0, k2);
            self.state = state.plus(h / 3.0, k3).plus(h / 6.0, k4);
        }
        controls
    }

    fn rates(&self, state: State, controls: &Controls) -> State {
        let (phi, theta) = (state.angles.x, state.angles.y);
        let (velocity, rate) =
            self.flier
                .accelerations(state.velocity, state.rate, (phi, theta), controls);
        let down = state.rate.y * phi.sin() + state.rate.z * phi.cos();
        State {
            velocity,
            rate,
            angles: DVec3::new(
                state.rate.x + theta.tan() * down,
                state.rate.y * phi.cos() - state.rate.z * phi.sin(),
                down / theta.cos(),
            ),
            position: from_roll_pitch_yaw(state.angles) * state.velocity,
        }
    }
}
