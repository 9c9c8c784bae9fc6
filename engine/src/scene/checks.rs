//! Checks that any scene must pass, whatever its components: their own fields, what they exclude and
//! need, and the checks that plugins add.

use std::collections::BTreeSet;

use aerobot_components::run::{ChannelSelection, InstrumentSelection};
use aerobot_components::scene_component::FieldReport;
use aerobot_components::tether::Tether;

use super::copies::{COPIES, check_step};
use super::reader::Written;
use super::source::nearest;
use super::{Scene, SceneEntity};
use crate::plugin::Simulator;

/// Checks each entity as it is written, also of a scene that is not `complete` because some of it could
/// not be read.
pub(super) fn check_written(
    simulator: &Simulator,
    written: &[Written],
    complete: bool,
    report: &mut FieldReport,
) {
    for Written { entity, .. } in written {
        for (name, component) in &entity.components {
            let path = format!("entities.{}.{name}", entity.name);
            report.within(&path, |report| component.check(report));
        }
    }
    if complete && written.is_empty() {
        report.add(
            "entities",
            "the scene has no entities",
            "add one: `\"gondola\": (Body: (mass_kg: ..), ..)`",
        );
    }
    let whole = written.iter().filter(|written| written.entity.complete);
    for Written { entity, .. } in whole {
        check_company(simulator, entity, report);
        check_step(entity, report);
    }
}

/// Runs the checks on the scene as a whole.
pub(super) fn check_scene(simulator: &Simulator, scene: &Scene, report: &mut FieldReport) {
    let mut across = FieldReport::new("");
    check_names(scene, &mut across);
    check_record(scene, &mut across);
    for check in &simulator.checks {
        check(scene, &mut across);
    }
    for violation in across.into_violations() {
        if !is_of_incomplete(scene, &violation.path) {
            let help = violation.help.unwrap_or_default();
            report.add(&violation.path, violation.message, help);
        }
    }
}

/// Whether a path leads to an entity of which some could not be read: what it seems to lack may be
/// just that.
fn is_of_incomplete(scene: &Scene, path: &str) -> bool {
    let entity = path
        .strip_prefix("entities.")
        .and_then(|rest| rest.split('.').next());
    scene
        .entities
        .iter()
        .any(|other| !other.complete && Some(other.name.as_str()) == entity)
}

/// What a component excludes must be absent, and what it needs present.
fn check_company(simulator: &Simulator, entity: &SceneEntity, report: &mut FieldReport) {
    let has = |name: &str| entity.components.iter().any(|(other, _)| *other == name);
    let stands_for = |name: &str| {
        let mut expansions = simulator.expansions.iter();
        expansions.any(|expansion| expansion.member == name && has(expansion.written))
    };
    if !entity.components.iter().any(|(name, _)| *name != COPIES) {
        report.add(
            &format!("entities.{}", entity.name),
            format!("`{}` has no components", entity.name),
            "give it a `Body`, a `Fixed` or a `Tether`, or leave it out",
        );
    }
    for (name, _) in &entity.components {
        let Some(entry) = simulator.components.get(name) else {
            continue;
        };
        let path = format!("entities.{}.{name}", entity.name);
        for excluded in entry.excludes.iter().filter(|excluded| has(excluded)) {
            report.add(
                &path,
                format!("`{name}` and `{excluded}` exclude each other"),
                "keep one of the two",
            );
        }
        for group in entry
            .requires
            .iter()
            .filter(|group| !group.iter().any(|name| has(name) || stands_for(name)))
        {
            report.add(
                &path,
                format!("`{name}` needs `{}` beside it", group.join("` or `")),
                "add it to the same entity",
            );
        }
    }
}

/// No member of a group has the name of another entity, and no entity that of a node. (Two names in the text
/// that are the same have been found there.)
fn check_names(scene: &Scene, report: &mut FieldReport) {
    let mut known = BTreeSet::new();
    for entity in &scene.entities {
        let path = format!("entities.{}", entity.name);
        let (message, help) = (
            format!("`{}` is the name of another entity too", entity.name),
            "give one of them another name",
        );
        let is_member = scene.groups.of(&entity.name).is_some();
        if !known.insert(entity.name.as_str()) && is_member {
            report.add(&path, message, help);
        }
        let node = entity.name.rsplit_once('/').and_then(|(owner, number)| {
            let nodes = scene.entity(owner)?.get::<Tether>()?.nodes;
            let number = number.parse::<u32>().ok()?;
            (1..=nodes).contains(&number).then_some(owner)
        });
        if let Some(tether) = node {
            let message = format!("`{}` is the name of a node of `{tether}`", entity.name);
            report.add(&path, message, help);
        }
    }
}

/// Entities that the record block names must exist.
fn check_record(scene: &Scene, report: &mut FieldReport) {
    let mut named: Vec<(String, &str)> = Vec::new();
    if let ChannelSelection::Only(channels) = &scene.run.record.channels {
        let names = channels.keys().filter(|name| *name != "system");
        named.extend(names.map(|name| (format!("run.record.channels.{name}"), name.as_str())));
    }
    if let InstrumentSelection::Only(names) = &scene.run.record.instruments {
        let places = names.iter().enumerate();
        named.extend(places.map(|(index, name)| {
            let path = format!("run.record.instruments.0.{index}");
            (path, name.as_str())
        }));
    }
    for (path, name) in named {
        if scene.entity(name).is_none() && !scene.may_be_unread(name) {
            let help = meant(name, scene.entities.iter());
            report.add(&path, format!("there is no entity `{name}`"), help);
        }
    }
}

/// The help for a name that no entity has: the nearest of `entities`, or else all of them.
pub(crate) fn meant<'a>(name: &str, entities: impl Iterator<Item = &'a SceneEntity>) -> String {
    let names: Vec<&str> = entities.map(|entity| entity.name.as_str()).collect();
    match nearest(name, names.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if names.is_empty() => String::new(),
        None => format!("there are `{}`", names.join("`, `")),
    }
}
