//! Forces of a sail: lift and drag of its wing and its rudder at their aerodynamic centres.
//!
//! With (u, v, w) the velocity of a surface through the air in the body frame, rho the density, S its area and
//! V the speed:
//!
//! ```text
//! alpha_w = atan2(v, u) of the wing        alpha_r = atan2(v, u) of the rudder +- epsilon - delta
//! lift = 1/2 rho V^2 S C_L along (v, -u, 0)/sqrt(u^2 + v^2)        drag = 1/2 rho V^2 S C_D against (u, v, w)
//! epsilon = 2 C_L/(pi AR) of the wing, with the minus sign
//! ```
//!
//! delta deflection of the rudder (rad). Each surface has its own velocity, v + omega x r, so that yaw is
//! damped; the air is that at the centre of mass. Lift is perpendicular to the motion and to the span; it
//! pushes to starboard (-y) where the air comes from port, the bow pointing to starboard of the motion.
//! (Equation 5 of the paper, sec. 5.2.1, has the axes of lift and drag exchanged, and its + before epsilon
//! makes the downwash push a rudder into the wind of the wing.)

use aerobot_components::actuator::ActuatorValue;
use aerobot_components::derivatives::TorqueDerivatives;
use aerobot_components::sail::{
    LevelHold, LiftingSurface, RudderActuator, SailAirspeed, SailLoads, SailShape,
};
use aerobot_components::state::{Air, AngularVelocity, Attitude, Force, Torque, Velocity};
use bevy_ecs::system::Query;
use glam::{DMat3, DQuat, DVec3};

use super::lifting_surface::coefficients;

/// How a sail moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SailMotion {
    /// Body to inertial.
    pub attitude: DQuat,
    /// Velocity of the centre of mass through the air, inertial frame, m/s.
    pub through_air_m_s: DVec3,
    /// Angular velocity, body frame, rad/s.
    pub rate_rad_s: DVec3,
}

/// Loads every sail.
pub fn sail(
    mut sails: Query<(
        &SailShape,
        &RudderActuator,
        &Air,
        &Attitude,
        &Velocity,
        &AngularVelocity,
        &mut Force,
        &mut Torque,
        &mut SailLoads,
    )>,
    rudders: Query<&ActuatorValue>,
) {
    for (shape, rudder, air, attitude, velocity, rate, mut force, mut torque, mut loads) in
        &mut sails
    {
        let deflection_rad = rudders.get(rudder.0).map_or(0.0, |value| value.0);
        let motion = SailMotion {
            attitude: attitude.0,
            through_air_m_s: velocity.0 - air.velocity_m_s,
            rate_rad_s: rate.0,
        };
        *loads = sail_loads(shape, &motion, air.density_kg_m3, deflection_rad);
        force.0 += attitude.0 * loads.force_n;
        torque.0 += attitude.0 * loads.torque_n_m;
    }
}

/// What acts on a sail in air of a density (kg/m^3) with a deflection of the rudder (rad).
#[must_use]
pub fn sail_loads(
    shape: &SailShape,
    motion: &SailMotion,
    density_kg_m3: f64,
    deflection_rad: f64,
) -> SailLoads {
    let wing_velocity = velocity_of(&shape.wing, shape.airspeed, motion);
    let rudder_velocity = velocity_of(&shape.rudder, shape.airspeed, motion);
    let wing_incidence_rad = incidence_rad(wing_velocity);
    let (wing_lift, wing_drag) = coefficients(&shape.wing, wing_incidence_rad, shape.stall);
    let rudder_incidence_rad =
        wrapped(incidence_rad(rudder_velocity) + shape.downwash_rad * wing_lift - deflection_rad);
    let (rudder_lift, rudder_drag) = coefficients(&shape.rudder, rudder_incidence_rad, shape.stall);
    let pressure = |velocity: DVec3| 0.5 * density_kg_m3 * velocity.length_squared();
    let wing_load_n = pressure(wing_velocity) * shape.wing.area_m2;
    let rudder_load_n = pressure(rudder_velocity) * shape.rudder.area_m2;
    let wing_n = resultant(
        wing_velocity,
        wing_load_n * wing_lift,
        wing_load_n * wing_drag,
    );
    let rudder_n = resultant(
        rudder_velocity,
        rudder_load_n * rudder_lift,
        rudder_load_n * rudder_drag,
    );
    SailLoads {
        wing_incidence_rad,
        rudder_incidence_rad,
        wing_lift_n: wing_load_n * wing_lift,
        rudder_lift_n: rudder_load_n * rudder_lift,
        drag_n: wing_load_n * wing_drag + rudder_load_n * rudder_drag,
        force_n: wing_n + rudder_n,
        torque_n_m: shape.wing.centre_m.cross(wing_n) + shape.rudder.centre_m.cross(rudder_n),
    }
}

/// Velocity of a surface through the air that counts, body frame, m/s.
fn velocity_of(surface: &LiftingSurface, airspeed: SailAirspeed, motion: &SailMotion) -> DVec3 {
    let to_body = motion.attitude.conjugate();
    let own = to_body * motion.through_air_m_s + motion.rate_rad_s.cross(surface.centre_m);
    match airspeed {
        SailAirspeed::Full => own,
        SailAirspeed::Horizontal => {
            let up = to_body * DVec3::Z;
            own - own.dot(up) * up
        }
    }
}

/// Angle from the bow to a velocity, rad; none at rest.
fn incidence_rad(velocity: DVec3) -> f64 {
    libm::atan2(velocity.y, velocity.x)
}

/// An angle in (-pi, pi].
fn wrapped(angle_rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    if angle_rad > std::f64::consts::PI {
        angle_rad - turn
    } else if angle_rad <= -std::f64::consts::PI {
        angle_rad + turn
    } else {
        angle_rad
    }
}

/// Lift (N) across a velocity and drag (N) against it, body frame.
fn resultant(velocity: DVec3, lift_n: f64, drag_n: f64) -> DVec3 {
    let across = velocity.truncate().length_squared().sqrt();
    let speed = velocity.length_squared().sqrt();
    if across == 0.0 {
        return if speed == 0.0 {
            DVec3::ZERO
        } else {
            velocity * (-drag_n / speed)
        };
    }
    DVec3::new(velocity.y, -velocity.x, 0.0) * (lift_n / across) - velocity * (drag_n / speed)
}

/// Holds sails level that are to be.
pub fn hold_level(mut sails: Query<(&LevelHold, &Attitude, &AngularVelocity, &mut Torque)>) {
    for (hold, attitude, rate, mut torque) in &mut sails {
        let tilt = (attitude.0 * DVec3::Z).cross(DVec3::Z);
        let turning = attitude.0 * DVec3::new(rate.0.x, rate.0.y, 0.0);
        torque.0 += hold.stiffness_n_m * tilt - hold.damping_n_m_s * turning;
    }
}

/// Finds how what holds a sail level changes with its attitude and its rate.
pub fn hold_level_derivatives(mut sails: Query<(&LevelHold, &mut TorqueDerivatives)>) {
    for (hold, mut derivatives) in &mut sails {
        let across = DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0));
        derivatives.by_rotation_n_m -= hold.stiffness_n_m * across;
        derivatives.by_rate_n_m_s -= hold.damping_n_m_s * across;
    }
}

/// Static stability in yaw about the centre of mass, over the dynamic pressure: the torque by which the air
/// turns the bow towards the motion, for each rad between them, m^3/rad. Negative: the sail turns away.
#[must_use]
pub fn yaw_stiffness_m3_rad(shape: &SailShape) -> f64 {
    let (wing, rudder) = (&shape.wing, &shape.rudder);
    let wing_slope = wing.area_m2 * wing.lift_slope_per_rad;
    let rudder_slope = rudder.area_m2 * rudder.lift_slope_per_rad;
    let straightened = 1.0 + shape.downwash_rad * wing.lift_slope_per_rad;
    // The drag of a surface at x turns with the motion too: its part across the bow is x alpha.
    let wing_drag = wing.area_m2 * wing.zero_lift_drag;
    let rudder_drag = rudder.area_m2 * rudder.zero_lift_drag;
    -wing.centre_m.x * (wing_slope + wing_drag)
        - rudder.centre_m.x * (rudder_slope * straightened + rudder_drag)
}

/// The area of the rudder above which the sail is stable, m^2, if a rudder makes it so.
#[must_use]
pub fn least_rudder_area_m2(shape: &SailShape) -> Option<f64> {
    let without = SailShape {
        rudder: LiftingSurface {
            area_m2: 0.0,
            ..shape.rudder
        },
        ..*shape
    };
    let with_one = SailShape {
        rudder: LiftingSurface {
            area_m2: 1.0,
            ..shape.rudder
        },
        ..*shape
    };
    let own = yaw_stiffness_m3_rad(&without);
    let by_area = yaw_stiffness_m3_rad(&with_one) - own;
    (by_area > 0.0).then(|| (-own / by_area).max(0.0))
}

#[cfg(test)]
mod tests;
