//! Building a simulation: a world, its schedules, everything in its place, the integrator.

use std::sync::Arc;

use aerobot_components::run::Formulation;
use aerobot_systems::dynamics::state_space::StateSpace;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::Fault;
use aerobot_systems::instruments::energy_guard::mechanical_energy;
use aerobot_systems::integration::Trajectory;
use bevy_ecs::world::World;

use crate::builtin::actuators;
use crate::builtin::channels::find_supports;
use crate::builtin::tethers::has_links;
use crate::coordinates::Coordinates;
use crate::evaluation::{Evaluation, Implicit, Integration, IntegrationSlot};
use crate::integrator_choice::{Choice, choose_integrator};
use crate::linearisation::Linearisation;
use crate::link_start::Start;
use crate::plugin::Simulator;
use crate::restructure::SceneOfWorld;
use crate::scene::{Scene, SceneError, SetupError};
use crate::schedule::{self, EVALUATE, Evaluate, LINEARISE, Linearise, STEP, Step};
use crate::sequence::Sequence;
use crate::simulation::{SceneFacts, Simulation};
use crate::stable_step::{self, StableStep};
use crate::stopping::owner_name;
use crate::world::{build_world, lay_out_state};
use crate::{link_stable_step, placement};

impl Simulator {
    /// Builds the world of a scene and places everything in it.
    ///
    /// # Errors
    /// What cannot be built, rendered: no equilibrium, a step that is not stable, an altitude outside
    /// the atmosphere, an ambiguity between systems.
    pub fn build(&self, scene: &Scene) -> Result<Simulation, SceneError> {
        let refuse = |error| scene.refuse(error);
        let mut world = build_world(self, scene).map_err(refuse)?;
        actuators::bind(&mut world, scene).map_err(refuse)?;
        let layout = lay_out_state(&mut world);
        let mut schedules = Schedules::new(self, scene, &mut world)?;
        placement::place(&mut world, schedules.forces(), scene).map_err(refuse)?;
        find_supports(&mut world);
        start_environment(&mut world);
        let Coordinates {
            mut state,
            linearised,
        } = Coordinates::of(&mut world, scene, layout).map_err(refuse)?;
        let trajectory = start(&mut world, scene, &mut schedules, &mut *state)?;
        let scales = state.error_scales(&mut world);
        let first_order = scales[2 * state.layout().coordinates..].to_vec();
        let mut linearisation =
            Linearisation::new(&mut world, schedules.linearise, first_order, linearised);
        let stable_step = stable_step(&mut world, scene, &mut linearisation, &mut *state);
        let Choice {
            integrator,
            step_s,
            description,
        } = choose_integrator(scene, &stable_step, scales)?;
        let integration = Integration {
            evaluation: schedules.evaluation,
            statics: schedules.statics,
            state,
            implicit: Implicit {
                linearisation,
                energy: world.register_system(mechanical_energy),
            },
            integrator,
            trajectory,
            limit_s: 0.0,
            failure: None,
        };
        world.insert_resource(IntegrationSlot::new(integration));
        world.insert_resource(SceneOfWorld(Arc::new(scene.clone())));
        let facts = SceneFacts {
            name: scene.name.clone(),
            seed: scene.run.seed,
            formulation: scene.run.formulation.name(),
            integrator: description,
        };
        let duration_s = scene.run.duration_s;
        let steps = (stable_step, step_s);
        Ok(Simulation::new(
            world,
            schedules.step,
            duration_s,
            facts,
            steps,
        ))
    }
}

/// Everything that is ordered.
struct Schedules {
    evaluation: Evaluation,
    /// The forces of the lumped formulation, where another moves the world.
    statics: Option<Evaluation>,
    step: Sequence,
    linearise: Sequence,
}

impl Schedules {
    fn new(simulator: &Simulator, scene: &Scene, world: &mut World) -> Result<Self, SceneError> {
        let formulation = scene.run.formulation;
        let evaluate = |formulation, world: &mut World| {
            let of_scene = (scene, formulation);
            schedule::build(Evaluate, &EVALUATE, simulator, of_scene, world)
                .map(|schedule| Evaluation { schedule })
                .map_err(unordered)
        };
        let of_scene = (scene, formulation);
        Ok(Self {
            evaluation: evaluate(formulation, world)?,
            statics: match formulation {
                Formulation::LumpedMass => None,
                Formulation::Denoc => Some(evaluate(Formulation::LumpedMass, world)?),
            },
            step: schedule::build(Step, &STEP, simulator, of_scene, world).map_err(unordered)?,
            linearise: schedule::build(Linearise, &LINEARISE, simulator, of_scene, world)
                .map_err(unordered)?,
        })
    }

    /// What finds states of rest.
    fn forces(&mut self) -> &mut Evaluation {
        self.statics.as_mut().unwrap_or(&mut self.evaluation)
    }
}

/// The state that the components start from, evaluated.
fn start(
    world: &mut World,
    scene: &Scene,
    schedules: &mut Schedules,
    state: &mut dyn StateSpace,
) -> Result<Trajectory, SceneError> {
    let mut trajectory = Trajectory::new(0.0, vec![0.0; state.layout().len()]);
    let start = Start::of(world);
    state.gather(world, &mut trajectory.state);
    state
        .scatter(world, &trajectory.state)
        .and_then(|()| schedules.evaluation.run(world))
        .map_err(|fault| not_evaluated(world, scene, &fault))?;
    start.check(world).map_err(|error| scene.refuse(error))?;
    Ok(trajectory)
}

fn stable_step(
    world: &mut World,
    scene: &Scene,
    linearisation: &mut Linearisation,
    state: &mut dyn StateSpace,
) -> StableStep {
    let of_springs = stable_step::find(world);
    if !has_links(scene, scene.run.formulation) {
        return of_springs;
    }
    let springs = scene.run.elastic_links.then_some(&of_springs);
    let of_links = link_stable_step::find(world, linearisation, state, springs);
    let of_torsion = stable_step::by_torsion(world);
    if of_torsion.step_s < of_links.step_s {
        of_torsion
    } else {
        of_links
    }
}

/// A start that cannot be evaluated, rendered.
fn not_evaluated(world: &World, scene: &Scene, fault: &Fault) -> SceneError {
    let name = fault.entity.and_then(|entity| owner_name(world, entity));
    let path = name
        .as_ref()
        .map_or_else(String::new, |name| format!("entities.{name}"));
    let who = name.map_or_else(String::new, |name| format!("`{name}`: "));
    scene.refuse(SetupError::new(path, format!("{who}{}", fault.message), ""))
}

fn unordered(text: String) -> SceneError {
    SceneError::plain(format_args!(
        "the systems of the plugins cannot be ordered: {text}"
    ))
}

/// The wind of the first interval.
fn start_environment(world: &mut World) {
    world
        .resource_mut::<EnvironmentModel>()
        .wind
        .begin_interval(0.0);
}
