//! A steady state as it is told: read from the world once everything stands there.

use aerobot_components::body::Anchor;
use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::segment::{SegmentGeometry, Tension};
use aerobot_components::state::{
    Acceleration, AngularAcceleration, Attitude, Force, Inertia, Position, StateIndex, Torque,
    Velocity,
};
use aerobot_components::tether::{Tether, TetherNode, TetherParts};
use aerobot_components::torsion::Twist;
use aerobot_systems::clock::Clock;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::instruments::attitude::{heading_rad, tilt_rad};
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{With, Without};
use bevy_ecs::world::World;

use super::{Residual, Trim, TrimmedBody, TrimmedEnd, TrimmedSystem, TrimmedTether};
use crate::builtin::fixed_wing;
use crate::placement::{self, SteadySystem};
use crate::world::{EntityName, SceneEntities};

/// An acceleration (m/s^2, rad/s^2) that is left beyond this is worth a warning, if round-off does not
/// explain it.
const SMALL_ACCELERATION: f64 = 1e-6;
/// Segments that end at one part with round-off of their own, generously.
const ROUND_OFFS: f64 = 8.0;

pub(super) fn report(world: &mut World, systems: &[SteadySystem]) -> Trim {
    let residual = residual(world);
    let entities = world.resource::<SceneEntities>().in_order();
    Trim {
        systems: systems.iter().map(|found| system(world, found)).collect(),
        bodies: entities.iter().filter_map(|id| body(world, *id)).collect(),
        tethers: entities
            .iter()
            .filter_map(|id| tether(world, *id))
            .collect(),
        notes: notes(world),
        warnings: warnings(world, systems, &residual),
        residual,
    }
}

fn name(world: &World, entity: Entity) -> String {
    world
        .get::<EntityName>(entity)
        .map_or_else(String::new, |name| name.0.to_string())
}

fn system(world: &World, found: &SteadySystem) -> TrimmedSystem {
    let names = |entities: &[Entity]| entities.iter().map(|id| name(world, *id)).collect();
    let system = &found.system;
    let altitude_m = system
        .reference
        .and_then(|reference| world.get::<Position>(reference))
        .map(|position| position.0.z);
    let wind = &world.resource::<EnvironmentModel>().wind;
    TrimmedSystem {
        anchors: names(&system.anchors),
        bodies: names(&system.bodies),
        tethers: names(&system.tethers),
        reference: system.reference.map(|reference| name(world, reference)),
        velocity_m_s: found.velocity_m_s,
        wind_at_reference_m_s: altitude_m
            .and_then(|altitude_m| wind.velocity_m_s(altitude_m).ok())
            .unwrap_or_default(),
    }
}

fn body(world: &World, entity: Entity) -> Option<TrimmedBody> {
    let attitude = world.get::<Attitude>(entity)?.0;
    // A drone flies; it has a trim of its own, and starts in it.
    if world.get::<FixedWing>(entity).is_some() {
        return None;
    }
    Some(TrimmedBody {
        name: name(world, entity),
        is_anchor: world.get::<Anchor>(entity).is_some(),
        turns: world.get::<Inertia>(entity).is_some(),
        position_m: world.get::<Position>(entity)?.0,
        velocity_m_s: world.get::<Velocity>(entity)?.0,
        attitude,
        tilt_rad: tilt_rad(attitude),
        heading_rad: heading_rad(attitude),
    })
}

fn tether(world: &World, entity: Entity) -> Option<TrimmedTether> {
    let tether = world.get::<Tether>(entity)?;
    let parts = world.get::<TetherParts>(entity)?;
    let tensions = parts.segments.iter().enumerate().filter_map(|(index, id)| {
        let tension = world.get::<Tension>(*id)?;
        Some((index + 1, tension.0))
    });
    let (largest_segment, largest_tension_n) = tensions
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or_default();
    let nodes = || {
        let points = parts.points.iter().copied();
        points.filter(|point| world.get::<TetherNode>(*point).is_some())
    };
    let first = nodes().next().or(parts.points.first().copied())?;
    Some(TrimmedTether {
        name: name(world, entity),
        from: end(
            world,
            &tether.from.0,
            parts.points.first(),
            parts.segments.first(),
        )?,
        to: end(
            world,
            &tether.to.0,
            parts.points.last(),
            parts.segments.last(),
        )?,
        largest_tension_n,
        largest_segment,
        twist_rad: world.get::<Twist>(entity).map(|twist| twist.twist_rad),
        velocity_m_s: world.get::<Velocity>(first)?.0,
        node_positions_m: nodes()
            .filter_map(|node| Some(world.get::<Position>(node)?.0))
            .collect(),
    })
}

fn end(
    world: &World,
    carrier: &str,
    point: Option<&Entity>,
    segment: Option<&Entity>,
) -> Option<TrimmedEnd> {
    let (point, segment) = (*point?, *segment?);
    let force = world.get::<Force>(point)?.0;
    let line = if force.length() > 0.0 {
        force
    } else {
        world.get::<SegmentGeometry>(segment)?.direction
    };
    Some(TrimmedEnd {
        carrier: carrier.to_owned(),
        position_m: world.get::<Position>(point)?.0,
        force_n: force.length(),
        tension_n: world.get::<Tension>(segment)?.0,
        angle_from_vertical_rad: libm::atan2(libm::hypot(line.x, line.y), line.z.abs()),
    })
}

/// A value and the entity that has it, the largest of those seen.
#[derive(Default)]
struct Largest(f64, String);

impl Largest {
    fn see(&mut self, value: f64, name: &EntityName) {
        if self.1.is_empty() || value > self.0 {
            *self = Self(value, name.0.to_string());
        }
    }
}

/// The largest of what is left, over everything that the run would integrate.
fn residual(world: &mut World) -> Residual {
    let (mut force, mut linear, mut angular) =
        (Largest::default(), Largest::default(), Largest::default());
    let mut parts =
        world.query_filtered::<(&EntityName, &Force, &Acceleration), (With<StateIndex>, Without<FixedWing>)>();
    for (name, left, acceleration) in parts.iter(world) {
        force.see(left.0.length(), name);
        linear.see(acceleration.0.length(), name);
    }
    let mut torque_n_m = 0.0_f64;
    let mut turning = world.query_filtered::<
        (&EntityName, &AngularAcceleration, &Torque),
        (With<StateIndex>, With<Inertia>, Without<FixedWing>),
    >();
    for (name, acceleration, torque) in turning.iter(world) {
        angular.see(acceleration.0.length(), name);
        torque_n_m = torque_n_m.max(torque.0.length());
    }
    Residual {
        force_n: force.0,
        force_at: force.1,
        acceleration_m_s2: linear.0,
        acceleration_at: linear.1,
        angular_acceleration_rad_s2: angular.0,
        angular_acceleration_at: angular.1,
        torque_n_m,
        round_off_n: placement::position_noise_n(world),
    }
}

fn notes(world: &World) -> Vec<String> {
    let wind = &world.resource::<EnvironmentModel>().wind;
    let mut notes = fixed_wing::describe(world);
    if wind.gusts().next().is_some() {
        notes.push(format!(
            "the wind has stochastic gusts: this is the steady state in them as they are at {} s",
            world.resource::<Clock>().time_s
        ));
    }
    let edges = wind.edges_s();
    if edges.is_empty() {
        return notes;
    }
    let times: Vec<String> = edges.iter().take(4).map(|edge| format!("{edge}")).collect();
    let more = if edges.len() > 4 { ", .." } else { "" };
    notes.push(format!(
        "the wind changes at {}{more} s: this is the steady state in the wind as it stands at {} s",
        times.join(", "),
        world.resource::<Clock>().time_s
    ));
    notes
}

fn warnings(world: &World, systems: &[SteadySystem], residual: &Residual) -> Vec<String> {
    let mut warnings = Vec::new();
    for found in systems {
        if let Some(unstable) = found.instability {
            warnings.push(format!(
                "`{}`: the equilibrium is unstable: pushed out of it, it leaves by a factor e in \
                 {:.3} s where nothing damps",
                name(world, unstable.entity),
                unstable.growth_time_s
            ));
        }
        if let (Some(slope), Some(reference)) = (found.vertical_slope_n_m, found.system.reference)
            && slope >= 0.0
        {
            warnings.push(format!(
                "`{}`: nothing brings it back to its altitude: {slope:.3e} N push it away for each \
                 metre",
                name(world, reference)
            ));
        }
    }
    if residual.acceleration_m_s2 > SMALL_ACCELERATION
        && residual.force_n > ROUND_OFFS * residual.round_off_n
    {
        warnings.push(format!(
            "`{}` is left with an acceleration of {:.3e} m/s^2",
            residual.acceleration_at, residual.acceleration_m_s2
        ));
    }
    // Round-off at the arm of a metre.
    if residual.angular_acceleration_rad_s2 > SMALL_ACCELERATION
        && residual.torque_n_m > ROUND_OFFS * residual.round_off_n
    {
        warnings.push(format!(
            "`{}` is left with an angular acceleration of {:.3e} rad/s^2: nothing balances its heading",
            residual.angular_acceleration_at, residual.angular_acceleration_rad_s2
        ));
    }
    warnings
}
