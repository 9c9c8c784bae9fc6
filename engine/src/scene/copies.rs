//! Entities with `Copies`: what each copy reads in the text, and where it stands.

use std::ops::Range;

use aerobot_components::body::{Fixed, Moving, Pose};
use aerobot_components::copies::{Copies, MOST_COPIES, numbered};
use aerobot_components::scene_component::{FieldReport, SceneComponent};
use aerobot_components::tether::{Tether, TetherStart};
use aerobot_components::tether_ring::Tethers;
use glam::DVec3;

use super::SceneEntity;
use super::registry::ParsedComponent;
use super::source::{Kind, Node, Scalar};

/// How often an entity is there, if it is to be copied and can be.
pub(super) fn count(entity: &SceneEntity) -> Option<u32> {
    let count = entity.get::<Copies>()?.count;
    (1..=MOST_COPIES).contains(&count).then_some(count)
}

/// The text of a value as copy `number` reads it; `None` if it is the same for all.
pub(crate) fn numbered_text(text: &str, value: &Node, number: u32) -> Option<String> {
    let mut strings = Vec::new();
    find_strings(text, value, &mut strings);
    if strings.is_empty() {
        return None;
    }
    let mut result = String::new();
    let mut from = value.span.start;
    for string in strings {
        result.push_str(&text[from..string.start]);
        result.push_str(&numbered(&text[string.clone()], number));
        from = string.end;
    }
    result.push_str(&text[from..value.span.end]);
    Some(result)
}

/// The strings in a value that have a `#` in them, in the order of the text.
fn find_strings(text: &str, node: &Node, found: &mut Vec<Range<usize>>) {
    if node.kind == Kind::Scalar(Scalar::Text) {
        let string = &text[node.span.clone()];
        // The `#` of a raw string are its quotes.
        if string.starts_with('"') && string.contains('#') {
            found.push(node.span.clone());
        }
    }
    if let Kind::Map { entries } = &node.kind {
        for entry in entries {
            find_strings(text, &entry.key, found);
            find_strings(text, &entry.value, found);
        }
        return;
    }
    for (_, _, child) in node.children() {
        find_strings(text, child, found);
    }
}

/// Moves a component that places something in the inertial frame, m.
pub(super) fn shift(component: &mut dyn ParsedComponent, by_m: DVec3) {
    for place in places(component) {
        *place += by_m;
    }
}

/// Places in the inertial frame that a component gives, m.
fn places(component: &mut dyn ParsedComponent) -> Vec<&mut DVec3> {
    let component = component.as_any_mut();
    if component.is::<Pose>() {
        let pose = component.downcast_mut::<Pose>();
        pose.map(|pose| &mut pose.position_m).into_iter().collect()
    } else if component.is::<Fixed>() {
        let fixed = component.downcast_mut::<Fixed>();
        let place = fixed.and_then(|fixed| fixed.position_m.as_mut());
        place.into_iter().collect()
    } else if component.is::<Moving>() {
        let moving = component.downcast_mut::<Moving>();
        moving
            .map(|moving| &mut moving.position_m)
            .into_iter()
            .collect()
    } else if component.is::<Tether>() {
        let tether = component.downcast_mut::<Tether>();
        tether.map_or_else(Vec::new, |tether| nodes(&mut tether.start))
    } else if component.is::<Tethers>() {
        let tethers = component.downcast_mut::<Tethers>();
        tethers.map_or_else(Vec::new, |tethers| nodes(&mut tethers.start))
    } else {
        Vec::new()
    }
}

/// Places at which nodes start, m.
fn nodes(start: &mut TetherStart) -> Vec<&mut DVec3> {
    match start {
        TetherStart::Equilibrium | TetherStart::Straight => Vec::new(),
        TetherStart::Positions(positions) => positions.iter_mut().collect(),
        TetherStart::Each(starts) => starts.iter_mut().flatten().collect(),
    }
}

/// Copies with a place need a step from one to the next, and those without have no use for it.
pub(super) fn check_step(entity: &SceneEntity, report: &mut FieldReport) {
    let Some(copies) = entity.get::<Copies>().filter(|copies| copies.count > 1) else {
        return;
    };
    let mut components = entity.components.iter();
    let placing =
        components.find(|(_, component)| !places(&mut *component.boxed_clone()).is_empty());
    let path = entity.path::<Copies>();
    match placing {
        Some((name, _)) if copies.step_m == DVec3::ZERO => report.add(
            &path,
            format!("`{name}` puts all copies of `{}` in one place", entity.name),
            "give the `step_m` from each copy to the next",
        ),
        None if copies.step_m != DVec3::ZERO => report.add(
            &format!("{path}.step_m"),
            format!("nothing says where the first `{}` is", entity.name),
            "leave `step_m` out, or give a `Pose` or a `position_m` that it can be counted from",
        ),
        _ => {}
    }
}

/// Name of the component, which stands in no copy.
pub(crate) const COPIES: &str = Copies::NAME;
