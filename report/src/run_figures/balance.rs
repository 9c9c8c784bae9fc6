//! Energy and momentum of the whole, and what is left between them and what came in.

use crate::figure::{Axis, Figure, Panel, Series};
use crate::record::{ChannelTrack, Record};

const SYSTEM: &str = "system";

fn channel<'a>(record: &'a Record, name: &str) -> Option<&'a ChannelTrack> {
    record.tables.channel(SYSTEM, name)
}

fn line(track: &ChannelTrack, name: &str) -> Series {
    let points = track
        .times_s
        .iter()
        .copied()
        .zip(track.values.iter().copied());
    Series::line(name, points)
}

/// What is left of `stock` less `flow` since the start.
fn left(stock: &ChannelTrack, flow: &ChannelTrack) -> Series {
    let start = stock
        .values
        .first()
        .zip(flow.values.first())
        .map_or(0.0, |(a, b)| a - b);
    let rows = stock.times_s.iter().zip(&stock.values).zip(&flow.values);
    Series::line(
        "left between them",
        rows.map(|((time_s, stock), flow)| (*time_s, stock - flow - start)),
    )
}

/// How a run comes to record them.
const HINT: &str = "was not recorded: `--set run.record.channels=All` records it";

/// Kinetic, potential and mechanical energy from the start, the work of everything else, and what is left.
pub(super) fn energy(record: &Record) -> Result<Figure, String> {
    let (Some(mechanical), Some(work)) = (
        channel(record, "mechanical_energy_j"),
        channel(record, "nonconservative_work_j"),
    ) else {
        return Err(format!("the energy of the whole {HINT}"));
    };
    let from_start = |name: &str, words: &str| {
        let track = channel(record, name)?;
        let start = *track.values.first()?;
        let mut series = line(track, words);
        series.y.iter_mut().for_each(|value| *value -= start);
        Some(series)
    };
    let stocks = [
        from_start("kinetic_energy_j", "kinetic"),
        from_start("potential_energy_j", "potential, elastic with it"),
        from_start("mechanical_energy_j", "mechanical"),
        Some(line(work, "work of other forces")),
    ];
    let stocks = stocks.into_iter().flatten().enumerate();
    Ok(Figure {
        title: "Energy".to_owned(),
        caption: "From the start. What is left between mechanical energy and work is the error of the integration."
            .to_owned(),
        panels: vec![
            Panel {
                x: Axis::time(),
                y: Axis::new("energy from the start [J]"),
                series: stocks.map(|(tone, series)| series.with_tone(tone)).collect(),
                ..Panel::default()
            },
            Panel {
                x: Axis::time(),
                y: Axis::new("left [J]"),
                series: vec![left(mechanical, work).with_tone(4)],
                ..Panel::default()
            },
        ],
        ..Figure::default()
    })
}

/// Momentum from the start along each axis, the impulse of the outer forces, and what is left.
pub(super) fn momentum(record: &Record) -> Result<Figure, String> {
    let mut panels = Vec::new();
    let mut rest = Panel {
        x: Axis::time(),
        y: Axis::new("left [kg m/s]"),
        ..Panel::default()
    };
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let (Some(momentum), Some(impulse)) = (
            channel(record, &format!("momentum_{name}_kg_m_s")),
            channel(record, &format!("impulse_{name}_n_s")),
        ) else {
            return Err(format!("the momentum of the whole {HINT}"));
        };
        let start = momentum.values.first().copied().unwrap_or_default();
        let mut gained = line(momentum, "momentum from the start");
        gained.y.iter_mut().for_each(|value| *value -= start);
        panels.push(Panel {
            x: Axis::time(),
            y: Axis::new(format!("along {name} [kg m/s]")),
            series: vec![
                gained.with_tone(0),
                line(impulse, "impulse of the outer forces").with_tone(1),
            ],
            ..Panel::default()
        });
        let mut remainder = left(momentum, impulse).with_tone(axis + 2);
        remainder.name = format!("left along {name}");
        rest.series.push(remainder);
    }
    panels.push(rest);
    Ok(Figure {
        title: "Momentum".to_owned(),
        panels,
        ..Figure::default()
    })
}
