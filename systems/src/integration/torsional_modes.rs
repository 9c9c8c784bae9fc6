//! The fastest torsional motion of bodies on tethers that resist being twisted.
//!
//! In the space of twists the modes are the eigenvectors of `B_st = sqrt(k_s k_t) a_s' W a_t`: k_s the
//! stiffness GJ/L of tether s (N m), a_s how its twist grows with the turning of the bodies and W their
//! inverse inertias. Its largest eigenvalue lambda = omega^2 (1/s^2) is at most the largest sum of
//! magnitudes in a row (Gershgorin 1931); with dampings c_s (N m s) in place of k_s it bounds the damping
//! rate gamma (1/s). For one tether, and for equal ones between the same two bodies, the bound is exact:
//! lambda = n (GJ/L) (1/I_1 + 1/I_2).

use glam::{DMat3, DVec3};

/// A tether as the analysis sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct TwistedTether {
    /// Stiffness GJ/L, N m.
    pub stiffness_n_m: f64,
    /// Damping, N m s.
    pub damping_n_m_s: f64,
    /// How its twist grows with the turning of each free body at its ends, inertial axes; by index of the
    /// body.
    pub arms: Vec<(usize, DVec3)>,
}

/// A bound of the largest eigenvalue, with the `strength` of each tether as its weight, and the tether whose
/// row it is: lambda (1/s^2) by stiffness, gamma (1/s) by damping. `inverse_inertias` of the bodies,
/// 1/(kg m^2), inertial axes.
#[must_use]
pub fn fastest_twist(
    tethers: &[TwistedTether],
    inverse_inertias: &[DMat3],
    strength: impl Fn(&TwistedTether) -> f64,
) -> (f64, usize) {
    let coupling = |s: &TwistedTether, t: &TwistedTether| -> f64 {
        let pairs = s
            .arms
            .iter()
            .flat_map(|a| t.arms.iter().map(move |b| (a, b)));
        let shared = pairs.filter(|((a, _), (b, _))| a == b);
        shared
            .map(|((body, a), (_, b))| a.dot(inverse_inertias[*body] * *b))
            .sum()
    };
    let mut largest = (0.0, 0);
    for (index, s) in tethers.iter().enumerate() {
        let row: f64 = tethers
            .iter()
            .map(|t| (strength(s) * strength(t)).sqrt() * coupling(s, t).abs())
            .sum();
        if row > largest.0 {
            largest = (row, index);
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n (GJ/L) (1/I_1 + 1/I_2) about a common axis, whichever way it points.
    #[test]
    fn equal_tethers_between_two_bodies_have_their_closed_form() {
        let axis = DVec3::new(0.2, -0.5, 0.7).normalize();
        let tether = TwistedTether {
            stiffness_n_m: 3.0,
            damping_n_m_s: 0.5,
            arms: vec![(0, -axis), (1, axis)],
        };
        let inertias = [0.5, 0.125].map(|inverse| DMat3::from_diagonal(DVec3::splat(inverse)));
        let three = vec![tether.clone(), tether.clone(), tether];
        let (lambda, _) = fastest_twist(&three, &inertias, |tether| tether.stiffness_n_m);
        assert!((lambda - 9.0 * 0.625).abs() < 1e-12, "{lambda}");
        let (gamma, _) = fastest_twist(&three, &inertias, |tether| tether.damping_n_m_s);
        assert!((gamma - 1.5 * 0.625).abs() < 1e-12, "{gamma}");
    }
}
