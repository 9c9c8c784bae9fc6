//! The JSON part of a file as it grows: nodes, meshes, materials and the motion of nodes.

use serde_json::{Value, json};

use super::axes;
use super::buffer::{Buffer, Purpose};
use crate::export::meshes::Shape;

/// Where the numbers of a shape are.
struct ShapeNumbers {
    shape: Shape,
    positions: usize,
    normals: usize,
    triangles: usize,
}

/// A file as it grows.
pub(super) struct Document {
    pub(super) nodes: Vec<Value>,
    pub(super) materials: Vec<Value>,
    pub(super) meshes: Vec<Value>,
    pub(super) cameras: Vec<Value>,
    pub(super) channels: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    pub(super) buffer: Buffer,
    shapes: Vec<ShapeNumbers>,
    painted: Vec<(Shape, usize)>,
    /// Accessor of the times of frames.
    times: usize,
}

/// How a node moves, in the axes of glTF: a row for each frame, or nothing where it has no such property.
#[derive(Default)]
pub(super) struct Motion {
    pub(super) translations: Vec<[f32; 3]>,
    pub(super) rotations: Vec<[f32; 4]>,
    pub(super) scales: Vec<[f32; 3]>,
}

impl Document {
    /// With frames at these times, s, the first at zero.
    pub(super) fn new(times_s: &[[f32; 1]]) -> Self {
        let mut buffer = Buffer::default();
        Self {
            times: buffer.rows(times_s, Purpose::Motion, true),
            buffer,
            nodes: Vec::new(),
            materials: Vec::new(),
            meshes: Vec::new(),
            cameras: Vec::new(),
            channels: Vec::new(),
            samplers: Vec::new(),
            shapes: Vec::new(),
            painted: Vec::new(),
        }
    }

    /// The mesh of a shape in a material; made once.
    pub(super) fn mesh(&mut self, shape: Shape, material: Value) -> usize {
        let material = place_of(&mut self.materials, material);
        if let Some(mesh) = self
            .painted
            .iter()
            .position(|key| *key == (shape, material))
        {
            return mesh;
        }
        let numbers = self.shape(shape);
        let primitive = json!({
            "attributes": { "POSITION": numbers.positions, "NORMAL": numbers.normals },
            "indices": numbers.triangles,
            "material": material,
        });
        self.painted.push((shape, material));
        self.meshes.push(json!({ "primitives": [primitive] }));
        self.meshes.len() - 1
    }

    fn shape(&mut self, shape: Shape) -> &ShapeNumbers {
        let known = self
            .shapes
            .iter()
            .position(|numbers| numbers.shape == shape);
        let place = known.unwrap_or_else(|| {
            let mesh = shape.mesh();
            let turned = |vectors: &[glam::DVec3]| -> Vec<[f32; 3]> {
                let turned = vectors.iter().map(|vector| axes::vector(*vector));
                turned
                    .map(|vector| axes::single(vector.to_array()))
                    .collect()
            };
            let buffer = &mut self.buffer;
            self.shapes.push(ShapeNumbers {
                shape,
                positions: buffer.rows(&turned(&mesh.positions), Purpose::Vertices, true),
                normals: buffer.rows(&turned(&mesh.normals), Purpose::Vertices, false),
                triangles: buffer.triangles(&mesh.triangles),
            });
            self.shapes.len() - 1
        });
        &self.shapes[place]
    }

    /// Adds a node.
    pub(super) fn node(&mut self, node: Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// Adds a node that moves; it stands as in the first frame, and what does not change has no channel.
    pub(super) fn moving_node(&mut self, mut node: Value, motion: &Motion) -> usize {
        let place = self.nodes.len();
        self.animate(&mut node, place, "translation", &motion.translations);
        self.animate(&mut node, place, "rotation", &motion.rotations);
        self.animate(&mut node, place, "scale", &motion.scales);
        self.node(node)
    }

    fn animate<const N: usize>(
        &mut self,
        node: &mut Value,
        place: usize,
        path: &str,
        rows: &[[f32; N]],
    ) {
        let Some(first) = rows.first() else {
            return;
        };
        node[path] = json!(first.map(f64::from).to_vec());
        if rows.iter().all(|row| row == first) {
            return;
        }
        let output = self.buffer.rows(rows, Purpose::Motion, false);
        self.channels.push(json!({
            "sampler": self.samplers.len(),
            "target": { "node": place, "path": path },
        }));
        self.samplers.push(json!({
            "input": self.times,
            "output": output,
            "interpolation": "LINEAR",
        }));
    }
}

/// The place of a value in a list, at whose end it is put if it is not there.
fn place_of(list: &mut Vec<Value>, value: Value) -> usize {
    let known = list.iter().position(|other| *other == value);
    known.unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}
