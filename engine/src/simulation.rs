//! A simulation: the world of one scene, built, and the loop that runs it.

use aerobot_components::run::Formulation;
use aerobot_components::sampling::Sampling;
use aerobot_systems::clock::Clock;
use aerobot_systems::denoc::stage_system::LinkStages;
use aerobot_systems::dynamics::joint_vector::JointVector;
use aerobot_systems::dynamics::state_space::{Layout, StateSpace};
use aerobot_systems::dynamics::state_vector::StateVector;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::{Fault, FaultSlot};
use aerobot_systems::instruments::energy_guard::mechanical_energy;
use aerobot_systems::integration::{Cost, Equations, StepFailure, Trajectory};
use aerobot_systems::linearised_motion::shifted_system::ShiftedSystem;
use aerobot_systems::linearised_motion::stage_solver::StageSolver;
use aerobot_systems::linearised_motion::topology::Topology;
use bevy_ecs::query::QueryState;
use bevy_ecs::world::World;

use crate::builtin::channels::find_supports;
use crate::builtin::recorder::Recorder;
use crate::builtin::tethers::has_links;
use crate::evaluation::{
    Evaluation, Implicit, Integration, IntegrationSlot, WorldEquations, with_integration,
};
use crate::integrator_choice::{Choice, choose_integrator, is_linearised};
use crate::linearisation::Linearisation;
use crate::link_stable_step;
use crate::link_start::Start;
use crate::link_tree;
use crate::placement;
use crate::plugin::Simulator;
use crate::recording::frame::ResultSink;
use crate::recording::summary::{Stop, Summary};
use crate::scene::{Scene, SceneError, SetupError};
use crate::schedule::{self, EVALUATE, Evaluate, LINEARISE, Linearise, STEP, Step};
use crate::sequence::Sequence;
use crate::stable_step::{self, StableStep};
use crate::stopping::owner_name;
use crate::topology;
use crate::world::{Edges, build_world, lay_out_state};

/// A built simulation.
pub struct Simulation {
    pub(crate) world: World,
    step: Sequence,
    samplings: QueryState<&'static Sampling>,
    duration_s: f64,
    pub(crate) stable_step: StableStep,
    pub(crate) step_s: Option<f64>,
    pub(crate) scene: SceneFacts,
}

/// What the summary says of the scene.
pub(crate) struct SceneFacts {
    pub(crate) name: String,
    pub(crate) seed: u64,
    pub(crate) formulation: &'static str,
    pub(crate) integrator: String,
}

impl Simulator {
    /// Builds the world of a scene and places everything in it.
    ///
    /// # Errors
    /// What cannot be built, rendered: no equilibrium, a step that is not stable, an altitude outside
    /// the atmosphere, an ambiguity between systems.
    pub fn build(&self, scene: &Scene) -> Result<Simulation, SceneError> {
        let mut world = build_world(self, scene).map_err(|error| scene.refuse(error))?;
        let layout = lay_out_state(&mut world);
        let formulation = scene.run.formulation;
        let evaluate = |formulation, world: &mut World| {
            let schedule = schedule::build(Evaluate, &EVALUATE, self, (scene, formulation), world);
            Ok::<_, SceneError>(Evaluation {
                schedule: schedule.map_err(unordered)?,
            })
        };
        let mut evaluation = evaluate(formulation, &mut world)?;
        let mut statics = match formulation {
            Formulation::LumpedMass => None,
            Formulation::Denoc => Some(evaluate(Formulation::LumpedMass, &mut world)?),
        };
        let of_scene = (scene, formulation);
        let step = schedule::build(Step, &STEP, self, of_scene, &mut world).map_err(unordered)?;
        let linearise = schedule::build(Linearise, &LINEARISE, self, of_scene, &mut world)
            .map_err(unordered)?;
        let forces = statics.as_mut().unwrap_or(&mut evaluation);
        placement::place(&mut world, forces, scene).map_err(|error| scene.refuse(error))?;
        find_supports(&mut world);
        start_environment(&mut world);
        let Coordinates {
            mut state,
            topology,
            solver,
        } = coordinates(&mut world, scene, layout).map_err(|error| scene.refuse(error))?;
        let mut trajectory = Trajectory::new(0.0, vec![0.0; state.layout().len()]);
        let start = Start::of(&mut world);
        state.gather(&mut world, &mut trajectory.state);
        state
            .scatter(&mut world, &trajectory.state)
            .and_then(|()| evaluation.run(&mut world))
            .map_err(|fault| not_evaluated(&world, scene, &fault))?;
        start
            .check(&mut world)
            .map_err(|error| scene.refuse(error))?;
        let scales = state.error_scales(&mut world);
        let coordinates = state.layout().coordinates;
        let first_order = scales[2 * coordinates..].to_vec();
        let mut linearisation =
            Linearisation::new(&mut world, linearise, first_order, topology, solver);
        let mut stable_step = stable_step::find(&mut world);
        if has_links(scene, formulation) {
            let springs = scene.run.elastic_links.then_some(&stable_step);
            stable_step =
                link_stable_step::find(&mut world, &mut linearisation, &mut *state, springs);
        }
        let implicit = Implicit {
            linearisation,
            energy: world.register_system(mechanical_energy),
        };
        let Choice {
            integrator,
            step_s,
            description,
        } = choose_integrator(scene, &stable_step, scales)?;
        world.insert_resource(IntegrationSlot::new(Integration {
            evaluation,
            statics,
            state,
            implicit,
            integrator,
            trajectory,
            limit_s: 0.0,
            failure: None,
        }));
        Ok(Simulation {
            samplings: world.query(),
            world,
            step,
            duration_s: scene.run.duration_s,
            scene: SceneFacts {
                name: scene.name.clone(),
                seed: scene.run.seed,
                formulation: scene.run.formulation.name(),
                integrator: description,
            },
            stable_step,
            step_s,
        })
    }
}

/// What a formulation counts motion in.
struct Coordinates {
    state: Box<dyn StateSpace>,
    /// Empty where the integrator never asks for it.
    topology: Topology,
    solver: Box<dyn StageSolver>,
}

fn coordinates(
    world: &mut World,
    scene: &Scene,
    layout: Layout,
) -> Result<Coordinates, SetupError> {
    if has_links(scene, scene.run.formulation) {
        let found = topology::find(world, layout)?;
        let mechanism = link_tree::build(world, scene, &found)?;
        let tree = mechanism.tree.clone();
        world.insert_resource(mechanism);
        let state = JointVector::new(world, layout.first_order);
        let solver = LinkStages::new(tree, found.topology.clone(), state.places());
        return Ok(Coordinates {
            state: Box::new(state),
            topology: found.topology,
            solver: Box::new(solver),
        });
    }
    let topology = if is_linearised(&scene.run.integrator) {
        topology::find(world, layout)?.topology
    } else {
        Topology::default()
    };
    Ok(Coordinates {
        state: Box::new(StateVector::new(world, layout)),
        solver: Box::new(ShiftedSystem::new(topology.clone())),
        topology,
    })
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

impl Simulation {
    /// Runs from the start to the end of the scene, or to where it cannot go on. Frames go to `sink`
    /// as they come; `progress` hears of every accepted step's time in s.
    pub fn run(&mut self, sink: &mut dyn ResultSink, progress: &mut dyn FnMut(f64)) -> Summary {
        let mut stop = self.step_to(0.0, sink);
        let mut time_s = 0.0;
        while stop.is_none() && time_s < self.duration_s {
            let limit_s = self.next_limit_s(time_s);
            stop = self.step_to(limit_s, sink);
            time_s = self.time_s();
            progress(time_s);
        }
        self.summary(stop)
    }

    /// As [`Simulation::trim`], for those who do not ask what was found.
    ///
    /// # Errors
    /// As there.
    pub fn settle_in_wind(&mut self, scene: &Scene) -> Result<(), SceneError> {
        self.trim(scene).map(|_| ())
    }

    /// The world, for programs that look at components themselves.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Time of the current state, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.world.resource::<Clock>().time_s
    }

    /// The largest step that fixed-step RK4 can take, and the segment that sets it.
    #[must_use]
    pub fn stable_step(&self) -> &StableStep {
        &self.stable_step
    }

    /// Runs Evaluate on the components as they are, `count` times: for measurements.
    ///
    /// # Errors
    /// The fault that a system reported.
    pub fn evaluate(&mut self, count: usize) -> Result<(), Fault> {
        with_integration(&mut self.world, |world, integration| {
            (0..count).try_for_each(|_| integration.evaluation.run(world))
        })
        .unwrap_or(Ok(()))
    }

    /// Finds the rates of the current state `count` times, as an integrator does: for measurements.
    ///
    /// # Errors
    /// The fault that a system reported.
    pub fn rates(&mut self, count: usize) -> Result<(), Fault> {
        with_integration(&mut self.world, |world, integration| {
            let Integration {
                evaluation,
                state,
                implicit,
                trajectory,
                ..
            } = integration;
            let mut equations = WorldEquations {
                world,
                evaluation,
                state: &mut **state,
                implicit,
            };
            (0..count).try_for_each(|_| {
                equations.rates(trajectory.time_s, &trajectory.state, &mut trajectory.rates)
            })
        })
        .unwrap_or(Ok(()))
    }

    /// The integrator with its settings, in words.
    #[must_use]
    pub fn integrator(&self) -> &str {
        &self.scene.integrator
    }

    /// What the integration has cost so far.
    pub fn cost(&mut self) -> Cost {
        with_integration(&mut self.world, |_, integration| {
            integration.trajectory.cost
        })
        .unwrap_or_default()
    }

    /// The instant that the next step may not cross, s.
    fn next_limit_s(&mut self, time_s: f64) -> f64 {
        let mut limit_s = self.duration_s;
        limit_s = limit_s.min(self.world.resource::<Edges>().next_s());
        limit_s = limit_s.min(self.world.resource::<Recorder>().next_s());
        for sampling in self.samplings.iter(&self.world) {
            if sampling.next_s() > time_s {
                limit_s = limit_s.min(sampling.next_s());
            }
        }
        limit_s
    }

    /// One pass through the Step schedule, with a step that ends at `limit_s` or before.
    fn step_to(&mut self, limit_s: f64, sink: &mut dyn ResultSink) -> Option<Stop> {
        let known = with_integration(&mut self.world, |_, integration| {
            integration.limit_s = limit_s;
            integration.trajectory.time_s
        })?;
        self.step.run(&mut self.world);
        let (failure, time_s) = with_integration(&mut self.world, |_, integration| {
            (integration.failure.take(), integration.trajectory.time_s)
        })?;
        if let Some(failure) = failure {
            // What was observed after a failed step is not an accepted state.
            self.world.resource_mut::<Recorder>().frame.clear(time_s);
            return Some(self.explain(&failure, known));
        }
        // What an instrument reports belongs to this state, not to the next evaluation.
        if let Some(fault) = self.world.resource_mut::<FaultSlot>().take() {
            self.world.resource_mut::<Recorder>().frame.clear(time_s);
            return Some(self.explain(&StepFailure::Fault(fault), time_s));
        }
        let mut recorder = self.world.resource_mut::<Recorder>();
        recorder.done(time_s);
        recorder.frame.time_s = time_s;
        let written = if recorder.frame.is_empty() {
            Ok(())
        } else {
            sink.take(&recorder.frame)
        };
        recorder.frame.clear(time_s);
        if let Some((entity, channel)) = recorder.not_finite.take() {
            let reason = format!("the channel `{channel}` is not a finite number");
            return Some(Stop {
                time_s,
                entity: Some(entity.to_string()),
                reason,
            });
        }
        written.err().map(|error| Stop {
            time_s,
            entity: None,
            reason: format!("the results cannot be written: {error}"),
        })
    }
}
