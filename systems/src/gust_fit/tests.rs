//! Synthetic series: the stated intervals against the truth.

use super::*;
use crate::environment::gust::GustAxis;
use crate::environment::gust::design::GustParameters;
use crate::stochastic::marginal::Marginal;

/// A series every `grid_s` for `duration_s`, of which `keep` says by time what was measured.
fn series(
    (decay_per_s, frequency_rad_s): (f64, f64),
    (marginal, mean_m_s): (&Marginal, f64),
    (grid_s, duration_s): (f64, f64),
    seed: u64,
    keep: &dyn Fn(usize) -> bool,
) -> Series {
    let parameters = GustParameters {
        axis: 0,
        process: ComplexOrnsteinUhlenbeck {
            decay_per_s,
            frequency_rad_s,
        },
        marginal: marginal.clone(),
        mean_m_s: Some(mean_m_s),
        is_target: false,
        grid_s: Some(grid_s),
        layers: None,
        allow_loss: true,
        stream: 0,
        knots_per_step: 2,
    };
    let gust = GustAxis::new(parameters, seed).unwrap();
    let mut parent = gust.design().parent(seed);
    let mut x = Vec::new();
    let count = (duration_s / grid_s) as usize;
    (0..count).for_each(|_| parent.next(&mut x));
    let kept: Vec<usize> = (0..count).filter(|k| keep(*k)).collect();
    Series {
        column: "speed_m_s".to_owned(),
        times_s: kept.iter().map(|k| *k as f64 * grid_s).collect(),
        speeds_m_s: kept
            .iter()
            .map(|k| gust.design().velocity_m_s(x[*k]))
            .collect(),
        gaps: 0,
    }
}

/// Of 100 seeds, in how many each interval covers the truth: both numbers of the marginal, the mean, alpha and
/// omega.
fn covered(
    kind: Kind,
    truth: [f64; 5],
    marginal: &Marginal,
    sampling: (f64, f64),
    keep: &dyn Fn(usize) -> bool,
) -> [u32; 5] {
    let mut covered = [0; 5];
    for seed in 0..100 {
        let process = (truth[3], truth[4]);
        let series = series(process, (marginal, truth[2]), sampling, seed, keep);
        let fit = fit(&series, &[kind]).unwrap();
        let [a, b] = fit.marginal;
        let estimates = [a, b, fit.mean_m_s, fit.decay_per_s, fit.frequency_rad_s];
        for ((estimate, truth), covered) in estimates.iter().zip(truth).zip(&mut covered) {
            *covered += u32::from(estimate.low <= truth && truth <= estimate.high);
        }
    }
    println!("{kind:?}: {covered:?} of 100");
    covered
}

/// Every third value is missing, and of 300 seconds out of 1000 all.
fn with_gaps(k: usize) -> bool {
    !k.is_multiple_of(3) && k % 500 >= 150
}

#[test]
fn the_intervals_of_a_normal_gust_cover_the_truth() {
    let marginal = Marginal::Normal {
        standard_deviation_m_s: 1.5,
    };
    let truth = [4.0, 1.5, 4.0, 0.05, 0.2];
    for keep in [&|_| true, &with_gaps as &dyn Fn(usize) -> bool] {
        let covered = covered(Kind::Normal, truth, &marginal, (2.0, 3600.0), keep);
        assert!(covered.iter().all(|count| *count >= 88), "{covered:?}");
    }
}

#[test]
fn the_intervals_of_other_gusts_cover_the_truth() {
    let weibull = Marginal::Weibull {
        scale_m_s: 0.8,
        shape: 1.9,
    };
    let truth = [0.8, 1.9, weibull.mean_m_s(), 0.1, 0.15];
    let found = covered(Kind::Weibull, truth, &weibull, (2.0, 2000.0), &with_gaps);
    assert!(found.iter().all(|count| *count >= 88), "{found:?}");
    let lognormal = Marginal::Lognormal {
        median_m_s: 3.0,
        log_standard_deviation: 0.5,
    };
    // One that does not oscillate.
    let truth = [3.0, 0.5, lognormal.mean_m_s(), 0.08, 0.0];
    let found = covered(Kind::Lognormal, truth, &lognormal, (2.0, 2000.0), &|_| true);
    assert!(found.iter().all(|count| *count >= 88), "{found:?}");
}

/// Long records tell the marginals apart.
#[test]
fn the_likeliest_marginal_is_the_one_it_was() {
    let weibull = Marginal::Weibull {
        scale_m_s: 0.8,
        shape: 1.9,
    };
    let lognormal = Marginal::Lognormal {
        median_m_s: 3.0,
        log_standard_deviation: 0.5,
    };
    let normal = Marginal::Normal {
        standard_deviation_m_s: 1.0,
    };
    for (marginal, mean_m_s, kind) in [
        (&weibull, weibull.mean_m_s(), Kind::Weibull),
        (&lognormal, lognormal.mean_m_s(), Kind::Lognormal),
        (&normal, 6.0, Kind::Normal),
    ] {
        let series = series((0.1, 0.2), (marginal, mean_m_s), (1.0, 5000.0), 2, &|_| {
            true
        });
        let fit = fit(&series, &Kind::ALL).unwrap();
        assert_eq!(fit.kind, kind);
        let best = fit.log_likelihoods.iter().map(|(_, value)| *value);
        assert_eq!(best.fold(f64::MIN, f64::max), fit.log_likelihood);
    }
}
