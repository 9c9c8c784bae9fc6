//! Spectra of motions, with their peaks.

use super::motion::{unwound, yaw_pitch_roll};
use super::nothing;
use crate::figure::{Axis, Figure, Label, Panel, Series};
use crate::record::{Record, StateTrack};
use crate::spectrum::{Spectrum, amplitude_spectrum, peaks};

/// Peaks that are named in a panel.
const NAMED: usize = 4;
/// Amplitudes below this part of the largest are not looked at.
const LEAST: f64 = 1e-5;

/// Amplitude spectra of the displacements and of the yaw of every body.
pub(super) fn spectrum(record: &Record) -> Result<Figure, String> {
    type Signal = fn(&StateTrack) -> Vec<f64>;
    let signals: [(&str, Signal); 4] = [
        ("x amplitude [m]", |body| {
            body.positions_m.iter().map(|at| at.x).collect()
        }),
        ("y amplitude [m]", |body| {
            body.positions_m.iter().map(|at| at.y).collect()
        }),
        ("z amplitude [m]", |body| {
            body.positions_m.iter().map(|at| at.z).collect()
        }),
        ("yaw amplitude [deg]", |body| {
            let yaws = body
                .rotations
                .iter()
                .map(|(attitude, _)| yaw_pitch_roll(*attitude)[0]);
            unwound(yaws).into_iter().map(f64::to_degrees).collect()
        }),
    ];
    let panels: Vec<Panel> = signals
        .iter()
        .filter_map(|(label, signal)| panel(record, label, *signal))
        .collect();
    if panels.is_empty() {
        return nothing("no body moves, or too few rows were recorded at even times");
    }
    Ok(Figure {
        title: "Spectra of the motions".to_owned(),
        caption: "Amplitudes under a Hann window, the straight line through each record taken off; named are the \
                  largest peaks, placed between bins."
            .to_owned(),
        panels,
        ..Figure::default()
    })
}

fn panel(record: &Record, label: &str, signal: fn(&StateTrack) -> Vec<f64>) -> Option<Panel> {
    let mut found: Vec<(usize, &StateTrack, Spectrum)> = Vec::new();
    for (place, body) in record.tables.bodies().enumerate() {
        if let Some(spectrum) = amplitude_spectrum(&body.times_s, &signal(body)) {
            found.push((place, body, spectrum));
        }
    }
    let largest = found
        .iter()
        .flat_map(|(_, _, spectrum)| &spectrum.amplitudes)
        .fold(0.0, |most: f64, amplitude| most.max(*amplitude));
    if largest < 1e-9 {
        return None;
    }
    let mut labels: Vec<Label> = Vec::new();
    let strongest = found
        .iter()
        .max_by(|a, b| a.2.largest().total_cmp(&b.2.largest()))?;
    for peak in peaks(&strongest.2).into_iter().take(NAMED) {
        labels.push(Label {
            x: peak.frequency_hz,
            y: peak.amplitude,
            text: format!("{} Hz", significant(peak.frequency_hz)),
        });
    }
    let series = found.iter().map(|(place, body, spectrum)| {
        let rows = spectrum
            .frequencies_hz
            .iter()
            .zip(&spectrum.amplitudes)
            .skip(1);
        let rows = rows.map(|(hz, amplitude)| (*hz, amplitude.max(LEAST * largest)));
        Series::line(&body.name, rows).with_tone(*place)
    });
    Some(Panel {
        x: Axis::log("frequency [Hz]"),
        y: Axis::log(label),
        series: series.collect(),
        labels,
        ..Panel::default()
    })
}

/// Three significant digits.
fn significant(value: f64) -> String {
    let decimals = (2.0 - libm::log10(value.abs()).floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}
