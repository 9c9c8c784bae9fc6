//! The 3-D view of runs as a part of a page: markup, and motion as data for `assets/view/*.js`.
//!
//! Arrays are base64 of little-endian numbers, a third longer than the numbers: times as `f64`, the rest as
//! `f32`, lengths from an origin near the first body, so that 10 km away they are good to half a millimetre.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use serde_json::{Value, json};

use super::json_in_html;
use crate::animation::{Animation, BodyMotion, TetherMotion};

/// Style of the view, for a `<style>` of the page.
pub const STYLE: &str = include_str!("../../assets/view/view.css");

/// Script of the view, for a `<script>` below [`view`]; it keeps its names to itself, but for
/// `window.aerobotView`. It tells the time that it shows by the event `aerobot:time` of the document, and
/// shows that of an event `aerobot:seek`, both with `detail.time_s`.
pub const SCRIPT: &str = concat!(
    "(() => {\n'use strict';\n",
    include_str!("../../assets/view/matrices.js"),
    include_str!("../../assets/view/colours.js"),
    include_str!("../../assets/view/data.js"),
    include_str!("../../assets/view/meshes.js"),
    include_str!("../../assets/view/shaders.js"),
    include_str!("../../assets/view/drawing.js"),
    include_str!("../../assets/view/camera.js"),
    include_str!("../../assets/view/looks.js"),
    include_str!("../../assets/view/cage.js"),
    include_str!("../../assets/view/scene.js"),
    include_str!("../../assets/view/overlay.js"),
    include_str!("../../assets/view/legend.js"),
    include_str!("../../assets/view/player.js"),
    include_str!("../../assets/view/controls.js"),
    include_str!("../../assets/view/main.js"),
    "})();\n",
);

const MARKUP: &str = include_str!("../../assets/view/view.html");

/// The view of runs, each with what it is called, drawn over each other: the first as it is, others
/// translucent and dashed.
#[must_use]
pub fn view(runs: &[(&str, &Animation)]) -> String {
    let origin_m = origin_m(runs);
    let runs: Vec<Value> = runs
        .iter()
        .map(|(name, animation)| run(name, animation, origin_m))
        .collect();
    let data = json!({"origin_m": origin_m.to_array(), "runs": runs});
    let data = json_in_html(&data);
    format!(
        "<section class=\"view\" aria-label=\"3-D view\">\n{MARKUP}<script type=\"application/json\" class=\"view-data\">{data}</script>\n</section>\n"
    )
}

/// Whole metres near the first body of the first run.
fn origin_m(runs: &[(&str, &Animation)]) -> DVec3 {
    let bodies = runs.iter().flat_map(|(_, animation)| &animation.bodies);
    let mut places = bodies.filter_map(|body| body.positions_m.first());
    places.next().copied().unwrap_or(DVec3::ZERO).round()
}

fn run(name: &str, animation: &Animation, origin_m: DVec3) -> Value {
    let bodies = animation.bodies.iter().map(|it| body(it, origin_m));
    let tethers = animation.tethers.iter().map(|it| tether(it, origin_m));
    let times = animation.times_s.iter().flat_map(|time| time.to_le_bytes());
    json!({
        "name": name,
        "times_s": STANDARD.encode(times.collect::<Vec<u8>>()),
        "bodies": bodies.collect::<Vec<_>>(),
        "tethers": tethers.collect::<Vec<_>>(),
        "events": animation.events,
    })
}

fn body(body: &BodyMotion, origin_m: DVec3) -> Value {
    json!({
        "name": body.name,
        "parts": body.parts,
        "positions_m": vectors(body.positions_m.iter().map(|at| *at - origin_m)),
        "attitudes": floats(body.attitudes.iter().flat_map(|attitude| attitude.to_array())),
        "wind_m_s": vectors(body.wind_m_s.iter().copied()),
    })
}

fn tether(tether: &TetherMotion, origin_m: DVec3) -> Value {
    let points = tether.points_m.iter().flatten().map(|at| *at - origin_m);
    let tensions = tether.tensions_n.iter().flatten();
    json!({
        "name": tether.name,
        "diameter_m": tether.diameter_m,
        "segments": tether.tensions_n.first().map_or(0, Vec::len),
        "points_m": vectors(points),
        "tensions_n": floats(tensions.map(|tension| tension.unwrap_or(f64::NAN))),
    })
}

fn vectors(vectors: impl Iterator<Item = DVec3>) -> String {
    floats(vectors.flat_map(|vector| vector.to_array()))
}

/// Base64 of the numbers as little-endian `f32`.
fn floats(numbers: impl Iterator<Item = f64>) -> String {
    let bytes: Vec<u8> = numbers
        .flat_map(|number| (number as f32).to_le_bytes())
        .collect();
    STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_body(name: &str, position_m: DVec3) -> Animation {
        Animation {
            times_s: vec![0.0],
            bodies: vec![BodyMotion {
                name: name.into(),
                parts: Vec::new(),
                positions_m: vec![position_m],
                attitudes: vec![glam::DQuat::IDENTITY],
                wind_m_s: vec![DVec3::ZERO],
            }],
            ..Animation::default()
        }
    }

    #[test]
    fn a_name_cannot_end_the_data() {
        let animation = one_body("</script><!--<img src=x>", DVec3::ZERO);
        let written = view(&[("<script>", &animation)]);
        assert_eq!(written.matches("</script").count(), 1);
        assert!(!written.contains("<img") && !written.contains("<!--"));
        assert!(!SCRIPT.contains("</script") && !STYLE.contains("</style"));
    }

    #[test]
    fn lengths_are_read_back_from_the_origin() {
        let place_m = DVec3::new(72_000.123, -3.25, 56_000.777);
        let written = view(&[("run", &one_body("body", place_m))]);
        let text = written.split("class=\"view-data\">").nth(1);
        let text = text.and_then(|text| text.split("</script>").next());
        let data: Value = serde_json::from_str(text.unwrap_or_default()).unwrap_or_default();
        let array = data["runs"][0]["bodies"][0]["positions_m"].as_str();
        let bytes = STANDARD.decode(array.unwrap_or_default());
        let bytes = bytes.unwrap_or_default();
        assert_eq!(bytes.len(), 12);
        for (k, number) in bytes.chunks(4).enumerate() {
            let number = f32::from_le_bytes([number[0], number[1], number[2], number[3]]);
            let origin_m = data["origin_m"][k].as_f64().unwrap_or(f64::NAN);
            assert!((f64::from(number) + origin_m - place_m[k]).abs() < 1e-6);
        }
    }
}
