//! What one realisation of a gust shows, beside what it should and how far off it may be.

use super::design::GustDesign;
use crate::stochastic::normal_distribution::quantile;
use crate::stochastic::sampling_error::SamplingError;

/// Correlations are followed until e^-this is left of them.
const FORGOTTEN: f64 = 20.0;
/// Probabilities whose quantiles are looked at.
const PROBABILITIES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// One statistic of a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistic {
    /// What it is, with its unit.
    pub name: String,
    /// In the record.
    pub found: f64,
    /// In a record without end.
    pub theory: f64,
    /// Standard error of one record of this length.
    pub error: f64,
}

/// The statistics of the knots of the first `duration_s` (s) under a seed, at the lowest level, with
/// correlations at the multiples nearest to `lags_s` (s) of its grid.
#[must_use]
pub fn statistics(
    design: &GustDesign,
    seed: u64,
    duration_s: f64,
    lags_s: &[f64],
) -> Vec<Statistic> {
    let record = Record::draw(design, seed, duration_s);
    let memory = FORGOTTEN / (design.parameters.process.decay_per_s * design.grid_s);
    let lags = (memory.ceil() as usize).min(record.speeds.len());
    let parent = (0..=lags).map(|lag| design.parent_autocorrelation(lag));
    let error = SamplingError::new(parent.collect(), record.speeds.len());
    let mut found = moments(design, &record, &error);
    let mut lags: Vec<usize> = lags_s
        .iter()
        .map(|lag_s| (lag_s / design.grid_s).round() as usize)
        .filter(|lag| *lag > 0 && *lag < record.speeds.len())
        .collect();
    lags.dedup();
    if found[1].found > 0.0 {
        found.extend(
            lags.iter()
                .map(|lag| autocorrelation(design, &record, &error, *lag)),
        );
    }
    if !record.quadratures.is_empty() {
        found.extend(
            lags.iter()
                .map(|lag| quadrature(design, &record, &error, *lag)),
        );
    }
    found.extend(
        PROBABILITIES
            .iter()
            .map(|p| part_below(design, &record, &error, *p)),
    );
    found
}

/// Velocities of the knots, and X and Y of the process behind them.
struct Record {
    speeds: Vec<f64>,
    parents: Vec<f64>,
    quadratures: Vec<f64>,
}

impl Record {
    fn draw(design: &GustDesign, seed: u64, duration_s: f64) -> Self {
        let mut parent = design.parent(seed);
        let count = (duration_s / design.grid_s) as usize + 1;
        let mut record = Self {
            speeds: Vec::with_capacity(count),
            parents: Vec::with_capacity(count),
            quadratures: Vec::new(),
        };
        let mut row = Vec::new();
        for _ in 0..count {
            row.clear();
            parent.next(&mut row);
            let x = row.first().copied().unwrap_or_default();
            record.parents.push(x);
            record.speeds.push(design.velocity_m_s(x));
            record.quadratures.extend(parent.quadrature());
        }
        record
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

fn moments(design: &GustDesign, record: &Record, error: &SamplingError) -> Vec<Statistic> {
    let marginal = &design.parameters.marginal;
    let average = mean(record.speeds.iter().copied());
    let off = record.speeds.iter().map(|speed| {
        let off = speed - average;
        off * off
    });
    vec![
        Statistic {
            name: "mean, m/s".to_owned(),
            found: average,
            theory: design.mean_m_s(),
            error: error.of_mean(|x| marginal.at(x)),
        },
        Statistic {
            name: "variance, m2/s2".to_owned(),
            found: mean(off),
            theory: marginal.variance_m2_s2(),
            error: error.of_variance(marginal),
        },
    ]
}

fn autocorrelation(
    design: &GustDesign,
    record: &Record,
    error: &SamplingError,
    lag: usize,
) -> Statistic {
    let average = mean(record.speeds.iter().copied());
    let product = |lag: usize| {
        let pairs = record.speeds[lag..].iter().zip(&record.speeds);
        pairs
            .map(|(a, b)| (a - average) * (b - average))
            .sum::<f64>()
    };
    let lag_s = lag as f64 * design.grid_s;
    // Each lag once: the sum of the error looks at it four times.
    let reach = error.reach() + 2 * lag;
    let known: Vec<f64> = (0..=reach)
        .map(|lag| design.autocorrelation(lag as f64 * design.grid_s))
        .collect();
    let rho = |lag: i64| {
        known
            .get(lag.unsigned_abs() as usize)
            .copied()
            .unwrap_or(0.0)
    };
    Statistic {
        name: format!("autocorrelation, {lag_s:.6} s"),
        found: product(lag) / product(0),
        theory: design.autocorrelation(lag_s),
        error: error.of_autocorrelation(lag, rho),
    }
}

fn quadrature(
    design: &GustDesign,
    record: &Record,
    error: &SamplingError,
    lag: usize,
) -> Statistic {
    let process = &design.parameters.process;
    let at = |lag: i64| lag as f64 * design.grid_s;
    let lag_s = at(lag as i64);
    let pairs = record.parents[lag..].iter().zip(&record.quadratures);
    Statistic {
        name: format!("quadrature E[X(t + tau) Y(t)], {lag_s:.6} s"),
        found: mean(pairs.map(|(x, y)| x * y)),
        theory: process.quadrature(lag_s),
        error: error.of_quadrature(
            lag,
            |lag| process.autocorrelation(at(lag)),
            |lag| process.quadrature(at(lag)),
        ),
    }
}

fn part_below(
    design: &GustDesign,
    record: &Record,
    error: &SamplingError,
    probability: f64,
) -> Statistic {
    let x = quantile(probability);
    let speed_m_s = design.velocity_m_s(x);
    let below = record
        .speeds
        .iter()
        .map(|speed| f64::from(*speed <= speed_m_s));
    Statistic {
        // A median of zero is no negative one.
        name: format!(
            "part below {:.4} m/s",
            if x.abs() < 1e-12 {
                design.velocity_m_s(0.0)
            } else {
                speed_m_s
            }
        ),
        found: mean(below),
        theory: probability,
        error: error.of_part_below(x),
    }
}
