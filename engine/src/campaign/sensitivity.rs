//! Which part of a metric's variance each field makes: Sobol indices of the runs of a campaign, by what its plan
//! allows.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::definition::Campaign;
use super::finished_runs::FinishedRuns;
use super::plan::RUN_SEED;
use super::saltelli::Saltelli;
use super::sobol_indices::{Estimate, FEWEST_RUNS, ranked_index, saltelli_indices};

/// Which part of the variance of a metric a field makes.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct SobolIndex {
    /// Path of the field; `run.seed` stands for chance.
    pub field: String,
    /// Name of the metric.
    pub metric: String,
    /// By itself; nothing where the metric does not vary, or of too few runs.
    pub first_order: Option<Estimate>,
    /// With everything that it does together with others; a Saltelli plan alone tells it.
    pub total: Option<Estimate>,
    /// How it was estimated.
    pub estimator: Cow<'static, str>,
    /// Base samples of a Saltelli plan, else runs, that have the metric.
    pub samples: u64,
    /// Base samples, or runs, that do not, and are left out.
    pub left_out: u64,
}

const SALTELLI: &str = "Saltelli 2010, Jansen 1999";
const RANKS: &str = "ranks, Gamboa 2022";

/// The indices of every field and metric.
pub(super) fn sobol_indices(campaign: &Campaign, runs: &FinishedRuns) -> Vec<SobolIndex> {
    match campaign.plan.saltelli() {
        Some(layout) => of_base_samples(campaign, layout, runs),
        None if campaign.plan.is_independent() => of_given_runs(campaign, runs),
        None => Vec::new(),
    }
}

fn of_base_samples(campaign: &Campaign, layout: Saltelli, runs: &FinishedRuns) -> Vec<SobolIndex> {
    let mut fields = campaign.plan.field_names();
    fields.extend(layout.chance.then_some(RUN_SEED));
    let (seed, each) = (campaign.specification.seed, layout.runs_each());
    let base_samples = runs.count() / each;
    let mut found = Vec::new();
    for (place, (name, _)) in campaign.specification.metrics.0.iter().enumerate() {
        let mut columns = vec![Vec::new(); each as usize];
        for base in 0..base_samples {
            let values = (0..each).map(|block| runs.metric(base * each + block, place));
            let Some(values) = values.collect::<Option<Vec<f64>>>() else {
                continue;
            };
            for (column, value) in columns.iter_mut().zip(values) {
                column.push(value);
            }
        }
        let samples = columns[0].len() as u64;
        let indices = saltelli_indices(&columns, seed, place as u64);
        for (number, field) in fields.iter().enumerate() {
            let pair = indices.as_ref().and_then(|pairs| pairs.get(number));
            found.push(SobolIndex {
                field: (*field).to_owned(),
                metric: name.clone(),
                first_order: pair.map(|pair| pair.0),
                total: pair.map(|pair| pair.1),
                estimator: SALTELLI.into(),
                samples,
                left_out: base_samples - samples,
            });
        }
    }
    found
}

fn of_given_runs(campaign: &Campaign, runs: &FinishedRuns) -> Vec<SobolIndex> {
    let metrics = &campaign.specification.metrics.0;
    let mut found = Vec::new();
    for (number, field) in campaign.plan.field_names().into_iter().enumerate() {
        let inputs = input_column(campaign, number, runs.count());
        for (place, (name, _)) in metrics.iter().enumerate() {
            let pairs: Vec<(f64, f64)> = (0..runs.count())
                .zip(&inputs)
                .filter_map(|(index, input)| Some((*input, runs.metric(index, place)?)))
                .collect();
            let stream = (number * metrics.len() + place) as u64;
            found.push(SobolIndex {
                field: field.to_owned(),
                metric: name.clone(),
                first_order: ranked_index(&pairs, campaign.specification.seed, stream),
                total: None,
                estimator: RANKS.into(),
                samples: pairs.len() as u64,
                left_out: runs.count() - pairs.len() as u64,
            });
        }
    }
    found
}

/// A field in the first so many runs: its values if all are numbers, else which of its values it is, in the
/// order of their texts.
pub(super) fn input_column(campaign: &Campaign, field: usize, runs: u64) -> Vec<f64> {
    let plan = &campaign.plan;
    let text = |index| plan.inputs(index).fields.into_iter().nth(field);
    let texts = (0..runs).map(|index| text(index).map_or_else(String::new, |(_, value)| value));
    if plan.is_numeric(field) {
        return texts.map(|text| text.parse().unwrap_or(0.0)).collect();
    }
    let mut numbers = BTreeMap::new();
    let mut seen = Vec::with_capacity(runs as usize);
    for text in texts {
        let next = numbers.len();
        seen.push(*numbers.entry(text).or_insert(next));
    }
    // From the order in which they came to that of their texts, which no other run changes.
    let mut order = vec![0.0; numbers.len()];
    for (place, number) in numbers.into_values().enumerate() {
        order[number] = place as f64;
    }
    seen.into_iter().map(|number| order[number]).collect()
}

/// How the indices are meant, for the notes of the summary.
pub(super) fn notes(campaign: &Campaign) -> Vec<String> {
    let text = match campaign.plan.saltelli() {
        Some(layout) => {
            let chance = if layout.chance {
                "; `run.seed` stands for chance, all draws of a run together"
            } else {
                ""
            };
            format!(
                "Sobol indices: first order by Saltelli et al. 2010, total by Jansen 1999, intervals by the \
                 bootstrap over base samples; a base sample that lacks a metric in any of its runs is left out \
                 of that metric{chance}. Means, percentiles and rank correlations are of the runs of A and B \
                 alone, which are independent"
            )
        }
        None if campaign.plan.is_independent() => format!(
            "first-order Sobol indices of {FEWEST_RUNS} or more runs by ranks (Gamboa et al. 2022), with normal \
             intervals: they are some 1 / n to 2 / n too low, those of a field without influence scatter by \
             1 / sqrt(n), and below some 400 runs the intervals hold the truth in 80 to 90 % instead of 95 %; \
             `plan: Saltelli` tells more, total indices and chance among it"
        ),
        None => "Sobol indices are left out: runs of this plan are not independent, as the estimator from \
                 given runs needs them, nor laid out for another; `plan: Saltelli` is"
            .to_owned(),
    };
    vec![text]
}
