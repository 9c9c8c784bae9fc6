//! What a scene's dimensions come out as: radii of spheres, and where on what each tether is attached.

use std::collections::BTreeMap;

use aerobot_components::aerodynamics::SphereRadius;
use aerobot_components::tether::{Attachment, TetherParts};
use glam::DVec3;

use crate::plugin::Simulator;
use crate::scene::{Scene, SceneError};
use crate::world::{EntityName, SceneEntities, build_world};

/// An end of a tether.
#[derive(Clone, Debug, PartialEq)]
pub struct TetherEndPlace {
    /// The body or anchor that carries it.
    pub carrier: String,
    /// Place on the carrier, from its centre of mass in the body frame, m.
    pub offset_m: DVec3,
}

/// The dimensions of a scene, resolved.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    /// Radius of every sphere, m, by the name of its entity.
    pub sphere_radius_m: BTreeMap<String, f64>,
    /// Both ends of every tether, `from` first, by the name of the tether.
    pub tether_ends: BTreeMap<String, [TetherEndPlace; 2]>,
}

impl Simulator {
    /// The dimensions of a scene, as a run of it begins with; nothing is placed.
    ///
    /// # Errors
    /// What cannot be built, rendered.
    pub fn geometry(&self, scene: &Scene) -> Result<Geometry, SceneError> {
        let world = build_world(self, scene).map_err(|error| scene.refuse(error))?;
        let mut geometry = Geometry::default();
        for &entity in world.resource::<SceneEntities>().in_order() {
            let Some(EntityName(name)) = world.get(entity) else {
                continue;
            };
            if let Some(radius) = world.get::<SphereRadius>(entity) {
                geometry.sphere_radius_m.insert(name.to_string(), radius.0);
            }
            let place = |point: Option<&_>| {
                let attachment = world.get::<Attachment>(*point?)?;
                Some(TetherEndPlace {
                    carrier: world.get::<EntityName>(attachment.carrier)?.0.to_string(),
                    offset_m: attachment.offset_m,
                })
            };
            if let Some(TetherParts { points, .. }) = world.get(entity)
                && let (Some(from), Some(to)) = (place(points.first()), place(points.last()))
            {
                geometry.tether_ends.insert(name.to_string(), [from, to]);
            }
        }
        Ok(geometry)
    }
}
