//! A root between two points of opposite sign, by inverse quadratic interpolation where that is
//! sure to gain and by halving where it is not.
//!
//! Source: T. R. Chandrupatla, Adv. Eng. Software 28 (1997) 145-149. A value may be infinite, as the
//! sign of something that cannot be computed: then the bracket is halved.

/// A place and the value there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) place: f64,
    pub(super) value: f64,
}

/// Narrows the bracket from `a` to `b`, whose values have opposite signs, to a width of `tolerance`,
/// and gives the end with the smaller value.
pub(super) fn find<E>(
    mut a: Sample,
    mut b: Sample,
    tolerance: f64,
    value: &mut dyn FnMut(f64) -> Result<f64, E>,
) -> Result<Sample, E> {
    // a is the newest end, b the opposite one, c the end that a replaced.
    let mut fraction = 0.5;
    loop {
        let best = if a.value.abs() < b.value.abs() { a } else { b };
        let width = (b.place - a.place).abs();
        if best.value == 0.0 || width <= tolerance {
            return Ok(best);
        }
        // Never nearer to an end than the tolerance: the last steps then close the bracket.
        let least = (0.5 * tolerance / width).min(0.5);
        let place = a.place + f64::clamp(fraction, least, 1.0 - least) * (b.place - a.place);
        if place == a.place || place == b.place {
            return Ok(best);
        }
        let new = Sample {
            place,
            value: value(place)?,
        };
        let c = if (new.value > 0.0) == (a.value > 0.0) {
            a
        } else {
            let opposite = b;
            b = a;
            opposite
        };
        a = new;
        fraction = interpolate(a, b, c).unwrap_or(0.5);
    }
}

/// The fraction of the way from `a` to `b` at which the inverse quadratic through the three points
/// vanishes, where it is monotonic between them.
fn interpolate(a: Sample, b: Sample, c: Sample) -> Option<f64> {
    let xi = (a.place - b.place) / (c.place - b.place);
    let phi = (a.value - b.value) / (c.value - b.value);
    if !(phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi) {
        return None;
    }
    let along = a.value / (b.value - a.value) * c.value / (b.value - c.value);
    let bent = (c.place - a.place) / (b.place - a.place) * a.value / (c.value - a.value) * b.value
        / (c.value - b.value);
    let fraction = along + bent;
    fraction.is_finite().then_some(fraction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(low: f64, high: f64, function: impl Fn(f64) -> f64) -> (f64, usize) {
        let at = |place| Sample {
            place,
            value: function(place),
        };
        let mut count = 0;
        let mut counted = |place| {
            count += 1;
            Ok::<_, ()>(function(place))
        };
        let found = find(at(low), at(high), 1e-12, &mut counted).unwrap();
        (found.place, count)
    }

    #[test]
    fn it_finds_roots_fast_where_they_are_smooth_and_surely_where_not() {
        let (place, count) = root(0.0, 4.0, |x| x * x * x - 2.0 * x - 5.0);
        assert!(
            (place - 2.094_551_481_542_326_5).abs() < 1e-12 && count < 14,
            "{place} {count}"
        );
        let (place, count) = root(-1.0, 3.0, |x| (x - 0.3).powi(9));
        assert!((place - 0.3).abs() < 1e-3 && count < 120, "{place} {count}");
        let (place, _) = root(0.0, 1.0, |x| if x < 0.7 { -1.0 } else { 1.0 });
        assert!((place - 0.7).abs() < 1e-12);
    }

    #[test]
    fn an_infinite_value_counts_as_its_sign() {
        let (place, _) = root(0.0, 10.0, |x| if x > 3.0 { f64::INFINITY } else { x - 1.5 });
        assert!((place - 1.5).abs() < 1e-12);
    }

    #[test]
    fn an_end_may_be_the_root() {
        assert_eq!(root(0.0, 1.0, |x| x), (0.0, 0));
    }
}
