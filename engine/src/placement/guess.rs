//! The geometric guess: everything hangs plumb from what holds it, or floats plumb above it.

use std::collections::BTreeMap;

use aerobot_components::aerodynamics::{DisplacedVolume, RadiusRule, Sphere};
use aerobot_components::body::Body;
use aerobot_components::state::{Mass, Position};
use aerobot_components::tether::{Attachment, Tether, TetherParts, TetherStart};
use aerobot_systems::environment::EnvironmentModel;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::attachment_position;
use crate::balloon_sizing::{tethered_mass_kg, tethered_together};
use crate::scene::{Scene, SetupError};
use crate::world::{EntityName, SceneEntities};

/// A tether as the guess sees it: its two carriers with the places on them.
struct Line {
    ends: [(Entity, DVec3); 2],
    length_m: f64,
    stiffness_n: f64,
    mass_kg: f64,
}

/// Places `bodies`; returns those whose altitude floats.
pub(super) fn place_bodies(
    world: &mut World,
    scene: &Scene,
    bodies: &[Entity],
) -> Result<Vec<Entity>, SetupError> {
    let lines = lines(world);
    let mut waiting: Vec<Entity> = bodies.to_vec();
    let mut floating = Vec::new();
    loop {
        hang(world, &lines, &mut waiting);
        let Some(&first) = waiting.first() else {
            return Ok(floating);
        };
        let balloon = floating_balloon(world, scene, first)?;
        let altitude_m = floating_altitude(world, scene, balloon)?;
        if let Some(mut position) = world.get_mut::<Position>(balloon) {
            position.0 = DVec3::new(0.0, 0.0, altitude_m);
        }
        waiting.retain(|body| *body != balloon);
        floating.push(balloon);
    }
}

fn lines(world: &mut World) -> Vec<Line> {
    let mut tethers = world.query::<(&Tether, &TetherParts)>();
    let found: Vec<_> = tethers
        .iter(world)
        .filter_map(|(tether, parts)| {
            let (first, last) = (*parts.points.first()?, *parts.points.last()?);
            let end = |point| {
                world
                    .get::<Attachment>(point)
                    .map(|end: &Attachment| (end.carrier, end.offset_m))
            };
            Some(Line {
                ends: [end(first)?, end(last)?],
                length_m: tether.length_m,
                stiffness_n: tether.axial_stiffness_n,
                mass_kg: tether.lumped_mass_kg(),
            })
        })
        .collect();
    found
}

/// Hangs every waiting body that tethers join to a placed one, generation by generation.
fn hang(world: &mut World, lines: &[Line], waiting: &mut Vec<Entity>) {
    let mut generations: Vec<Vec<(Entity, Vec<usize>)>> = Vec::new();
    let mut left = waiting.clone();
    loop {
        let next: Vec<(Entity, Vec<usize>)> = left
            .iter()
            .filter_map(|body| {
                let holding = holding_lines(lines, *body, &left);
                (!holding.is_empty()).then_some((*body, holding))
            })
            .collect();
        if next.is_empty() {
            break;
        }
        left.retain(|body| !next.iter().any(|(placed, _)| placed == body));
        generations.push(next);
    }
    let loads = loads(world, lines, &generations);
    for (body, holding) in generations.into_iter().flatten() {
        let load = loads.get(&body).copied().unwrap_or(0.0);
        let down = if load < 0.0 { DVec3::Z } else { DVec3::NEG_Z };
        let count = holding.len() as f64;
        let mut place = DVec3::ZERO;
        for index in &holding {
            let line = &lines[*index];
            let (own, holder) = oriented(line, body);
            let top = attachment_position(world, holder.0, holder.1);
            let length = line.length_m * (1.0 + load.abs() / (count * line.stiffness_n));
            place += (top + length * down - own.1) / count;
        }
        if let Some(mut position) = world.get_mut::<Position>(body) {
            position.0 = place;
        }
    }
    *waiting = left;
}

/// Lines that join `body` to something that is placed.
fn holding_lines(lines: &[Line], body: Entity, waiting: &[Entity]) -> Vec<usize> {
    (0..lines.len())
        .filter(|index| {
            let [a, b] = &lines[*index].ends;
            (a.0 == body && !waiting.contains(&b.0)) || (b.0 == body && !waiting.contains(&a.0))
        })
        .collect()
}

/// The ends of a line, that of `body` first.
fn oriented(line: &Line, body: Entity) -> ((Entity, DVec3), (Entity, DVec3)) {
    let [a, b] = line.ends;
    if a.0 == body { (a, b) } else { (b, a) }
}

/// Net weight in N that hangs at each body, from the last generation up; negative where it lifts.
fn loads(
    world: &World,
    lines: &[Line],
    generations: &[Vec<(Entity, Vec<usize>)>],
) -> BTreeMap<Entity, f64> {
    let environment = world.resource::<EnvironmentModel>();
    let mut loads: BTreeMap<Entity, f64> = BTreeMap::new();
    for (body, holding) in generations.iter().rev().flatten() {
        // The altitude of what holds it is near enough for a guess.
        let altitude_m = holding.first().map_or(0.0, |index| {
            let holder = oriented(&lines[*index], *body).1;
            world
                .get::<Position>(holder.0)
                .map_or(0.0, |position| position.0.z)
        });
        let gravity = environment.gravity.acceleration_m_s2(altitude_m);
        let density = environment
            .atmosphere
            .density_kg_m3(altitude_m)
            .unwrap_or(0.0);
        let mass = world.get::<Mass>(*body).map_or(0.0, |mass| mass.0);
        let volume = world
            .get::<DisplacedVolume>(*body)
            .map_or(0.0, |volume| volume.0);
        let own = gravity * (mass - density * volume);
        let total = *loads
            .entry(*body)
            .and_modify(|load| *load += own)
            .or_insert(own);
        for index in holding {
            let line = &lines[*index];
            let holder = oriented(line, *body).1.0;
            *loads.entry(holder).or_insert(0.0) +=
                total / holding.len() as f64 + gravity * line.mass_kg;
        }
    }
    loads
}

/// The balloon that carries the system of `body`.
fn floating_balloon(world: &World, scene: &Scene, body: Entity) -> Result<Entity, SetupError> {
    let name = world.get::<EntityName>(body).map_or("", |name| &name.0);
    let together = tethered_together(scene, name);
    let balloons: Vec<Entity> = together
        .iter()
        .filter_map(|name| world.resource::<SceneEntities>().get(name))
        .filter(|id| world.get::<DisplacedVolume>(*id).is_some())
        .collect();
    balloons
        .iter()
        .copied()
        .find(|id| {
            world
                .get::<Sphere>(*id)
                .is_some_and(|sphere| sphere.radius.is_some())
        })
        .or_else(|| balloons.first().copied())
        .ok_or_else(|| {
            SetupError::new(
                format!("entities.{name}"),
                format!("`{name}` has no `Pose`, and nothing holds it up"),
                "give it a `Pose`, tether it to an anchor, or to a balloon with `Buoyancy`",
            )
        })
}

/// The altitude at which a balloon's lift equals the weight of all that is tethered to it, m.
fn floating_altitude(world: &World, scene: &Scene, balloon: Entity) -> Result<f64, SetupError> {
    if let Some(RadiusRule::Equilibrium { altitude_m }) = world
        .get::<Sphere>(balloon)
        .and_then(|sphere| sphere.radius)
    {
        return Ok(altitude_m);
    }
    let name = world.get::<EntityName>(balloon).map_or("", |name| &name.0);
    let mass_kg = tethered_mass_kg(scene, name);
    let volume_m3 = world
        .get::<DisplacedVolume>(balloon)
        .map_or(0.0, |volume| volume.0);
    let atmosphere = &world.resource::<EnvironmentModel>().atmosphere;
    let excess = |altitude_m: f64| {
        atmosphere
            .density_kg_m3(altitude_m)
            .map_or(f64::NAN, |rho| rho * volume_m3 - mass_kg)
    };
    let (lowest, highest) = atmosphere.bounds_m();
    let (mut low, mut high) = (lowest.max(-5_000.0), highest.min(200_000.0));
    if !(excess(low) > 0.0 && excess(high) < 0.0) {
        return Err(SetupError::new(
            format!(
                "entities.{name}.{}",
                <Body as aerobot_components::scene_component::SceneComponent>::NAME
            ),
            format!("`{name}` floats at no altitude of this atmosphere with {mass_kg} kg"),
            "give it a `Pose`, another radius, or `radius: Equilibrium(altitude_m: ..)`",
        ));
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}

/// Places the nodes of all tethers between their ends as they stand.
pub(super) fn place_nodes(world: &mut World) {
    let mut tethers = world.query::<(Entity, &Tether)>();
    let all: Vec<(Entity, bool)> = tethers
        .iter(world)
        .map(|(entity, tether)| (entity, tether.start == TetherStart::Equilibrium))
        .collect();
    for (tether, may_sag) in all {
        if may_sag {
            place_sagging(world, tether);
        } else {
            place_on_line(world, tether);
        }
    }
}

/// Puts the nodes of a tether on the straight line between its ends, equally spaced.
pub(super) fn place_on_line(world: &mut World, tether: Entity) {
    let Some((from, to, count)) = span(world, tether) else {
        return;
    };
    let positions: Vec<DVec3> = (1..=count)
        .map(|number| from.lerp(to, number as f64 / (count + 1) as f64))
        .collect();
    set_node_positions(world, tether, &positions);
}

/// As [`place_on_line`], but a line longer than its span sags: a parabola of sag f over the span d has
/// the length d (1 + 8/3 (f/d)^2), a deep one rather that of two straight halves.
fn place_sagging(world: &mut World, tether: Entity) {
    let Some((from, to, count)) = span(world, tether) else {
        return;
    };
    let length = world
        .get::<Tether>(tether)
        .map_or(0.0, |tether| tether.length_m);
    let distance = from.distance(to);
    if length <= distance {
        return place_on_line(world, tether);
    }
    let shallow = distance * (0.375 * (length / distance.max(1e-9 * length) - 1.0)).sqrt();
    let deep = 0.5 * (length * length - distance * distance).sqrt();
    let sag = shallow.min(deep);
    let positions: Vec<DVec3> = (1..=count)
        .map(|number| {
            let s = number as f64 / (count + 1) as f64;
            from.lerp(to, s) - DVec3::Z * (4.0 * s * (1.0 - s) * sag)
        })
        .collect();
    set_node_positions(world, tether, &positions);
}

fn span(world: &World, tether: Entity) -> Option<(DVec3, DVec3, usize)> {
    let parts = world.get::<TetherParts>(tether)?;
    let end = |point: &Entity| {
        let end = world.get::<Attachment>(*point)?;
        Some(attachment_position(world, end.carrier, end.offset_m))
    };
    Some((
        end(parts.points.first()?)?,
        end(parts.points.last()?)?,
        parts.points.len() - 2,
    ))
}

/// Puts the nodes of a tether at `positions`, from its `from` on, m.
pub(super) fn set_node_positions(world: &mut World, tether: Entity, positions: &[DVec3]) {
    let Some(parts) = world.get::<TetherParts>(tether) else {
        return;
    };
    let nodes: Vec<Entity> = parts.points[1..parts.points.len() - 1].to_vec();
    for (node, place) in nodes.into_iter().zip(positions) {
        if let Some(mut position) = world.get_mut::<Position>(node) {
            position.0 = *place;
        }
    }
}
