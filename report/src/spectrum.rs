//! Amplitude spectra of records at even times.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Fewer samples than this have no spectrum to look at.
const LEAST: usize = 16;
/// Times are even to this part of their step.
const EVEN: f64 = 1e-6;

/// Amplitudes at even frequencies, from zero to the highest that the samples have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Frequencies, Hz.
    pub frequencies_hz: Vec<f64>,
    /// Amplitude of a sine at each frequency, in the unit of the record.
    pub amplitudes: Vec<f64>,
}

/// A peak of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Frequency between bins, Hz.
    pub frequency_hz: f64,
    /// Amplitude between bins, in the unit of the record.
    pub amplitude: f64,
}

impl Spectrum {
    /// The largest amplitude.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let amplitudes = self.amplitudes.iter().skip(1);
        amplitudes.fold(0.0, |most: f64, amplitude| most.max(*amplitude))
    }

    /// Frequencies (Hz) with their amplitudes.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let frequencies_hz = self.frequencies_hz.iter().copied();
        frequencies_hz.zip(self.amplitudes.iter().copied())
    }

    /// What is at or below a frequency, Hz.
    #[must_use]
    pub fn up_to(mut self, frequency_hz: f64) -> Self {
        let kept = self
            .frequencies_hz
            .partition_point(|hz| *hz <= frequency_hz);
        self.frequencies_hz.truncate(kept);
        self.amplitudes.truncate(kept);
        self
    }
}

/// The amplitude spectrum under a Hann window, the straight line of least squares taken off, with so many points for
/// each bin of the record: its frequencies are k / T with one point, and closer, by zeros behind the record, with more.
/// Nothing if there are too few samples or their times are not even. A last sample off the grid is left out.
#[must_use]
pub fn amplitude_spectrum(
    times_s: &[f64],
    values: &[f64],
    points_of_bin: usize,
) -> Option<Spectrum> {
    let step_s = times_s.get(1)? - times_s.first()?;
    let is_even = |pair: &[f64]| (pair[1] - pair[0] - step_s).abs() <= EVEN * step_s;
    let even = times_s.windows(2).take_while(|pair| is_even(pair)).count() + 1;
    let count = even.min(values.len());
    if count < LEAST || even + 1 < times_s.len() {
        return None;
    }
    let mut record: Vec<Complex<f64>> = detrended(&values[..count])
        .into_iter()
        .enumerate()
        .map(|(index, value)| {
            let window = 0.5 - 0.5 * libm::cos(TAU * index as f64 / count as f64);
            Complex::new(window * value, 0.0)
        })
        .collect();
    let points = count * points_of_bin.max(1);
    record.resize(points, Complex::default());
    FftPlanner::new()
        .plan_fft_forward(points)
        .process(&mut record);
    // The window lets half of an amplitude through, and a sine has two lines.
    let scale = 4.0 / count as f64;
    let half = points / 2 + 1;
    Some(Spectrum {
        frequencies_hz: (0..half)
            .map(|index| index as f64 / (points as f64 * step_s))
            .collect(),
        amplitudes: record[..half]
            .iter()
            .map(|value| scale * value.norm())
            .collect(),
    })
}

fn detrended(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let places = || (0..values.len()).map(|index| index as f64 - middle);
    let across: f64 = places()
        .zip(values)
        .map(|(place, value)| place * (value - mean))
        .sum();
    let slope = across / places().map(|place| place * place).sum::<f64>();
    places()
        .zip(values)
        .map(|(place, value)| value - mean - slope * place)
        .collect()
}

/// Peaks of at least a part of the largest amplitude, the largest first: points that are larger than
/// their neighbours, placed by the parabola through the logarithms of three.
#[must_use]
pub fn peaks(spectrum: &Spectrum, least_part: f64) -> Vec<Peak> {
    let amplitudes = &spectrum.amplitudes;
    let least = least_part * spectrum.largest();
    let mut found: Vec<Peak> = (2..amplitudes.len().saturating_sub(1))
        .filter(|index| {
            let here = amplitudes[*index];
            here > least && amplitudes[index - 1] < here && amplitudes[index + 1] <= here
        })
        .map(|index| between_bins(spectrum, index))
        .collect();
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    found
}

/// The peak nearest to a frequency (Hz), of those of at least a part of the largest amplitude.
#[must_use]
pub fn peak_near(spectrum: &Spectrum, frequency_hz: f64, least_part: f64) -> Option<Peak> {
    let away = |peak: &Peak| (peak.frequency_hz - frequency_hz).abs();
    let peaks = peaks(spectrum, least_part).into_iter();
    peaks.min_by(|a, b| away(a).total_cmp(&away(b)))
}

fn between_bins(spectrum: &Spectrum, index: usize) -> Peak {
    let log = |index: usize| libm::log(spectrum.amplitudes[index].max(f64::MIN_POSITIVE));
    let (before, here, after) = (log(index - 1), log(index), log(index + 1));
    let shift = 0.5 * (before - after) / (before - 2.0 * here + after);
    let width_hz = spectrum.frequencies_hz.get(1).copied().unwrap_or_default();
    Peak {
        frequency_hz: spectrum.frequencies_hz[index] + shift * width_hz,
        amplitude: libm::exp(here - 0.25 * (before - after) * shift),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(step_s: f64, count: u32, value: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let times_s = (0..count).map(|index| step_s * f64::from(index));
        let times_s: Vec<f64> = times_s.collect();
        let values = times_s.iter().map(|time_s| value(*time_s)).collect();
        (times_s, values)
    }

    fn assert_peaks(peaks: &[Peak], wanted: &[(f64, f64)]) {
        assert_eq!(peaks.len(), wanted.len(), "{peaks:?}");
        for (peak, (hz, amplitude)) in peaks.iter().zip(wanted) {
            assert!((peak.frequency_hz - hz).abs() < 2e-4, "{peaks:?}");
            // The parabola through three lines of a Hann window is too high by up to 3.8 %, half way between two.
            assert!((peak.amplitude / amplitude - 1.0).abs() < 0.04, "{peaks:?}");
        }
    }

    #[test]
    fn two_sines_on_a_slope_are_found() {
        let (times_s, values) = record(0.1, 2001, |t| {
            3.0 * libm::sin(TAU * 0.1234 * t) + 0.5 * libm::cos(TAU * 0.777 * t) + 40.0 - 0.3 * t
        });
        for points in [1, 4] {
            let spectrum = amplitude_spectrum(&times_s, &values, points).unwrap();
            assert_peaks(&peaks(&spectrum, 0.05), &[(0.1234, 3.0), (0.777, 0.5)]);
        }
    }

    /// Four bins apart: 300 s at 10 Hz.
    #[test]
    fn two_sines_close_together_are_told_apart() {
        let (times_s, values) = record(0.1, 3000, |t| {
            2.0 * libm::sin(TAU * 0.1894 * t + 0.4) + 0.5 * libm::cos(TAU * 0.2031 * t) - 0.02 * t
        });
        let spectrum = amplitude_spectrum(&times_s, &values, 4).unwrap();
        let found = peaks(&spectrum, 0.1);
        assert_peaks(&found, &[(0.1894, 2.0), (0.2031, 0.5)]);
        assert_eq!(peak_near(&spectrum, 0.21, 0.1), Some(found[1]));
    }

    #[test]
    fn uneven_times_have_no_spectrum() {
        let times_s: Vec<f64> = (0..100).map(|index| f64::from(index * index)).collect();
        assert!(amplitude_spectrum(&times_s, &times_s, 1).is_none());
    }
}
