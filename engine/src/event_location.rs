//! A step that ends where a condition of an event comes to hold: taken once as any other, and where some
//! condition holds at its end that did not before, repeated from its start with an end between, by regula
//! falsi and bisection, until the instant is known to [`RESOLUTION_S`].

use aerobot_components::state::{Attitude, ChartAttitude, FirstOrderState};
use aerobot_systems::integration::{Integrator, StepFailure, Trajectory};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::builtin::events::{Pending, margin};
use crate::evaluation::WorldEquations;
use crate::placement::snapshot::Snapshot;

/// An event on a condition happens at most this late, s.
const RESOLUTION_S: f64 = 1e-6;

/// One accepted step that ends at or before `limit_s` and does not pass the instant at which a pending
/// condition comes to hold.
///
/// # Errors
/// As [`Integrator::step`].
pub(crate) fn step(
    integrator: &mut dyn Integrator,
    equations: &mut WorldEquations<'_>,
    trajectory: &mut Trajectory,
    limit_s: f64,
) -> Result<(), StepFailure> {
    let Some(mut before) = largest_margin(equations.world) else {
        return integrator.step(equations, trajectory, limit_s);
    };
    let mut start = Start::of(equations.world, trajectory);
    integrator.step(equations, trajectory, limit_s)?;
    let (mut end_s, mut after) = (trajectory.time_s, at_present(equations.world));
    if after < 0.0 {
        return Ok(());
    }
    let mut bisect = false;
    while end_s - start.time_s > RESOLUTION_S {
        let part = if bisect || !(before.is_finite() && after.is_finite()) {
            0.5
        } else {
            (before / (before - after)).clamp(0.01, 0.99)
        };
        bisect = !bisect;
        let between_s = start.time_s + part * (end_s - start.time_s);
        start.restore(equations, trajectory);
        advance_to(integrator, equations, trajectory, between_s)?;
        let margin = at_present(equations.world);
        if margin < 0.0 {
            start = Start::of(equations.world, trajectory);
            before = margin;
        } else {
            (end_s, after) = (between_s, margin);
        }
    }
    if trajectory.time_s < end_s {
        advance_to(integrator, equations, trajectory, end_s)?;
    }
    Ok(())
}

fn advance_to(
    integrator: &mut dyn Integrator,
    equations: &mut WorldEquations<'_>,
    trajectory: &mut Trajectory,
    end_s: f64,
) -> Result<(), StepFailure> {
    while trajectory.time_s < end_s {
        integrator.step(equations, trajectory, end_s)?;
    }
    Ok(())
}

/// The largest margin of the conditions that are waited for; nothing where there are none.
fn largest_margin(world: &World) -> Option<f64> {
    let pending = world.get_resource::<Pending>()?;
    let conditions = pending.0.iter().filter_map(|event| event.when.as_ref());
    conditions
        .filter_map(|condition| margin(world, condition))
        .reduce(f64::max)
}

fn at_present(world: &World) -> f64 {
    largest_margin(world).unwrap_or(f64::NEG_INFINITY)
}

/// Where a step started.
struct Start {
    time_s: f64,
    has_switched: bool,
    motion: Snapshot,
    first_order: Vec<(Entity, FirstOrderState)>,
}

impl Start {
    fn of(world: &mut World, trajectory: &Trajectory) -> Self {
        Self {
            time_s: trajectory.time_s,
            has_switched: trajectory.has_switched,
            motion: Snapshot::of(world),
            first_order: world
                .query::<(Entity, &FirstOrderState)>()
                .iter(world)
                .map(|(entity, state)| (entity, *state))
                .collect(),
        }
    }

    fn restore(&self, equations: &mut WorldEquations<'_>, trajectory: &mut Trajectory) {
        let world = &mut *equations.world;
        self.motion.restore(world);
        for (entity, state) in &self.first_order {
            world.entity_mut(*entity).insert(*state);
        }
        let mut turned = world.query::<(&Attitude, &mut ChartAttitude)>();
        for (attitude, mut chart) in turned.iter_mut(world) {
            chart.0 = attitude.0;
        }
        equations.state.gather(world, &mut trajectory.state);
        trajectory.time_s = self.time_s;
        trajectory.rates_are_current = false;
        trajectory.has_switched = self.has_switched;
    }
}
