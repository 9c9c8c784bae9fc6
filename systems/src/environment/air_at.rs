//! Density and wind at every body and at the midpoint of every segment that asks for its [`Air`].

use aerobot_components::segment::{Segment, SegmentGeometry};
use aerobot_components::state::{Air, Position};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};

use super::EnvironmentModel;
use super::atmosphere::Atmosphere;
use crate::fault::FaultSlot;

/// Finds the air at bodies and at the midpoints of segments.
pub fn air_at_entities(
    environment: Res<EnvironmentModel>,
    mut faults: ResMut<FaultSlot>,
    mut bodies: Query<(Entity, &Position, &mut Air), Without<Segment>>,
    mut segments: Query<(Entity, &SegmentGeometry, &mut Air), With<Segment>>,
) {
    for (entity, position, mut air) in &mut bodies {
        *air = air_at(&environment, position.0.z, entity, &mut faults);
    }
    let (atmosphere, wind) = (&environment.atmosphere, &environment.wind);
    // Told apart once, not at every segment: the look-up is the hottest of a run.
    if let (Atmosphere::Table(table), false) = (atmosphere, wind.depends_on_altitude()) {
        let velocity_m_s = wind.level_velocity_m_s();
        for (entity, geometry, mut air) in &mut segments {
            let air = air.bypass_change_detection();
            air.velocity_m_s = velocity_m_s;
            match table.density_kg_m3(geometry.midpoint_m.z) {
                Some(density_kg_m3) => air.density_kg_m3 = density_kg_m3,
                None => *air = air_at(&environment, geometry.midpoint_m.z, entity, &mut faults),
            }
        }
        return;
    }
    for (entity, geometry, mut air) in &mut segments {
        *air.bypass_change_detection() =
            air_at(&environment, geometry.midpoint_m.z, entity, &mut faults);
    }
}

#[inline]
fn air_at(
    environment: &EnvironmentModel,
    altitude_m: f64,
    entity: Entity,
    faults: &mut FaultSlot,
) -> Air {
    let density = environment.atmosphere.density_kg_m3(altitude_m);
    let velocity = environment.wind.velocity_m_s(altitude_m);
    match (density, velocity) {
        (Ok(density_kg_m3), Ok(velocity_m_s)) => Air {
            density_kg_m3,
            velocity_m_s,
        },
        (density, velocity) => {
            let messages = [
                density.err().map(|outside| outside.to_string()),
                velocity.err().map(|outside| outside.to_string()),
            ];
            report(messages, entity, faults);
            Air::default()
        }
    }
}

#[cold]
fn report(messages: [Option<String>; 2], entity: Entity, faults: &mut FaultSlot) {
    for message in messages.into_iter().flatten() {
        faults.report(Some(entity), || message);
    }
}
