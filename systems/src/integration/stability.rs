//! How long a step classical Runge-Kutta takes without growth on a damped oscillator.
//!
//! A mode x'' + gamma x' + lambda x = 0 has the exponents s = -gamma/2 +- sqrt(gamma^2/4 - lambda);
//! a step h is stable while |R(h s)| <= 1, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 (Hairer and Wanner
//! 1996, IV.2).

/// The largest stable step of RK4, s, for a mode of squared frequency `lambda` (1/s^2) and damping
/// rate `gamma` (1/s); infinite where nothing oscillates or decays.
#[must_use]
pub fn largest_stable_step_s(lambda: f64, gamma: f64) -> f64 {
    let discriminant = 0.25 * gamma * gamma - lambda;
    let (re, im) = if discriminant >= 0.0 {
        (-0.5 * gamma - discriminant.sqrt(), 0.0)
    } else {
        (-0.5 * gamma, (-discriminant).sqrt())
    };
    let size = (re * re + im * im).sqrt();
    if size == 0.0 {
        return f64::INFINITY;
    }
    // The first exit from the region along the ray lies between |z| = 2 and |z| = 4.
    let direction = (re / size, im / size);
    let (mut inside, mut outside) = (2.0, 4.0);
    let mut radius = inside;
    while radius <= outside {
        if amplification(direction, radius) > 1.0 + 1e-12 {
            outside = radius;
            break;
        }
        inside = radius;
        radius += 0.01;
    }
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if amplification(direction, middle) > 1.0 + 1e-12 {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    inside / size
}

/// |R(z)| for z = radius x direction.
fn amplification(direction: (f64, f64), radius: f64) -> f64 {
    let z = (direction.0 * radius, direction.1 * radius);
    let mut value = (1.0, 0.0);
    for k in [4.0, 3.0, 2.0, 1.0] {
        // Horner: value = 1 + z / k * value.
        value = (
            1.0 + (z.0 * value.0 - z.1 * value.1) / k,
            (z.0 * value.1 + z.1 * value.0) / k,
        );
    }
    (value.0 * value.0 + value.1 * value.1).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_region_are_the_known_ones() {
        // Real axis: 2.785293563405282; imaginary axis: 2 sqrt 2.
        let overdamped = largest_stable_step_s(0.0, 3.0);
        assert!(
            (overdamped - 2.785_293_563_405_282 / 3.0).abs() < 1e-9,
            "{overdamped}"
        );
        let undamped = largest_stable_step_s(4.0, 0.0);
        assert!((undamped - 2.0_f64.sqrt()).abs() < 1e-9, "{undamped}");
        assert!(largest_stable_step_s(0.0, 0.0).is_infinite());
    }
}
