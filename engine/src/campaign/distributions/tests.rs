use super::*;

fn number(distribution: &Distribution, u: f64) -> f64 {
    distribution.value(u, &[]).parse().unwrap()
}

fn near(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(
        error < 1e-12 * (1.0 + expected.abs()),
        "{found}, not {expected}"
    );
}

/// Mean and variance by the midpoint rule on the quantile function.
fn moments(distribution: &Distribution) -> (f64, f64) {
    let count = 100_000;
    let values: Vec<f64> = (0..count)
        .map(|k| number(distribution, (f64::from(k) + 0.5) / f64::from(count)))
        .collect();
    let mean = values.iter().sum::<f64>() / f64::from(count);
    let squares = values.iter().map(|x| (x - mean) * (x - mean));
    (mean, squares.sum::<f64>() / f64::from(count))
}

#[test]
fn quantiles_have_their_closed_forms() {
    near(number(&Distribution::Uniform(80.0, 120.0), 0.25), 90.0);
    let weibull = Distribution::Weibull {
        scale: 3.0,
        shape: 2.0,
    };
    near(
        number(&weibull, 0.5),
        3.0 * libm::sqrt(std::f64::consts::LN_2),
    );
    let lognormal = Distribution::Lognormal {
        median: 2.0,
        log_standard_deviation: 0.5,
    };
    near(number(&lognormal, 0.5), 2.0);
    near(
        number(&lognormal, 0.975),
        2.0 * libm::exp(0.5 * 1.959963984540054),
    );
    let normal = Distribution::Normal {
        mean: 10.0,
        standard_deviation: 2.0,
    };
    near(number(&normal, 0.025), 10.0 - 2.0 * 1.959963984540054);
}

/// Means and variances of Weibull (shape 1 is exponential), lognormal and the half normal distribution.
#[test]
fn moments_have_their_closed_forms() {
    let close = |(mean, variance): (f64, f64), (m, v): (f64, f64)| {
        assert!((mean / m - 1.0).abs() < 1e-3 && (variance / v - 1.0).abs() < 3e-3);
    };
    let exponential = Distribution::Weibull {
        scale: 2.0,
        shape: 1.0,
    };
    close(moments(&exponential), (2.0, 4.0));
    let s2: f64 = 0.25;
    let lognormal = Distribution::Lognormal {
        median: 1.0,
        log_standard_deviation: 0.5,
    };
    let mean = libm::exp(s2 / 2.0);
    close(
        moments(&lognormal),
        (mean, (libm::exp(s2) - 1.0) * libm::exp(s2)),
    );
    let half = Distribution::TruncatedNormal {
        mean: 0.0,
        standard_deviation: 1.0,
        low: 0.0,
        high: 40.0,
    };
    let two_over_pi = 2.0 / std::f64::consts::PI;
    close(moments(&half), (libm::sqrt(two_over_pi), 1.0 - two_over_pi));
}

/// Far in the upper tail: the mean of a normal beyond a is close to a + 1/a, and nothing is outside.
#[test]
fn a_truncated_tail_keeps_its_digits() {
    let tail = Distribution::TruncatedNormal {
        mean: 0.0,
        standard_deviation: 1.0,
        low: 6.0,
        high: 12.0,
    };
    // density(6) / upper(6) is the mean.
    let density = libm::exp(-18.0) / libm::sqrt(2.0 * std::f64::consts::PI);
    let mean = density / normal_distribution::below(-6.0);
    assert!((moments(&tail).0 / mean - 1.0).abs() < 1e-5);
    assert!(number(&tail, 1e-15) >= 6.0 && number(&tail, 1.0 - 1e-15) <= 12.0);
}

#[test]
fn what_is_counted_comes_out_evenly() {
    let whole = Distribution::UniformInteger(-1, 2);
    let found: Vec<String> = (0..4)
        .map(|k| whole.value((f64::from(k) + 0.5) / 4.0, &[]))
        .collect();
    assert_eq!(found, ["-1", "0", "1", "2"]);
    let levels = Distribution::Levels {
        from: 1.0,
        to: 2.0,
        count: 3,
    };
    assert_eq!(levels.steps().unwrap(), ["1.0", "1.5", "2.0"]);
    let measured = Distribution::Measured {
        file: String::new(),
        column: String::new(),
    };
    assert_eq!(measured.value(0.9999, &[1.0, 5.5]), "5.5");
    assert_eq!(measured.value(0.49, &[1.0, 5.5]), "1.0");
}
