//! The derivative of a function at a point from central differences, extrapolated to a step of zero.
//!
//! ```text
//! d(h) = (f(x + h) - f(x - h)) / (2 h)        f'(x) = 1/3 d(h) - 2 d(h/2) + 8/3 d(h/4)
//! ```
//!
//! the value at h = 0 of the parabola through the three (Neville; Hairer, Norsett and Wanner 1993, sec.
//! II.9). For a smooth function the error is that of the fifth derivative, 0.0018 h^4 of it. The law of
//! drag, |v| v, has d(h) = |h| at rest, which an extrapolation in h^2 would leave standing: this one
//! takes it out exactly, and the slope there is zero as it should be.

/// Parts of the largest step at which differences are taken, with their weights.
pub const LEVELS: [(f64, f64); 3] = [(1.0, 1.0 / 3.0), (0.5, -2.0), (0.25, 8.0 / 3.0)];

/// Adds the derivative of `f` to `derivative`; `f` fills its second argument with the values where the
/// point is moved by its first, a part of the step of `step`, on either side.
///
/// # Errors
/// The first of `f`.
pub fn differentiate<E>(
    derivative: &mut [f64],
    step: f64,
    mut f: impl FnMut(f64, &mut [f64]) -> Result<(), E>,
) -> Result<(), E> {
    let mut forward = vec![0.0; derivative.len()];
    let mut backward = vec![0.0; derivative.len()];
    for (part, weight) in LEVELS {
        let h = part * step;
        f(h, &mut forward)?;
        f(-h, &mut backward)?;
        let scale = weight * 0.5 / h;
        for (sum, (forward, backward)) in derivative.iter_mut().zip(forward.iter().zip(&backward)) {
            *sum += scale * (forward - backward);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(at: f64, step: f64, law: impl Fn(f64) -> f64) -> f64 {
        let mut slope = [0.0];
        let found = differentiate(&mut slope, step, |h, values| {
            values[0] = law(at + h);
            Ok::<(), ()>(())
        });
        assert_eq!(found, Ok(()));
        slope[0]
    }

    #[test]
    fn polynomials_to_the_fourth_order_are_exact() {
        let found = slope(0.5, 0.25, |x| x * (1.0 + x * (2.0 + x * (3.0 + 4.0 * x))));
        let exact = 1.0 + 4.0 * 0.5 + 9.0 * 0.25 + 16.0 * 0.125;
        assert!((found - exact).abs() < 1e-13, "{found} {exact}");
    }

    /// sin^(5) = cos: 0.0018 h^4, and a sixteenth of it at half the step.
    #[test]
    fn the_error_is_of_fourth_order() {
        let error = |step| slope(0.0, step, libm::sin) - 1.0;
        let ratio = error(0.2) / error(0.1);
        assert!((ratio - 16.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn the_kink_of_drag_leaves_no_slope() {
        let found = slope(0.0, 1e-3, |v: f64| 7.0 * v.abs() * v);
        assert!(found.abs() < 1e-17, "{found}");
    }
}
