//! Mechanical energy of the whole system and the work of non-conservative forces.
//!
//! E = sum 1/2 m v^2 + sum 1/2 omega' J omega (kinetic) + sum m phi(z) (gravity)
//!   + sum 1/2 k (L - L0)^2 (elastic, taut segments).
//!
//! dW/dt = sum F.v + T.omega - m_a a.v over what is free to move, less the power of weight and
//! springs: drag, buoyancy, dampers, added mass, moving anchors and a user's own forces. Then
//! E(t) - E(0) = W(t) for exact motion; the difference measures the integration. Masses on anchors are
//! left out.

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, SegmentGeometry};
use aerobot_components::state::{
    Acceleration, AddedInertia, AngularVelocity, Attitude, FirstOrderState, Force, Inertia, Mass,
    Position, StateIndex, Torque, Velocity,
};
use aerobot_components::tether::Attachment;
use bevy_ecs::component::Component;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};
use crate::environment::EnvironmentModel;

/// Name of the channel of kinetic energy.
pub const KINETIC: &str = "kinetic_energy_j";
/// Name of the channel of potential energy, gravity and springs.
pub const POTENTIAL: &str = "potential_energy_j";
/// Name of the channel of their sum.
pub const MECHANICAL: &str = "mechanical_energy_j";
/// Name of the channel of the work of non-conservative forces since the start.
pub const WORK: &str = "nonconservative_work_j";

/// Marks the entity that integrates the work of non-conservative forces.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct WorkIntegral;

type FreeBodies<'w, 's> = Query<
    'w,
    's,
    (
        &'static Mass,
        &'static Position,
        &'static Velocity,
        Option<(&'static Inertia, &'static AngularVelocity)>,
    ),
    With<StateIndex>,
>;
type Ends<'w, 's> = Query<
    'w,
    's,
    (
        &'static Attachment,
        &'static Mass,
        &'static Position,
        &'static Velocity,
    ),
>;

/// Records the energy of the whole system.
pub fn energy(
    mut log: ResMut<ChannelLog>,
    environment: Res<EnvironmentModel>,
    bodies: FreeBodies,
    ends: Ends,
    anchors: Query<(), With<Anchor>>,
    segments: Query<(&KelvinVoigt, &SegmentGeometry)>,
    work: Query<(&BuiltInChannels, &FirstOrderState), With<WorkIntegral>>,
) {
    let Ok((channels, work)) = work.single() else {
        return;
    };
    let gravity = environment.gravity;
    let (mut kinetic, mut potential) = (0.0, 0.0);
    for (mass, position, velocity, turning) in &bodies {
        kinetic += 0.5 * mass.0 * velocity.0.length_squared();
        potential += mass.0 * gravity.potential_j_kg(position.0.z);
        if let Some((inertia, rate)) = turning {
            kinetic += 0.5 * rate.0.dot(inertia.0 * rate.0);
        }
    }
    for (end, mass, position, velocity) in &ends {
        if !anchors.contains(end.carrier) {
            kinetic += 0.5 * mass.0 * velocity.0.length_squared();
            potential += mass.0 * gravity.potential_j_kg(position.0.z);
        }
    }
    for (spring, geometry) in &segments {
        let stretch = elastic_stretch_m(spring, geometry.length_m);
        potential += 0.5 * spring.stiffness_n_m * stretch * stretch;
    }
    for (channel, value) in [
        (KINETIC, kinetic),
        (POTENTIAL, potential),
        (MECHANICAL, kinetic + potential),
        (WORK, work.value),
    ] {
        if channels.has(channel) {
            log.record_system(channel, value);
        }
    }
}

/// Finds the power of non-conservative forces, when all forces and accelerations are known.
pub fn nonconservative_power(
    environment: Res<EnvironmentModel>,
    bodies: Query<
        (
            &Mass,
            &Position,
            &Velocity,
            &Force,
            Option<(
                &Torque,
                &Attitude,
                &AngularVelocity,
                &AddedInertia,
                &Acceleration,
            )>,
        ),
        (With<StateIndex>, Without<Attachment>),
    >,
    ends: Ends,
    anchors: Query<(), With<Anchor>>,
    segments: Query<(&KelvinVoigt, &SegmentGeometry)>,
    mut work: Query<&mut FirstOrderState, With<WorkIntegral>>,
) {
    let Ok(mut work) = work.single_mut() else {
        return;
    };
    let gravity = environment.gravity;
    let weight_power = |mass: f64, z: f64, climb: f64| -mass * gravity.acceleration_m_s2(z) * climb;
    let mut power = 0.0;
    for (mass, position, velocity, force, body) in &bodies {
        power += force.0.dot(velocity.0) - weight_power(mass.0, position.0.z, velocity.0.z);
        if let Some((torque, attitude, rate, added, acceleration)) = body {
            power += torque.0.dot(attitude.0 * rate.0);
            power -= added.0 * acceleration.0.dot(velocity.0);
        }
    }
    for (end, mass, position, velocity) in &ends {
        if !anchors.contains(end.carrier) {
            power -= weight_power(mass.0, position.0.z, velocity.0.z);
        }
    }
    for (spring, geometry) in &segments {
        let stretch = elastic_stretch_m(spring, geometry.length_m);
        power += spring.stiffness_n_m * stretch * geometry.length_rate_m_s;
    }
    work.rate_per_s = power;
}

/// The stretch that stores energy, m.
pub(super) fn elastic_stretch_m(spring: &KelvinVoigt, length_m: f64) -> f64 {
    let stretch = length_m - spring.rest_length_m;
    if spring.slack {
        stretch.max(0.0)
    } else {
        stretch
    }
}
