//! The search: a sample of the whole box, local searches from its best designs side by side, and what they leave.
//!
//! All of it follows from the file: local searches go in step, each asks for one design, and all of these are
//! evaluated before any goes on. What is promised of the result: it was evaluated, it keeps to every constraint as
//! evaluated, and no better design was. That it is the best of all is promised only of one variable along which the
//! objective only rises or only falls, with one place where the constraints change between kept and broken, once a
//! design of either side was evaluated: it is then within the tolerance of that place.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

use crossbeam_channel::{Receiver, Sender, bounded};

use super::definition::DesignSearch;
use super::design::Design;
use super::evaluation::Evaluation;
use super::evaluator::{Evaluator, Progress};
use super::local_search::{Reach, Told, go_down};
use super::scales::Scales;
use super::specification::SearchSpec;
use crate::campaign::CampaignError;
use crate::campaign::sobol::Sobol;
use crate::plugin::Simulator;

/// How the work is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchWork {
    /// Number of threads.
    pub workers: usize,
    /// The most designs that are evaluated, if not that of the file.
    pub evaluations: Option<u64>,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchOutcome {
    /// All evaluations, in the order of the search.
    pub evaluations: Vec<Evaluation>,
    /// The place of the best feasible design among them.
    pub best: Option<usize>,
    /// The place of the design that is least infeasible, where none is feasible and not all failed.
    pub least_infeasible: Option<usize>,
    /// Whether it came to its end before the most evaluations.
    pub is_complete: bool,
}

/// Searches from the beginning; runs that the journal has are not done again.
///
/// # Errors
/// The journal cannot be written, or another process is at it.
pub fn search_designs(
    simulator: &Simulator,
    search: &DesignSearch,
    work: SearchWork,
    progress: &mut dyn FnMut(Progress),
) -> Result<SearchOutcome, CampaignError> {
    let most = work.evaluations;
    let most = most.unwrap_or(search.specification.search.evaluations);
    let limits = (work.workers, most);
    let mut evaluator = Evaluator::new(simulator, search, limits, progress)?;
    let is_complete = all_stages(&mut evaluator)?;
    let best = evaluator.best();
    let scales = Scales::of(&search.specification, &evaluator.evaluations);
    let least_infeasible = match best {
        Some(_) => None,
        None => scales.least_infeasible(&search.specification, &evaluator.evaluations),
    };
    Ok(SearchOutcome {
        evaluations: evaluator.finish()?,
        best,
        least_infeasible,
        is_complete,
    })
}

/// Whether it came to its end before the most evaluations.
fn all_stages(evaluator: &mut Evaluator<'_>) -> Result<bool, CampaignError> {
    let specification = &evaluator.search.specification;
    let sample = sample(specification);
    if !is_all(&evaluator.evaluate("sample", &sample)?) {
        return Ok(false);
    }
    let scales = Scales::of(specification, &evaluator.evaluations);
    let radius = radius(specification, sample.len());
    let starts = starts(specification, &scales, &evaluator.evaluations, radius);
    Ok(go_side_by_side(evaluator, &scales, &starts, radius)?
        && close_in(evaluator)?
        && step_integers(evaluator)?)
}

fn is_all(places: &[Option<usize>]) -> bool {
    places.iter().all(Option::is_some)
}

/// The start of the file, if it has one, and points of Sobol's sequence.
fn sample(specification: &SearchSpec) -> Vec<Design> {
    let variables = &specification.variables.0;
    let count = specification.search.sample_of(variables.len());
    let sobol = Sobol::new(specification.seed, variables.len());
    let start: Option<Vec<f64>> = variables
        .iter()
        .map(|(_, variable)| Some(variable.part(variable.start?)))
        .collect();
    let points = (0..count).map(|point| {
        let parts = (0..variables.len()).map(|field| sobol.coordinate(point, field));
        parts.collect::<Vec<f64>>()
    });
    let places = start.into_iter().chain(points).take(count as usize);
    places
        .map(|place| Design::at(specification, &place))
        .collect()
}

/// About half of the way between neighbours in the sample.
fn radius(specification: &SearchSpec, sample: usize) -> f64 {
    let sides = specification.variables.0.len() as f64;
    let half_way = 0.5 * libm::pow(sample.max(1) as f64, -1.0 / sides);
    half_way.clamp(0.02, 0.25)
}

/// The best designs of the sample that are no neighbours.
fn starts(
    specification: &SearchSpec,
    scales: &Scales,
    evaluations: &[Evaluation],
    radius: f64,
) -> Vec<Design> {
    let variables = specification.variables.0.len();
    let count = specification.search.starts_of(variables) as usize;
    let mut ranked: Vec<&Evaluation> = evaluations.iter().collect();
    ranked.sort_by(|a, b| {
        let rank = |of: &Evaluation| scales.rank(specification, of);
        let ((a_kind, a_value), (b_kind, b_value)) = (rank(a), rank(b));
        a_kind.cmp(&b_kind).then(a_value.total_cmp(&b_value))
    });
    let mut chosen: Vec<Design> = Vec::new();
    for evaluation in ranked {
        let far = |other: &Design| evaluation.design.distance(other) >= radius;
        if chosen.len() < count && chosen.iter().all(far) {
            chosen.push(evaluation.design.clone());
        }
    }
    chosen
}

/// A local search on its way.
struct Walker {
    asks: Receiver<Vec<f64>>,
    answers: Sender<Told>,
}

/// Local searches from all starts, each on a thread of its own that waits for answers. Whether all came to
/// their end.
fn go_side_by_side(
    evaluator: &mut Evaluator<'_>,
    scales: &Scales,
    starts: &[Design],
    radius: f64,
) -> Result<bool, CampaignError> {
    let specification = &evaluator.search.specification;
    let reach = |start: &Design| Reach {
        start: start.place.clone(),
        radius: first_changes(specification, radius),
        tolerance: specification.search.tolerance,
        margins: scales.margins(specification),
        most: specification.search.evaluations as usize,
    };
    thread::scope(|scope| {
        let mut walkers: Vec<Walker> = Vec::new();
        for start in starts {
            let (ask, asks) = bounded::<Vec<f64>>(0);
            let (answers, answer) = bounded::<Told>(1);
            let reach = reach(start);
            scope.spawn(move || {
                let mut asked = |place: &[f64]| {
                    ask.send(place.to_vec())
                        .ok()
                        .and_then(|()| answer.recv().ok())
                };
                // A search that fails has ended; what it asked for is kept.
                let _ = catch_unwind(AssertUnwindSafe(|| go_down(&reach, &mut asked)));
            });
            walkers.push(Walker { asks, answers });
        }
        while !walkers.is_empty() {
            let mut designs = Vec::new();
            walkers.retain(|walker| match walker.asks.recv() {
                Ok(place) => {
                    designs.push(Design::at(specification, &place));
                    true
                }
                Err(_) => false,
            });
            let places = evaluator.evaluate("local", &designs)?;
            if !is_all(&places) {
                return Ok(false);
            }
            for (walker, place) in walkers.iter().zip(places.into_iter().flatten()) {
                let told = scales.told(specification, &evaluator.evaluations, place);
                // One that is gone is missed in the next round.
                let _ = walker.answers.send(told);
            }
        }
        Ok(true)
    })
}

/// A whole number has to be reached by the first change.
fn first_changes(specification: &SearchSpec, radius: f64) -> Vec<f64> {
    let variables = specification.variables.0.iter();
    let change = variables.map(|(_, variable)| {
        if variable.integer {
            radius.max(1.0 / (variable.to - variable.from)).min(0.5)
        } else {
            radius
        }
    });
    change.collect()
}

/// Halves the way between the best design and the nearest one that would be better if it kept to the constraints.
fn close_in(evaluator: &mut Evaluator<'_>) -> Result<bool, CampaignError> {
    let specification = &evaluator.search.specification;
    let sign = specification.objective.sign();
    loop {
        let Some(best) = evaluator
            .best()
            .and_then(|place| evaluator.evaluations.get(place))
        else {
            return Ok(true);
        };
        let Some(merit) = best.merit(specification) else {
            return Ok(true);
        };
        let beyond = evaluator.evaluations.iter().filter(|other| {
            let found = other.found.as_ref();
            found.is_ok_and(|found| {
                !found.is_feasible(specification) && sign * found.objective < merit
            })
        });
        let distance = |other: &Evaluation| best.design.distance(&other.design);
        let Some(other) = beyond.min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return Ok(true);
        };
        if distance(other) <= specification.search.tolerance {
            return Ok(true);
        }
        let ends = best.design.place.iter().zip(&other.design.place);
        let middle: Vec<f64> = ends.map(|(a, b)| 0.5 * a + 0.5 * b).collect();
        let (before, count) = (best.index, evaluator.evaluations.len());
        let place = evaluator.evaluate("boundary", &[Design::at(specification, &middle)])?;
        let [Some(place)] = place[..] else {
            return Ok(false);
        };
        let found = &evaluator.evaluations[place];
        let is_beyond = found
            .found
            .as_ref()
            .is_ok_and(|found| !found.is_feasible(specification) && sign * found.objective < merit);
        let is_better = found.merit(specification).is_some_and(|new| new < merit);
        // It was there before, or is on neither side.
        let is_new = place == count && found.index != before;
        if !is_new || !(is_beyond || is_better) {
            return Ok(true);
        }
    }
}

/// Steps of one along whole numbers from the best design, as long as they make it better.
fn step_integers(evaluator: &mut Evaluator<'_>) -> Result<bool, CampaignError> {
    let specification = &evaluator.search.specification;
    loop {
        let Some(before) = evaluator.best() else {
            return Ok(true);
        };
        let best = evaluator.evaluations[before].design.clone();
        let mut designs = Vec::new();
        for (field, (_, variable)) in specification.variables.0.iter().enumerate() {
            for step in [-1.0, 1.0] {
                let value = best.values[field] + step;
                if variable.integer && (variable.from..=variable.to).contains(&value) {
                    let mut place = best.place.clone();
                    place[field] = variable.part(value);
                    designs.push(Design::at(specification, &place));
                }
            }
        }
        if !is_all(&evaluator.evaluate("integers", &designs)?) {
            return Ok(false);
        }
        if evaluator.best() == Some(before) {
            return Ok(true);
        }
    }
}
