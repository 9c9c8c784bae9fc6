//! Bodies: a node that moves, with one for each of its parts.

use glam::DVec3;
use serde_json::{Value, json};

use super::axes;
use super::colours::of_role;
use super::document::{Document, Motion};
use super::stage::Stage;
use crate::animation::appearance::Part;
use crate::animation::{Animation, BodyMotion};
use crate::export::meshes::shape_and_scale;

/// Adds the nodes of all bodies; gives one for each.
pub(super) fn add(animation: &Animation, stage: &Stage, document: &mut Document) -> Vec<usize> {
    let bodies = animation.bodies.iter();
    bodies.map(|body| add_body(body, stage, document)).collect()
}

fn add_body(body: &BodyMotion, stage: &Stage, document: &mut Document) -> usize {
    let parts = body.parts.iter().enumerate();
    let children: Vec<usize> = parts
        .map(|(number, part)| {
            let node = part_node(&body.name, number, part, document);
            document.node(node)
        })
        .collect();
    let frames = || stage.frames.iter();
    let attitudes = frames().map(|frame| axes::rotation(body.attitudes[*frame].normalize()));
    let motion = Motion {
        translations: frames()
            .map(|frame| stage.place(body.positions_m[*frame]))
            .collect(),
        rotations: attitudes
            .map(|attitude| axes::single(attitude.to_array()))
            .collect(),
        scales: Vec::new(),
    };
    let node = json!({ "name": body.name, "children": children });
    document.moving_node(node, &motion)
}

fn part_node(body: &str, number: usize, part: &Part, document: &mut Document) -> Value {
    let (shape, scale_m) = shape_and_scale(&part.solid);
    let mesh = document.mesh(shape, of_role(part.role));
    let at_m = axes::vector(DVec3::from_array(part.at_m)).to_array();
    let scale_m = axes::scale(scale_m).to_array();
    json!({
        "name": format!("{body} part {}", number + 1),
        "mesh": mesh,
        "translation": axes::single(at_m).map(f64::from).to_vec(),
        "scale": axes::single(scale_m).map(f64::from).to_vec(),
        "extras": { "to_scale": part.to_scale },
    })
}
