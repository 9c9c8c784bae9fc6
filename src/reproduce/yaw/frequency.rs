//! The frequency of a record in two ways: by the times at which it comes back, and by the bins of a
//! discrete Fourier transform.

/// A frequency by upward zero crossings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingFrequency {
    /// Mean frequency between the first and the last crossing, Hz.
    pub hz: f64,
    /// Half the difference between the largest and the smallest frequency of a single period, Hz; zero
    /// with one period.
    pub spread_hz: f64,
    /// Number of whole periods.
    pub periods: usize,
}

/// Part of the largest value that counts as zero.
const ROUND_OFF: f64 = 1e-9;

/// The frequency of a record of (time in s, value) by its upward zero crossings, each on the straight line
/// between its neighbours; nothing where there is no whole period.
///
/// A sine is straight where it is zero: its crossings are moved by less than (omega step)^2/16 of a step,
/// 2e-4 of it with 0.1 s at 0.0857 Hz. A record that starts at zero, but for round-off, and rises starts with
/// a crossing.
#[must_use]
pub fn by_crossings(record: &[(f64, f64)]) -> Option<CrossingFrequency> {
    let largest = record
        .iter()
        .fold(0.0_f64, |most, (_, value)| most.max(value.abs()));
    let zero = ROUND_OFF * largest;
    let crossings: Vec<f64> = record
        .windows(2)
        .filter_map(|pair| match *pair {
            [(before_s, before), (after_s, after)] if before <= zero && after > zero => {
                Some(before_s - before * (after_s - before_s) / (after - before))
            }
            _ => None,
        })
        .collect();
    let periods = crossings.len().checked_sub(1).filter(|count| *count > 0)?;
    let (first, last) = (crossings.first()?, crossings.last()?);
    let single = crossings.windows(2).map(|pair| 1.0 / (pair[1] - pair[0]));
    let (least, most) = single.fold((f64::INFINITY, 0.0_f64), |(least, most), hz| {
        (least.min(hz), most.max(hz))
    });
    Some(CrossingFrequency {
        hz: periods as f64 / (last - first),
        spread_hz: 0.5 * (most - least),
        periods,
    })
}

/// The number of the largest bin above zero of the discrete Fourier transform of equally spaced values:
/// bin k of a record of T seconds stands for k/T Hz. Nothing for fewer than four values.
#[must_use]
pub fn largest_bin(values: &[f64]) -> Option<usize> {
    let count = values.len();
    let power = |bin: usize| {
        let turn = std::f64::consts::TAU * bin as f64 / count as f64;
        let (mut cosine, mut sine) = (0.0, 0.0);
        for (index, value) in values.iter().enumerate() {
            let angle = turn * index as f64;
            cosine += value * libm::cos(angle);
            sine += value * libm::sin(angle);
        }
        cosine * cosine + sine * sine
    };
    let mut largest: Option<(usize, f64)> = None;
    for bin in 1..count / 2 {
        let found = power(bin);
        if largest.is_none_or(|(_, most)| found > most) {
            largest = Some((bin, found));
        }
    }
    largest.map(|(bin, _)| bin)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(hz: f64, phase: f64, until_s: u32) -> Vec<(f64, f64)> {
        let angle = |time: f64| std::f64::consts::TAU * hz * time + phase;
        (0..=10 * until_s)
            .map(|tenth| 0.1 * f64::from(tenth))
            .map(|time| (time, libm::sin(angle(time))))
            .collect()
    }

    #[test]
    fn crossings_tell_the_frequency_of_a_sine() {
        for (hz, phase, periods) in [(0.0857, 0.0, 5), (0.0857, -1.0, 4), (0.0382, 0.3, 1)] {
            let found = by_crossings(&sine(hz, phase, 60));
            let found = found.map(|found| ((found.hz / hz - 1.0).abs() < 1e-6, found.periods));
            assert_eq!(found, Some((true, periods)), "{hz} {phase}");
        }
        assert_eq!(by_crossings(&sine(0.0382, 0.1, 40)), None);
        assert_eq!(by_crossings(&[]), None);
    }

    /// A frequency between the bins shows in the nearest, whatever the mean.
    #[test]
    fn a_sine_stands_in_its_bin() {
        for (hz, bin) in [(2.0 / 15.0, 2), (0.128, 2), (1.0 / 15.0, 1), (0.3, 4)] {
            let record = &sine(hz, 0.4, 15)[..150];
            let values: Vec<f64> = record.iter().map(|(_, value)| value + 3.0).collect();
            let found = largest_bin(&values).unwrap_or(0);
            let near = (hz * 15.0 - found as f64).abs();
            assert!(found == bin || near <= 0.5, "{hz}: {found}");
        }
        assert_eq!(largest_bin(&[1.0, 2.0, 3.0]), None);
    }
}
