//! What a built scene contains, as lines for a person.

use aerobot_components::aerodynamics::SphereRadius;
use aerobot_components::body::{Anchor, Body};
use aerobot_components::state::{Mass, Position};
use aerobot_components::tether::{Tether, TetherParts};
use aerobot_systems::environment::EnvironmentModel;

use crate::builtin::{fixed_wing, gusts, sails};
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::world::SceneEntities;

impl Simulation {
    /// One line for each entity of `scene`, from which this simulation was built, and what the run
    /// will be like.
    pub fn contents(&mut self, scene: &Scene) -> Vec<String> {
        let groups = scene.groups.iter().filter_map(|group| {
            let (first, last) = (group.members.first()?, group.members.last()?);
            Some(format!(
                "{:<16} {}: `{first}` to `{last}`",
                group.name, group.component
            ))
        });
        let entities = scene.entities.iter().map(|entity| {
            let components: Vec<&str> = entity.components.iter().map(|(name, _)| *name).collect();
            format!(
                "{:<16} {}{}",
                entity.name,
                components.join(", "),
                self.facts(&entity.name)
            )
        });
        let mut lines: Vec<String> = groups.chain(entities).collect();
        lines.push(format!(
            "air: {:?}, gravity: {:?}, {} source(s) of wind",
            scene.environment.atmosphere,
            scene.environment.gravity,
            scene.environment.wind.len()
        ));
        let wind = &self.world().resource::<EnvironmentModel>().wind;
        lines.extend(gusts::describe(&wind.gusts().collect::<Vec<_>>()));
        lines.extend(fixed_wing::describe(self.world()));
        lines.extend(sails::describe(self.world(), scene));
        let stable = self.stable_step();
        if stable.step_s.is_finite() {
            lines.push(format!(
                "largest stable step of RK4 for the tethers: {:.4e} s, set by segment `{}`",
                stable.step_s, stable.segment
            ));
        }
        lines.push(format!(
            "run: {} s, output every {} s, {}, {}",
            scene.run.duration_s,
            scene.run.output_every_s,
            scene.run.formulation.name(),
            self.integrator()
        ));
        lines
    }

    fn facts(&self, name: &str) -> String {
        let world = self.world();
        let Some(entity) = world.resource::<SceneEntities>().get(name) else {
            return String::new();
        };
        if let (Some(tether), Some(parts)) = (
            world.get::<Tether>(entity),
            world.get::<TetherParts>(entity),
        ) {
            return format!(
                ": {} m from `{}` to `{}`, {} nodes, {} segments, {:.6} kg",
                tether.length_m,
                tether.from.0,
                tether.to.0,
                tether.nodes,
                parts.segments.len(),
                tether.mass_kg()
            );
        }
        let mut facts = Vec::new();
        if world.get::<Body>(entity).is_some()
            && let Some(mass) = world.get::<Mass>(entity)
        {
            facts.push(format!("{} kg", mass.0));
        }
        if let Some(radius) = world.get::<SphereRadius>(entity) {
            facts.push(format!("radius {:.6} m", radius.0));
        }
        if let Some(position) = world.get::<Position>(entity) {
            let place = position.0;
            let verb = if world.get::<Anchor>(entity).is_some() {
                "held"
            } else {
                "starts"
            };
            facts.push(format!(
                "{verb} at ({}, {}, {}) m",
                place.x, place.y, place.z
            ));
        }
        if facts.is_empty() {
            String::new()
        } else {
            format!(": {}", facts.join(", "))
        }
    }
}
