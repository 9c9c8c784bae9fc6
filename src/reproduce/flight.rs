//! One run of a scene in a case: all that was recorded, and how it ended.

use std::path::Path;

use aerobot_components::run::Formulation;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::{Frame, MemorySink};
use aerobot_engine::scene::{Scene, SceneError};
use glam::DVec3;

use super::check::largest;

/// A scene of the paper that is part of the program.
#[derive(Clone, Copy, Debug)]
pub(super) struct PaperScene {
    /// What messages call it.
    pub(super) name: &'static str,
    /// Its text.
    pub(super) text: &'static str,
}

impl PaperScene {
    /// The scene with fields set as `PATH=RON`.
    pub(super) fn load(
        self,
        simulator: &Simulator,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        simulator.load_text(self.name, self.text.to_owned(), Path::new("."), overrides)
    }
}

/// The field that chooses a formulation, as `PATH=RON`.
pub(super) fn formulation_override(formulation: Formulation) -> String {
    let name = match formulation {
        Formulation::LumpedMass => "LumpedMass",
        Formulation::Denoc => "Denoc",
    };
    format!("run.formulation={name}")
}

/// What was flown.
#[derive(Clone, Debug)]
pub struct Flight {
    /// The formulation.
    pub formulation: Formulation,
    /// The integrator with its settings.
    pub integrator: String,
    /// Everything that was recorded.
    pub results: MemorySink,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// Events: time (s), entity and kind.
    pub events: Vec<(f64, String, String)>,
    /// Why it stopped before its end, if it did.
    pub stopped: Option<String>,
}

impl Flight {
    /// Flies a scene; `progress` hears of the part of it that is done.
    ///
    /// # Errors
    /// A scene that cannot be built.
    pub fn of(
        simulator: &Simulator,
        scene: &Scene,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, SceneError> {
        let mut simulation = simulator.build(scene)?;
        let mut results = MemorySink::default();
        let duration_s = scene.run.duration_s;
        let summary = simulation.run(&mut results, &mut |time_s| progress(time_s / duration_s));
        let events = summary.events.into_iter();
        Ok(Self {
            formulation: scene.run.formulation,
            integrator: summary.integrator,
            results,
            simulated_s: summary.simulated_s,
            events: events
                .map(|event| (event.time_s, event.entity, event.kind))
                .collect(),
            stopped: summary.stopped.map(|stop| stop.reason),
        })
    }

    /// Position of an entity less that at the start, at every output: time (s) and m.
    #[must_use]
    pub fn displacements(&self, entity: &str) -> Vec<(f64, DVec3)> {
        let positions = self.results.positions(entity);
        let start = positions.first().map_or(DVec3::ZERO, |(_, at)| *at);
        let moved = |(time_s, at): (f64, DVec3)| (time_s, at - start);
        positions.into_iter().map(moved).collect()
    }

    /// Position of an entity at the start, m.
    #[must_use]
    pub fn start(&self, entity: &str) -> Option<DVec3> {
        Some(self.results.states(entity).next()?.1.position_m)
    }

    /// What was recorded at a time that is one of an output, s.
    #[must_use]
    pub fn frame(&self, time_s: f64) -> Option<&Frame> {
        let frames = &self.results.frames;
        frames
            .iter()
            .find(|frame| (frame.time_s - time_s).abs() < 1e-9)
    }

    /// The first value of a channel.
    #[must_use]
    pub fn first(&self, entity: &str, channel: &str) -> Option<f64> {
        let rows = &self.results.frames.first()?.channels;
        let mut own = rows.iter().filter(|row| &*row.entity == entity);
        Some(own.find(|row| row.channel == channel)?.value)
    }

    /// Largest size of a channel until a time, s; none if it was not recorded.
    #[must_use]
    pub fn largest(&self, entity: &str, channel: &str, until_s: f64) -> Option<f64> {
        let rows = self.results.channel(entity, channel);
        let sizes: Vec<f64> = rows
            .into_iter()
            .filter(|(time_s, _)| *time_s <= until_s)
            .map(|(_, value)| value.abs())
            .collect();
        (!sizes.is_empty()).then(|| largest(sizes))
    }

    /// The sentence for [`super::Report::stopped`].
    pub(super) fn stop_of(&self, what: &str) -> Option<String> {
        let reason = self.stopped.as_ref()?;
        Some(format!(
            "{what} stopped at {} s: {reason}",
            self.simulated_s
        ))
    }
}

/// Largest difference between two flights of one entity's displacement from its start, on any axis, m; not a
/// number if they have not the same outputs.
#[must_use]
pub fn largest_difference_m(first: &Flight, second: &Flight, entity: &str) -> f64 {
    let (a, b) = (first.displacements(entity), second.displacements(entity));
    if a.len() != b.len() || a.is_empty() {
        return f64::NAN;
    }
    let pairs = a.iter().zip(&b);
    largest(pairs.map(|((_, a), (_, b))| (*a - *b).abs().max_element()))
}

/// Adds a line of a CSV table.
pub(super) fn row(text: &mut String, fields: &[String]) {
    text.push_str(&fields.join(","));
    text.push('\n');
}

/// The three numbers of a vector as fields of a table.
pub(super) fn fields(vector: DVec3) -> [String; 3] {
    vector
        .to_array()
        .map(aerobot_engine::recording::number::number_text)
}
