//! Figure 11 of the paper: swing and turn of the gondola, and their spectra with the modes.

use aerobot_engine::modes::Motion;
use aerobot_report::figure::{Axis, Figure, Label, Panel, Series};
use aerobot_report::spectrum::Spectrum;

use super::super::drawing::{degrees, over_time, panel};
use super::{MojaveStudy, OffsetResult};

pub(super) fn figures(found: &MojaveStudy) -> Vec<Figure> {
    vec![motion(found), spectra(found)]
}

fn name(offset_m: f64) -> String {
    format!("{offset_m} m off the axis")
}

fn motion(found: &MojaveStudy) -> Figure {
    let each = |rows: &dyn Fn(&OffsetResult) -> Vec<(f64, f64)>| {
        let results = found.offsets.iter().enumerate();
        let series = results.map(|(tone, result)| {
            Series::line(name(result.flown.offset_m), degrees(&rows(result))).with_tone(tone)
        });
        series.collect()
    };
    over_time(
        "mojave-motion",
        "Swing and turn of the gondola (figure 11)",
        "Off its axis, a swing turns the gondola; on it, not.",
        vec![
            panel("swing along x [deg]", each(&|result| result.flown.swing())),
            panel(
                "turn against the balloon [deg]",
                each(&|result| result.flown.turn()),
            ),
        ],
    )
}

fn spectra(found: &MojaveStudy) -> Figure {
    let each = |y: &str, of: &dyn Fn(&OffsetResult) -> &Spectrum, motion: Motion| {
        let results = found.offsets.iter().enumerate();
        let series: Vec<Series> = results
            .map(|(tone, result)| {
                let points = of(result).points();
                let points = points.map(|(hz, angle)| (hz, angle.to_degrees()));
                Series::line(name(result.flown.offset_m), points).with_tone(tone)
            })
            .collect();
        let highest = series
            .iter()
            .flat_map(|series| &series.y)
            .copied()
            .fold(0.0, f64::max);
        let mode = found
            .offsets
            .first()
            .and_then(|result| result.mode_hz(motion));
        Panel {
            x: Axis::new("frequency [Hz]"),
            y: Axis::new(y),
            series,
            labels: mode
                .map(|hz| Label {
                    x: hz,
                    y: highest,
                    text: format!("mode at {hz:.4} Hz"),
                })
                .into_iter()
                .collect(),
            ..Panel::default()
        }
    };
    Figure {
        name: "mojave-spectrum".to_owned(),
        title: "Spectra of swing and turn".to_owned(),
        caption: "Named is the mode that the linearised motion has on the axis.".to_owned(),
        panels: vec![
            each("swing amplitude [deg]", &|result| &result.swing, Motion::Y),
            each("turn amplitude [deg]", &|result| &result.turn, Motion::Yaw),
        ],
    }
}
