//! Spectra of motions, with their peaks.

use super::motion::{unwound, yaw_pitch_roll};
use super::nothing;
use crate::figure::{Axis, Figure, Label, Panel, Series};
use crate::record::{Record, StateTrack};
use crate::spectrum::{Peak, Spectrum, amplitude_spectrum, peaks};

/// Peaks that are named in a panel, at most.
const NAMED: usize = 6;
/// Peaks of a body below this part of its largest are not named: a Hann window has side lobes.
const LEAST_PEAK: f64 = 0.03;
/// Amplitudes below this part of the panel's largest are drawn at it.
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
        caption: format!(
            "Amplitudes under a Hann window, the straight line through each record taken off, down to {LEAST:e} of \
             the largest. Named are the largest peaks of all bodies, placed between bins."
        ),
        panels,
        ..Figure::default()
    })
}

fn panel(record: &Record, label: &str, signal: fn(&StateTrack) -> Vec<f64>) -> Option<Panel> {
    let mut found: Vec<(usize, &StateTrack, Spectrum)> = Vec::new();
    for (place, body) in record.tables.bodies().enumerate() {
        if let Some(spectrum) = amplitude_spectrum(&body.times_s, &signal(body), 1) {
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
    let width_hz = found
        .iter()
        .filter_map(|(_, _, spectrum)| spectrum.frequencies_hz.get(1))
        .fold(0.0, |most: f64, width_hz| most.max(*width_hz));
    let all = found
        .iter()
        .flat_map(|(_, _, spectrum)| peaks(spectrum, LEAST_PEAK));
    let visible = all.filter(|peak| peak.amplitude > 2.0 * LEAST * largest);
    let series = found.iter().map(|(place, body, spectrum)| {
        let rows = spectrum
            .frequencies_hz
            .iter()
            .zip(&spectrum.amplitudes)
            .skip(1);
        let rows = rows.map(|(hz, amplitude)| (*hz, amplitude.max(LEAST * largest)));
        Series::line(&body.name, rows).with_tone(*place)
    });
    let room = (LEAST * largest, 10.0 * largest);
    Some(Panel {
        x: Axis::log("frequency [Hz]"),
        y: Axis {
            range: Some(room),
            ..Axis::log(label)
        },
        series: series.collect(),
        labels: names(visible.collect(), width_hz),
        ..Panel::default()
    })
}

/// Names of the largest peaks of all bodies; of those that a record cannot tell apart, of the largest.
fn names(mut peaks: Vec<Peak>, width_hz: f64) -> Vec<Label> {
    peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    let mut named: Vec<Peak> = Vec::new();
    for peak in peaks {
        let is_near =
            |other: &Peak| (other.frequency_hz - peak.frequency_hz).abs() < 2.0 * width_hz;
        if named.len() < NAMED && !named.iter().any(is_near) {
            named.push(peak);
        }
    }
    let name = |peak: Peak| Label {
        x: peak.frequency_hz,
        y: peak.amplitude,
        text: format!("{} Hz", told(peak.frequency_hz, width_hz)),
    };
    named.into_iter().map(name).collect()
}

/// A frequency with the digits that a record with lines so far apart can have: a tenth of a line.
fn told(frequency_hz: f64, width_hz: f64) -> String {
    let decimals = (1.0 - libm::log10(width_hz).floor()).clamp(0.0, 9.0) as usize;
    format!("{frequency_hz:.decimals$}")
}
