//! Momentum of everything that is free to move, and the impulse of the outer forces on it.
//!
//! P = sum m v over bodies, nodes, and the masses of tethers and riders that free bodies carry.
//!
//! dI/dt = sum F - sum m_a a + sum mu r/2 (v_far - v_near)
//!
//! F all forces on what is free to move, m_a added mass, a acceleration of its body; mu r/2 mass that the two ends of
//! a line gain at a winch in unit time, at their velocities, an end on an anchor left out ([`crate::dynamics::winch`]).
//! Forces between two of them, tensions and the reactions of rigid links, are in the sum twice and cancel: what is
//! left is weight, buoyancy, drag, thrust, a user's forces, and the pull of anchors (and the momentum of line that a
//! winch on an anchor lets go). P(t) - I(t) then stays for exact motion.
//!
//! P is that of the masses alone: the air that moves with a body is outside, its reaction -m_a a is an outer force, as
//! in the work of [`super::energy`]. What is held by an anchor or rides on one has no part in P.

use aerobot_components::body::Anchor;
use aerobot_components::docking::Docked;
use aerobot_components::state::{
    Acceleration, AddedInertia, FirstOrderState, Force, Mass, StateIndex, Velocity,
};
use aerobot_components::tether::Attachment;
use aerobot_components::winch::ReeledLine;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, ResMut, SystemParam};
use glam::DVec3;

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Names of the channels of momentum along x, y and z.
pub const MOMENTUM: [&str; 3] = [
    "momentum_x_kg_m_s",
    "momentum_y_kg_m_s",
    "momentum_z_kg_m_s",
];
/// Names of the channels of the impulse of outer forces since the start.
pub const IMPULSE: [&str; 3] = ["impulse_x_n_s", "impulse_y_n_s", "impulse_z_n_s"];

/// Integrates one component of the impulse of outer forces: that along x (0), y (1) or z (2).
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImpulseIntegral(pub usize);

/// Everything that has momentum.
#[derive(SystemParam)]
pub struct MomentumSum<'w, 's> {
    moving: Query<
        'w,
        's,
        (
            &'static Mass,
            &'static Velocity,
            &'static Force,
            Option<(&'static AddedInertia, &'static Acceleration)>,
        ),
        With<StateIndex>,
    >,
    ends: Query<'w, 's, (&'static Attachment, &'static Mass, &'static Velocity)>,
    riders: Query<'w, 's, (&'static Docked, &'static Mass, &'static Velocity)>,
    lines: Query<'w, 's, &'static ReeledLine>,
    velocities: Query<'w, 's, &'static Velocity>,
    anchors: Query<'w, 's, (), With<Anchor>>,
}

impl MomentumSum<'_, '_> {
    /// Momentum of the state that was evaluated last, kg m/s.
    #[must_use]
    pub fn momentum_kg_m_s(&self) -> DVec3 {
        let moving = self.moving.iter();
        let own = moving.map(|(mass, velocity, ..)| mass.0 * velocity.0);
        let ends = self.ends.iter();
        let ends = ends.filter(|(end, ..)| !self.anchors.contains(end.carrier));
        let riders = self.riders.iter();
        let riders = riders.filter(|(docked, ..)| !self.anchors.contains(docked.carrier));
        own.chain(ends.map(|(_, mass, velocity)| mass.0 * velocity.0))
            .chain(riders.map(|(_, mass, velocity)| mass.0 * velocity.0))
            .sum()
    }

    /// Force from outside, N, when all forces and accelerations are known.
    #[must_use]
    pub fn outer_force_n(&self) -> DVec3 {
        let moving = self.moving.iter().map(|(_, _, force, air)| {
            let by_air = air.map_or(DVec3::ZERO, |(added, acceleration)| {
                added.0 * acceleration.0
            });
            force.0 - by_air
        });
        moving
            .chain(self.lines.iter().map(|line| self.flow_n(line)))
            .sum()
    }

    /// Rate at which the momentum changes by the masses at the ends of a reeled line, N.
    fn flow_n(&self, line: &ReeledLine) -> DVec3 {
        let free_m_s = |point: Entity| {
            let end = self.ends.get(point);
            let is_held = end.is_ok_and(|(end, ..)| self.anchors.contains(end.carrier));
            let velocity = self.velocities.get(point).ok().filter(|_| !is_held);
            velocity.map_or(DVec3::ZERO, |velocity| velocity.0)
        };
        0.5 * line.line_kg_m * line.rate_m_s * (free_m_s(line.far) - free_m_s(line.near))
    }

    /// Whether something outside of the system can give it an impulse at once.
    #[must_use]
    pub fn is_held(&self) -> bool {
        !self.anchors.is_empty()
    }
}

/// Momentum that a change at one instant may take from or give to the system, kg m/s: nothing where there is no
/// anchor to take it.
pub fn momentum_beside_anchors(sum: MomentumSum) -> Option<DVec3> {
    sum.is_held().then(|| sum.momentum_kg_m_s())
}

/// Finds the rates of the impulse of outer forces.
pub fn outer_impulse(
    sum: MomentumSum,
    mut impulses: Query<(&ImpulseIntegral, &mut FirstOrderState)>,
) {
    let force_n = sum.outer_force_n();
    for (axis, mut impulse) in &mut impulses {
        impulse.rate_per_s = force_n[axis.0];
    }
}

/// Records momentum and impulse of the whole system.
pub fn momentum(
    mut log: ResMut<ChannelLog>,
    sum: MomentumSum,
    impulses: Query<(&ImpulseIntegral, &BuiltInChannels, &FirstOrderState)>,
) {
    let momentum = sum.momentum_kg_m_s();
    for (axis, channels, impulse) in &impulses {
        for (channel, value) in [
            (MOMENTUM[axis.0], momentum[axis.0]),
            (IMPULSE[axis.0], impulse.value),
        ] {
            if channels.has(channel) {
                log.record_system(channel, value);
            }
        }
    }
}
