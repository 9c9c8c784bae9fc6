//! Sums of energy and power over everything that is free to move.
//!
//! Kinetic: sum 1/2 m v^2 + sum 1/2 omega' J omega. Potential: sum m phi(z) + sum 1/2 k (L - L0)^2 over taut
//! segments + sum 1/2 (GJ / L) phi^2 of tethers that resist being twisted by phi. Bodies and nodes count, and the
//! masses that tethers put on bodies; masses on anchors do not. Of a link that is a rod, half of whose mass m
//! counts at each end, m/12 v^2 is taken off, v the velocity of one end against the other. Rigid links store
//! nothing.

use aerobot_components::body::Anchor;
use aerobot_components::docking::Docked;
use aerobot_components::segment::{KelvinVoigt, RigidLink, SegmentGeometry};
use aerobot_components::state::{
    Acceleration, AddedInertia, AngularVelocity, Attitude, Force, Inertia, Mass, Position,
    StateIndex, Torque, Velocity,
};
use aerobot_components::tether::Attachment;
use aerobot_components::torsion::{Torsion, Twist};
use bevy_ecs::query::{QueryData, With, Without};
use bevy_ecs::system::{Query, Res, SystemParam};

use super::winch::ReelPower;
use crate::dynamics::link_mechanism::LinkMechanism;
use crate::environment::EnvironmentModel;

/// What the air that moves with a body is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AddedMass {
    /// A part of the system: it has kinetic energy.
    Inside,
    /// A part of the surroundings: its reaction is a force that does work.
    Outside,
}

/// What moves and is loaded: a node, or a body with what makes it one.
#[derive(QueryData)]
struct Moving {
    mass: &'static Mass,
    position: &'static Position,
    velocity: &'static Velocity,
    force: &'static Force,
    spin: Option<(&'static Inertia, &'static AngularVelocity)>,
    body: Option<(
        &'static Torque,
        &'static Attitude,
        &'static AngularVelocity,
        &'static AddedInertia,
        &'static Acceleration,
    )>,
}

/// A body that rides on another; the forces on it count with those on its carrier.
#[derive(QueryData)]
struct Rider {
    docked: &'static Docked,
    mass: &'static Mass,
    position: &'static Position,
    velocity: &'static Velocity,
    spin: (&'static Inertia, &'static AngularVelocity),
}

/// The spring of a segment as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchedSpring {
    /// Stiffness, N/m.
    pub stiffness_n_m: f64,
    /// The stretch that stores energy, m.
    pub stretch_m: f64,
    /// Rate of change of the length, m/s.
    pub rate_m_s: f64,
}

/// Everything that has energy.
#[derive(SystemParam)]
pub struct EnergySum<'w, 's> {
    environment: Res<'w, EnvironmentModel>,
    moving: Query<'w, 's, Moving, With<StateIndex>>,
    ends: Query<
        'w,
        's,
        (
            &'static Attachment,
            &'static Mass,
            &'static Position,
            &'static Velocity,
        ),
    >,
    riders: Query<'w, 's, Rider>,
    anchors: Query<'w, 's, (), With<Anchor>>,
    segments: Query<'w, 's, (&'static KelvinVoigt, &'static SegmentGeometry), Without<RigidLink>>,
    torsions: Query<'w, 's, (&'static Torsion, &'static Twist)>,
    reels: Query<'w, 's, &'static ReelPower>,
    links: Option<Res<'w, LinkMechanism>>,
}

impl EnergySum<'_, '_> {
    /// Kinetic energy, J.
    #[must_use]
    pub fn kinetic_j(&self, added: AddedMass) -> f64 {
        let mut kinetic_j = 0.0;
        for moving in &self.moving {
            let mut mass_kg = moving.mass.0;
            if let (AddedMass::Inside, Some((_, _, _, added, _))) = (added, moving.body) {
                mass_kg += added.0;
            }
            kinetic_j += 0.5 * mass_kg * moving.velocity.0.length_squared();
            if let Some((inertia, rate)) = moving.spin {
                kinetic_j += 0.5 * rate.0.dot(inertia.0 * rate.0);
            }
        }
        for (mass, _, velocity) in self.free_ends() {
            kinetic_j += 0.5 * mass.0 * velocity.0.length_squared();
        }
        for rider in self.free_riders() {
            kinetic_j += 0.5 * rider.mass.0 * rider.velocity.0.length_squared();
            let (inertia, rate) = rider.spin;
            kinetic_j += 0.5 * rate.0.dot(inertia.0 * rate.0);
        }
        kinetic_j + self.links.as_ref().map_or(0.0, |links| links.kinetic_j())
    }

    /// Potential energy of gravity, springs and torsion, J.
    #[must_use]
    pub fn potential_j(&self) -> f64 {
        let gravity = self.environment.gravity;
        let mut potential_j = 0.0;
        for moving in &self.moving {
            potential_j += moving.mass.0 * gravity.potential_j_kg(moving.position.0.z);
        }
        for (mass, position, _) in self.free_ends() {
            potential_j += mass.0 * gravity.potential_j_kg(position.0.z);
        }
        for rider in self.free_riders() {
            potential_j += rider.mass.0 * gravity.potential_j_kg(rider.position.0.z);
        }
        for spring in self.springs() {
            potential_j += 0.5 * spring.stiffness_n_m * spring.stretch_m * spring.stretch_m;
        }
        for (torsion, twist) in &self.torsions {
            potential_j += 0.5 * torsion.stiffness_n_m * twist.twist_rad * twist.twist_rad;
        }
        potential_j
    }

    /// Power of all forces and torques but weight, W; those of the tethers are among them.
    #[must_use]
    pub fn power_besides_weight_w(&self, added: AddedMass) -> f64 {
        let gravity = self.environment.gravity;
        // Of the opposite of weight.
        let lift_w = |mass: &Mass, position: &Position, velocity: &Velocity| {
            mass.0 * gravity.acceleration_m_s2(position.0.z) * velocity.0.z
        };
        let mut power_w = 0.0;
        for moving in &self.moving {
            power_w += moving.force.0.dot(moving.velocity.0)
                + lift_w(moving.mass, moving.position, moving.velocity);
            if let Some((torque, attitude, rate, added_inertia, acceleration)) = moving.body {
                power_w += torque.0.dot(attitude.0 * rate.0);
                if added == AddedMass::Outside {
                    power_w -= added_inertia.0 * acceleration.0.dot(moving.velocity.0);
                }
            }
        }
        for (mass, position, velocity) in self.free_ends() {
            power_w += lift_w(mass, position, velocity);
        }
        for rider in self.free_riders() {
            power_w += lift_w(rider.mass, rider.position, rider.velocity);
        }
        // What the reactions of rods do goes into their kinetic energy.
        power_w
            + self
                .links
                .as_ref()
                .map_or(0.0, |links| links.kinetic_rate_w())
    }

    /// The springs of all segments.
    pub fn springs(&self) -> impl Iterator<Item = StretchedSpring> {
        self.segments.iter().map(|(spring, geometry)| {
            let stretch_m = geometry.length_m - spring.rest_length_m;
            StretchedSpring {
                stiffness_n_m: spring.stiffness_n_m,
                stretch_m: if spring.slack {
                    stretch_m.max(0.0)
                } else {
                    stretch_m
                },
                rate_m_s: geometry.length_rate_m_s,
            }
        })
    }

    /// Power that goes into the potential of torsion, W.
    #[must_use]
    pub fn torsion_potential_rate_w(&self) -> f64 {
        let rates = self
            .torsions
            .iter()
            .map(|(torsion, twist)| torsion.stiffness_n_m * twist.twist_rad * twist.rate_rad_s);
        rates.sum()
    }

    /// Power that torsion takes, its damping included, W.
    #[must_use]
    pub fn torsion_power_w(&self) -> f64 {
        let taken = self.torsions.iter();
        taken
            .map(|(_, twist)| twist.torque_n_m * twist.rate_rad_s)
            .sum()
    }

    /// What winches do: by the change of lengths and masses, and through dampers, W.
    #[must_use]
    pub fn reels_w(&self) -> (f64, f64) {
        let add = |sum: (f64, f64), power: &ReelPower| {
            (sum.0 + power.by_change_w, sum.1 + power.by_damper_w)
        };
        self.reels.iter().fold((0.0, 0.0), add)
    }

    /// The bodies that ride on what is free to move.
    fn free_riders(&self) -> impl Iterator<Item = RiderItem<'_, '_>> {
        self.riders
            .iter()
            .filter(|rider| !self.anchors.contains(rider.docked.carrier))
    }

    /// The masses of tethers that are carried by what is free to move.
    fn free_ends(&self) -> impl Iterator<Item = (&Mass, &Position, &Velocity)> {
        self.ends
            .iter()
            .filter(|(end, ..)| !self.anchors.contains(end.carrier))
            .map(|(_, mass, position, velocity)| (mass, position, velocity))
    }
}
