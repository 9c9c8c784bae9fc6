//! The binary part of a file: numbers of single precision, and what the JSON part says of them.

use serde_json::{Value, json};

/// `componentType` of floats and of unsigned 32-bit integers.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// What numbers are for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Vertices of meshes.
    Vertices,
    /// Corners of triangles.
    Indices,
    /// Times and values of animations.
    Motion,
}

/// Numbers one after the other, with the views and accessors of each table of them.
#[derive(Default)]
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Buffer {
    /// Puts rows of numbers in, and gives their accessor. Bounds are said of positions and times, as glTF
    /// asks.
    pub(super) fn rows<const N: usize>(
        &mut self,
        rows: &[[f32; N]],
        purpose: Purpose,
        bounded: bool,
    ) -> usize {
        let kind = match N {
            1 => "SCALAR",
            3 => "VEC3",
            _ => "VEC4",
        };
        let start = self.bytes.len();
        for value in rows.iter().flatten() {
            self.bytes.extend_from_slice(&value.to_le_bytes());
        }
        let mut accessor = json!({ "componentType": FLOAT, "count": rows.len(), "type": kind });
        if bounded {
            accessor["min"] = json!(bound(rows, f32::INFINITY, f32::min));
            accessor["max"] = json!(bound(rows, f32::NEG_INFINITY, f32::max));
        }
        self.add(start, purpose, accessor)
    }

    /// Puts corners of triangles in, and gives their accessor.
    pub(super) fn triangles(&mut self, triangles: &[[u32; 3]]) -> usize {
        let start = self.bytes.len();
        for corner in triangles.iter().flatten() {
            self.bytes.extend_from_slice(&corner.to_le_bytes());
        }
        let count = 3 * triangles.len();
        let accessor = json!({ "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR" });
        self.add(start, Purpose::Indices, accessor)
    }

    fn add(&mut self, start: usize, purpose: Purpose, mut accessor: Value) -> usize {
        let length = self.bytes.len() - start;
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": length });
        match purpose {
            Purpose::Vertices => view["target"] = json!(34962),
            Purpose::Indices => view["target"] = json!(34963),
            Purpose::Motion => {}
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// Least or greatest value of each column. As double precision, because that prints all of a float.
fn bound<const N: usize>(rows: &[[f32; N]], start: f32, pick: fn(f32, f32) -> f32) -> Vec<f64> {
    let column = |column: usize| rows.iter().map(move |row| row[column]);
    (0..N)
        .map(|place| f64::from(column(place).fold(start, pick)))
        .collect()
}

/// Both parts as one binary file: header, JSON padded with spaces, numbers; nothing above 4 GiB.
pub(super) fn binary_file(mut json: Vec<u8>, numbers: &[u8]) -> Option<Vec<u8>> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + numbers.len();
    let length = |length: usize| u32::try_from(length).ok().map(u32::to_le_bytes);
    let mut file = Vec::with_capacity(total);
    file.extend_from_slice(b"glTF");
    file.extend_from_slice(&2_u32.to_le_bytes());
    file.extend_from_slice(&length(total)?);
    file.extend_from_slice(&length(json.len())?);
    file.extend_from_slice(b"JSON");
    file.extend_from_slice(&json);
    file.extend_from_slice(&length(numbers.len())?);
    file.extend_from_slice(b"BIN\0");
    file.extend_from_slice(numbers);
    Some(file)
}
