//! Modes of small motions about the steady state of the run's scene.

use aerobot_engine::modes::ModesRequest;
use aerobot_engine::plugin::Simulator;

use super::nothing;
use crate::figure::{Axis, Figure, Label, Mark, Panel, Series};
use crate::record::Record;

/// Modes that are named.
const NAMED: usize = 8;

/// Frequency and damping ratio of every mode that oscillates.
pub(super) fn modes(simulator: &Simulator, record: &Record) -> Result<Figure, String> {
    let first_line = |error: aerobot_engine::scene::SceneError| {
        let text = error.to_string();
        let first = text.lines().next().unwrap_or_default();
        first.trim_start_matches("error: ").to_owned()
    };
    let mut simulation = simulator.build(&record.scene).map_err(first_line)?;
    let found = simulation
        .modes(&record.scene, &ModesRequest::default())
        .map_err(first_line)?;
    let oscillating: Vec<_> = found
        .modes
        .iter()
        .filter(|mode| mode.oscillates())
        .collect();
    if oscillating.is_empty() {
        return nothing("no mode oscillates");
    }
    let place = |mode: &aerobot_engine::modes::Mode| (mode.frequency_hz(), mode.damping_ratio());
    let (stable, unstable): (Vec<_>, Vec<_>) = oscillating
        .iter()
        .copied()
        .partition(|mode| !mode.is_unstable());
    let series = [("decays", stable), ("grows", unstable)]
        .into_iter()
        .enumerate();
    let series = series.map(|(tone, (name, modes))| {
        let points = modes.iter().map(|mode| place(mode));
        Series::line(name, points)
            .with_mark(Mark::Points)
            .with_tone(tone)
    });
    let labels = oscillating.iter().take(NAMED).map(|mode| Label {
        x: place(mode).0,
        y: place(mode).1,
        text: mode.name.clone(),
    });
    Ok(Figure {
        title: "Modes of small motions".to_owned(),
        caption: "About the steady state; the slowest are named.".to_owned(),
        panels: vec![Panel {
            x: Axis::log("frequency [Hz]"),
            y: Axis::new("damping ratio [1]"),
            series: series.filter(|series| !series.x.is_empty()).collect(),
            labels: labels.collect(),
            ..Panel::default()
        }],
        ..Figure::default()
    })
}
