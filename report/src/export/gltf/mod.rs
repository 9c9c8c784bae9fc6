//! An animation as glTF 2.0 (ISO/IEC 12113:2022), one binary file without extensions.
//!
//! Each body is a node with a child for each of its parts, each tether a node with a child for each of its
//! segments: the unit cylinder between its two points. The animation `flight` moves them, linearly between
//! frames. A segment that is not there in a frame has no size in it. Axes are those of glTF (`axes.rs`);
//! positions are of single precision, from an origin that `asset.extras` names.
//!
//! glTF has no colour that changes with time that viewers show, so that a segment has the colour of its largest
//! tension of the flight.

mod axes;
mod bodies;
mod buffer;
mod colours;
mod document;
mod segments;
mod stage;

use aerobot_engine::recording::summary::Summary;
use serde_json::{Value, json};

use super::{ExportError, check_not_empty};
use crate::animation::Animation;
use document::Document;
use stage::Stage;

/// The file, a `.glb`. The same animation gives the same bytes.
///
/// # Errors
/// There is nothing to show, or too much.
pub fn binary(animation: &Animation, summary: &Summary) -> Result<Vec<u8>, ExportError> {
    check_not_empty(animation)?;
    let stage = Stage::of(animation);
    let mut document = Document::new(&stage.times_s);
    let mut roots = bodies::add(animation, &stage, &mut document);
    roots.extend(segments::add(animation, &stage, &mut document));
    roots.extend(stage.add_cameras(animation, &mut document));
    let mut json = json!({
        "asset": {
            "version": "2.0",
            "generator": format!("aerobot {}", summary.version),
            "extras": about(animation, summary, &stage),
        },
        "scene": 0,
        "scenes": [{ "name": summary.scene, "nodes": roots }],
        "nodes": document.nodes,
        "meshes": document.meshes,
        "materials": document.materials,
        "cameras": document.cameras,
        "accessors": document.buffer.accessors,
        "bufferViews": document.buffer.views,
        "buffers": [{ "byteLength": document.buffer.bytes.len() }],
    });
    if !document.channels.is_empty() {
        json["animations"] = json!([{
            "name": "flight",
            "channels": document.channels,
            "samplers": document.samplers,
            "extras": { "events": events(animation) },
        }]);
    }
    let text = json.to_string().into_bytes();
    buffer::binary_file(text, &document.buffer.bytes).ok_or(ExportError::TooLarge)
}

/// What a reader has to know.
fn about(animation: &Animation, summary: &Summary, stage: &Stage) -> Value {
    json!({
        "scene": summary.scene,
        "version": summary.version,
        "seed": summary.seed,
        "start_s": animation.times_s.first(),
        "origin_m": stage.origin_m.to_array(),
        "axes": "the run's (x, y, z), x downwind, y left, z up, less origin_m, is (-y, z, -x) here, in metres",
        "tethers": "a segment is a cylinder whose y axis goes from its first point to its second, at least as \
                    thick as can be seen (shown_diameter_m); its colour is its largest tension of the flight",
        "greatest_tension_n": animation.tension_range_n().map(|(_, most)| most),
    })
}

fn events(animation: &Animation) -> Vec<Value> {
    let events = animation.events.iter();
    events
        .map(|(time_s, what)| json!({ "time_s": time_s, "what": what }))
        .collect()
}
