//! Spheres, buoyancy, added mass and the drag of bodies.

use aerobot_components::aerodynamics::{
    AddedMass, AddedVolume, Buoyancy, ConstantDragArea, DisplacedVolume, Drag, Sphere, SphereDrag,
    SphereRadius,
};
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::Air;
use aerobot_systems::dynamics::rigid_body::added_mass;
use aerobot_systems::forces::body_drag::{
    constant_drag, constant_drag_derivatives, sphere_drag, sphere_drag_derivatives,
};
use aerobot_systems::forces::buoyancy::buoyancy;
use bevy_ecs::world::World;

use crate::plugin::{Plugin, Simulator};
use crate::scene::{Scene, SetupError};
use crate::schedule::Phase;
use crate::world::SceneEntities;

/// What the air does to bodies.
pub struct AerodynamicsPlugin;

impl Plugin for AerodynamicsPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Sphere>()
            .register_component::<Buoyancy>()
            .register_component::<AddedMass>()
            .register_component::<Drag>()
            .add_check(check_spheres)
            .add_setup(set_up)
            .add_systems_for::<AddedMass, _, _>(Phase::Environment, || added_mass)
            .add_systems_for::<Buoyancy, _, _>(Phase::Forces, || buoyancy)
            .add_systems_for::<Drag, _, _>(Phase::Forces, || constant_drag)
            .add_systems_if(Phase::Forces, has_sphere_drag, || sphere_drag)
            .add_systems_for::<Drag, _, _>(Phase::Derivatives, || constant_drag_derivatives)
            .add_systems_if(Phase::Derivatives, has_sphere_drag, || {
                sphere_drag_derivatives
            });
    }
}

fn has_sphere_drag(scene: &Scene) -> bool {
    scene
        .with::<Drag>()
        .any(|(_, drag)| matches!(drag, Drag::Morrison))
}

fn check_spheres(scene: &Scene, report: &mut FieldReport) {
    for entity in &scene.entities {
        if entity.has::<Sphere>() {
            continue;
        }
        if entity
            .get::<Buoyancy>()
            .is_some_and(|buoyancy| buoyancy.volume_m3.is_none())
        {
            report.add(
                &entity.path::<Buoyancy>(),
                "`Buoyancy` needs a volume",
                "give `volume_m3`, or add a `Sphere`",
            );
        }
        match entity.get::<Drag>() {
            Some(Drag::Constant { area_m2: None, .. }) => report.add(
                &entity.path::<Drag>(),
                "`Drag` needs a reference area",
                "give `area_m2`, or add a `Sphere`",
            ),
            Some(Drag::Morrison) => report.add(
                &entity.path::<Drag>(),
                "`Morrison` is the drag of a sphere, and there is none",
                "add `Sphere: (radius_m: ..)`, or use `Constant`",
            ),
            _ => {}
        }
    }
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for entity in &scene.entities {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let mut spawned = world.entity_mut(id);
        let radius = spawned.get::<SphereRadius>().copied();
        let sphere_volume = radius.map_or(0.0, |radius| radius.volume_m3());
        let displaced = entity
            .get::<Buoyancy>()
            .map(|buoyancy| buoyancy.volume_m3.unwrap_or(sphere_volume));
        if let Some(volume_m3) = displaced {
            spawned.insert((DisplacedVolume(volume_m3), Air::default()));
        }
        if let Some(added) = entity.get::<AddedMass>() {
            let volume_m3 = displaced.unwrap_or(sphere_volume);
            spawned.insert((AddedVolume(added.coefficient * volume_m3), Air::default()));
        }
        let frontal = radius.map_or(0.0, |radius| radius.frontal_area_m2());
        match (entity.get::<Drag>(), radius) {
            (
                Some(Drag::Constant {
                    coefficient,
                    area_m2,
                }),
                _,
            ) => {
                let area = coefficient * area_m2.unwrap_or(frontal);
                spawned.insert((ConstantDragArea(area), Air::default()));
            }
            (Some(Drag::Morrison), Some(radius)) => {
                let sphere = SphereDrag {
                    diameter_m: 2.0 * radius.0,
                    area_m2: frontal,
                };
                spawned.insert((sphere, Air::default()));
            }
            _ => {}
        }
    }
    Ok(())
}
