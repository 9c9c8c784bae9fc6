//! An atmosphere as a table over altitude, with a continuous slope of the density.
//!
//! ```text
//! rho(z) = exp(f(z)),   p(z) = exp(g(z)),   T(z) = h(z)
//! d rho / dz = rho f'(z)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | z | altitude | m |
//! | rho, p, T | density, pressure, temperature | kg/m3, Pa, K |
//! | f, g, h | monotone cubics through ln rho, ln p and T of the rows | |
//!
//! Source: [`super::monotone_cubic`] (Fritsch and Butland 1984).
//!
//! Assumptions: between rows density and pressure are close to exponential. Modes and trim need
//! the continuous slope, because working altitudes are often rows.

use std::sync::{Arc, LazyLock};

use super::exponential_cells::ExponentialCells;
use super::knots::{ColumnError, InterpolationError, Knots, check_positive};
use super::monotone_cubic::MonotoneCubic;
use super::vira;
use super::viscosity::Gas;

/// Density over altitude, and where known pressure and temperature, of one gas.
#[derive(Debug, Clone, PartialEq)]
pub struct AtmosphereTable {
    gas: Gas,
    knots: Knots,
    ln_density: MonotoneCubic,
    density: Arc<ExponentialCells>,
    ln_pressure: Option<MonotoneCubic>,
    temperature: Option<MonotoneCubic>,
}

impl AtmosphereTable {
    /// A table of rows: altitude (m, strictly increasing), density (kg/m3), and optionally
    /// pressure (Pa) and temperature (K), all positive.
    ///
    /// # Errors
    /// Names the column and the row of a value that is not finite, not positive or not
    /// increasing, and refuses fewer than two rows and columns of unequal length.
    pub fn new(
        gas: Gas,
        altitude_m: &[f64],
        density_kg_m3: &[f64],
        pressure_pa: Option<&[f64]>,
        temperature_k: Option<&[f64]>,
    ) -> Result<Self, ColumnError> {
        let knots = Knots::new(altitude_m).map_err(|error| error.within("altitude_m"))?;
        let logarithm = |column, values| {
            MonotoneCubic::of_logarithm(&knots, values)
                .map_err(|error: InterpolationError| error.within(column))
        };
        let ln_density = logarithm("density_kg_m3", density_kg_m3)?;
        let ln_pressure = pressure_pa
            .map(|values| logarithm("pressure_pa", values))
            .transpose()?;
        let temperature = temperature_k
            .map(|values| positive(&knots, values))
            .transpose()
            .map_err(|error| error.within("temperature_k"))?;
        Ok(Self {
            gas,
            density: Arc::new(ExponentialCells::new(&knots, &ln_density)),
            knots,
            ln_density,
            ln_pressure,
            temperature,
        })
    }

    /// The Venus International Reference Atmosphere, 0-30 degrees, 0-100 km ([`super::vira`]).
    pub fn vira() -> Self {
        // Many runs of a campaign share it.
        static TABLE: LazyLock<AtmosphereTable> = LazyLock::new(AtmosphereTable::of_vira);
        TABLE.clone()
    }

    fn of_vira() -> Self {
        let column =
            |index: usize| -> Vec<f64> { vira::ROWS.iter().map(|row| row[index]).collect() };
        let knots = Knots::from_checked(column(0));
        let ln_density = MonotoneCubic::of_checked_logarithm(&knots, &column(3));
        Self {
            density: Arc::new(ExponentialCells::new(&knots, &ln_density)),
            gas: Gas::CarbonDioxide,
            temperature: Some(MonotoneCubic::from_checked(&knots, &column(1))),
            ln_pressure: Some(MonotoneCubic::of_checked_logarithm(&knots, &column(2))),
            ln_density,
            knots,
        }
    }

    /// The gas, which sets the viscosity.
    #[inline]
    pub fn gas(&self) -> Gas {
        self.gas
    }

    /// The lowest altitude, m.
    #[inline]
    pub fn lowest_m(&self) -> f64 {
        self.knots.lowest()
    }

    /// The highest altitude, m.
    #[inline]
    pub fn highest_m(&self) -> f64 {
        self.knots.highest()
    }

    /// Density (kg/m3) at an altitude (m); `None` outside the table.
    #[inline]
    pub fn density_kg_m3(&self, altitude_m: f64) -> Option<f64> {
        self.density.value(altitude_m)
    }

    /// Slope of the density (kg/m3 per m) at an altitude (m); `None` outside the table.
    #[inline]
    pub fn density_slope(&self, altitude_m: f64) -> Option<f64> {
        let interval = self.knots.interval(altitude_m)?;
        let density_kg_m3 = self.density.value(altitude_m)?;
        Some(density_kg_m3 * self.ln_density.slope(interval, altitude_m))
    }

    /// Pressure (Pa) at an altitude (m): the outer `None` outside the table, the inner one if the
    /// table has no pressure.
    #[inline]
    pub fn pressure_pa(&self, altitude_m: f64) -> Option<Option<f64>> {
        let interval = self.knots.interval(altitude_m)?;
        let logarithm = self.ln_pressure.as_ref();
        Some(logarithm.map(|cubic| libm::exp(cubic.value(interval, altitude_m))))
    }

    /// Temperature (K) at an altitude (m): the outer `None` outside the table, the inner one if
    /// the table has no temperature.
    #[inline]
    pub fn temperature_k(&self, altitude_m: f64) -> Option<Option<f64>> {
        let interval = self.knots.interval(altitude_m)?;
        let temperature = self.temperature.as_ref();
        Some(temperature.map(|cubic| cubic.value(interval, altitude_m)))
    }
}

fn positive(knots: &Knots, values: &[f64]) -> Result<MonotoneCubic, InterpolationError> {
    let cubic = MonotoneCubic::new(knots, values)?;
    check_positive(values)?;
    Ok(cubic)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `vira()` skips the checks of `new`; here its rows pass them, and give the same table.
    #[test]
    fn the_built_in_table_passes_every_check() {
        let column =
            |index: usize| -> Vec<f64> { vira::ROWS.iter().map(|row| row[index]).collect() };
        let checked = AtmosphereTable::new(
            Gas::CarbonDioxide,
            &column(0),
            &column(3),
            Some(&column(2)),
            Some(&column(1)),
        );
        assert_eq!(checked, Ok(AtmosphereTable::vira()));
    }

    #[test]
    fn rows_are_reproduced() {
        let table = AtmosphereTable::vira();
        for [altitude_m, temperature_k, pressure_pa, density_kg_m3] in vira::ROWS {
            let close = |value: f64, row: f64| (value / row - 1.0).abs() < 1e-14;
            assert!(close(
                table.density_kg_m3(altitude_m).unwrap(),
                density_kg_m3
            ));
            assert!(close(
                table.pressure_pa(altitude_m).unwrap().unwrap(),
                pressure_pa
            ));
            assert!(close(
                table.temperature_k(altitude_m).unwrap().unwrap(),
                temperature_k
            ));
        }
    }

    #[test]
    fn the_slope_of_the_density_is_continuous_and_its_derivative() {
        let table = AtmosphereTable::vira();
        let density = |z: f64| table.density_kg_m3(z).unwrap();
        let slope = |z: f64| table.density_slope(z).unwrap();
        for z in (1..99).map(|km| f64::from(km) * 1e3) {
            let (left, right) = (slope(z - 1e-6), slope(z + 1e-6));
            assert!((left / right - 1.0).abs() < 1e-8, "at the knot {z}");
            // At a knot the second derivative jumps, which a difference sees in first order.
            for (z, tolerance) in [(z, 1e-4), (z + 370.0, 1e-7)] {
                let secant = (density(z + 0.1) - density(z - 0.1)) / 0.2;
                assert!((secant / slope(z) - 1.0).abs() < tolerance, "at {z}");
            }
        }
    }

    #[test]
    fn density_and_pressure_fall_everywhere() {
        let table = AtmosphereTable::vira();
        for z in (0..10_000).map(|k| f64::from(k) * 10.0) {
            assert!(table.density_slope(z).unwrap() < 0.0);
            assert!(table.pressure_pa(z + 10.0).unwrap() < table.pressure_pa(z).unwrap());
        }
    }

    /// dp/dz = -rho g with g = 8.87 m/s2 at the mean radius, falling as 1/r^2 (by 1.6-2.3 % at these
    /// altitudes), and rho = p M / (R T) with 43.45 g/mol.
    #[test]
    fn vira_is_hydrostatic_and_an_ideal_gas_at_45_to_70_km() {
        let table = AtmosphereTable::vira();
        let pressure = |z: f64| table.pressure_pa(z).unwrap().unwrap();
        for z in (450..=700).map(|k| f64::from(k) * 100.0) {
            let gravity_m_s2 = 8.87 * (6_051.8e3 / (6_051.8e3 + z)).powi(2);
            let weight = table.density_kg_m3(z).unwrap() * gravity_m_s2;
            // Over a km, the spacing of the rows: their four digits do not bear a finer slope.
            let rise = (pressure(z - 500.0) - pressure(z + 500.0)) / 1000.0;
            assert!((rise / weight - 1.0).abs() < 0.01, "at {z}");
            assert!((rise / weight * gravity_m_s2 / 8.87 - 1.0).abs() < 0.025);
            let temperature = table.temperature_k(z).unwrap().unwrap();
            let ideal = pressure(z) * 0.04345 / (8.314_462_618 * temperature);
            let error = table.density_kg_m3(z).unwrap() / ideal - 1.0;
            assert!(error.abs() < 0.005, "{error} at {z}");
        }
    }

    #[test]
    fn bad_columns_are_named_with_their_row() {
        let refuse = |z: &[f64], rho: &[f64], p: Option<&[f64]>, t: Option<&[f64]>| {
            let table = AtmosphereTable::new(Gas::Air, z, rho, p, t);
            table.unwrap_err().to_string()
        };
        let good = [1.0, 2.0];
        assert_eq!(
            refuse(&[0.0, 0.0], &good, None, None),
            "altitude_m, row 2: 0 does not exceed 0 of the row before"
        );
        assert_eq!(
            refuse(&good, &[1.0, 0.0], None, None),
            "density_kg_m3, row 2: 0 is not positive"
        );
        assert_eq!(
            refuse(&good, &good, Some(&[1.0]), None),
            "pressure_pa, row 2: 1 values for 2 knots"
        );
        assert_eq!(
            refuse(&good, &good, None, Some(&[-4.0, 5.0])),
            "temperature_k, row 1: -4 is not positive"
        );
    }
}
