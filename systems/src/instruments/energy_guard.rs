//! Mechanical energy as the implicit integrator watches it: whether a step has made energy.
//!
//! As [`super::energy`], with the added mass in the kinetic energy, and the power of everything but
//! weight and the tethers' axial forces. Dampers are left out: they can only take.

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, SegmentGeometry, Tension};
use aerobot_components::state::{
    AddedInertia, AngularVelocity, Attitude, Force, Inertia, Mass, Position, StateIndex, Torque,
    Velocity,
};
use aerobot_components::tether::{Attachment, TetherNode};
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res};

use super::energy::elastic_stretch_m;
use crate::environment::EnvironmentModel;
use crate::integration::MechanicalEnergy;

/// Energy and power of the state that was evaluated last.
pub fn mechanical_energy(
    environment: Res<EnvironmentModel>,
    nodes: Query<(&Mass, &Position, &Velocity, &Force), With<TetherNode>>,
    bodies: Query<
        (
            (&Mass, &AddedInertia, Option<&Inertia>),
            (&Position, &Velocity, &Attitude, &AngularVelocity),
            (&Force, &Torque),
        ),
        (With<StateIndex>, Without<TetherNode>),
    >,
    ends: Query<(&Attachment, &Mass, &Position, &Velocity)>,
    anchors: Query<(), With<Anchor>>,
    segments: Query<(&KelvinVoigt, &SegmentGeometry, &Tension)>,
) -> MechanicalEnergy {
    let gravity = environment.gravity;
    let (mut kinetic, mut potential, mut power) = (0.0, 0.0, 0.0);
    let mut add = |mass: f64, moving: f64, position: &Position, velocity: &Velocity| {
        let z = position.0.z;
        kinetic += 0.5 * moving * velocity.0.length_squared();
        potential += mass * gravity.potential_j_kg(z);
        power += mass * gravity.acceleration_m_s2(z) * velocity.0.z;
    };
    for (mass, position, velocity, _) in &nodes {
        add(mass.0, mass.0, position, velocity);
    }
    for ((mass, added, _), (position, velocity, _, _), _) in &bodies {
        add(mass.0, mass.0 + added.0, position, velocity);
    }
    for (end, mass, position, velocity) in &ends {
        if !anchors.contains(end.carrier) {
            add(mass.0, mass.0, position, velocity);
        }
    }
    for (_, _, velocity, force) in &nodes {
        power += force.0.dot(velocity.0);
    }
    for ((_, _, inertia), (_, velocity, attitude, rate), (force, torque)) in &bodies {
        power += force.0.dot(velocity.0) + torque.0.dot(attitude.0 * rate.0);
        if let Some(inertia) = inertia {
            kinetic += 0.5 * rate.0.dot(inertia.0 * rate.0);
        }
    }
    for (spring, geometry, tension) in &segments {
        let stretch = elastic_stretch_m(spring, geometry.length_m);
        potential += 0.5 * spring.stiffness_n_m * stretch * stretch;
        power += tension.0 * geometry.length_rate_m_s;
    }
    MechanicalEnergy {
        energy_j: kinetic + potential,
        kinetic_j: kinetic,
        power_w: power,
    }
}
