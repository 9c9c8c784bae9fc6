//! The systems of a schedule in their order, run one after the other.
//!
//! bevy's executor guards every system against panics and keeps account of what has run, of buffers to
//! apply and of sets to ask: for the small systems of an evaluation that costs as much as their work.
//! A [`Schedule`] still orders the systems and checks them for ambiguities; what it has found is then
//! run without it, unless it holds what only the executor knows how to run.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use bevy_ecs::error::ErrorContext;
use bevy_ecs::schedule::{ConditionWithAccess, Schedule, SystemKey, SystemWithAccess};
use bevy_ecs::system::{IntoSystem, RunSystemError, System};
use bevy_ecs::world::World;

/// Systems in their order.
pub(crate) struct Sequence(Runner);

enum Runner {
    /// Systems that need no executor.
    Direct(Vec<Member>),
    /// Some systems have commands to apply, or conditions in common.
    Executor(Box<Schedule>),
}

/// A system and the conditions of its own.
struct Member {
    system: SystemWithAccess,
    conditions: Vec<ConditionWithAccess>,
}

/// Systems in an order that has been checked, each by its key in a schedule of the same registrations and
/// its type.
type Order = Arc<[(SystemKey, TypeId)]>;

/// The orders that have been found, so that the many worlds of a campaign are not ordered one by one.
#[derive(Default)]
pub(crate) struct Orders(Mutex<BTreeMap<OrderOf, Order>>);

/// What an order follows from: the registrations, by their numbers, and the seed of a shuffle.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct OrderOf {
    pub(crate) registrations: Vec<usize>,
    pub(crate) shuffle_seed: Option<u64>,
}

impl Orders {
    /// [`Sequence::new`], without ordering again what has been ordered before.
    ///
    /// # Errors
    /// The text of an ambiguity or of a cycle.
    pub(crate) fn sequence(
        &self,
        of: OrderOf,
        assemble: impl Fn() -> Schedule,
        world: &mut World,
    ) -> Result<Sequence, String> {
        let known = self.known().get(&of).cloned();
        let members = known.and_then(|order| members(&order, assemble(), world));
        if let Some(members) = members {
            return Ok(Sequence(Runner::Direct(members)));
        }
        let (sequence, order) = Sequence::ordered(assemble, world)?;
        if let Some(order) = order {
            self.known().insert(of, order);
        }
        Ok(sequence)
    }

    fn known(&self) -> std::sync::MutexGuard<'_, BTreeMap<OrderOf, Order>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sequence {
    /// The systems of the schedule that `assemble` makes, in an order that has been checked.
    ///
    /// `assemble` is called twice: a schedule that has been ordered does not give its systems back.
    ///
    /// # Errors
    /// The text of an ambiguity or of a cycle.
    #[cfg(test)]
    fn new(assemble: impl Fn() -> Schedule, world: &mut World) -> Result<Self, String> {
        Ok(Self::ordered(assemble, world)?.0)
    }

    /// The same, with the order where it can be used again.
    fn ordered(
        assemble: impl Fn() -> Schedule,
        world: &mut World,
    ) -> Result<(Self, Option<Order>), String> {
        let mut ordered = assemble();
        if let Err(error) = ordered.initialize(world) {
            return Err(error.to_string(ordered.graph(), world));
        }
        let order = order(&ordered);
        let members = order
            .as_ref()
            .and_then(|order| members(order, assemble(), world));
        Ok(match members {
            Some(members) => (Self(Runner::Direct(members)), order),
            None => (Self(Runner::Executor(Box::new(ordered))), None),
        })
    }

    /// Runs all of them.
    pub(crate) fn run(&mut self, world: &mut World) {
        match &mut self.0 {
            Runner::Executor(schedule) => schedule.run(world),
            Runner::Direct(members) => {
                if let Some(check) = world.check_change_ticks() {
                    for member in &mut *members {
                        member.system.check_change_tick(check);
                        for condition in &mut member.conditions {
                            condition.check_change_tick(check);
                        }
                    }
                }
                for member in members {
                    member.run(world);
                }
            }
        }
    }

    /// Whether the executor is not needed.
    #[cfg(test)]
    fn is_direct(&self) -> bool {
        matches!(self.0, Runner::Direct(_))
    }
}

impl Member {
    #[inline]
    fn run(&mut self, world: &mut World) {
        let mut wanted = true;
        for condition in &mut self.conditions {
            // All are asked, as by the executor: a condition may count how often.
            wanted &= run(condition, world).unwrap_or(false);
        }
        if wanted {
            run(&mut self.system, world);
        }
    }
}

/// Runs a system; what it fails with goes where the executor sends it.
#[inline]
fn run<S: System<In = ()>>(system: &mut S, world: &mut World) -> Option<S::Out> {
    match system.run_without_applying_deferred((), world) {
        Ok(result) => Some(result),
        Err(error) => {
            fail(system, error, world);
            None
        }
    }
}

#[cold]
fn fail<S: System>(system: &S, error: RunSystemError, world: &World) {
    // A system that is skipped has asked for what may be missing.
    if let RunSystemError::Failed(error) = error {
        let context = ErrorContext::System {
            name: system.name(),
            last_run: system.get_last_run(),
        };
        world.fallback_error_handler()(error, context);
    }
}

/// The order of a schedule; `None` if its systems need the executor.
fn order(ordered: &Schedule) -> Option<Order> {
    let mut order = Vec::new();
    for (key, system) in ordered.systems().ok()? {
        if system.has_deferred() {
            return None;
        }
        order.push((key, system.system_type()));
    }
    Some(order.into())
}

/// The systems of `fresh` in an order, which was found of the same registrations; `None` if they need the
/// executor.
fn members(order: &Order, mut fresh: Schedule, world: &mut World) -> Option<Vec<Member>> {
    let graph = fresh.graph_mut();
    let mut sets = graph.system_sets.iter();
    if sets.any(|(_, _, conditions)| !conditions.is_empty()) {
        return None;
    }
    // The schedule puts systems of its own between those that have something to apply.
    if order.len() != graph.systems.len() {
        return None;
    }
    let mut members = Vec::with_capacity(order.len());
    for (key, system_type) in order.iter() {
        let place = graph.systems.get_mut(*key)?;
        if place.system_type() != *system_type {
            return None;
        }
        let nothing = SystemWithAccess::new(Box::new(IntoSystem::into_system(|| {})));
        let mut system = std::mem::replace(place, nothing);
        system.initialize(world);
        let mut conditions = std::mem::take(graph.systems.get_conditions_mut(*key)?);
        for condition in &mut conditions {
            condition.initialize(world);
        }
        members.push(Member { system, conditions });
    }
    Some(members)
}

#[cfg(test)]
mod tests;
