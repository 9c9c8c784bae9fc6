//! A latch that closes and opens. Closed, the rider is no part of the state: its mass is carried by the other body
//! ([`aerobot_systems::docking::ridden_body`]), whichever formulation moves it. Closing keeps momentum and angular
//! momentum ([`aerobot_systems::docking::impact`]); where links hold the carrier, what they do not allow of its new
//! motion is taken off by their impulses as the state is gathered. Opening changes no velocity, and so nothing
//! else.

use aerobot_components::body::Anchor;
use aerobot_components::docking::{Docked, DockingPhase, LatchState};
use aerobot_components::state::{
    AddedInertia, AngularVelocity, Attitude, ChartAttitude, Inertia, Mass, Origin, Position,
    StateIndex, Velocity,
};
use aerobot_systems::clock::Clock;
use aerobot_systems::docking::guidance::Guidance;
use aerobot_systems::docking::impact::{Carrier, Rider, carried, joined_motion};
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::linearised_motion::topology::BodyIndex;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::log;
use crate::world::{Free, SceneEntities, Warnings};

/// Joins a body to the one that its latch is for, as they are to each other now.
pub(super) fn close(world: &mut World, rider: Entity) {
    let Some((docked, bodies)) = pair(world, rider) else {
        return;
    };
    let carrier = docked.carrier;
    if world.get::<Anchor>(carrier).is_none() {
        let (velocity_m_s, rate_rad_s) = joined_motion(&bodies.0, &bodies.1);
        let attitude = world.get::<Attitude>(carrier).copied().unwrap_or_default();
        let added = carried(
            bodies.1.mass_kg,
            bodies.1.inertia_kg_m2,
            docked.offset_m,
            docked.attitude,
        );
        let mut entity = world.entity_mut(carrier);
        entity.insert((
            Velocity(attitude.0 * velocity_m_s),
            AngularVelocity(rate_rad_s),
        ));
        if let Some(mut of_carrier) = entity.get_mut::<CarriedMass>() {
            *of_carrier = of_carrier.plus(&added);
        }
    }
    world
        .entity_mut(rider)
        .remove::<(Free, StateIndex, BodyIndex)>()
        .insert(docked);
    enter(world, rider, DockingPhase::Docked);
    log(world, "docked", rider, None);
}

/// Lets a body go from the one that it rides on: both go on as they move.
pub(super) fn open(world: &mut World, name: &str) {
    let Some(rider) = world.resource::<SceneEntities>().get(name) else {
        return;
    };
    let Some(docked) = world.get::<Docked>(rider).copied() else {
        let time_s = world.resource::<Clock>().time_s;
        world.resource_mut::<Warnings>().0.push(format!(
            "`{name}` was to be undocked at {time_s} s, when it was not docked"
        ));
        return;
    };
    if let (Some(mass), Some(inertia)) = (
        world.get::<Mass>(rider).copied(),
        world.get::<Inertia>(rider).copied(),
    ) && let Some(mut of_carrier) = world.get_mut::<CarriedMass>(docked.carrier)
    {
        let own = carried(mass.0, inertia.0, docked.offset_m, docked.attitude);
        *of_carrier = CarriedMass {
            mass_kg: of_carrier.mass_kg - own.mass_kg,
            first_moment_kg_m: of_carrier.first_moment_kg_m - own.first_moment_kg_m,
            inertia_kg_m2: of_carrier.inertia_kg_m2 - own.inertia_kg_m2,
        };
    }
    let position = world.get::<Position>(rider).copied().unwrap_or_default();
    let attitude = world.get::<Attitude>(rider).copied().unwrap_or_default();
    world.entity_mut(rider).remove::<Docked>().insert((
        Free,
        Origin(position.0),
        ChartAttitude(attitude.0),
    ));
    // It does not close again by itself.
    if let Some(mut latch) = world.get_mut::<LatchState>(rider) {
        latch.is_armed = false;
    }
    enter(world, rider, DockingPhase::Released);
    log(world, "released", rider, None);
}

fn enter(world: &mut World, rider: Entity, phase: DockingPhase) {
    let time_s = world.resource::<Clock>().time_s;
    if let Some(mut guidance) = world.get_mut::<Guidance>(rider) {
        guidance.enter(phase, time_s);
        // The latch itself is what tells of these.
        guidance.news.pop();
    }
}

/// The body of a latch and the one that it is for, as they are.
fn pair(world: &World, rider: Entity) -> Option<(Docked, (Carrier, Rider))> {
    let carrier = world.get::<LatchState>(rider)?.target;
    let attitude = world.get::<Attitude>(carrier)?.0;
    let to_carrier = attitude.conjugate();
    let place = world.get::<Position>(rider)?.0 - world.get::<Position>(carrier)?.0;
    let docked = Docked {
        carrier,
        offset_m: to_carrier * place,
        attitude: (to_carrier * world.get::<Attitude>(rider)?.0).normalize(),
    };
    let load = world.get::<CarriedMass>(carrier).copied()?;
    let mass_kg = world.get::<Mass>(carrier).map_or(0.0, |mass| mass.0);
    let added_kg = world.get::<AddedInertia>(carrier).map_or(0.0, |kg| kg.0);
    let inertia = world
        .get::<Inertia>(carrier)
        .map_or(glam::DMat3::ZERO, |inertia| inertia.0);
    let bodies = (
        Carrier {
            mass_kg: mass_kg + added_kg + load.mass_kg,
            first_moment_kg_m: load.first_moment_kg_m,
            inertia_kg_m2: inertia + load.inertia_kg_m2,
            velocity_m_s: to_carrier * world.get::<Velocity>(carrier)?.0,
            rate_rad_s: world.get::<AngularVelocity>(carrier)?.0,
        },
        Rider {
            mass_kg: world.get::<Mass>(rider)?.0,
            inertia_kg_m2: world.get::<Inertia>(rider)?.0,
            offset_m: docked.offset_m,
            attitude: docked.attitude,
            velocity_m_s: to_carrier * world.get::<Velocity>(rider)?.0,
            rate_rad_s: world.get::<AngularVelocity>(rider)?.0,
        },
    );
    Some((docked, bodies))
}
