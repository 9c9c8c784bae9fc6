//! Amplitude spectra of records at even times.

use std::f64::consts::TAU;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Fewer samples than this have no spectrum to look at.
const LEAST: usize = 16;
/// Times are even to this part of their step.
const EVEN: f64 = 1e-6;

/// Amplitudes at the frequencies k / T.
#[derive(Clone, Debug, PartialEq)]
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
    /// Amplitude in its bin.
    pub amplitude: f64,
}

impl Spectrum {
    /// The largest amplitude.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let amplitudes = self.amplitudes.iter().skip(1);
        amplitudes.fold(0.0, |most: f64, amplitude| most.max(*amplitude))
    }
}

/// The amplitude spectrum under a Hann window, the straight line of least squares taken off; nothing if there
/// are too few samples or their times are not even. A last sample off the grid is left out.
#[must_use]
pub fn amplitude_spectrum(times_s: &[f64], values: &[f64]) -> Option<Spectrum> {
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
    FftPlanner::new()
        .plan_fft_forward(count)
        .process(&mut record);
    // The window lets half of an amplitude through, and a sine has two lines.
    let scale = 4.0 / count as f64;
    let half = count / 2 + 1;
    Some(Spectrum {
        frequencies_hz: (0..half)
            .map(|index| index as f64 / (count as f64 * step_s))
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

/// Peaks, the largest first: bins that are larger than the two on either side and a fiftieth of the largest,
/// placed by the parabola through the logarithms of three.
#[must_use]
pub fn peaks(spectrum: &Spectrum) -> Vec<Peak> {
    let amplitudes = &spectrum.amplitudes;
    let least = spectrum.largest() / 50.0;
    let width_hz = spectrum.frequencies_hz.get(1).copied().unwrap_or_default();
    let mut found: Vec<Peak> = (2..amplitudes.len().saturating_sub(2))
        .filter(|index| {
            let here = amplitudes[*index];
            let beside = [index - 2, index - 1, index + 1, index + 2];
            here > least && beside.iter().all(|other| amplitudes[*other] < here)
        })
        .map(|index| {
            let log = |index: usize| libm::log(amplitudes[index].max(f64::MIN_POSITIVE));
            let (before, here, after) = (log(index - 1), log(index), log(index + 1));
            let shift = 0.5 * (before - after) / (before - 2.0 * here + after);
            Peak {
                frequency_hz: spectrum.frequencies_hz[index] + shift * width_hz,
                amplitude: amplitudes[index],
            }
        })
        .collect();
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_sines_on_a_slope_are_found() {
        let times_s: Vec<f64> = (0..2001).map(|index| 0.1 * f64::from(index)).collect();
        let value = |t: f64| {
            3.0 * libm::sin(TAU * 0.1234 * t) + 0.5 * libm::cos(TAU * 0.777 * t) + 40.0 - 0.3 * t
        };
        let values: Vec<f64> = times_s.iter().map(|t| value(*t)).collect();
        let spectrum = amplitude_spectrum(&times_s, &values).unwrap();
        let peaks = peaks(&spectrum);
        assert_eq!(peaks.len(), 2);
        assert!((peaks[0].frequency_hz - 0.1234).abs() < 2e-4);
        assert!((peaks[1].frequency_hz - 0.777).abs() < 2e-4);
        // Between two bins a Hann window shows at least 85 % of an amplitude.
        assert!((0.84 * 3.0..3.01).contains(&peaks[0].amplitude));
        assert!((0.84 * 0.5..0.51).contains(&peaks[1].amplitude));
    }

    #[test]
    fn uneven_times_have_no_spectrum() {
        let times_s: Vec<f64> = (0..100).map(|index| f64::from(index * index)).collect();
        assert!(amplitude_spectrum(&times_s, &times_s).is_none());
    }
}
