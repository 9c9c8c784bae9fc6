//! Segments of tethers: each the unit cylinder, moved, turned and scaled so that it lies between its points.

use glam::{DQuat, DVec3};
use serde_json::json;

use super::axes;
use super::colours::{of_tension, part_of};
use super::document::{Document, Motion};
use super::stage::Stage;
use crate::animation::{Animation, TetherMotion};
use crate::export::meshes::Shape;

/// Smallest diameter that is shown, as a part of half the diagonal of what is shown: a pixel or so.
const THINNEST: f64 = 2e-3;

/// Adds a node for each tether with one for each of its segments; gives the former.
pub(super) fn add(animation: &Animation, stage: &Stage, document: &mut Document) -> Vec<usize> {
    let greatest_n = animation.tension_range_n().map_or(0.0, |(_, most)| most);
    let tethers = animation.tethers.iter();
    tethers
        .map(|tether| add_tether(tether, greatest_n, stage, document))
        .collect()
}

fn add_tether(
    tether: &TetherMotion,
    greatest_n: f64,
    stage: &Stage,
    document: &mut Document,
) -> usize {
    let shown_diameter_m = tether.diameter_m.max(THINNEST * stage.size_m);
    let count = tether.tensions_n.first().map_or(0, Vec::len);
    let mut children = Vec::with_capacity(count);
    for segment in 0..count {
        let largest_n = tether.tensions_n.iter().filter_map(|row| row[segment]);
        let largest_n = largest_n.reduce(f64::max);
        let part = part_of(largest_n.unwrap_or(0.0), greatest_n);
        let mesh = document.mesh(Shape::Cylinder, of_tension(part, greatest_n));
        let node = json!({
            "name": format!("{}/{}", tether.name, segment + 1),
            "mesh": mesh,
            "extras": { "largest_tension_n": largest_n },
        });
        let motion = motion(tether, segment, 0.5 * shown_diameter_m, stage);
        children.push(document.moving_node(node, &motion));
    }
    document.node(json!({
        "name": tether.name,
        "children": children,
        "extras": {
            "diameter_m": tether.diameter_m,
            "shown_diameter_m": shown_diameter_m,
        },
    }))
}

/// The cylinder's axis from the first point to the second; nothing is left of it in frames without the segment.
fn motion(tether: &TetherMotion, segment: usize, radius_m: f64, stage: &Stage) -> Motion {
    let mut motion = Motion::default();
    let mut attitude = DQuat::IDENTITY;
    for frame in &stage.frames {
        let points_m = &tether.points_m[*frame];
        let (from_m, to_m) = (points_m[segment], points_m[segment + 1]);
        let length_m = (to_m - from_m).length();
        let is_there = tether.tensions_n[*frame][segment].is_some() && length_m > 0.0;
        let mut scale_m = DVec3::ZERO;
        if is_there {
            // From the attitude before, so that it is interpolated the short way round and never twists.
            let direction = (to_m - from_m) / length_m;
            let turn = DQuat::from_rotation_arc(attitude * DVec3::Z, direction);
            attitude = (turn * attitude).normalize();
            scale_m = DVec3::new(radius_m, radius_m, length_m);
        }
        let rotation = axes::rotation(attitude).to_array();
        motion.translations.push(stage.place(0.5 * (from_m + to_m)));
        motion.rotations.push(axes::single(rotation));
        motion
            .scales
            .push(axes::single(axes::scale(scale_m).to_array()));
    }
    motion
}
