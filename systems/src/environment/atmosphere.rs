//! The air at an altitude: density and its slope, pressure, temperature, viscosity.
//!
//! ```text
//! vacuum                    rho = 0
//! uniform                   rho = rho0
//! exponential               rho = rho0 exp(-(z - z0) / H),   d rho / dz = -rho / H
//! table                     see atmosphere_table.rs
//! standard atmosphere 1976  see standard_atmosphere_1976.rs
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | rho | density | kg/m3 |
//! | rho0, z0 | density at the altitude z0 | kg/m3, m |
//! | H | scale height | m |
//!
//! Sources: the exponential is the isothermal atmosphere, e.g. U.S. Standard Atmosphere (1976),
//! equation 33b; the others are named in their files.
//!
//! Assumptions: the air does not change along the horizontal or with time. Vacuum, uniform and
//! exponential have no bounds (altitudes are finite all the same) and no pressure of their own;
//! they have a viscosity where a temperature is given.

use super::atmosphere_table::AtmosphereTable;
use super::standard_atmosphere_1976::{self as standard, Air};
use super::viscosity::Gas;
use thiserror::Error;

/// An altitude outside the atmosphere, or one that is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "altitude {altitude_m} m is outside the atmosphere, which is known from {lowest_m} m to \
     {highest_m} m"
)]
pub struct OutsideAtmosphere {
    /// The altitude asked for, m.
    pub altitude_m: f64,
    /// The lowest altitude of the atmosphere, m; -inf where it has none.
    pub lowest_m: f64,
    /// The highest altitude of the atmosphere, m; inf where it has none.
    pub highest_m: f64,
}

/// A model of the air over altitude. Numbers are finite, densities, temperatures and scale heights
/// positive: whoever builds one from a file checks that.
#[derive(Debug, Clone, PartialEq)]
pub enum Atmosphere {
    /// No air: density and pressure zero.
    Vacuum,
    /// The same everywhere.
    Uniform {
        /// Density, kg/m3.
        density_kg_m3: f64,
        /// Temperature, K, if known.
        temperature_k: Option<f64>,
        /// The gas, which sets the viscosity.
        gas: Gas,
    },
    /// Density falling exponentially, temperature the same everywhere.
    Exponential {
        /// Density at `altitude_m`, kg/m3.
        density_kg_m3: f64,
        /// Altitude of `density_kg_m3`, m.
        altitude_m: f64,
        /// Altitude over which density falls by a factor e, m.
        scale_height_m: f64,
        /// Temperature, K, if known.
        temperature_k: Option<f64>,
        /// The gas, which sets the viscosity.
        gas: Gas,
    },
    /// Rows over altitude.
    Table(AtmosphereTable),
    /// The Earth's air, -5 to 86 km.
    StandardAtmosphere1976,
}

impl Atmosphere {
    /// The Venus International Reference Atmosphere, 0-30 degrees, 0-100 km.
    pub fn vira() -> Self {
        Self::Table(AtmosphereTable::vira())
    }

    /// Density (kg/m3) at an altitude (m).
    ///
    /// # Errors
    /// The altitude is outside the atmosphere, or not finite.
    #[inline]
    pub fn density_kg_m3(&self, altitude_m: f64) -> Result<f64, OutsideAtmosphere> {
        let density = match self {
            Self::Table(table) => table.density_kg_m3(altitude_m),
            Self::Uniform { density_kg_m3, .. } => finite(altitude_m, *density_kg_m3),
            Self::Exponential { .. } => self.exponential(altitude_m).map(|(density, _)| density),
            Self::StandardAtmosphere1976 => standard::air(altitude_m).map(|air| air.density_kg_m3),
            Self::Vacuum => finite(altitude_m, 0.0),
        };
        density.ok_or_else(|| self.outside(altitude_m))
    }

    /// Slope of the density over altitude, d rho / dz (kg/m3 per m), at an altitude (m).
    ///
    /// # Errors
    /// The altitude is outside the atmosphere, or not finite.
    #[inline]
    pub fn density_slope(&self, altitude_m: f64) -> Result<f64, OutsideAtmosphere> {
        let slope = match self {
            Self::Table(table) => table.density_slope(altitude_m),
            Self::Uniform { .. } | Self::Vacuum => finite(altitude_m, 0.0),
            Self::Exponential { .. } => self.exponential(altitude_m).map(|(_, slope)| slope),
            Self::StandardAtmosphere1976 => {
                standard::air(altitude_m).map(|air| air.density_slope_kg_m4)
            }
        };
        slope.ok_or_else(|| self.outside(altitude_m))
    }

    /// Pressure (Pa) at an altitude (m); `None` where the model has none: a uniform or an
    /// exponential atmosphere, and a table without that column.
    ///
    /// # Errors
    /// The altitude is outside the atmosphere, or not finite.
    #[inline]
    pub fn pressure_pa(&self, altitude_m: f64) -> Result<Option<f64>, OutsideAtmosphere> {
        let pressure = match self {
            Self::Table(table) => table.pressure_pa(altitude_m),
            Self::Uniform { .. } | Self::Exponential { .. } => finite(altitude_m, None),
            Self::StandardAtmosphere1976 => {
                standard::air(altitude_m).map(|air| Some(air.pressure_pa))
            }
            Self::Vacuum => finite(altitude_m, Some(0.0)),
        };
        pressure.ok_or_else(|| self.outside(altitude_m))
    }

    /// Temperature (K) at an altitude (m); `None` where the model has none: vacuum, a uniform or
    /// an exponential atmosphere without one, and a table without that column.
    ///
    /// # Errors
    /// The altitude is outside the atmosphere, or not finite.
    #[inline]
    pub fn temperature_k(&self, altitude_m: f64) -> Result<Option<f64>, OutsideAtmosphere> {
        let temperature = match self {
            Self::Table(table) => table.temperature_k(altitude_m),
            Self::Uniform { temperature_k, .. } | Self::Exponential { temperature_k, .. } => {
                finite(altitude_m, *temperature_k)
            }
            Self::StandardAtmosphere1976 => {
                standard::air(altitude_m).map(|Air { temperature_k, .. }| Some(temperature_k))
            }
            Self::Vacuum => finite(altitude_m, None),
        };
        temperature.ok_or_else(|| self.outside(altitude_m))
    }

    /// Dynamic viscosity (Pa s) at an altitude (m); `None` where there is no temperature.
    ///
    /// # Errors
    /// The altitude is outside the atmosphere, or not finite.
    #[inline]
    pub fn viscosity_pa_s(&self, altitude_m: f64) -> Result<Option<f64>, OutsideAtmosphere> {
        let gas = match self {
            Self::Table(table) => table.gas(),
            Self::Uniform { gas, .. } | Self::Exponential { gas, .. } => *gas,
            Self::StandardAtmosphere1976 | Self::Vacuum => Gas::Air,
        };
        let temperature_k = self.temperature_k(altitude_m)?;
        Ok(temperature_k.map(|temperature_k| gas.viscosity_pa_s(temperature_k)))
    }

    /// Lowest and highest altitude (m) of the model; infinite where it has no bounds.
    pub fn bounds_m(&self) -> (f64, f64) {
        match self {
            Self::Table(table) => (table.lowest_m(), table.highest_m()),
            Self::StandardAtmosphere1976 => (standard::LOWEST_M, standard::HIGHEST_M),
            Self::Vacuum | Self::Uniform { .. } | Self::Exponential { .. } => {
                (f64::NEG_INFINITY, f64::INFINITY)
            }
        }
    }

    /// Density and slope of the exponential model; `None` for the others.
    #[inline]
    fn exponential(&self, z_m: f64) -> Option<(f64, f64)> {
        let &Self::Exponential {
            density_kg_m3,
            altitude_m,
            scale_height_m,
            ..
        } = self
        else {
            return None;
        };
        let density = density_kg_m3 * libm::exp(-(z_m - altitude_m) / scale_height_m);
        finite(z_m, (density, -density / scale_height_m))
    }

    #[cold]
    fn outside(&self, altitude_m: f64) -> OutsideAtmosphere {
        let (lowest_m, highest_m) = self.bounds_m();
        OutsideAtmosphere {
            altitude_m,
            lowest_m,
            highest_m,
        }
    }
}

/// `value` at a finite altitude, `None` otherwise.
#[inline]
fn finite<T>(altitude_m: f64, value: T) -> Option<T> {
    altitude_m.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exponential() -> Atmosphere {
        Atmosphere::Exponential {
            density_kg_m3: 0.8183,
            altitude_m: 56_000.0,
            scale_height_m: 8_200.0,
            temperature_k: Some(250.0),
            gas: Gas::CarbonDioxide,
        }
    }

    fn uniform(temperature_k: Option<f64>) -> Atmosphere {
        Atmosphere::Uniform {
            density_kg_m3: 1.2,
            temperature_k,
            gas: Gas::Air,
        }
    }

    #[test]
    fn the_exponential_falls_by_e_over_a_scale_height() {
        let air = exponential();
        assert_eq!(air.density_kg_m3(56_000.0), Ok(0.8183));
        let higher = air.density_kg_m3(64_200.0).unwrap();
        assert!((higher * std::f64::consts::E / 0.8183 - 1.0).abs() < 1e-15);
        assert!((air.density_slope(64_200.0).unwrap() * 8_200.0 / higher + 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_density_in_every_model() {
        for air in [
            Atmosphere::Vacuum,
            uniform(None),
            exponential(),
            Atmosphere::vira(),
            Atmosphere::StandardAtmosphere1976,
        ] {
            for z in [1_234.0, 30_300.0, 56_500.0, 62_700.0, 71_500.0] {
                let density = |z| air.density_kg_m3(z).unwrap();
                let secant = (density(z + 0.5) - density(z - 0.5)) / 1.0;
                let slope = air.density_slope(z).unwrap();
                assert!((secant - slope).abs() <= 1e-6 * slope.abs(), "at {z}");
            }
        }
    }

    #[test]
    fn vira_at_56_km_is_the_row_of_the_table() {
        let air = Atmosphere::vira();
        assert!((air.density_kg_m3(56_000.0).unwrap() - 0.8183).abs() < 1e-15);
        assert!((air.pressure_pa(56_000.0).unwrap().unwrap() - 45_590.0).abs() < 1e-9);
        assert_eq!(air.temperature_k(56_000.0), Ok(Some(291.8)));
        let viscosity = air.viscosity_pa_s(56_000.0).unwrap().unwrap();
        // Reference data: 1.45152e-5 at 290 K, 1.49938e-5 at 300 K.
        assert!((viscosity / (1.45152e-5 + 0.18 * 0.04786e-5) - 1.0).abs() < 2e-3);
    }

    #[test]
    fn what_a_model_does_not_know_is_none() {
        assert_eq!(uniform(None).pressure_pa(0.0), Ok(None));
        assert_eq!(uniform(None).viscosity_pa_s(0.0), Ok(None));
        let viscosity = uniform(Some(288.15)).viscosity_pa_s(0.0).unwrap().unwrap();
        assert!((viscosity / 1.7894e-5 - 1.0).abs() < 3e-5);
        assert_eq!(Atmosphere::Vacuum.viscosity_pa_s(0.0), Ok(None));
        assert_eq!(Atmosphere::Vacuum.pressure_pa(0.0), Ok(Some(0.0)));
        let sea_level = Atmosphere::StandardAtmosphere1976;
        let viscosity = sea_level.viscosity_pa_s(0.0).unwrap().unwrap();
        assert!((viscosity / 1.7894e-5 - 1.0).abs() < 3e-5);
    }

    #[test]
    fn outside_is_an_error_that_says_the_bounds() {
        let error = Atmosphere::vira().density_kg_m3(100_001.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "altitude 100001 m is outside the atmosphere, which is known from 0 m to 100000 m"
        );
        let air = Atmosphere::StandardAtmosphere1976;
        assert_eq!(air.density_slope(86_001.0).unwrap_err().highest_m, 86_000.0);
        assert!(air.temperature_k(-5_001.0).is_err());
        assert!(Atmosphere::vira().pressure_pa(-0.1).is_err());
        assert!(Atmosphere::vira().viscosity_pa_s(-0.1).is_err());
    }

    #[test]
    fn nan_is_outside_every_model() {
        for air in [
            Atmosphere::Vacuum,
            uniform(None),
            exponential(),
            Atmosphere::vira(),
            Atmosphere::StandardAtmosphere1976,
        ] {
            assert!(air.density_kg_m3(f64::NAN).is_err());
            assert!(air.density_slope(f64::NAN).is_err());
            assert!(air.pressure_pa(f64::NAN).is_err());
            assert!(air.viscosity_pa_s(f64::NAN).is_err());
            assert!(air.density_kg_m3(f64::INFINITY).is_err());
        }
    }
}
