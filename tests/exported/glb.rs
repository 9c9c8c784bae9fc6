//! A binary glTF file taken apart by what ISO/IEC 12113 says of it, and its nodes placed frame by frame.

use glam::{DQuat, DVec3};
use serde_json::Value;

pub(crate) struct Glb {
    pub(crate) json: Value,
    pub(crate) numbers: Vec<u8>,
}

fn whole(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

fn place(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

impl Glb {
    pub(crate) fn parse(bytes: &[u8]) -> Self {
        assert_eq!(&bytes[..4], b"glTF");
        assert_eq!(whole(bytes, 4), 2);
        assert_eq!(whole(bytes, 8), bytes.len());
        let json = whole(bytes, 12);
        assert_eq!(&bytes[16..20], b"JSON");
        let rest = &bytes[20 + json..];
        assert_eq!(json % 4, 0);
        assert_eq!(&rest[4..8], b"BIN\0");
        assert_eq!(whole(rest, 0) + 8, rest.len());
        Self {
            json: serde_json::from_slice(&bytes[20..20 + json]).unwrap(),
            numbers: rest[8..].to_vec(),
        }
    }

    /// The rows of an accessor of floats.
    pub(crate) fn rows(&self, accessor: usize) -> Vec<Vec<f64>> {
        let accessor = &self.json["accessors"][accessor];
        assert_eq!(accessor["componentType"], 5126);
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let view = &self.json["bufferViews"][place(&accessor["bufferView"])];
        let start = place(&view["byteOffset"]);
        let bytes = &self.numbers[start..start + place(&view["byteLength"])];
        assert_eq!(bytes.len(), place(&accessor["count"]) * width * 4);
        let floats = bytes.chunks_exact(4);
        let floats: Vec<f64> = floats
            .map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().unwrap())))
            .collect();
        floats.chunks(width).map(<[f64]>::to_vec).collect()
    }

    pub(crate) fn node(&self, name: &str) -> usize {
        let nodes = self.json["nodes"].as_array().unwrap();
        let found = nodes.iter().position(|node| node["name"] == name);
        found.unwrap_or_else(|| panic!("no node `{name}`"))
    }

    /// Times of the animation, s.
    pub(crate) fn times_s(&self) -> Vec<f64> {
        let input = place(&self.json["animations"][0]["samplers"][0]["input"]);
        self.rows(input).concat()
    }

    /// What moves a property of a node, or where it stands; the unit of that property if neither is said.
    fn property(&self, node: usize, path: &str, unit: &[f64]) -> Vec<Vec<f64>> {
        let animation = &self.json["animations"][0];
        let channels = animation["channels"].as_array().unwrap();
        let channel = channels
            .iter()
            .find(|channel| channel["target"]["node"] == node && channel["target"]["path"] == path);
        if let Some(channel) = channel {
            let sampler = &animation["samplers"][place(&channel["sampler"])];
            assert_eq!(sampler["interpolation"], "LINEAR");
            return self.rows(place(&sampler["output"]));
        }
        let standing = self.json["nodes"][node][path].as_array();
        let standing = standing.map(|row| row.iter().map(|v| v.as_f64().unwrap()).collect());
        vec![standing.unwrap_or_else(|| unit.to_vec()); self.times_s().len()]
    }

    /// Translation, rotation and scale of a node in every frame.
    pub(crate) fn motion(&self, node: usize) -> Vec<(DVec3, DQuat, DVec3)> {
        let translations = self.property(node, "translation", &[0.0; 3]);
        let rotations = self.property(node, "rotation", &[0.0, 0.0, 0.0, 1.0]);
        let scales = self.property(node, "scale", &[1.0; 3]);
        let rows = translations.iter().zip(&rotations).zip(&scales);
        rows.map(|((translation, rotation), scale)| {
            (
                DVec3::from_slice(translation),
                DQuat::from_slice(rotation),
                DVec3::from_slice(scale),
            )
        })
        .collect()
    }

    /// What positions are from, in the axes of the run, m.
    pub(crate) fn origin_m(&self) -> DVec3 {
        let origin = self.json["asset"]["extras"]["origin_m"].as_array().unwrap();
        let origin: Vec<f64> = origin.iter().map(|part| part.as_f64().unwrap()).collect();
        DVec3::from_slice(&origin)
    }

    /// Where something of the run should be.
    pub(crate) fn place_of(&self, position_m: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = position_m - self.origin_m();
        DVec3::new(-y, z, -x)
    }
}
