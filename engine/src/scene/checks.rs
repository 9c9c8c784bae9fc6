//! Checks that any scene must pass, whatever its components: their own fields, what they exclude and
//! need, and the checks that plugins add.

use aerobot_components::run::{ChannelSelection, Formulation, InstrumentSelection};
use aerobot_components::scene_component::FieldReport;

use super::source::nearest;
use super::{Scene, SceneEntity};
use crate::plugin::Simulator;

/// Runs every check; those that look across the scene only if all of it could be read.
pub(super) fn check_scene(
    simulator: &Simulator,
    scene: &Scene,
    complete: bool,
    report: &mut FieldReport,
) {
    for entity in &scene.entities {
        for (name, component) in &entity.components {
            let path = format!("entities.{}.{name}", entity.name);
            report.within(&path, |report| component.check(report));
        }
    }
    if !complete {
        return;
    }
    if scene.entities.is_empty() {
        report.add("entities", "the scene has no entities", "");
    }
    for entity in &scene.entities {
        check_company(simulator, entity, report);
    }
    check_formulation(scene, report);
    check_record(scene, report);
    for check in &simulator.checks {
        check(scene, report);
    }
}

/// What a component excludes must be absent, and what it needs present.
fn check_company(simulator: &Simulator, entity: &SceneEntity, report: &mut FieldReport) {
    let has = |name: &str| entity.components.iter().any(|(other, _)| *other == name);
    if entity.components.is_empty() {
        report.add(
            &format!("entities.{}", entity.name),
            format!("`{}` has no components", entity.name),
            "",
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
                "",
            );
        }
        for group in entry
            .requires
            .iter()
            .filter(|group| !group.iter().any(|name| has(name)))
        {
            report.add(
                &path,
                format!("`{name}` needs `{}` beside it", group.join("` or `")),
                "",
            );
        }
    }
}

fn check_formulation(scene: &Scene, report: &mut FieldReport) {
    if scene.run.formulation == Formulation::Denoc {
        report.add(
            "run.formulation",
            "the formulation `Denoc` is not part of this version",
            "use `LumpedMass` (`--formulation lumped-mass`)",
        );
    }
}

/// Entities that the record block names must exist.
fn check_record(scene: &Scene, report: &mut FieldReport) {
    let mut named: Vec<(&str, String)> = Vec::new();
    if let ChannelSelection::Only(channels) = &scene.run.record.channels {
        let names = channels.keys().filter(|name| *name != "system");
        named.extend(names.map(|name| ("run.record.channels", name.clone())));
    }
    if let InstrumentSelection::Only(names) = &scene.run.record.instruments {
        named.extend(
            names
                .iter()
                .map(|name| ("run.record.instruments", name.clone())),
        );
    }
    for (path, name) in named {
        if scene.entity(&name).is_none() {
            let names = scene.entities.iter().map(|entity| entity.name.as_str());
            let help = nearest(&name, names)
                .map_or_else(String::new, |near| format!("did you mean `{near}`?"));
            report.add(path, format!("there is no entity `{name}`"), help);
        }
    }
}
