//! A body that rides on another: its state follows from that of the carrier, which has its mass; the forces on it
//! act on the carrier; and what the latch between them carries.
//!
//! ```text
//! x = p + R r,  v = v_c + R (omega x r),  a = a_c + R (alpha x r + omega x (omega x r))
//! F_l = m a - F
//! Q_l = J alpha_b + omega_b x (J omega_b) - Q - s x F_l
//! ```
//!
//! p, v_c, a_c, R, omega, alpha state of the carrier, r place of the rider's centre of mass on it; F, Q all other
//! forces on the rider and their torque about its centre of mass; F_l, Q_l force on it through the latch and torque
//! about its port, which is at s from its centre of mass (Newton and Euler).

use aerobot_components::docking::{Docked, DockingPort};
use aerobot_components::state::{
    Acceleration, AngularAcceleration, AngularVelocity, Attitude, Force, Inertia, Mass, Position,
    Torque, Velocity,
};
use bevy_ecs::query::Without;
use bevy_ecs::system::Query;
use glam::DVec3;

/// Puts every rider where its carrier has it.
pub fn place_riders(
    carriers: Query<(&Position, &Velocity, &Attitude, &AngularVelocity), Without<Docked>>,
    mut riders: Query<(
        &Docked,
        &mut Position,
        &mut Velocity,
        &mut Attitude,
        &mut AngularVelocity,
    )>,
) {
    for (docked, mut position, mut velocity, mut attitude, mut rate) in &mut riders {
        let Ok(carrier) = carriers.get(docked.carrier) else {
            continue;
        };
        let (place, motion, turn, turning) = carrier;
        position.0 = place.0 + turn.0 * docked.offset_m;
        velocity.0 = motion.0 + turn.0 * turning.0.cross(docked.offset_m);
        attitude.0 = turn.0 * docked.attitude;
        rate.0 = docked.attitude.conjugate() * turning.0;
    }
}

/// Passes the forces on every rider to its carrier.
pub fn load_carriers_of_riders(
    riders: Query<(&Docked, &Force, &Torque)>,
    mut carriers: Query<(&Attitude, &mut Force, &mut Torque), Without<Docked>>,
) {
    for (docked, load, moment) in &riders {
        let Ok((attitude, mut force, mut torque)) = carriers.get_mut(docked.carrier) else {
            continue;
        };
        force.0 += load.0;
        torque.0 += moment.0 + (attitude.0 * docked.offset_m).cross(load.0);
    }
}

/// Finds the acceleration of every rider from that of its carrier.
pub fn accelerate_riders(
    carriers: Query<
        (
            &Acceleration,
            &AngularAcceleration,
            &Attitude,
            &AngularVelocity,
        ),
        Without<Docked>,
    >,
    mut riders: Query<(&Docked, &mut Acceleration, &mut AngularAcceleration)>,
) {
    for (docked, mut linear, mut angular) in &mut riders {
        let Ok((of_carrier, turning, attitude, rate)) = carriers.get(docked.carrier) else {
            continue;
        };
        let arm = docked.offset_m;
        let about = turning.0.cross(arm) + rate.0.cross(rate.0.cross(arm));
        linear.0 = of_carrier.0 + attitude.0 * about;
        angular.0 = docked.attitude.conjugate() * turning.0;
    }
}

/// What a latch carries, inertial frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LatchLoad {
    /// Force on the rider, N.
    pub force_n: DVec3,
    /// Torque on the rider about its port, N m.
    pub torque_n_m: DVec3,
}

impl LatchLoad {
    /// Of a rider of this mass and inertia, on which `forces` act besides.
    #[must_use]
    pub fn of(
        (mass, inertia, port): (&Mass, &Inertia, &DockingPort),
        (attitude, rate): (&Attitude, &AngularVelocity),
        (linear, angular): (&Acceleration, &AngularAcceleration),
        (force, torque): (&Force, &Torque),
    ) -> Self {
        let force_n = mass.0 * linear.0 - force.0;
        let own = inertia.0 * angular.0 + rate.0.cross(inertia.0 * rate.0);
        let arm_m = attitude.0 * port.at_m;
        Self {
            force_n,
            torque_n_m: attitude.0 * own - torque.0 - arm_m.cross(force_n),
        }
    }
}
