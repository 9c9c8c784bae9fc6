//! One run of a campaign.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::CampaignError;
use super::definition::Campaign;
use super::envelopes::EnvelopeSampler;
use super::metrics::Latch;
use super::preparation::SCENE_FILE;
use super::record::{Outcome, Record};
use crate::plugin::Simulator;
use crate::recording::frame::{Frame, ResultSink};
use crate::recording::summary::Summary;
use crate::run_folder::{Destination, FinishedRun, PreparedRun, RunError};
use crate::scene::{Scene, SceneError};

/// Latches metrics and envelopes as rows come.
struct RunSink {
    latches: Vec<Latch>,
    samplers: Vec<EnvelopeSampler>,
}

impl ResultSink for RunSink {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        self.latches.iter_mut().for_each(|latch| latch.take(frame));
        self.samplers
            .iter_mut()
            .for_each(|sampler| sampler.take(frame));
        Ok(())
    }
}

impl RunSink {
    fn new(campaign: &Campaign) -> Self {
        let specification = &campaign.specification;
        let metrics = specification.metrics.0.iter();
        let envelopes = specification.envelopes.0.iter();
        Self {
            latches: metrics.map(|(_, metric)| Latch::new(metric)).collect(),
            samplers: envelopes
                .map(|(_, envelope)| EnvelopeSampler::new(envelope))
                .collect(),
        }
    }

    fn into_record(self, index: u64, summary: &Summary) -> Record {
        let (latches, samplers) = (self.latches.iter(), self.samplers.into_iter());
        match &summary.stopped {
            None => Record {
                index,
                outcome: Outcome::Done,
                reason: String::new(),
                simulated_s: summary.simulated_s,
                metrics: latches.map(Latch::value).collect(),
                envelopes: samplers.map(EnvelopeSampler::into_values).collect(),
            },
            Some(stop) => {
                let entity = stop.entity.as_ref();
                let entity = entity.map_or_else(String::new, |entity| format!("`{entity}`: "));
                Record {
                    index,
                    outcome: Outcome::Stopped,
                    reason: format!("{entity}{}", stop.reason),
                    simulated_s: summary.simulated_s,
                    // A final value before the end would mean something else.
                    metrics: latches.map(|_| None).collect(),
                    envelopes: samplers.map(|_| Vec::new()).collect(),
                }
            }
        }
    }
}

impl Campaign {
    /// Does a run, by its index from 0. What goes wrong with it is in the record.
    #[must_use]
    pub fn run(&self, simulator: &Simulator, index: u64) -> Record {
        self.run_with(simulator, index, &self.plan.inputs(index).overrides())
    }

    /// Does a run with other overrides of the scene than its inputs.
    pub(crate) fn run_with(
        &self,
        simulator: &Simulator,
        index: u64,
        overrides: &[String],
    ) -> Record {
        let done = catch_unwind(AssertUnwindSafe(|| {
            let scene = self.scene_with(simulator, overrides)?;
            let mut simulation = simulator.build(&scene)?;
            let mut sink = RunSink::new(self);
            let summary = simulation.run(&mut sink, &mut |_| {});
            Ok(sink.into_record(index, &summary))
        }));
        match done {
            Ok(Ok(record)) => record,
            Ok(Err(error)) => self.not_run(index, Outcome::Refused, first_line(&error)),
            Err(panic) => self.not_run(index, Outcome::Stopped, words_of(panic.as_ref())),
        }
    }

    /// Repeats a run with everything that `aerobot run` writes; `progress` hears of every accepted step's time
    /// in s. The record has the same bits as that of the run itself.
    ///
    /// # Errors
    /// There is no such run, its scene is refused, or the folder exists.
    pub fn replay(
        &self,
        simulator: &Simulator,
        index: u64,
        destination: &Destination,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(FinishedRun, Record), CampaignError> {
        if index >= self.plan.runs {
            let last = self.plan.runs - 1;
            let message = format!("there is no run {index}: they are numbered from 0 to {last}");
            return Err(CampaignError::refused(message, ""));
        }
        let scene = self.scene(simulator, index)?;
        let simulation = simulator.build(&scene)?;
        let prepared =
            PreparedRun::new(simulation, &scene, destination).map_err(|error| match error {
                RunError::Scene(error) => error.into(),
                RunError::Exists(folder) => {
                    let message = format!("the output folder `{}` exists", folder.display());
                    CampaignError::refused(message, "name another with `--out`")
                }
                RunError::Io(path, error) => CampaignError::unwritten(&path, &error),
            })?;
        let mut sink = RunSink::new(self);
        let finished = prepared.run(&mut sink, progress);
        let record = sink.into_record(index, &finished.summary);
        Ok((finished, record))
    }

    /// The scene of a run.
    ///
    /// # Errors
    /// What the scene refuses of its inputs, rendered.
    pub fn scene(&self, simulator: &Simulator, index: u64) -> Result<Scene, SceneError> {
        let inputs = self.plan.inputs(index);
        if let (true, Ok(seed)) = (inputs.fields.is_empty(), inputs.seed.parse()) {
            let common = self
                .common_scene
                .get_or_init(|| self.scene_with(simulator, &[]));
            let mut scene = common.clone()?;
            scene.run.seed = seed;
            return Ok(scene);
        }
        self.scene_with(simulator, &inputs.overrides())
    }

    /// What all runs have in common, with overrides.
    ///
    /// # Errors
    /// What the scene refuses of them, rendered.
    pub(crate) fn scene_with(
        &self,
        simulator: &Simulator,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        let (text, folder) = (self.scene_text.clone(), self.input_folder());
        simulator.load_text(SCENE_FILE, text, &folder, overrides)
    }

    fn not_run(&self, index: u64, outcome: Outcome, reason: String) -> Record {
        Record {
            index,
            outcome,
            reason,
            simulated_s: 0.0,
            metrics: vec![None; self.specification.metrics.0.len()],
            envelopes: vec![Vec::new(); self.specification.envelopes.0.len()],
        }
    }
}

pub(crate) fn first_line(error: &SceneError) -> String {
    let first = error.text.lines().next().unwrap_or_default();
    first.strip_prefix("error: ").unwrap_or(first).to_owned()
}

fn words_of(panic: &(dyn Any + Send)) -> String {
    let words = panic
        .downcast_ref::<&str>()
        .map(|words| (*words).to_owned());
    let words = words.or_else(|| panic.downcast_ref::<String>().cloned());
    format!("the program failed: {}", words.unwrap_or_default())
}
