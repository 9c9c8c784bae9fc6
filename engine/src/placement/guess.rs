//! The geometric guess: everything hangs plumb from what holds it, or floats plumb above it.

use std::collections::BTreeMap;

use aerobot_components::aerodynamics::{DisplacedVolume, RadiusRule, Sphere};
use aerobot_components::body::Body;
use aerobot_components::state::{Attitude, Inertia, Mass, Position};
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::instruments::attitude::heading_rad;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DQuat, DVec2, DVec3};

use super::attachment_position;
use crate::balloon_sizing::{tethered_mass_kg, tethered_together};
use crate::scene::{Scene, SetupError};
use crate::world::{EntityName, SceneEntities};

/// A tether as the guess sees it: its two carriers with the places on them.
struct Line {
    ends: [(Entity, DVec3); 2],
    length_m: f64,
    stiffness_n: f64,
    /// Weight at the altitude of the highest thing that is placed, N: near enough for a guess.
    weight_n: f64,
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
        hang(world, &lines, bodies, &mut waiting);
        let Some(&first) = waiting.first() else {
            return Ok(floating);
        };
        let name = world.get::<EntityName>(first).map_or("", |name| &name.0);
        let balloon = floating_balloon(world, scene, name)?;
        let altitude_m = floating_altitude(world, scene, balloon)?;
        if let Some(mut position) = world.get_mut::<Position>(balloon) {
            position.0 = DVec3::new(0.0, 0.0, altitude_m);
        }
        waiting.retain(|body| *body != balloon);
        floating.push(balloon);
    }
}

/// Hangs `bodies` anew, all but one that stays where it is and is turned only.
pub(super) fn hang_anew(world: &mut World, bodies: &[Entity], stays: Option<Entity>) {
    let lines = lines(world);
    let bodies_to_place = bodies.iter().copied();
    let mut waiting = bodies_to_place
        .filter(|body| Some(*body) != stays)
        .collect();
    hang(world, &lines, bodies, &mut waiting);
}

fn lines(world: &mut World) -> Vec<Line> {
    let gravity = world.resource::<EnvironmentModel>().gravity;
    let mut positions = world.query::<&Position>();
    let highest_m = positions
        .iter(world)
        .map(|position| position.0.z)
        .fold(0.0, f64::max);
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
                weight_n: tether.lumped_mass_kg() * gravity.acceleration_m_s2(highest_m),
            })
        })
        .collect();
    found
}

/// Hangs every waiting body that tethers join to a placed one, generation by generation; `bodies` are
/// all that may be turned.
fn hang(world: &mut World, lines: &[Line], bodies: &[Entity], waiting: &mut Vec<Entity>) {
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
    turn(world, lines, bodies, &generations, &loads);
    for (body, holding) in generations.into_iter().flatten() {
        let load = loads.get(&body).copied().unwrap_or(0.0);
        let down = if load < 0.0 { DVec3::Z } else { DVec3::NEG_Z };
        if let Some(yaw) = untwisting_yaw(world, lines, body, &holding)
            && let Some(mut attitude) = world.get_mut::<Attitude>(body)
        {
            attitude.0 = yaw * attitude.0;
        }
        let attitude = world.get::<Attitude>(body).copied().unwrap_or_default();
        let count = holding.len() as f64;
        // Where the body would be for each of its lines, were it plumb.
        let plumb: Vec<(DVec3, f64)> = holding
            .iter()
            .map(|index| {
                let line = &lines[*index];
                let (own, holder) = oriented(line, body);
                let top = attachment_position(world, holder.0, holder.1);
                let length = line.length_m * (1.0 + load.abs() / (count * line.stiffness_n));
                (top - attitude.0 * own.1, length)
            })
            .collect();
        let middle = plumb
            .iter()
            .fold(DVec3::ZERO, |sum, (top, _)| sum + *top / count);
        let mut place = DVec3::ZERO;
        for (top, length) in plumb {
            let height = height_m(length, (middle - top).with_z(0.0).length());
            place += (top + height * down) / count;
        }
        if let Some(mut position) = world.get_mut::<Position>(body) {
            position.0 = place;
        }
    }
    *waiting = left;
}

/// Height between the ends of a line of `length_m` that are `across_m` apart horizontally, m.
fn height_m(length_m: f64, across_m: f64) -> f64 {
    if across_m < 1e-9 * length_m {
        return length_m;
    }
    // A line that is too short is stretched, and stays off the horizontal.
    let part = (across_m / length_m).min(0.99);
    length_m * (1.0 - part * part).sqrt()
}

/// The turn about the vertical that brings the places of a body nearest, all in all, below those from
/// which lines hold it; none where they are all above one another.
fn untwisting_yaw(world: &World, lines: &[Line], body: Entity, holding: &[usize]) -> Option<DQuat> {
    world.get::<Inertia>(body)?;
    let attitude = world.get::<Attitude>(body)?.0;
    let pairs: Vec<(DVec2, DVec2)> = holding
        .iter()
        .map(|index| {
            let (own, holder) = oriented(&lines[*index], body);
            let top = attachment_position(world, holder.0, holder.1);
            ((attitude * own.1).truncate(), top.truncate())
        })
        .collect();
    let count = pairs.len() as f64;
    let sum = pairs.iter().fold((DVec2::ZERO, DVec2::ZERO), |sum, pair| {
        (sum.0 + pair.0, sum.1 + pair.1)
    });
    let (mut cosine, mut sine, mut size) = (0.0, 0.0, 0.0);
    for (own, top) in pairs {
        let (own, top) = (own - sum.0 / count, top - sum.1 / count);
        cosine += own.dot(top);
        sine += own.perp_dot(top);
        size += own.length() * top.length();
    }
    let is_known = libm::hypot(cosine, sine) > SMALLEST_PART * size;
    let yaw_rad = libm::atan2(sine, cosine);
    (is_known && yaw_rad.abs() > SMALLEST_PART).then(|| DQuat::from_rotation_z(yaw_rad))
}

/// What is smaller than this part of its terms is their round-off.
const SMALLEST_PART: f64 = 1e-9;

/// Turns bodies to where plumb lines hold them: upward forces f_i at places r_i make no torque if
/// sum f_i r_i points up; they keep the heading they have.
fn turn(
    world: &mut World,
    lines: &[Line],
    bodies: &[Entity],
    generations: &[Vec<(Entity, Vec<usize>)>],
    loads: &BTreeMap<Entity, f64>,
) {
    let mut leans: BTreeMap<Entity, Lean> = BTreeMap::new();
    for (body, holding) in generations.iter().flatten() {
        let up = loads.get(body).copied().unwrap_or(0.0) / holding.len() as f64;
        for index in holding {
            let line = &lines[*index];
            let (own, holder) = oriented(line, *body);
            leans.entry(*body).or_default().add(up * own.1);
            let pull = up + line.weight_n;
            leans.entry(holder.0).or_default().add(-pull * holder.1);
        }
    }
    for body in bodies {
        if world.get::<Inertia>(*body).is_none() {
            continue;
        }
        let lean = leans.get(body).and_then(Lean::direction);
        if let (Some(lean), Some(mut attitude)) = (lean, world.get_mut::<Attitude>(*body)) {
            let heading = DQuat::from_rotation_z(heading_rad(attitude.0));
            attitude.0 = heading * DQuat::from_rotation_arc(lean, DVec3::Z);
        }
    }
}

/// What points up in a body that lines hold: sum f_i r_i.
#[derive(Default)]
struct Lean {
    terms: Vec<DVec3>,
}

impl Lean {
    fn add(&mut self, term: DVec3) {
        self.terms.push(term);
    }

    /// Its direction; none where the terms cancel, nor where it would turn a body over that three lines or
    /// more hold up by an area.
    fn direction(&self) -> Option<DVec3> {
        let sum = self.terms.iter().fold(DVec3::ZERO, |sum, term| sum + *term);
        let size: f64 = self.terms.iter().map(|term| term.length()).sum();
        let is_held_by_area = || {
            let mut pairs = self.terms.windows(2).map(|pair| pair[0] - pair[1]);
            let first = pairs.next().unwrap_or_default();
            pairs.any(|other| first.cross(other).length() > SMALLEST_PART * size * size)
        };
        let is_round_off = sum.length() <= SMALLEST_PART * size;
        let direction = (!is_round_off).then(|| sum.try_normalize())??;
        (direction.z > 0.0 || !is_held_by_area()).then_some(direction)
    }
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
    let mut loads: BTreeMap<Entity, f64> = BTreeMap::new();
    let altitudes = altitudes(world, lines, generations);
    for (body, holding) in generations.iter().rev().flatten() {
        let own = net_weight_n(world, *body, altitudes.get(body).copied().unwrap_or(0.0));
        let total = *loads
            .entry(*body)
            .and_modify(|load| *load += own)
            .or_insert(own);
        for index in holding {
            let line = &lines[*index];
            let holder = oriented(line, *body).1.0;
            *loads.entry(holder).or_insert(0.0) += total / holding.len() as f64 + line.weight_n;
        }
    }
    loads
}

/// Altitude in m at which each body is weighed: that of the placed thing at the top of its line, which
/// is near enough for a guess.
fn altitudes(
    world: &World,
    lines: &[Line],
    generations: &[Vec<(Entity, Vec<usize>)>],
) -> BTreeMap<Entity, f64> {
    let mut altitudes: BTreeMap<Entity, f64> = BTreeMap::new();
    for (body, holding) in generations.iter().flatten() {
        let Some(holder) = holding
            .first()
            .map(|index| oriented(&lines[*index], *body).1.0)
        else {
            continue;
        };
        let placed = world
            .get::<Position>(holder)
            .map_or(0.0, |position| position.0.z);
        let altitude_m = altitudes.get(&holder).copied().unwrap_or(placed);
        altitudes.insert(*body, altitude_m);
    }
    altitudes
}

/// Weight less buoyancy of a body at an altitude in m, N.
fn net_weight_n(world: &World, body: Entity, altitude_m: f64) -> f64 {
    let environment = world.resource::<EnvironmentModel>();
    let density = environment
        .atmosphere
        .density_kg_m3(altitude_m)
        .unwrap_or(0.0);
    let mass = world.get::<Mass>(body).map_or(0.0, |mass| mass.0);
    let volume = world
        .get::<DisplacedVolume>(body)
        .map_or(0.0, |volume| volume.0);
    environment.gravity.acceleration_m_s2(altitude_m) * (mass - density * volume)
}

/// The balloon that carries the system of the body called `name`.
pub(super) fn floating_balloon(
    world: &World,
    scene: &Scene,
    name: &str,
) -> Result<Entity, SetupError> {
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
