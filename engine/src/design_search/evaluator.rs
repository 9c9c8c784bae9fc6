//! Evaluates designs, each once, with what the journal has of them.

use std::collections::{BTreeMap, BTreeSet};

use super::definition::DesignSearch;
use super::design::Design;
use super::evaluation::{Evaluation, judge};
use super::journal::{RunRecords, line, open_search_journal};
use crate::campaign::CampaignError;
use crate::campaign::line_journal::LineJournal;
use crate::campaign::record::Record;
use crate::campaign::worker_pool::do_all;
use crate::plugin::Simulator;

/// How far a search is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Designs that are evaluated.
    pub evaluations: u64,
    /// The most that may be.
    pub most: u64,
    /// Runs that were done now, not found in the journal.
    pub new_runs: u64,
    /// The best objective so far, in its unit; none if no design was feasible.
    pub best: Option<f64>,
}

/// Evaluates designs in the order in which they are asked for.
pub(super) struct Evaluator<'a> {
    pub(super) search: &'a DesignSearch,
    simulator: &'a Simulator,
    workers: usize,
    most: u64,
    journal: LineJournal,
    records: RunRecords,
    /// All evaluations in their order.
    pub(super) evaluations: Vec<Evaluation>,
    /// Their places by the keys of their designs.
    places: BTreeMap<String, usize>,
    new_runs: u64,
    best_objective: Option<f64>,
    progress: &'a mut dyn FnMut(Progress),
}

impl<'a> Evaluator<'a> {
    /// With the journal of the search; at most `most` designs are evaluated.
    pub(super) fn new(
        simulator: &'a Simulator,
        search: &'a DesignSearch,
        (workers, most): (usize, u64),
        progress: &'a mut dyn FnMut(Progress),
    ) -> Result<Self, CampaignError> {
        let (journal, records) = open_search_journal(search)?;
        Ok(Self {
            search,
            simulator,
            workers,
            most,
            journal,
            records,
            evaluations: Vec::new(),
            places: BTreeMap::new(),
            new_runs: 0,
            best_objective: None,
            progress,
        })
    }

    /// The place of each design among the evaluations; `None` where there may be no more of them.
    pub(super) fn evaluate(
        &mut self,
        stage: &'static str,
        designs: &[Design],
    ) -> Result<Vec<Option<usize>>, CampaignError> {
        let mut asked = BTreeSet::new();
        let mut new: Vec<(String, &Design)> = Vec::new();
        for design in designs {
            let key = design.key();
            let is_new = !self.places.contains_key(&key) && !asked.contains(&key);
            if is_new && ((self.evaluations.len() + new.len()) as u64) < self.most {
                asked.insert(key.clone());
                new.push((key, design));
            }
        }
        self.run(&new)?;
        for (key, design) in new {
            let index = self.evaluations.len();
            let found = self.judge(&key, design);
            self.places.insert(key, index);
            self.evaluations.push(Evaluation {
                index: index as u64,
                stage,
                design: design.clone(),
                found,
            });
        }
        let best = self.best().and_then(|place| self.evaluations.get(place));
        let best = best.and_then(|best| best.found.as_ref().ok());
        self.best_objective = best.map(|found| found.objective);
        let progress = self.how_far();
        (self.progress)(progress);
        let places = designs
            .iter()
            .map(|design| self.places.get(&design.key()).copied());
        Ok(places.collect())
    }

    /// Does the runs of designs that the journal does not have.
    fn run(&mut self, designs: &[(String, &Design)]) -> Result<(), CampaignError> {
        let runs = self.search.runs_of_design();
        let mut missing: Vec<(&String, &Design, u64)> = Vec::new();
        for (key, design) in designs {
            let absent = (0..runs).filter(|run| !self.records.contains_key(&(key.clone(), *run)));
            missing.extend(absent.map(|run| (key, *design, run)));
        }
        let mut progress = self.how_far();
        let (search, simulator) = (self.search, self.simulator);
        let job = |number: u64| {
            let (_, design, run) = missing[number as usize];
            (number, search.run(simulator, design, run))
        };
        do_all(
            0..missing.len() as u64,
            self.workers,
            job,
            |(number, record): (u64, Record)| -> Result<(), CampaignError> {
                let (key, _, run) = missing[number as usize];
                self.journal.add(&line(key, &record))?;
                self.records.insert((key.clone(), run), record);
                self.new_runs += 1;
                progress.new_runs = self.new_runs;
                (self.progress)(progress);
                Ok(())
            },
        )
    }

    fn judge(&self, key: &str, design: &Design) -> Result<super::evaluation::Found, String> {
        let specification = &self.search.specification;
        let needs_scene = specification
            .measures()
            .any(|(_, measure)| measure.needs_scene());
        let scene = needs_scene.then(|| self.search.scene(self.simulator, design));
        let runs = (0..self.search.runs_of_design())
            .filter_map(|run| self.records.get(&(key.to_owned(), run)));
        judge(specification, design, scene, &runs.collect::<Vec<_>>())
    }

    fn how_far(&self) -> Progress {
        Progress {
            evaluations: self.evaluations.len() as u64,
            most: self.most,
            new_runs: self.new_runs,
            best: self.best_objective,
        }
    }

    /// The place of the best feasible design; the first of equals.
    pub(super) fn best(&self) -> Option<usize> {
        let search = &self.search.specification;
        let merits = self.evaluations.iter().enumerate();
        let merits = merits.filter_map(|(place, of)| Some((of.merit(search)?, place)));
        let best = merits.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        best.map(|(_, place)| place)
    }

    /// Hands the journal to the disk, and gives the evaluations.
    pub(super) fn finish(self) -> Result<Vec<Evaluation>, CampaignError> {
        self.journal.synchronise()?;
        Ok(self.evaluations)
    }
}
