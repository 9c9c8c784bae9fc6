//! The one public door: a [`Plugin`] registers components with the scene language, checks, setups and
//! systems. The built-in physics comes in through it like any user's.

use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::ScheduleSystem;
use bevy_ecs::world::World;

use aerobot_components::run::Formulation;
use aerobot_components::scene_component::{FieldReport, SceneComponent};

use crate::builtin;
use crate::scene::groups::Expansion;
use crate::scene::registry::{ComponentEntry, ComponentRegistry};
use crate::scene::{Scene, SetupError};
use crate::schedule::{Phase, Registration};
use crate::sequence::Orders;

/// A family of components and systems that joins a simulator.
pub trait Plugin {
    /// Registers everything the family consists of.
    fn build(&self, simulator: &mut Simulator);
}

type Check = dyn Fn(&Scene, &mut FieldReport) + Send + Sync;
type Setup = dyn Fn(&mut World, &Scene) -> Result<(), SetupError> + Send + Sync;

/// Everything that is registered: loads scenes and builds simulations of them.
///
/// One simulator serves any number of simulations, on any number of threads.
pub struct Simulator {
    pub(crate) components: ComponentRegistry,
    pub(crate) expansions: Vec<Expansion>,
    pub(crate) checks: Vec<Box<Check>>,
    pub(crate) setups: Vec<Box<Setup>>,
    pub(crate) systems: Vec<Registration>,
    pub(crate) shuffle_seed: Option<u64>,
    pub(crate) orders: Orders,
}

impl Default for Simulator {
    fn default() -> Self {
        Self::new()
    }
}

impl Simulator {
    /// A simulator with the built-in physics.
    #[must_use]
    pub fn new() -> Self {
        let mut simulator = Self {
            components: ComponentRegistry::default(),
            expansions: Vec::new(),
            checks: Vec::new(),
            setups: Vec::new(),
            systems: Vec::new(),
            shuffle_seed: None,
            orders: Orders::default(),
        };
        builtin::register(&mut simulator);
        simulator
    }

    /// Adds a plugin.
    pub fn add_plugin(&mut self, plugin: &dyn Plugin) -> &mut Self {
        plugin.build(self);
        self
    }

    /// Makes `C` writable in scenes under its name; a later registration of a name replaces an
    /// earlier one.
    pub fn register_component<C: SceneComponent>(&mut self) -> &mut Self {
        self.components.insert(ComponentEntry::of::<C>());
        self
    }

    /// Makes an entity with a `C` stand for the entities `NAME/1`, `NAME/2` and so on, each with one
    /// component of what `members` makes of the `C`, and with the other components of the entity. `C` has
    /// to be registered; it is checked, and then no longer in the scene.
    pub fn add_expansion<C: SceneComponent, M: SceneComponent>(
        &mut self,
        members: impl Fn(&C) -> Vec<M> + Send + Sync + 'static,
    ) -> &mut Self {
        self.expansions.push(Expansion::new(members));
        self
    }

    /// Adds a check on the whole scene, run with all others before anything is built; its violations
    /// are shown together with theirs.
    pub fn add_check(
        &mut self,
        check: impl Fn(&Scene, &mut FieldReport) + Send + Sync + 'static,
    ) -> &mut Self {
        self.checks.push(Box::new(check));
        self
    }

    /// Adds a setup that derives what systems need from the components of a scene; setups run once,
    /// in the order of registration, after every entity has been spawned with its components.
    pub fn add_setup(
        &mut self,
        setup: impl Fn(&mut World, &Scene) -> Result<(), SetupError> + Send + Sync + 'static,
    ) -> &mut Self {
        self.setups.push(Box::new(setup));
        self
    }

    /// Adds systems to a phase, after all that were added to it before. `systems` makes them anew
    /// for each simulation: `|| my_force`, or `|| (first, second).chain()`.
    pub fn add_systems<C, M>(
        &mut self,
        phase: Phase,
        systems: impl Fn() -> C + Send + Sync + 'static,
    ) -> &mut Self
    where
        C: IntoScheduleConfigs<ScheduleSystem, M>,
        M: 'static,
    {
        self.add_systems_if(phase, |_| true, systems)
    }

    /// As [`Simulator::add_systems`], for scenes with a component of type `S` only: a system without
    /// work still costs some 20 ns in every evaluation.
    pub fn add_systems_for<S, C, M>(
        &mut self,
        phase: Phase,
        systems: impl Fn() -> C + Send + Sync + 'static,
    ) -> &mut Self
    where
        S: SceneComponent,
        C: IntoScheduleConfigs<ScheduleSystem, M>,
        M: 'static,
    {
        self.add_systems_if(phase, |scene| scene.with::<S>().next().is_some(), systems)
    }

    /// As [`Simulator::add_systems`], for scenes that fulfil a condition only.
    pub fn add_systems_if<C, M>(
        &mut self,
        phase: Phase,
        needed: impl Fn(&Scene) -> bool + Send + Sync + 'static,
        systems: impl Fn() -> C + Send + Sync + 'static,
    ) -> &mut Self
    where
        C: IntoScheduleConfigs<ScheduleSystem, M>,
        M: 'static,
    {
        self.add_systems_in(phase, move |scene, _| needed(scene), systems)
    }

    /// As [`Simulator::add_systems_if`], with a condition on the formulation for which a schedule is made:
    /// only what moves bodies and tethers ever needs it. (States of rest are found with the forces of the
    /// lumped formulation in either.)
    pub fn add_systems_in<C, M>(
        &mut self,
        phase: Phase,
        needed: impl Fn(&Scene, Formulation) -> bool + Send + Sync + 'static,
        systems: impl Fn() -> C + Send + Sync + 'static,
    ) -> &mut Self
    where
        C: IntoScheduleConfigs<ScheduleSystem, M>,
        M: 'static,
    {
        self.systems.push(Registration {
            phase,
            needed: Box::new(needed),
            add: Box::new(move |schedule, set| {
                schedule.add_systems(systems().in_set(set));
            }),
        });
        self
    }

    /// Shuffles what the schedules leave unordered: for tests that nothing depends on it.
    pub fn set_shuffle_seed(&mut self, seed: u64) -> &mut Self {
        self.shuffle_seed = Some(seed);
        self
    }
}
