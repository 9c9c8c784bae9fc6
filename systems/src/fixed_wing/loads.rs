//! Forces and moments of a fixed-wing drone: air and propeller together, and the system that adds them.

use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::fixed_wing::aircraft::Aircraft;
use aerobot_components::fixed_wing::controls::Controls;
use aerobot_components::state::{Air, AngularVelocity, Attitude, Force, Torque, Velocity};
use bevy_ecs::system::Query;
use glam::DVec3;

use super::aerodynamics::aerodynamic_loads;
use super::north_east_down::vector;
use super::propeller::thrust;

/// Force and moment about the centre of mass, forward-right-down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loads {
    /// Force, N.
    pub force_n: DVec3,
    /// Moment, N m.
    pub moment_n_m: DVec3,
}

/// All loads but weight, in air of a density in kg/m^3, at a velocity through it in m/s and rates in rad/s,
/// forward-right-down. The propeller turns clockwise as seen from behind; what turns it turns the airframe the
/// other way.
#[must_use]
pub fn loads(
    aircraft: &Aircraft,
    density_kg_m3: f64,
    velocity_m_s: DVec3,
    rate_rad_s: DVec3,
    controls: &Controls,
) -> Loads {
    let mut loads = aerodynamic_loads(aircraft, density_kg_m3, velocity_m_s, rate_rad_s, controls);
    let propulsion = &aircraft.propulsion;
    let airspeed_m_s = velocity_m_s.length();
    let propeller = thrust(propulsion, density_kg_m3, airspeed_m_s, controls.throttle);
    loads.force_n.x += propeller.thrust_n;
    if propulsion.reaction {
        loads.moment_n_m.x -= propeller.torque_n_m;
    }
    loads
}

/// Adds the loads of every fixed-wing drone.
pub fn fixed_wing_loads(
    mut drones: Query<(
        &FixedWing,
        &Aircraft,
        &Controls,
        &Air,
        &Velocity,
        &Attitude,
        &AngularVelocity,
        &mut Force,
        &mut Torque,
    )>,
) {
    for (drone, aircraft, controls, air, velocity, attitude, rate, mut force, mut torque) in
        &mut drones
    {
        let through_air = velocity.0 - drone.wind.velocity_m_s(air.velocity_m_s);
        let found = loads(
            aircraft,
            air.density_kg_m3,
            vector(attitude.0.conjugate() * through_air),
            vector(rate.0),
            controls,
        );
        force.0 += attitude.0 * vector(found.force_n);
        torque.0 += attitude.0 * vector(found.moment_n_m);
    }
}
