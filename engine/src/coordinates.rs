//! What a formulation counts motion in, from the components of a world as they are: when a simulation is
//! built, and again whenever its topology has changed.

use aerobot_systems::denoc::stage_system::{Extras, LinkStages};
use aerobot_systems::dynamics::joint_vector::JointVector;
use aerobot_systems::dynamics::state_space::{Layout, StateSpace};
use aerobot_systems::dynamics::state_vector::StateVector;
use aerobot_systems::linearised_motion::shifted_system::ShiftedSystem;
use aerobot_systems::linearised_motion::stage_solver::StageSolver;
use aerobot_systems::linearised_motion::topology::Topology;
use bevy_ecs::world::World;

use crate::builtin::tethers::has_links;
use crate::integrator_choice::is_linearised;
use crate::scene::{Scene, SetupError};
use crate::{link_tree, topology};

/// The state of a world with what solves for its implicit stages.
pub(crate) struct Coordinates {
    /// Carries states to and from the components.
    pub(crate) state: Box<dyn StateSpace>,
    /// Solves with the linearised motion, and says in which topology it sees it: both empty where the
    /// integrator never asks.
    pub(crate) linearised: (Topology, Box<dyn StageSolver>),
}

impl Coordinates {
    /// Of a world in which everything has its place in a state of this layout.
    ///
    /// # Errors
    /// A topology that the formulation cannot move.
    pub(crate) fn of(world: &mut World, scene: &Scene, layout: Layout) -> Result<Self, SetupError> {
        if has_links(scene, scene.run.formulation) {
            let found = topology::find(world, layout)?;
            let mechanism = link_tree::build(world, scene, &found);
            let tree = mechanism.tree.clone();
            let extras = Extras {
                loose: mechanism
                    .entities
                    .loose
                    .iter()
                    .map(|loose| loose.point)
                    .collect(),
                tips_kg: mechanism.entities.tips_kg.clone(),
                elasticity: mechanism.entities.elasticity.clone(),
            };
            world.insert_resource(mechanism);
            let state = JointVector::new(world, layout.first_order);
            let solver = LinkStages::new(tree, found.topology.clone(), state.places(), extras);
            return Ok(Self {
                state: Box::new(state),
                linearised: (found.topology, Box::new(solver)),
            });
        }
        let topology = if is_linearised(&scene.run.integrator) {
            topology::find(world, layout)?.topology
        } else {
            Topology::default()
        };
        let solver = ShiftedSystem::new(topology.clone());
        Ok(Self {
            state: Box::new(StateVector::new(world, layout)),
            linearised: (topology, Box::new(solver)),
        })
    }
}
