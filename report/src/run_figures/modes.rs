//! Modes of small motions about the steady state of the run's scene.

use aerobot_engine::modes::{Mode, ModesRequest};
use aerobot_engine::plugin::Simulator;

use super::nothing;
use crate::figure::{Axis, Figure, Mark, Panel, Series};
use crate::record::Record;

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
    // The slowest at the top.
    let count = oscillating.len();
    let row = |index: usize| (count - 1 - index) as f64;
    let names = Axis {
        names: oscillating
            .iter()
            .rev()
            .map(|mode| mode.name.clone())
            .collect(),
        ..Axis::new("")
    };
    let panel = |x: Axis, value: &dyn Fn(&Mode) -> f64| {
        let series = [("decays", false), ("grows", true)].into_iter().enumerate();
        let series = series.map(|(tone, (name, grows))| {
            let chosen = oscillating.iter().enumerate();
            let chosen = chosen.filter(|(_, mode)| mode.is_unstable() == grows);
            let points = chosen.map(|(index, mode)| (value(mode), row(index)));
            Series::line(name, points)
                .with_mark(Mark::Points)
                .with_tone(tone)
        });
        Panel {
            x,
            y: names.clone(),
            series: series.filter(|series| !series.x.is_empty()).collect(),
            ..Panel::default()
        }
    };
    Ok(Figure {
        title: "Modes of small motions".to_owned(),
        caption: "About the steady state, the slowest first.".to_owned(),
        panels: vec![
            panel(Axis::log("frequency [Hz]"), &Mode::frequency_hz),
            panel(Axis::new("damping ratio [1]"), &Mode::damping_ratio),
        ],
        ..Figure::default()
    })
}
