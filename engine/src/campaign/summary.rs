//! `summary.json`: what the runs of a campaign have in common.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::definition::Campaign;
use super::finished_runs::FinishedRuns;
use super::sensitivity::{self, SobolIndex, input_column, sobol_indices};
use super::sobol_indices::Estimate;
use super::statistics::{bootstrap, mean_and_deviation, percentile, rank_correlation};

/// Percentiles of every metric.
pub const PERCENTS: [f64; 7] = [1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0];

/// The summary of a campaign.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct CampaignSummary {
    /// Version of the program.
    pub version: String,
    /// Name of the campaign.
    pub campaign: String,
    /// Fingerprint of what it was made of.
    pub fingerprint: String,
    /// Seed of the campaign.
    pub seed: u64,
    /// Runs that were planned.
    pub runs_planned: u64,
    /// Runs that are counted here: the first so many.
    pub runs: u64,
    /// Those of them that got to their end; all numbers below are of these.
    pub runs_done: u64,
    /// Why others did not, the most frequent reason first.
    pub failures: Vec<Failure>,
    /// The metrics, in the order of the campaign.
    pub metrics: Vec<MetricSummary>,
    /// Spearman's rank correlation of each field that varies with each metric, where both are numbers.
    pub rank_correlations: Vec<RankCorrelation>,
    /// Which part of each metric's variance each field makes.
    pub sobol_indices: Vec<SobolIndex>,
    /// How the numbers are meant.
    pub notes: Vec<String>,
}

/// Runs that failed for one reason.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Failure {
    /// The reason, with `#` for numbers.
    pub reason: String,
    /// How many runs.
    pub runs: u64,
    /// Index of the first of them.
    pub first_run: u64,
    /// Its inputs, as `--set` has them.
    pub first_inputs: Vec<String>,
    /// The command that repeats it, with `DIR` for the folder of the campaign.
    pub replay: String,
}

/// What stands for the folder of the campaign in a summary, which is the same wherever that is.
const FOLDER: &str = "DIR";

/// A metric over all runs that have it, in its unit.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct MetricSummary {
    /// Its name.
    pub name: String,
    /// Runs that have it, and count for all but the extremes: of a Saltelli plan those of A and B.
    pub runs: u64,
    /// Runs that got to their end without it: what `FirstTime` waits for never was.
    pub done_without: u64,
    /// Mean.
    pub mean: Option<f64>,
    /// 95 % interval of the mean by the bootstrap.
    pub mean_interval_95: Option<[f64; 2]>,
    /// Standard deviation over n - 1.
    pub standard_deviation: Option<f64>,
    /// Smallest value, and index of its run.
    pub smallest: Option<(f64, u64)>,
    /// Largest value, and index of its run.
    pub largest: Option<(f64, u64)>,
    /// Percentiles.
    pub percentiles: Vec<Percentile>,
    /// Resamples of the bootstrap.
    pub bootstrap_resamples: Option<u32>,
}

/// A percentile, in the metric's unit.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Percentile {
    /// Which, %.
    pub percent: f64,
    /// Its value.
    pub value: f64,
    /// 95 % interval by the bootstrap.
    pub interval_95: Option<[f64; 2]>,
}

/// Spearman's rank correlation of a field and a metric.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct RankCorrelation {
    /// Path of the field.
    pub field: String,
    /// Name of the metric.
    pub metric: String,
    /// The correlation; nothing where one of the two does not vary.
    pub spearman: Option<f64>,
    /// Runs that have both.
    pub runs: u64,
}

/// Folds the runs, in the order of their indices.
#[must_use]
pub fn summarise(campaign: &Campaign, runs: &FinishedRuns) -> CampaignSummary {
    let metrics = campaign.specification.metrics.0.iter().enumerate();
    let metrics = metrics.map(|(place, (name, _))| of_metric(campaign, runs, place, name));
    CampaignSummary {
        version: campaign.manifest.version.clone(),
        campaign: campaign.specification.name.clone(),
        fingerprint: campaign.manifest.fingerprint.clone(),
        seed: campaign.specification.seed,
        runs_planned: campaign.plan.runs,
        runs: runs.count(),
        runs_done: runs.done(),
        failures: runs.failures(campaign),
        metrics: metrics.collect(),
        rank_correlations: rank_correlations(campaign, runs),
        sobol_indices: sobol_indices(campaign, runs),
        notes: notes(campaign, runs),
    }
}

fn notes(campaign: &Campaign, runs: &FinishedRuns) -> Vec<String> {
    let mut notes = vec![
        "intervals are of the percentile bootstrap and take runs as independent: of a Latin hypercube or \
         Sobol's sequence they are too wide as a rule, of a grid or a list they mean little"
            .to_owned(),
    ];
    notes.extend(sensitivity::notes(campaign));
    if runs.count() < campaign.plan.runs {
        notes.push(
            "the campaign ended at a width of an interval that was looked at several times, which makes the \
             interval cover somewhat less than it says"
                .to_owned(),
        );
    }
    notes
}

impl Failure {
    /// Of so many runs, the first of which has this index.
    pub(super) fn new(campaign: &Campaign, reason: &str, (runs, first_run): (u64, u64)) -> Self {
        Self {
            reason: reason.to_owned(),
            runs,
            first_run,
            first_inputs: campaign.plan.inputs(first_run).overrides(),
            replay: format!("aerobot campaign replay {FOLDER} --run {first_run}"),
        }
    }
}

/// A text with `#` in the place of each number.
pub(super) fn without_numbers(text: &str) -> String {
    let mut found = String::new();
    let mut in_number = false;
    let mut before = ' ';
    for character in text.chars() {
        let starts = character.is_ascii_digit() && !before.is_alphanumeric() && before != '_';
        let goes_on = in_number && (character.is_ascii_digit() || ".e-".contains(character));
        if starts && !in_number {
            found.push('#');
        }
        in_number = starts || goes_on;
        if !in_number {
            found.push(character);
        }
        before = character;
    }
    found
}

fn of_metric(campaign: &Campaign, runs: &FinishedRuns, place: usize, name: &str) -> MetricSummary {
    let mut values: Vec<(f64, u64)> = (0..runs.count())
        .filter_map(|index| Some((runs.metric(index, place)?, index)))
        .collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let missing = runs.done() - values.len() as u64;
    let independent = values
        .iter()
        .filter(|(_, index)| is_independent(campaign, *index));
    let sorted: Vec<f64> = independent.map(|(value, _)| *value).collect();
    let moments = mean_and_deviation(&sorted);
    let seed = campaign.specification.seed;
    let intervals = bootstrap(&sorted, &PERCENTS, seed, place as u64);
    let percentiles = PERCENTS.iter().enumerate().filter_map(|(at, percent)| {
        Some(Percentile {
            percent: *percent,
            value: percentile(&sorted, *percent)?,
            interval_95: intervals
                .as_ref()
                .and_then(|found| found.percentiles.get(at).copied()),
        })
    });
    MetricSummary {
        name: name.to_owned(),
        runs: sorted.len() as u64,
        done_without: missing,
        mean: moments
            .map(|(mean, _)| mean)
            .or_else(|| sorted.first().copied()),
        mean_interval_95: intervals.as_ref().map(|found| found.mean),
        standard_deviation: moments.map(|(_, deviation)| deviation),
        smallest: values.first().copied(),
        largest: values.last().copied(),
        percentiles: percentiles.collect(),
        bootstrap_resamples: intervals.as_ref().map(|found| found.resamples),
    }
}

/// Whether a run shares no input with those before: of a Saltelli plan most do.
fn is_independent(campaign: &Campaign, index: u64) -> bool {
    let layout = campaign.plan.saltelli();
    layout.is_none_or(|layout| layout.is_independent(index))
}

fn rank_correlations(campaign: &Campaign, runs: &FinishedRuns) -> Vec<RankCorrelation> {
    let mut found = Vec::new();
    for (number, field) in campaign.plan.field_names().into_iter().enumerate() {
        if !campaign.plan.is_numeric(number) {
            continue;
        }
        let inputs = input_column(campaign, number, runs.count());
        for (place, (metric, _)) in campaign.specification.metrics.0.iter().enumerate() {
            let pairs: Vec<(f64, f64)> = (0..runs.count())
                .zip(&inputs)
                .filter(|(index, _)| is_independent(campaign, *index))
                .filter_map(|(index, input)| Some((*input, runs.metric(index, place)?)))
                .collect();
            if !pairs.is_empty() {
                found.push(RankCorrelation {
                    field: field.to_owned(),
                    metric: metric.clone(),
                    spearman: rank_correlation(&pairs),
                    runs: pairs.len() as u64,
                });
            }
        }
    }
    found
}

impl CampaignSummary {
    /// A few lines for the terminal; `folder` is that of the campaign.
    #[must_use]
    pub fn describe(&self, folder: &str) -> String {
        let mut text = format!(
            "{}: {} of {} runs, {} done\n",
            self.campaign, self.runs, self.runs_planned, self.runs_done
        );
        for failure in self.failures.iter().take(10) {
            let Failure { reason, runs, .. } = failure;
            let _ = writeln!(text, "  {runs} failed: {reason}");
            let replay = failure.replay.replace(FOLDER, folder);
            let _ = writeln!(text, "    first with {}", failure.first_inputs.join(" "));
            let _ = writeln!(text, "    `{replay}`");
        }
        let width = self
            .metrics
            .iter()
            .map(|metric| metric.name.len())
            .max()
            .unwrap_or(0);
        let shown = |value: f64| format!("{value:.4e}");
        for metric in &self.metrics {
            let _ = write!(text, "  {:width$}", metric.name);
            let (Some(mean), Some((least, _)), Some((most, _))) =
                (metric.mean, metric.smallest, metric.largest)
            else {
                let _ = writeln!(text, "  no run has it");
                continue;
            };
            let _ = write!(text, "  mean {}", shown(mean));
            if let Some([low, high]) = metric.mean_interval_95 {
                let _ = write!(text, " ({} to {})", shown(low), shown(high));
            }
            for percentile in &metric.percentiles {
                if [5.0, 50.0, 95.0].contains(&percentile.percent) {
                    let _ = write!(
                        text,
                        ", {} % {}",
                        percentile.percent,
                        shown(percentile.value)
                    );
                }
            }
            let _ = write!(text, ", from {} to {}", shown(least), shown(most));
            if metric.done_without > 0 {
                let _ = write!(text, "; {} runs were done without", metric.done_without);
            }
            text.push('\n');
        }
        for found in &self.rank_correlations {
            if let Some(spearman) = found.spearman {
                let RankCorrelation { field, metric, .. } = found;
                let _ = writeln!(
                    text,
                    "  rank correlation {spearman:+.3} of {field} and {metric}"
                );
            }
        }
        for found in &self.sobol_indices {
            if let Some(first) = &found.first_order {
                let _ = write!(text, "  Sobol index {}", part(first));
                if let Some(total) = &found.total {
                    let _ = write!(text, ", in all {}", part(total));
                }
                let SobolIndex { field, metric, .. } = found;
                let _ = writeln!(text, " of {field} on {metric}");
            }
        }
        if let Some(most) = self.sobol_indices.iter().max_by_key(|found| found.left_out)
            && most.left_out > 0
        {
            let all = most.samples + most.left_out;
            let of = if most.total.is_some() {
                "base samples"
            } else {
                "runs"
            };
            let SobolIndex {
                left_out, metric, ..
            } = most;
            let _ = writeln!(
                text,
                "  {left_out} of {all} {of} lack {metric}, and are left out of its Sobol indices"
            );
        }
        text
    }
}

/// A part of a variance with its interval.
fn part(estimate: &Estimate) -> String {
    let [low, high] = estimate.interval_95;
    format!("{:.3} ({low:.3} to {high:.3})", estimate.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_differ_in_words_and_not_in_numbers() {
        let reason = "`tether/3`: fell below 12.5 m at 3e-5 s";
        assert_eq!(without_numbers(reason), "`tether/#`: fell below # m at # s");
    }
}
