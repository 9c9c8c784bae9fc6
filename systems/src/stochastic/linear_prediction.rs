//! The best linear prediction of a stationary sequence from its past, by the recursion of Levinson and
//! Durbin: with it a normal sequence of any autocorrelation can be drawn exactly, value by value.
//!
//! ```text
//! x_n given x_(n-1) .. x_(n-m):  mean sum_j phi_(m,j) x_(n-j),  variance v_m
//! kappa = (r_(m+1) - sum_j phi_(m,j) r_(m+1-j)) / v_m
//! phi_(m+1,m+1) = kappa,  phi_(m+1,j) = phi_(m,j) - kappa phi_(m,m+1-j),  v_(m+1) = v_m (1 - kappa^2)
//! ```
//!
//! r: autocorrelation, r_0 = 1. An autocorrelation is one (positive definite) exactly if |kappa| < 1 at
//! every order. Drawn on with the order held at m, the sequence keeps r up to the lag m and forgets beyond
//! (the continuation of largest entropy).
//!
//! Source: Durbin (1960), Rev. Int. Stat. Inst. 28, 233-243; Hosking (1984), Water Resour. Res. 20,
//! 1898-1908.

use std::sync::Arc;

/// A sequence that has no such autocorrelation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositiveDefinite {
    /// The lag at which it is impossible, given those before.
    pub lag: usize,
}

/// The prediction of growing order.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPrediction {
    autocorrelation: Arc<[f64]>,
    /// phi_(m,1) to phi_(m,m).
    coefficients: Vec<f64>,
    /// v_m.
    variance: f64,
}

impl LinearPrediction {
    /// The prediction from nothing, of a sequence with the autocorrelation r_0 = 1, r_1, ...
    #[must_use]
    pub fn new(autocorrelation: Arc<[f64]>) -> Self {
        Self {
            autocorrelation,
            coefficients: Vec::new(),
            variance: 1.0,
        }
    }

    /// Whether a sequence can have this autocorrelation at all.
    ///
    /// # Errors
    /// The first lag at which it cannot.
    pub fn check(autocorrelation: &Arc<[f64]>) -> Result<(), NotPositiveDefinite> {
        let mut prediction = Self::new(Arc::clone(autocorrelation));
        while prediction.grow()? {}
        Ok(())
    }

    /// Goes on to the next order; says whether there was one.
    ///
    /// # Errors
    /// The autocorrelation is none.
    pub fn grow(&mut self) -> Result<bool, NotPositiveDefinite> {
        let order = self.coefficients.len();
        let lag = order + 1;
        let Some(r) = self.autocorrelation.get(lag) else {
            return Ok(false);
        };
        let known = self.autocorrelation[1..lag].iter().rev();
        let predicted: f64 = self
            .coefficients
            .iter()
            .zip(known)
            .map(|(c, r)| c * r)
            .sum();
        let kappa = (r - predicted) / self.variance;
        // NaN is refused as well.
        let left = 1.0 - kappa * kappa;
        if left.is_nan() || left <= 0.0 {
            return Err(NotPositiveDefinite { lag });
        }
        for j in 0..order.div_ceil(2) {
            let (a, b) = (self.coefficients[j], self.coefficients[order - 1 - j]);
            self.coefficients[j] = a - kappa * b;
            self.coefficients[order - 1 - j] = b - kappa * a;
        }
        self.coefficients.push(kappa);
        self.variance *= left;
        Ok(true)
    }

    /// phi_(m,1) to phi_(m,m): what multiplies the last value, the one before, and so on.
    #[must_use]
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// v_m, as part of the variance of the sequence.
    #[must_use]
    pub fn variance(&self) -> f64 {
        self.variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is predicted with is what the normal equations of Yule and Walker say.
    #[test]
    fn every_order_solves_its_normal_equations() {
        let r: Arc<[f64]> = (0..9)
            .map(|lag| {
                let lag = f64::from(lag);
                0.7 * libm::exp(-0.3 * lag) * libm::cos(0.5 * lag) + 0.3 * libm::exp(-lag * lag)
            })
            .collect();
        let mut prediction = LinearPrediction::new(Arc::clone(&r));
        while prediction.grow().unwrap() {
            let phi = prediction.coefficients();
            for i in 1..=phi.len() {
                let sum: f64 = (1..=phi.len()).map(|j| phi[j - 1] * r[i.abs_diff(j)]).sum();
                assert!((sum - r[i]).abs() < 1e-12, "order {}, row {i}", phi.len());
            }
            let explained: f64 = (1..).zip(phi).map(|(j, phi): (usize, _)| phi * r[j]).sum();
            assert!((1.0 - explained - prediction.variance()).abs() < 1e-12);
        }
        assert_eq!(prediction.coefficients().len(), 8);
    }

    #[test]
    fn what_is_no_autocorrelation_is_refused_at_its_lag() {
        // Two neighbours that resemble a third cannot be opposites: r_2 >= 2 r_1^2 - 1.
        let r: Arc<[f64]> = Arc::from([1.0, 0.9, 0.61, 0.3]);
        assert_eq!(
            LinearPrediction::check(&r),
            Err(NotPositiveDefinite { lag: 2 })
        );
    }
}
