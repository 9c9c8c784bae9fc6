//! What a measured series of wind says about a gust: mean, marginal, alpha and omega, each with the interval
//! that holds the truth in 95 of 100 such series.
//!
//! The velocities are a marginal's function of a normal process with the autocorrelation
//! e^(-alpha tau) cos(omega tau); all numbers are found at once where their likelihood
//! ([`likelihood`]) is largest. Intervals follow from its curvature there, in numbers in which it is nearly a
//! parabola ([`candidate`], ln alpha, omega); that of an omega near zero from the likelihood itself, as far as
//! it falls by 1.92 with all else as good as it can be. Of the marginals the likeliest is taken.
//!
//! Source: Cox and Hinkley (1974), Theoretical Statistics, 9.2 and 9.3.
//!
//! Assumptions: a stationary wind, measured without error, by a record of many correlation times. What is
//! sampled every h s says nothing of frequencies beyond pi/h.

pub mod candidate;
pub mod likelihood;
mod maximum;
pub mod series;

use std::cell::RefCell;
use std::f64::consts::PI;

use nalgebra::DMatrix;

use crate::stochastic::complex_ornstein_uhlenbeck::ComplexOrnsteinUhlenbeck;
use candidate::Kind;
use likelihood::log_likelihood;
use maximum::Maximum;
use series::Series;

/// Half the width of a 95 % interval, in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;
/// Half of the square of it: what the likelihood falls by.
const FALL_95: f64 = 0.5 * NORMAL_95 * NORMAL_95;
/// An omega of fewer standard deviations than this is near zero.
const NEAR_ZERO: f64 = 4.0;
/// Values of alpha and of omega that are tried first.
const TRIED_DECAYS: u32 = 10;
const TRIED_FREQUENCIES: u32 = 20;
/// The best of these is carried to a maximum, and the best of those whose omega differs from it by this factor.
const OTHER_FREQUENCY: f64 = 1.7;
/// In units of the rate of the start; an omega that may as well be larger is none.
const MOST_FREQUENCY: f64 = 1e3;
/// Of an interval that holds an end of a confidence interval: to a thousandth of it.
const HALVINGS: usize = 10;

/// A number with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The likeliest value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A fitted gust.
#[derive(Clone, Debug)]
pub struct GustFit {
    /// The likeliest kind of marginal.
    pub kind: Kind,
    /// Its two numbers, as [`Kind::fields`] names them.
    pub marginal: [Estimate; 2],
    /// Mean of the velocity, m/s.
    pub mean_m_s: Estimate,
    /// alpha, 1/s.
    pub decay_per_s: Estimate,
    /// omega, rad/s.
    pub frequency_rad_s: Estimate,
    /// ln of the likelihood, of the density in s/m.
    pub log_likelihood: f64,
    /// That of every kind that could be fitted.
    pub log_likelihoods: Vec<(Kind, f64)>,
}

/// Fits the likeliest of `kinds`; `None` if there is no maximum, as where the series is too short to show one.
#[must_use]
pub fn fit(series: &Series, kinds: &[Kind]) -> Option<GustFit> {
    if series.times_s.len() < 2 {
        return None;
    }
    let is_positive = series.speeds_m_s.iter().all(|speed| *speed > 0.0);
    let usable = kinds
        .iter()
        .filter(|kind| is_positive || !kind.is_of_positive());
    let problems = usable.map(|kind| Problem::new(series, *kind));
    let found: Vec<(Problem, Maximum)> = problems
        .filter_map(|problem| {
            let maximum = problem.maximum()?;
            Some((problem, maximum))
        })
        .collect();
    let best = found
        .iter()
        .max_by(|(_, a), (_, b)| a.value.total_cmp(&b.value));
    let (problem, maximum) = best?;
    let mut fit = problem.fit(maximum)?;
    fit.log_likelihoods = found
        .iter()
        .map(|(problem, maximum)| (problem.kind, problem.log_likelihood(maximum)))
        .collect();
    Some(fit)
}

/// The likelihood of one kind as a function of (a, b, ln(alpha t), omega t), velocities in units of their
/// spread and t such that omega t is of order one.
struct Problem<'a> {
    kind: Kind,
    times_s: &'a [f64],
    speeds: Vec<f64>,
    /// What was subtracted from velocities, and what they were divided by, m/s.
    offset_m_s: f64,
    unit_m_s: f64,
    /// t, s.
    time_s: f64,
    /// Where to climb from.
    starts: Vec<[f64; 4]>,
    scratch: RefCell<Vec<f64>>,
}

impl<'a> Problem<'a> {
    fn new(series: &'a Series, kind: Kind) -> Self {
        let [mean, log_spread] = Kind::Normal.start(&series.speeds_m_s);
        let unit_m_s = libm::exp(log_spread);
        let offset_m_s = if kind.is_of_positive() { 0.0 } else { mean };
        let speeds = series.speeds_m_s.iter();
        let speeds: Vec<f64> = speeds
            .map(|speed| (speed - offset_m_s) / unit_m_s)
            .collect();
        let start = kind.start(&speeds);
        let mut x = Vec::new();
        kind.parents(start, &speeds, &mut x);
        let starts = likely(&series.times_s, &x);
        let rate = starts.first().map_or(1.0, |process| {
            libm::hypot(process.decay_per_s, process.frequency_rad_s)
        });
        Self {
            kind,
            times_s: &series.times_s,
            starts: starts
                .iter()
                .map(|process| {
                    // From zero itself nothing would lead away.
                    let frequency = process.frequency_rad_s.max(0.1 * process.decay_per_s);
                    let decay = libm::log(process.decay_per_s / rate);
                    [start[0], start[1], decay, frequency / rate]
                })
                .collect(),
            speeds,
            offset_m_s,
            unit_m_s,
            time_s: 1.0 / rate,
            scratch: RefCell::default(),
        }
    }

    fn value(&self, place: &[f64]) -> f64 {
        let process = ComplexOrnsteinUhlenbeck {
            decay_per_s: libm::exp(place[2]) / self.time_s,
            frequency_rad_s: place[3] / self.time_s,
        };
        let mut x = self.scratch.borrow_mut();
        let slopes = self
            .kind
            .parents([place[0], place[1]], &self.speeds, &mut x);
        let value = slopes + log_likelihood(&process, self.times_s, &x);
        if value.is_finite() { value } else { f64::MIN }
    }

    fn climb(&self, from: &[f64], free: &[usize]) -> Option<Maximum> {
        // The sharpest curvature is that of so many velocities.
        let step = (0.2 / (self.speeds.len() as f64).sqrt()).min(1e-2);
        maximum::find(&|place| self.value(place), from, free, step)
    }

    fn maximum(&self) -> Option<Maximum> {
        let climbed = self
            .starts
            .iter()
            .filter_map(|start| self.climb(start, &[0, 1, 2, 3]));
        let mut best = climbed.max_by(|a, b| a.value.total_cmp(&b.value))?;
        // The likelihood is even in omega.
        if best.place[3] < 0.0 {
            best.place[3] = -best.place[3];
            best = self.climb(&best.place, &[0, 1, 2, 3])?;
        }
        Some(best)
    }

    /// ln of the density of the velocities as they were measured, s/m.
    fn log_likelihood(&self, maximum: &Maximum) -> f64 {
        maximum.value - self.speeds.len() as f64 * libm::log(self.unit_m_s)
    }

    fn fit(&self, maximum: &Maximum) -> Option<GustFit> {
        let covariance = maximum.information.clone().try_inverse()?;
        let place = &maximum.place;
        let half = |index: usize| NORMAL_95 * covariance[(index, index)].max(0.0).sqrt();
        let linear = |index: usize, scale: f64, offset: f64| {
            let (value, half) = (place[index], half(index));
            Estimate {
                value: scale * value + offset,
                low: scale * (value - half) + offset,
                high: scale * (value + half) + offset,
            }
        };
        let exponential = |index: usize, scale: f64| {
            let (value, half) = (place[index], half(index));
            Estimate {
                value: scale * libm::exp(value),
                low: scale * libm::exp(value - half),
                high: scale * libm::exp(value + half),
            }
        };
        let marginal = match self.kind {
            Kind::Normal => [
                linear(0, self.unit_m_s, self.offset_m_s),
                exponential(1, self.unit_m_s),
            ],
            Kind::Lognormal | Kind::Weibull => [exponential(0, self.unit_m_s), exponential(1, 1.0)],
        };
        Some(GustFit {
            kind: self.kind,
            mean_m_s: match self.kind {
                Kind::Normal => marginal[0],
                _ => self.mean(place, &covariance),
            },
            marginal,
            decay_per_s: exponential(2, 1.0 / self.time_s),
            frequency_rad_s: if place[3] < NEAR_ZERO * half(3) / NORMAL_95 {
                self.frequency_near_zero(maximum)?
            } else {
                linear(3, 1.0 / self.time_s, 0.0)
            },
            log_likelihood: self.log_likelihood(maximum),
            log_likelihoods: Vec::new(),
        })
    }

    /// The mean of a marginal of positive velocities; its logarithm is nearly normal.
    fn mean(&self, place: &[f64], covariance: &DMatrix<f64>) -> Estimate {
        const STEP: f64 = 1e-5;
        let log_mean = |a: f64, b: f64| libm::log(self.kind.mean([a, b]));
        let (a, b) = (place[0], place[1]);
        let slopes = [
            (log_mean(a + STEP, b) - log_mean(a - STEP, b)) / (2.0 * STEP),
            (log_mean(a, b + STEP) - log_mean(a, b - STEP)) / (2.0 * STEP),
        ];
        let mut variance = 0.0;
        for (i, x) in slopes.iter().enumerate() {
            for (j, y) in slopes.iter().enumerate() {
                variance += x * y * covariance[(i, j)];
            }
        }
        let (value, half) = (log_mean(a, b), NORMAL_95 * variance.max(0.0).sqrt());
        Estimate {
            value: self.unit_m_s * libm::exp(value),
            low: self.unit_m_s * libm::exp(value - half),
            high: self.unit_m_s * libm::exp(value + half),
        }
    }

    /// omega by the likelihood itself, which near zero is no parabola.
    fn frequency_near_zero(&self, maximum: &Maximum) -> Option<Estimate> {
        let top = maximum.place[3];
        let wanted = maximum.value - FALL_95;
        let mut place = maximum.place.clone();
        // All else as good as it can be, from where it was last.
        let mut at = |frequency: f64| -> Option<f64> {
            place[3] = frequency;
            let found = self.climb(&place, &[0, 1, 2])?;
            place = found.place;
            Some(found.value)
        };
        let low = if at(0.0)? >= wanted {
            0.0
        } else {
            bisect(&mut at, 0.0, top, wanted)?
        };
        let mut outer = 2.0 * top.max(0.1);
        while at(outer)? >= wanted {
            outer *= 1.5;
            if outer > MOST_FREQUENCY {
                return None;
            }
        }
        let high = bisect(&mut at, outer, top, wanted)?;
        Some(Estimate {
            value: top / self.time_s,
            low: low / self.time_s,
            high: high / self.time_s,
        })
    }
}

/// The place between `outside`, where the function is below `wanted`, and `inside`, where it is not.
fn bisect(
    function: &mut dyn FnMut(f64) -> Option<f64>,
    mut outside: f64,
    mut inside: f64,
    wanted: f64,
) -> Option<f64> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (outside + inside);
        if function(middle)? < wanted {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    Some(outside)
}

/// The most likely of a grid of alpha and omega, for given parents.
fn likely(times_s: &[f64], x: &[f64]) -> Vec<ComplexOrnsteinUhlenbeck> {
    let mut steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let step_s = steps[steps.len() / 2];
    let span_s = times_s[times_s.len() - 1] - times_s[0];
    let between = |low: f64, high: f64, index: u32, count: u32| {
        low * libm::pow(high / low, f64::from(index) / f64::from(count))
    };
    let mut tried = Vec::new();
    for i in 0..=TRIED_DECAYS {
        let decay_per_s = between(1.0 / span_s, 3.0 / step_s, i, TRIED_DECAYS);
        for j in 0..=TRIED_FREQUENCIES {
            let process = ComplexOrnsteinUhlenbeck {
                decay_per_s,
                frequency_rad_s: match j {
                    0 => 0.0,
                    _ => between(2.0 / span_s, 0.95 * PI / step_s, j, TRIED_FREQUENCIES),
                },
            };
            tried.push((log_likelihood(&process, times_s, x), process));
        }
    }
    tried.retain(|(value, _)| value.is_finite());
    tried.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    let Some((_, best)) = tried.first().copied() else {
        return Vec::new();
    };
    let near = best.frequency_rad_s / OTHER_FREQUENCY..=best.frequency_rad_s * OTHER_FREQUENCY;
    let mut others = tried.iter().map(|(_, process)| *process);
    let other = others.find(|process| !near.contains(&process.frequency_rad_s));
    [Some(best), other].into_iter().flatten().collect()
}

#[cfg(test)]
mod tests;
