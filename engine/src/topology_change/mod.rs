//! Changes of topology at one instant of a run: the step that ends there has been accepted, the next one
//! starts from a world that is put together anew.
//!
//! What a change takes from or gives to the mechanical energy is added to the work of non-conservative
//! forces, so that energy less work goes on without a step; and what it does to the momentum to the impulse of outer
//! forces, where there are anchors: without them nothing outside can have done it.

mod cutting;
mod dividing;
pub(crate) mod driving;
mod latching;
pub(crate) mod reeling;
mod renumbering;

use aerobot_components::events::Action;
use aerobot_components::state::FirstOrderState;
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::first_order::FirstOrderIndex;
use aerobot_systems::fault::Fault;
use aerobot_systems::instruments::energy::{WorkIntegral, mechanical_energy_j};
use aerobot_systems::instruments::momentum::{ImpulseIntegral, momentum_beside_anchors};
use aerobot_systems::integration::StepFailure;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::system::RunSystemOnce;
use bevy_ecs::world::World;
use glam::DVec3;

use crate::evaluation::{Integration, with_integration};
use crate::restructure::{evaluate, restructure};
use crate::world::{EntityName, EventLog};

/// Something that changes at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Change {
    /// An event of the scene.
    Event(Action),
    /// What a winch does on its way, to the line of this entity.
    Winch(Entity, reeling::Turn),
    /// The winch with a drive at the line of this entity turns at another rate, m/s.
    Drive(Entity, f64),
    /// The latch of this body closes.
    Latch(Entity),
}

/// Makes changes and goes on from there; whether the run can.
pub(crate) fn apply(world: &mut World, changes: &[Change]) -> bool {
    let done = with_integration(world, |world, integration| {
        if integration.failure.is_some() {
            return false;
        }
        let before = (energy_j(world), momentum_kg_m_s(world));
        for change in changes {
            match change {
                Change::Event(action) => act(world, action),
                Change::Winch(line, turn) => reeling::turn(world, *line, *turn),
                Change::Drive(line, rate_m_s) => driving::turn(world, *line, *rate_m_s),
                Change::Latch(body) => latching::close(world, *body),
            }
        }
        match go_on(world, integration) {
            Ok(()) => {
                account_for_work(world, integration, before.0);
                account_for_impulse(world, integration, before.1);
                true
            }
            Err(failure) => {
                integration.failure = Some(failure);
                false
            }
        }
    });
    done.unwrap_or(false)
}

fn act(world: &mut World, action: &Action) {
    match action {
        Action::Cut { tether, segment } => cutting::cut(world, tether, *segment),
        Action::Release { body } => cutting::release(world, body),
        Action::Undock { body } => latching::open(world, body),
        Action::Reel {
            tether,
            rate_m_s,
            length_m,
            until_s,
        } => reeling::start(world, tether, *rate_m_s, (*length_m, *until_s)),
    }
}

fn go_on(world: &mut World, integration: &mut Integration) -> Result<(), StepFailure> {
    reeling::weigh(world);
    restructure(world, integration).map_err(|error| {
        let messages = error.0.into_iter().map(|violation| violation.message);
        StepFailure::Fault(Fault {
            entity: None,
            message: messages.collect::<Vec<_>>().join("; "),
        })
    })?;
    integration.trajectory.switch();
    evaluate(world, integration)
}

/// Mechanical energy of the state that was evaluated last, J; nothing where no one asks for it.
fn energy_j(world: &mut World) -> Option<f64> {
    world
        .query_filtered::<(), With<WorkIntegral>>()
        .single(world)
        .ok()?;
    world.run_system_once(mechanical_energy_j).ok()
}

/// Counts what a change has done to the energy as work.
fn account_for_work(world: &mut World, integration: &mut Integration, before_j: Option<f64>) {
    let (Some(before_j), Some(after_j)) = (before_j, energy_j(world)) else {
        return;
    };
    let mut work =
        world.query_filtered::<(&FirstOrderIndex, &mut FirstOrderState), With<WorkIntegral>>();
    if let Ok((index, mut work)) = work.single_mut(world) {
        work.value += after_j - before_j;
        let first = 2 * integration.state.layout().coordinates;
        integration.trajectory.state[first + index.0] = work.value;
    }
}

/// Momentum of the state that was evaluated last, kg m/s; nothing where no one asks for it, and where nothing outside
/// can change it at once.
fn momentum_kg_m_s(world: &mut World) -> Option<DVec3> {
    let mut impulses = world.query_filtered::<(), With<ImpulseIntegral>>();
    impulses.iter(world).next()?;
    world.run_system_once(momentum_beside_anchors).ok()?
}

/// Counts what a change has done to the momentum as impulse of anchors.
fn account_for_impulse(world: &mut World, integration: &mut Integration, before: Option<DVec3>) {
    let (Some(before), Some(after)) = (before, momentum_kg_m_s(world)) else {
        return;
    };
    let first = 2 * integration.state.layout().coordinates;
    let mut impulses = world.query::<(&ImpulseIntegral, &FirstOrderIndex, &mut FirstOrderState)>();
    for (axis, index, mut impulse) in impulses.iter_mut(world) {
        impulse.value += after[axis.0] - before[axis.0];
        integration.trajectory.state[first + index.0] = impulse.value;
    }
}

/// Logs what happens now to an entity, or to a part of it by number.
fn log(world: &mut World, kind: &str, entity: Entity, part: Option<u32>) {
    let time_s = world.resource::<Clock>().time_s;
    let mut name = world
        .get::<EntityName>(entity)
        .map_or_else(String::new, |name| name.0.to_string());
    if let Some(part) = part {
        name = format!("{name}/{part}");
    }
    world.resource_mut::<EventLog>().add(time_s, kind, &name);
}
