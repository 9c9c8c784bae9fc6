//! Amplitudes of a record over frequency.

use std::f64::consts::{PI, TAU};

/// The spectrum of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Frequency (Hz) and amplitude in the unit of the record: a sine of amplitude 1 has a peak of 1.
    pub points: Vec<(f64, f64)>,
}

/// Points of a spectrum for each bin of the record's transform.
const POINTS_OF_BIN: f64 = 4.0;

impl Spectrum {
    /// The spectrum up to a frequency (Hz) of equally spaced values, `interval_s` apart, less their straight line, in a
    /// Hann window.
    #[must_use]
    pub fn of(values: &[f64], interval_s: f64, until_hz: f64) -> Self {
        let count = values.len();
        if count < 4 {
            return Self::default();
        }
        let windowed = windowed(values);
        let step_hz = 1.0 / (POINTS_OF_BIN * interval_s * count as f64);
        let points = (0..=libm::floor(until_hz / step_hz) as usize).map(|index| {
            let frequency_hz = index as f64 * step_hz;
            let amplitude = transform(&windowed, TAU * frequency_hz * interval_s);
            // Two for both signs of the frequency, two for the mean of the window.
            (frequency_hz, 4.0 * amplitude / count as f64)
        });
        Self {
            points: points.collect(),
        }
    }

    /// Its peaks of at least a part of the highest, in the order of frequency: Hz and amplitude at the tip of the parabola
    /// through the logarithms of three points.
    #[must_use]
    pub fn peaks(&self, least_part: f64) -> Vec<(f64, f64)> {
        let highest = self
            .points
            .iter()
            .fold(0.0_f64, |most, point| most.max(point.1));
        self.points
            .windows(3)
            .filter_map(|three| match *three {
                [before, at, after] if at.1 > before.1 && at.1 >= after.1 => {
                    Some(tip(before, at, after))
                }
                _ => None,
            })
            .filter(|(_, amplitude)| *amplitude >= least_part * highest)
            .collect()
    }

    /// The peak nearest to a frequency, Hz and amplitude.
    #[must_use]
    pub fn peak_near(&self, frequency_hz: f64, least_part: f64) -> Option<(f64, f64)> {
        let peaks = self.peaks(least_part).into_iter();
        peaks.min_by(|a, b| {
            let away = |peak: &(f64, f64)| (peak.0 - frequency_hz).abs();
            away(a).total_cmp(&away(b))
        })
    }
}

/// Values less the straight line that fits them best, times sin^2.
fn windowed(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let places = || (0..values.len()).map(|index| index as f64 - middle);
    let moment: f64 = places()
        .zip(values)
        .map(|(place, value)| place * value)
        .sum();
    let slope = moment / places().map(|place| place * place).sum::<f64>();
    places()
        .zip(values)
        .map(|(place, value)| {
            let window = libm::cos(PI * place / count);
            (value - mean - slope * place) * window * window
        })
        .collect()
}

/// Size of the sum of the values times e^(-i k turn).
fn transform(values: &[f64], turn_rad: f64) -> f64 {
    let (cosine, sine) = (libm::cos(turn_rad), libm::sin(turn_rad));
    let (mut x, mut y) = (1.0, 0.0);
    let (mut real, mut imaginary) = (0.0, 0.0);
    for value in values {
        real += value * x;
        imaginary += value * y;
        (x, y) = (x * cosine - y * sine, x * sine + y * cosine);
    }
    (real * real + imaginary * imaginary).sqrt()
}

fn tip(before: (f64, f64), at: (f64, f64), after: (f64, f64)) -> (f64, f64) {
    let [a, b, c] = [before.1, at.1, after.1].map(libm::log);
    let bend = a - 2.0 * b + c;
    if !(bend < 0.0 && bend.is_finite()) {
        return at;
    }
    let shift = 0.5 * (a - c) / bend;
    (
        at.0 + shift * (after.0 - at.0),
        libm::exp(b - 0.25 * (a - c) * shift),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sines on a slope, 300 s at 10 Hz.
    #[test]
    fn two_sines_are_told_apart() {
        let value = |index: u32| {
            let time_s = 0.1 * f64::from(index);
            2.0 * libm::sin(TAU * 0.1894 * time_s + 0.4)
                + 0.5 * libm::cos(TAU * 0.2031 * time_s)
                + 3.0
                - 0.02 * time_s
        };
        let values: Vec<f64> = (0..3000).map(value).collect();
        let spectrum = Spectrum::of(&values, 0.1, 1.0);
        let peaks = spectrum.peaks(0.1);
        assert_eq!(peaks.len(), 2, "{peaks:?}");
        for ((hz, amplitude), (wanted_hz, wanted)) in
            peaks.iter().zip([(0.1894, 2.0), (0.2031, 0.5)])
        {
            assert!((hz - wanted_hz).abs() < 2e-4, "{peaks:?}");
            assert!((amplitude / wanted - 1.0).abs() < 0.03, "{peaks:?}");
        }
        assert_eq!(spectrum.peak_near(0.21, 0.1), Some(peaks[1]));
        assert_eq!(Spectrum::of(&values[..3], 0.1, 1.0).peaks(0.1), []);
    }
}
