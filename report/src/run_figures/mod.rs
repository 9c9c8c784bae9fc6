//! The figures of a run. Of two runs, one figure has the lines of both.

mod air;
mod balance;
mod channels;
mod modes;
mod motion;
mod overlay;
mod shape;
mod spectrum;
mod tension;
mod unit;

use aerobot_engine::plugin::Simulator;

use crate::figure::Figure;
use crate::record::Record;

pub use overlay::overlay;

/// What a figure shows of a run.
#[derive(Clone, Copy)]
pub struct RunFigureKind {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows, in a few words.
    pub about: &'static str,
    /// Makes it, or says why there is nothing to show.
    make: fn(&Simulator, &Record) -> Result<Figure, String>,
    /// Whether a report has it: what takes long it has not.
    pub in_report: bool,
}

/// All figures of a run, in the order of a report.
pub const KINDS: [RunFigureKind; 17] = [
    kind(
        "displacement",
        "how far each body is from where it started",
        |_, r| motion::displacement(r),
    ),
    kind(
        "attitude",
        "yaw, pitch and roll of each body in degrees",
        |_, r| motion::attitude(r),
    ),
    kind("altitude", "altitude of each body", |_, r| {
        motion::altitude(r)
    }),
    kind("path", "where each body went, seen from above", |_, r| {
        motion::path(r)
    }),
    kind(
        "tension",
        "tension at the top, at the bottom, and the largest of each tether",
        |_, r| tension::histories(r),
    ),
    kind(
        "tension-profile",
        "tension along each tether at some instants",
        |_, r| tension::profile(r),
    ),
    kind(
        "shape",
        "shapes of the tethers at some instants, with equal axes",
        |_, r| shape::shapes(r),
    ),
    kind(
        "relative-wind",
        "the air's velocity relative to each body",
        |_, r| air::relative_wind(r),
    ),
    kind(
        "commands",
        "what controllers and schedules ask, and what actuators do",
        |_, r| channels::commands(r),
    ),
    kind(
        "channels",
        "everything else that instruments recorded",
        |_, r| channels::others(r),
    ),
    kind(
        "energy",
        "energies, work, and what is left between them",
        |_, r| balance::energy(r),
    ),
    kind(
        "momentum",
        "momentum, impulse of the outer forces, and what is left between them",
        |_, r| balance::momentum(r),
    ),
    kind(
        "spectrum",
        "spectra of the bodies' motions with their peaks",
        |_, r| spectrum::spectrum(r),
    ),
    kind("wind-profile", "the wind over altitude", |_, r| {
        air::wind_profile(r)
    }),
    kind(
        "wind-acf",
        "autocorrelation of stochastic gusts beside the theory",
        |_, r| air::wind_acf(r),
    ),
    kind("docking", "the way of a drone to its port", |_, r| {
        motion::docking(r)
    }),
    RunFigureKind {
        in_report: false,
        ..kind(
            "modes",
            "frequencies and damping of small motions about the steady state",
            modes::modes,
        )
    },
];

/// Those that show bodies.
const OF_BODIES: [&str; 8] = [
    "displacement",
    "attitude",
    "altitude",
    "path",
    "shape",
    "relative-wind",
    "spectrum",
    "docking",
];

const fn kind(
    name: &'static str,
    about: &'static str,
    make: fn(&Simulator, &Record) -> Result<Figure, String>,
) -> RunFigureKind {
    RunFigureKind {
        name,
        about,
        make,
        in_report: true,
    }
}

impl RunFigureKind {
    /// The kind of a name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        KINDS.into_iter().find(|kind| kind.name == name)
    }

    /// The figure of one run, or of several with the lines of all.
    ///
    /// # Errors
    /// Why there is nothing to show, as a sentence; of several runs, if that is so of every one.
    pub fn figure(&self, simulator: &Simulator, records: &[&Record]) -> Result<Figure, String> {
        let mut found = Vec::new();
        let mut reason = None;
        for record in records {
            let is_there =
                !OF_BODIES.contains(&self.name) || record.tables.bodies().next().is_some();
            let made = match is_there {
                true => (self.make)(simulator, record),
                false => nothing("no body was recorded (`run.record.bodies`)"),
            };
            match made {
                Ok(figure) => found.push((record.label.as_str(), figure)),
                Err(why) => reason = Some(why),
            }
        }
        let mut figure = overlay(found, records.len() > 1)
            .ok_or_else(|| reason.unwrap_or_else(|| "there is no run".to_owned()))?;
        self.name.clone_into(&mut figure.name);
        Ok(figure)
    }
}

/// How many instants figures of instants show.
const INSTANTS: usize = 6;

/// Instants of a run, evenly apart, the first and the last among them, s.
fn instants_s(record: &Record) -> Vec<f64> {
    let Some(span) = record.tables.span_s() else {
        return Vec::new();
    };
    let step_s = (span.end - span.start) / (INSTANTS - 1) as f64;
    let instant = |index: usize| match index + 1 {
        INSTANTS => span.end,
        _ => span.start + index as f64 * step_s,
    };
    (0..INSTANTS).map(instant).collect()
}

/// The instant as a legend has it.
fn instant_name(time_s: f64) -> String {
    let text = format!("{time_s:.2}");
    format!("{} s", text.trim_end_matches('0').trim_end_matches('.'))
}

fn nothing<T>(what: &str) -> Result<T, String> {
    Err(what.to_owned())
}
