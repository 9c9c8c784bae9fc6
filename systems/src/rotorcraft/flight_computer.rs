//! The flight computer of a rotorcraft: from where it is to be to a thrust and an attitude, at its own ticks.
//!
//! ```text
//! v_c = v_r + sat(k_p (p_r - p), v_max)
//! a_c = a_r + k_v (v_c - v)
//! F   = m (a_c + g z) - D
//! ```
//!
//! p place of the point that is guided, v velocity of the centre of mass, r the reference; m mass, g gravity, D drag at
//! the body's present velocity through the air, F force of the rotors (N). F is tilted by the largest tilt at most; its
//! direction is the z axis of the commanded attitude, and its part along the body's z axis the commanded thrust,
//! as far as rotors and motors give it ([`super::momentum_theory`]). Both are held until the next tick.
//!
//! Assumptions: the drone knows its own motion, the air about it and its drag (inertial unit and air data without
//! errors).

use aerobot_components::aerodynamics::ConstantDragArea;
use aerobot_components::docking::{Docked, Docking};
use aerobot_components::rotorcraft::{
    Course, FlightReference, FlightStatus, RotorCommand, Rotorcraft,
};
use aerobot_components::sampling::Sampling;
use aerobot_components::state::{Air, Attitude, Mass, Position, Velocity};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Without;
use bevy_ecs::system::{Query, Res};
use glam::{DMat3, DQuat, DVec3};

use super::momentum_theory::{Inflow, largest_thrust_n};
use crate::clock::Clock;
use crate::environment::EnvironmentModel;

/// The flight computer of a body: an entity of its own, with a [`Sampling`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlightComputer(pub Entity);

/// Of the upward force that hovering takes, the rotors give at least this part.
const LEAST_LIFT: f64 = 0.3;

/// Gives every rotorcraft that nothing else guides the reference of its course.
pub fn follow_course(
    clock: Res<Clock>,
    computers: Query<(&FlightComputer, &Sampling)>,
    mut bodies: Query<(&Rotorcraft, &Air, &mut FlightReference), Without<Docking>>,
) {
    for (computer, sampling) in &computers {
        if !sampling.is_due(clock.time_s) {
            continue;
        }
        let Ok((rotorcraft, air, mut reference)) = bodies.get_mut(computer.0) else {
            continue;
        };
        match rotorcraft.course {
            Course::Hold => {}
            Course::Drift => {
                reference.position_m = None;
                reference.velocity_m_s = air.velocity_m_s.with_z(0.0);
            }
            Course::Along {
                position_m,
                velocity_m_s,
                heading_rad,
            } => {
                reference.position_m = Some(position_m + clock.time_s * velocity_m_s);
                reference.velocity_m_s = velocity_m_s;
                reference.heading_rad = heading_rad;
            }
        }
    }
}

/// Commands rotors and attitude where a tick is due; whether there was one.
pub fn command_rotors(
    clock: Res<Clock>,
    environment: Res<EnvironmentModel>,
    mut computers: Query<(&FlightComputer, &mut Sampling)>,
    mut bodies: Query<(
        (&Rotorcraft, &FlightReference, Option<&Docked>),
        (&Position, &Velocity, &Attitude),
        (&Mass, &Air, Option<&ConstantDragArea>),
        (&mut RotorCommand, &mut FlightStatus),
    )>,
) -> bool {
    let mut has_commanded = false;
    for (computer, mut sampling) in &mut computers {
        if !sampling.is_due(clock.time_s) {
            continue;
        }
        sampling.done(clock.time_s);
        let Ok((what, motion, (mass, air, drag_area), mut out)) = bodies.get_mut(computer.0) else {
            continue;
        };
        let (rotorcraft, reference, docked) = what;
        has_commanded = true;
        if docked.is_some() {
            *out.0 = RotorCommand {
                thrust_n: 0.0,
                attitude: motion.2.0,
                is_idle: true,
            };
            *out.1 = FlightStatus::default();
            continue;
        }
        let flight = Flight {
            position_m: motion.0.0,
            velocity_m_s: motion.1.0,
            attitude: motion.2.0,
            mass_kg: mass.0,
            gravity_m_s2: environment.gravity.acceleration_m_s2(motion.0.0.z),
            air: *air,
            drag_area_m2: drag_area.map_or(0.0, |area| area.0),
        };
        (*out.0, *out.1) = command(rotorcraft, reference, &flight);
    }
    has_commanded
}

/// The state of flight at a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Of the centre of mass, inertial frame, m.
    pub position_m: DVec3,
    /// Of the centre of mass, inertial frame, m/s.
    pub velocity_m_s: DVec3,
    /// Body to inertial.
    pub attitude: DQuat,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
    /// The air about the body.
    pub air: Air,
    /// Drag coefficient times area, m^2.
    pub drag_area_m2: f64,
}

/// The command at a tick, and what was found on the way.
#[must_use]
pub fn command(
    rotorcraft: &Rotorcraft,
    reference: &FlightReference,
    flight: &Flight,
) -> (RotorCommand, FlightStatus) {
    let through_air = flight.velocity_m_s - flight.air.velocity_m_s;
    let drag_n = -0.5
        * flight.air.density_kg_m3
        * flight.drag_area_m2
        * through_air.length_squared().sqrt()
        * through_air;
    let point_m = flight.position_m + flight.attitude * reference.point_m;
    let towards = reference.position_m.map_or(DVec3::ZERO, |wanted| {
        let velocity = rotorcraft.position_gain_per_s * (wanted - point_m);
        velocity.clamp_length_max(rotorcraft.largest_speed_m_s)
    });
    let wanted_m_s = reference.velocity_m_s + towards;
    let acceleration = reference.acceleration_m_s2
        + rotorcraft.velocity_gain_per_s * (wanted_m_s - flight.velocity_m_s);
    let weight_n = flight.mass_kg * flight.gravity_m_s2;
    let wanted_n = flight.mass_kg * acceleration + weight_n * DVec3::Z - drag_n;
    let (force_n, is_tilt_limited) = tilted_at_most(
        wanted_n.with_z(wanted_n.z.max(LEAST_LIFT * weight_n)),
        rotorcraft.largest_tilt_rad,
    );
    let axis = flight.attitude * DVec3::Z;
    let axial_m_s = through_air.dot(axis);
    let inflow = Inflow {
        density_kg_m3: flight.air.density_kg_m3,
        axial_m_s,
        edgewise_m_s: (through_air - axial_m_s * axis).length_squared().sqrt(),
    };
    let largest_thrust_n = largest_thrust_n(rotorcraft, &inflow);
    let command = RotorCommand {
        thrust_n: force_n.dot(axis).clamp(0.0, largest_thrust_n),
        attitude: attitude_of(force_n, reference.heading_rad),
        is_idle: false,
    };
    let status = FlightStatus {
        needed_thrust_n: force_n.length_squared().sqrt(),
        largest_thrust_n,
        is_tilt_limited,
    };
    (command, status)
}

/// A force with its horizontal part cut to a tilt (rad), and whether it was.
fn tilted_at_most(force_n: DVec3, tilt_rad: f64) -> (DVec3, bool) {
    let across = force_n.with_z(0.0);
    let most = force_n.z * libm::tan(tilt_rad);
    let cut = across.clamp_length_max(most);
    (cut.with_z(force_n.z), cut != across)
}

/// The attitude whose z axis is along a force that points upward, and whose x axis has a heading (rad).
#[must_use]
pub fn attitude_of(force_n: DVec3, heading_rad: f64) -> DQuat {
    let z = force_n / force_n.length_squared().sqrt();
    let (sine, cosine) = libm::sincos(heading_rad);
    let x = DVec3::new(-sine, cosine, 0.0).cross(z);
    let x = x / x.length_squared().sqrt();
    DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::attitude::heading_rad;

    #[test]
    fn an_attitude_has_its_axis_and_its_heading() {
        for (force, heading) in [
            (DVec3::new(1.0, -2.0, 8.0), 0.4),
            (DVec3::Z, -3.0),
            (DVec3::new(0.0, 3.0, 5.0), 1.5),
        ] {
            let attitude = attitude_of(force, heading);
            assert!((attitude * DVec3::Z - force.normalize()).length() < 1e-14);
            assert!((heading_rad(attitude) - heading).abs() < 1e-14);
        }
    }

    #[test]
    fn a_tilt_is_cut_to_its_limit() {
        let (cut, is_cut) = tilted_at_most(DVec3::new(3.0, 4.0, 1.0), 0.5);
        assert!(is_cut && (libm::atan2(cut.with_z(0.0).length(), cut.z) - 0.5).abs() < 1e-14);
        assert!((cut.x * 4.0 - cut.y * 3.0).abs() < 1e-14);
    }
}
