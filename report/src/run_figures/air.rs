//! The wind: what bodies feel of it, over altitude, and in itself.

use aerobot_components::fixed_wing::FixedWing;
use aerobot_engine::builtin::environment::environment_model;
use aerobot_systems::environment::gust::GustAxis;
use aerobot_systems::environment::gust::statistics::statistics;
use aerobot_systems::environment::wind::Wind;
use glam::DVec3;

use super::{instant_name, nothing};
use crate::figure::{Axis, Figure, Mark, Panel, Series};
use crate::record::Record;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Points of a profile.
const LEVELS: usize = 200;
/// Lags of an autocorrelation, and how many correlation times they reach.
const LAGS: usize = 60;
const REACH: f64 = 5.0;

fn wind(record: &Record) -> Result<Wind, String> {
    let model = environment_model(&record.scene);
    model
        .map(|model| model.wind)
        .map_err(|_| "the wind of the scene cannot be made".to_owned())
}

/// Speed and direction of the air relative to each body.
pub(super) fn relative_wind(record: &Record) -> Result<Figure, String> {
    let wind = wind(record)?;
    let mut panels: Vec<Panel> = ["speed", "x", "y", "z"]
        .iter()
        .map(|name| Panel {
            x: Axis::time(),
            y: Axis::new(format!("relative wind, {name} [m/s]")),
            ..Panel::default()
        })
        .collect();
    for (place, body) in record.tables.bodies().enumerate() {
        let entity = record.scene.entity(&body.name);
        let drone = entity.and_then(|entity| entity.get::<FixedWing>());
        let mut wind = wind.clone();
        let mut relative = Vec::with_capacity(body.times_s.len());
        for (index, time_s) in body.times_s.iter().enumerate() {
            wind.begin_interval(*time_s);
            wind.advance_gusts(*time_s);
            let Ok(air_m_s) = wind.velocity_m_s(body.positions_m[index].z) else {
                continue;
            };
            let air_m_s = drone.map_or(air_m_s, |drone| drone.wind.velocity_m_s(air_m_s));
            relative.push((*time_s, air_m_s - body.velocities_m_s[index]));
        }
        let lines: [Vec<(f64, f64)>; 4] = [
            relative.iter().map(|(t, v)| (*t, v.length())).collect(),
            relative.iter().map(|(t, v)| (*t, v.x)).collect(),
            relative.iter().map(|(t, v)| (*t, v.y)).collect(),
            relative.iter().map(|(t, v)| (*t, v.z)).collect(),
        ];
        for (panel, line) in panels.iter_mut().zip(lines) {
            panel
                .series
                .push(Series::line(&body.name, line).with_tone(place));
        }
    }
    let all = panels
        .iter()
        .flat_map(|panel| &panel.series)
        .flat_map(|series| &series.y);
    if all.clone().all(|speed| *speed == 0.0) {
        return nothing("nothing moves through the air");
    }
    Ok(Figure {
        title: "Relative wind at the bodies".to_owned(),
        caption: "Velocity of the air less that of the body; the wind is drawn again from the scene and its seed."
            .to_owned(),
        panels,
        ..Figure::default()
    })
}

/// The wind over the altitudes of the run, at its start and at its end.
pub(super) fn wind_profile(record: &Record) -> Result<Figure, String> {
    let wind = wind(record)?;
    let places = record
        .tables
        .states
        .iter()
        .flat_map(|track| &track.positions_m);
    let (low, high) = places
        .map(|at| at.z)
        .fold((f64::MAX, f64::MIN), |(low, high), z| {
            (low.min(z), high.max(z))
        });
    let Some(span) = record.tables.span_s().filter(|_| low <= high) else {
        return nothing("nothing was recorded");
    };
    let room_m = (0.2 * (high - low)).max(100.0);
    let (low, high) = (low - room_m, high + room_m);
    let mut series = Vec::new();
    for (index, time_s) in [span.start, span.end].into_iter().enumerate() {
        let mut wind = wind.clone();
        wind.begin_interval(time_s);
        wind.advance_gusts(time_s);
        let levels = (0..=LEVELS).map(|level| low + (high - low) * level as f64 / LEVELS as f64);
        let profile: Vec<(f64, DVec3)> = levels
            .filter_map(|altitude_m| Some((altitude_m, wind.velocity_m_s(altitude_m).ok()?)))
            .collect();
        for (axis, name) in AXES.iter().enumerate() {
            let points = profile.iter().map(|(altitude_m, v)| (v[axis], *altitude_m));
            let name = format!("{name} at {}", instant_name(time_s));
            series.push(Series::line(name, points).with_tone(3 * index + axis));
        }
    }
    if series
        .iter()
        .flat_map(|series| &series.x)
        .all(|speed| *speed == 0.0)
    {
        return nothing("the air is still at the start and at the end");
    }
    Ok(Figure {
        title: "Wind over altitude".to_owned(),
        panels: vec![Panel {
            x: Axis::new("velocity of the air [m/s]"),
            y: Axis::new("altitude [m]"),
            series,
            ..Panel::default()
        }],
        ..Figure::default()
    })
}

/// Autocorrelation of every gust of the run, with what theory says and how far off one record may be.
pub(super) fn wind_acf(record: &Record) -> Result<Figure, String> {
    let wind = wind(record)?;
    let duration_s = record.scene.run.duration_s;
    let panels: Vec<Panel> = wind
        .gusts()
        .filter_map(|gust| acf(gust, record.scene.run.seed, duration_s))
        .collect();
    if panels.is_empty() {
        return nothing(
            "the scene has no stochastic gusts, or its run is too short for their lags",
        );
    }
    Ok(Figure {
        title: "Autocorrelation of the gusts".to_owned(),
        caption: "The band is two standard errors of one record of the run's length.".to_owned(),
        panels,
        ..Figure::default()
    })
}

fn acf(gust: &GustAxis, seed: u64, duration_s: f64) -> Option<Panel> {
    let design = gust.design();
    let reach_s = (REACH / design.parameters.process.decay_per_s).min(0.5 * duration_s);
    let lags_s: Vec<f64> = (1..=LAGS)
        .map(|lag| reach_s * lag as f64 / LAGS as f64)
        .collect();
    let found = statistics(design, seed, duration_s, &lags_s);
    let rows: Vec<(f64, f64, f64, f64)> = found
        .iter()
        .filter_map(|statistic| {
            let lag_s = statistic.name.strip_prefix("autocorrelation, ")?;
            let lag_s = lag_s.strip_suffix(" s")?.parse().ok()?;
            Some((lag_s, statistic.found, statistic.theory, statistic.error))
        })
        .collect();
    if rows.len() < 2 {
        return None;
    }
    let low = rows.iter().map(|row| (row.0, row.2 - 2.0 * row.3));
    let band = Series::line("two standard errors", low).with_mark(Mark::Band {
        to: rows.iter().map(|row| row.2 + 2.0 * row.3).collect(),
    });
    Some(Panel {
        title: format!("gust along {}", AXES[design.parameters.axis.min(2)]),
        x: Axis::new("lag [s]"),
        y: Axis::new("autocorrelation [1]"),
        series: vec![
            band.with_tone(2),
            Series::line("theory", rows.iter().map(|row| (row.0, row.2))).with_tone(0),
            Series::line("this run", rows.iter().map(|row| (row.0, row.1))).with_tone(1),
        ],
        ..Panel::default()
    })
}
