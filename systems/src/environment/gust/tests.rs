//! Long records against what the process is to be. Errors are judged at four sigma, with the formulas for
//! one record where the process is normal, else with the spread of many.

use super::design::Layers;
use super::*;
use crate::stochastic::complex_ornstein_uhlenbeck::ComplexOrnsteinUhlenbeck;
use crate::stochastic::marginal::Marginal;

const UNIT: Marginal = Marginal::Normal {
    standard_deviation_m_s: 1.0,
};

fn parameters(decay_per_s: f64, frequency_rad_s: f64, marginal: Marginal) -> GustParameters {
    GustParameters {
        axis: 0,
        process: ComplexOrnsteinUhlenbeck {
            decay_per_s,
            frequency_rad_s,
        },
        marginal,
        mean_m_s: None,
        is_target: false,
        grid_s: None,
        layers: None,
        allow_loss: false,
        stream: 0,
        knots_per_step: 2,
    }
}

/// The velocities at the knots of the first `duration_s`.
fn record(gust: &mut GustAxis, duration_s: f64) -> Vec<f64> {
    let grid_s = gust.design().grid_s;
    let count = (duration_s / grid_s) as usize;
    (0..count)
        .map(|knot| {
            // Not a rounded multiple of the grid, that could stand before its knot.
            gust.provide(knot as u64);
            gust.row = (knot as u64 - gust.first) as usize;
            gust.part = 0.0;
            gust.at_level(0)
        })
        .collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// Mean of (a - m) (b - m), b by `lag` before a.
fn covariance(a: &[f64], b: &[f64], lag: usize, m: f64) -> f64 {
    let pairs = a[lag..].iter().zip(b);
    mean(pairs.map(|(a, b)| (a - m) * (b - m)))
}

fn within(found: f64, expected: f64, sigma: f64, what: &str) {
    println!("{what}: {found:.5}, expected {expected:.5}, sigma {sigma:.5}");
    assert!((found - expected).abs() < 4.0 * sigma, "{what}");
}

/// Mean, variance and autocorrelation of normal gusts, with the closed forms of their sampling errors:
/// var(mean) = 2 alpha/((alpha^2 + omega^2) T), var(var) = (2/T)(1/(2 alpha) + alpha/(2 (alpha^2 + omega^2))).
/// The mean of x(t + tau) x(t) has at most the error of the variance.
#[test]
fn a_normal_gust_has_its_mean_variance_and_autocorrelation() {
    for (alpha, omega, sigma) in [(0.05, 0.2, 1.0), (0.3, 0.0, 2.5), (0.01, 0.5, 0.7)] {
        let duration_s = 2e4 / alpha;
        let marginal = Marginal::Normal {
            standard_deviation_m_s: sigma,
        };
        let mut gust = GustAxis::new(parameters(alpha, omega, marginal), 3).unwrap();
        let grid_s = gust.design().grid_s;
        let record: Vec<f64> = record(&mut gust, duration_s)
            .iter()
            .map(|y| y / sigma)
            .collect();
        let square = alpha * alpha + omega * omega;
        let of_mean = (2.0 * alpha / (square * duration_s)).sqrt();
        let of_variance = (2.0 / duration_s * (0.5 / alpha + 0.5 * alpha / square)).sqrt();
        within(mean(record.iter().copied()), 0.0, of_mean, "mean");
        within(
            covariance(&record, &record, 0, 0.0),
            1.0,
            of_variance,
            "variance",
        );
        for lag_s in [2.0, 5.0, 10.0, 20.0] {
            let lag = (lag_s / grid_s).round() as usize;
            let lag_s = lag as f64 * grid_s;
            let expected = (-alpha * lag_s).exp() * (omega * lag_s).cos();
            let found = covariance(&record, &record, lag, 0.0);
            within(
                found,
                expected,
                of_variance,
                &format!("autocorrelation, {lag_s} s"),
            );
        }
    }
}

/// E[X(t + tau) Y(t)] = -e^(-alpha tau) sin(omega tau).
#[test]
fn the_quadrature_correlation_is_that_of_the_process() {
    let gust = GustAxis::new(parameters(0.05, 0.2, UNIT), 8).unwrap();
    let mut parent = gust.design().parent(8);
    let duration_s = 4e5;
    let count = (duration_s / gust.design().grid_s) as usize;
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for _ in 0..count {
        parent.next(&mut x);
        y.push(parent.quadrature().unwrap());
    }
    // The largest error that any lag can have: (1/T) int rho^2 + |q|^2 = (1/T) int e^(-2 alpha |u|).
    let sigma = (1.0 / (0.05 * duration_s)).sqrt();
    for lag_s in [0.0, 2.0, 5.0, 10.0, 20.0] {
        let lag = (lag_s / gust.design().grid_s).round() as usize;
        let expected = -(-0.05_f64 * lag_s).exp() * (0.2 * lag_s).sin();
        within(
            covariance(&x, &y, lag, 0.0),
            expected,
            sigma,
            &format!("{lag_s} s"),
        );
    }
}

/// Records under so many seeds.
fn records(parameters: &GustParameters, duration_s: f64) -> Vec<Vec<f64>> {
    (0..48)
        .map(|seed| {
            let mut gust = GustAxis::new(parameters.clone(), seed).unwrap();
            record(&mut gust, duration_s)
        })
        .collect()
}

/// The mean over records of what `of` finds in each, and its standard error.
fn over(records: &[Vec<f64>], of: impl Fn(&[f64]) -> f64) -> (f64, f64) {
    let values: Vec<f64> = records.iter().map(|record| of(record)).collect();
    let average = mean(values.iter().copied());
    let spread = mean(values.iter().map(|value| (value - average).powi(2)));
    (average, (spread / (values.len() - 1) as f64).sqrt())
}

/// Probabilities below the quantiles of the definitions, mean and variance of the closed forms.
#[test]
fn other_marginals_have_their_moments_and_quantiles() {
    let sample: Vec<f64> = (1..=40).map(|k| 0.1 * f64::from(k * k % 83)).collect();
    let mut sorted = sample.clone();
    sorted.sort_by(f64::total_cmp);
    // F(y), the probability below y.
    type Below = Box<dyn Fn(f64) -> f64>;
    let cases: [(Marginal, f64, f64, Below, [f64; 3]); 3] = [
        (
            Marginal::Weibull {
                scale_m_s: 0.8,
                shape: 1.9,
            },
            // Gamma(1 + 1/1.9), Gamma(1 + 2/1.9).
            0.8 * 0.887363316,
            0.64 * (1.023405102 - 0.887363316 * 0.887363316),
            Box::new(|y: f64| 1.0 - (-(y / 0.8).powf(1.9)).exp()),
            [0.2, 0.7, 1.3],
        ),
        (
            Marginal::Lognormal {
                median_m_s: 2.0,
                log_standard_deviation: 0.5,
            },
            2.0 * 0.125_f64.exp(),
            4.0 * 0.25_f64.exp() * (0.25_f64.exp() - 1.0),
            Box::new(|y: f64| 0.5 * libm::erfc(-(y / 2.0).ln() / 0.5 / 2.0_f64.sqrt())),
            [1.0, 2.0, 4.0],
        ),
        (
            Marginal::of_sample(sample.clone()),
            mean(sample.iter().copied()),
            f64::NAN,
            // Between the 10th and 11th value, and so on: (i - 1/2)/n at the i-th, linear.
            Box::new(move |y: f64| {
                let i = sorted.iter().filter(|value| **value <= y).count();
                let part = (y - sorted[i - 1]) / (sorted[i] - sorted[i - 1]);
                (i as f64 - 0.5 + part) / 40.0
            }),
            [1.05, 3.95, 6.05],
        ),
    ];
    for (marginal, expected_mean, expected_variance, below, places) in cases {
        let records = records(&parameters(0.2, 0.3, marginal), 4e3);
        let (found, error) = over(&records, |record| mean(record.iter().copied()));
        within(found, expected_mean, error, "mean");
        if expected_variance.is_finite() {
            let (found, error) = over(&records, |record| {
                covariance(record, record, 0, expected_mean)
            });
            within(found, expected_variance, error, "variance");
        }
        for y in places {
            let (found, error) = over(&records, |record| {
                mean(record.iter().map(|value| f64::from(*value <= y)))
            });
            within(found, below(y), error, &format!("part below {y} m/s"));
        }
    }
}

/// A Weibull distribution of shape 2 makes 0.49298 of a correlation of 0.5 (computed apart).
#[test]
fn a_marginal_bends_the_autocorrelation_of_its_parent() {
    let marginal = Marginal::Weibull {
        scale_m_s: 1.0,
        shape: 2.0,
    };
    let gamma = std::f64::consts::PI.sqrt() / 2.0;
    let mut parameters = parameters(std::f64::consts::LN_2 / 2.0, 0.0, marginal);
    parameters.grid_s = Some(0.02);
    let (found, error) = over(&records(&parameters, 4e3), |record| {
        covariance(record, record, 100, gamma) / (1.0 - gamma * gamma)
    });
    within(found, 0.49298, error, "rho_Y");
}

/// On request the velocity itself has the stated autocorrelation, and its marginal all the same.
#[test]
fn the_target_autocorrelation_is_that_of_the_velocity() {
    let lognormal = Marginal::Lognormal {
        median_m_s: 1.0,
        log_standard_deviation: 0.8,
    };
    let (alpha, omega) = (0.2, 0.25);
    let square: f64 = 0.64;
    let (mean_m_s, variance) = ((0.5 * square).exp(), square.exp() * (square.exp() - 1.0));
    let mut bent = parameters(alpha, omega, lognormal);
    let mut stated = bent.clone();
    stated.is_target = true;
    for parameters in [&mut bent, &mut stated] {
        parameters.grid_s = Some(0.1);
        parameters.allow_loss = true;
    }
    let design = GustAxis::new(stated.clone(), 0).unwrap();
    assert!(design.design().is_corrected());
    let (bent, stated) = (records(&bent, 2e3), records(&stated, 2e3));
    for lag in [10, 30, 60, 100, 150] {
        let lag_s = 0.1 * lag as f64;
        let at_lag = |record: &[f64]| covariance(record, record, lag, mean_m_s) / variance;
        let parent = (-alpha * lag_s).exp() * (omega * lag_s).cos();
        let (found, error) = over(&stated, at_lag);
        within(found, parent, error, &format!("stated, {lag_s} s"));
        let (found, error) = over(&bent, at_lag);
        let expected = ((square * parent).exp() - 1.0) / (square.exp() - 1.0);
        within(found, expected, error, &format!("bent, {lag_s} s"));
    }
    let (found, error) = over(&stated, |record| {
        mean(record.iter().map(|y| f64::from(*y <= 1.0)))
    });
    within(found, 0.5, error, "part below the median");
}

#[test]
fn an_impossible_autocorrelation_is_refused_with_its_lag() {
    let lognormal = |log_standard_deviation| Marginal::Lognormal {
        median_m_s: 1.0,
        log_standard_deviation,
    };
    // (e^-1 - 1)/(e - 1) = -0.3679 is the least that s = 1 has; e^-(pi/4) cos(pi) = -0.4559.
    let mut deep = parameters(0.05, 0.2, lognormal(1.0));
    deep.is_target = true;
    let refused = GustAxis::new(deep, 0).unwrap_err();
    assert!(
        matches!(refused, GustError::Unreachable { least, .. } if (least + 0.367_879).abs() < 1e-6),
        "{refused}"
    );
    // Reached, but what the parent would need is no autocorrelation.
    let mut wide = parameters(0.075, 0.2, lognormal(1.0));
    wide.is_target = true;
    let refused = GustAxis::new(wide, 0).unwrap_err();
    assert!(
        matches!(refused, GustError::NotPositiveDefinite { .. }),
        "{refused}"
    );
}

/// At the knots the variance is the same on every grid; midway between them (1 - rho)/2 is lost, 3.4 % at
/// 1 s and 29 % at 5 s.
#[test]
fn the_variance_at_knots_does_not_depend_on_the_grid() {
    for (grid_s, midway) in [(0.1, 0.002_593), (1.0, 0.033_9), (5.0, 0.289_6)] {
        let mut parameters = parameters(0.05, 0.2, UNIT);
        parameters.grid_s = Some(grid_s);
        parameters.allow_loss = true;
        let mut gust = GustAxis::new(parameters, 5).unwrap();
        let duration_s = 4e5;
        let knots = record(&mut gust, duration_s);
        let sigma = (2.0 / duration_s * (10.0 + 0.025 / (0.002_5 + 0.04))).sqrt();
        // A sum over a coarse grid is no integral: so many lags more.
        let sigma = sigma * (1.0 + 0.05 * grid_s);
        within(
            covariance(&knots, &knots, 0, 0.0),
            1.0,
            sigma,
            &format!("{grid_s} s"),
        );
        let middles: Vec<f64> = knots
            .windows(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        let found = covariance(&middles, &middles, 0, 0.0);
        within(found, 1.0 - midway, sigma, &format!("{grid_s} s, midway"));
        let expected = 2.0 / 3.0 * midway;
        assert!((gust.design().loss_in_time() / expected - 1.0).abs() < 0.01);
    }
}

#[test]
fn a_coarse_grid_is_refused_with_what_would_do() {
    let mut coarse = parameters(0.05, 0.2, UNIT);
    coarse.grid_s = Some(1.0);
    let refused = GustAxis::new(coarse, 0).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "knots 1 s apart lose 2.26 % of the variance on average"
    );
    // A whole period later everything is nearly as it was, which does not make the grid a fine one.
    let mut aliased = parameters(1e-4, 1.0, UNIT);
    aliased.grid_s = Some(std::f64::consts::TAU);
    assert!(GustAxis::new(aliased, 0).is_err());
    for (decay_per_s, frequency_rad_s) in [(0.05, 0.2), (4.3e-4, 4.1e-4), (3.0, 0.0), (1e-3, 2.0)] {
        let gust = GustAxis::new(parameters(decay_per_s, frequency_rad_s, UNIT), 0).unwrap();
        let loss = gust.design().loss_in_time();
        assert!(loss <= 0.005 && loss > 0.0005, "{loss}");
    }
}

/// A time has the same wind, whatever was asked before.
#[test]
fn the_wind_is_a_function_of_time() {
    let mut parameters = parameters(0.5, 2.0, UNIT);
    parameters.grid_s = Some(0.01);
    let mut forward = GustAxis::new(parameters.clone(), 11).unwrap();
    // Far beyond what is kept, so that going back draws all of it again.
    let times_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.731).collect();
    let mut at = |time_s: f64| {
        forward.advance_to(time_s);
        forward.velocity_m_s()
    };
    let velocities: Vec<f64> = times_s.iter().map(|time_s| at(*time_s)).collect();
    for index in [2999, 2000, 1, 2998, 0] {
        assert_eq!(at(times_s[index]), velocities[index]);
    }
    let mut other = GustAxis::new(parameters, 11).unwrap();
    other.advance_to(times_s[2999]);
    assert_eq!(other.velocity_m_s(), velocities[2999]);
}

/// A step ends on every second knot at the latest, also where round-off puts its start before one.
#[test]
fn steps_pass_no_more_knots_than_they_may() {
    let mut parameters = parameters(0.05, 0.2, UNIT);
    parameters.grid_s = Some(0.1);
    let gust = GustAxis::new(parameters.clone(), 0).unwrap();
    for (time_s, limit_s) in [(0.0, 0.2), (0.15, 0.2), (0.2, 0.4), (0.1 + 0.2 + 0.3, 0.8)] {
        assert!((gust.step_limit_s(time_s) - limit_s).abs() < 1e-12);
    }
    assert!((gust.step_limit_s(0.6_f64.next_down()) - 0.8).abs() < 1e-12);
    parameters.knots_per_step = 0;
    let gust = GustAxis::new(parameters, 0).unwrap();
    assert_eq!(gust.step_limit_s(0.0), f64::INFINITY);
}

/// Axes, streams and seeds draw numbers of their own.
#[test]
fn gusts_are_independent() {
    let duration_s = 2e5;
    let base = parameters(0.5, 1.0, UNIT);
    let mut other_axis = base.clone();
    other_axis.axis = 1;
    let mut other_stream = base.clone();
    other_stream.stream = 1;
    let first = record(&mut GustAxis::new(base.clone(), 1).unwrap(), duration_s);
    // (1/T) int rho^2.
    let sigma = ((1.0 + 0.2) / duration_s).sqrt();
    for (parameters, seed) in [(other_axis, 1), (other_stream, 1), (base, 2)] {
        let second = record(&mut GustAxis::new(parameters, seed).unwrap(), duration_s);
        within(
            covariance(&first, &second, 0, 0.0),
            0.0,
            sigma,
            "cross-correlation",
        );
    }
}

fn layered() -> GustParameters {
    let mut layered = parameters(0.5, 1.0, UNIT);
    layered.layers = Some(Layers {
        decay_length_m: 1000.0,
        from_m: 50_000.0,
        to_m: 52_000.0,
        level_m: None,
    });
    layered
}

/// E[X(z) X(z')] = e^(-|z - z'|/L) at equal times, at the levels. By Isserlis' theorem the mean of a product
/// has the variance (1 + r^2)/T int rho^2.
#[test]
fn the_correlation_over_altitude_decays_with_its_length() {
    let mut gust = GustAxis::new(layered(), 4).unwrap();
    let (grid_s, duration_s) = (gust.design().grid_s, 2e4);
    let levels = gust.design().levels.unwrap();
    assert_eq!((levels.spacing_m, levels.count()), (10.0, 201));
    let lowest: usize = 30;
    let others = [
        (30, 0.0),
        (35, 50.0),
        (80, 500.0),
        (0, 300.0),
        (180, 1500.0),
    ];
    let mut products = [0.0; 5];
    let count = (duration_s / grid_s) as usize;
    for knot in 0..count {
        gust.advance_to((knot as f64 + 1e-9) * grid_s);
        let base = gust.at_level(lowest);
        for ((level, _), product) in others.iter().zip(&mut products) {
            *product += base * gust.at_level(*level) / count as f64;
        }
    }
    // int rho^2 = 1/(2 alpha) + alpha/(2 (alpha^2 + omega^2)).
    let integral = 1.0 + 0.2;
    for ((_, distance_m), product) in others.iter().zip(products) {
        let r = f64::exp(-distance_m / 1000.0);
        let sigma = f64::sqrt((1.0 + r * r) * integral / duration_s);
        within(product, r, sigma, &format!("{distance_m} m"));
    }
}

/// A corrected process has the same correlation over altitude as one that is not.
#[test]
fn a_corrected_gust_is_correlated_over_altitude_too() {
    let mut parameters = layered();
    parameters.marginal = Marginal::Lognormal {
        median_m_s: 1.0,
        log_standard_deviation: 0.5,
    };
    parameters.process.frequency_rad_s = 0.3;
    parameters.is_target = true;
    let gust = GustAxis::new(parameters, 0).unwrap();
    let (levels, apart) = (gust.levels(), 70);
    assert!(gust.design().is_corrected());
    let products: Vec<Vec<f64>> = (0..48)
        .map(|seed| {
            let (mut parent, mut row) = (gust.design().parent(seed), Vec::new());
            (0..500).for_each(|_| parent.next(&mut row));
            let rows = row.chunks_exact(levels);
            rows.map(|row| row[20] * row[20 + apart]).collect()
        })
        .collect();
    let (found, error) = over(&products, |products| mean(products.iter().copied()));
    let distance_m = apart as f64 * gust.design().levels.unwrap().spacing_m;
    within(
        found,
        f64::exp(-distance_m / 1000.0),
        error,
        "parents 70 levels apart",
    );
}

#[test]
fn between_levels_the_gust_is_linear_and_beyond_them_unknown() {
    let mut gust = GustAxis::new(layered(), 4).unwrap();
    gust.advance_to(3.21);
    let at = |altitude_m| gust.velocity_at_m_s(altitude_m).unwrap();
    assert_eq!(at(50_000.0), gust.velocity_m_s());
    assert!((at(50_025.0) - 0.5 * (at(50_020.0) + at(50_030.0))).abs() < 1e-12);
    let secant = (at(51_999.0) - at(51_993.0)) / 6.0;
    assert!((gust.slope_per_s(51_995.0).unwrap() - secant).abs() < 1e-12);
    for outside in [49_999.9, 52_000.1, f64::NAN] {
        assert!(gust.velocity_at_m_s(outside).is_none() && gust.slope_per_s(outside).is_none());
    }
    let loss = gust.design().loss_in_altitude();
    assert!((loss - (1.0 - (-0.01_f64).exp()) / 3.0).abs() < 1e-12);
    let twice = gust.scaled(2.0);
    assert_eq!(twice.velocity_at_m_s(51_000.0).unwrap(), 2.0 * at(51_000.0));
}
