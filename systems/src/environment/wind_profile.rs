//! Wind as a table over altitude, with a continuous slope.
//!
//! ```text
//! W(z) = (f(z), g(z), h(z)),   dW/dz = (f'(z), g'(z), h'(z))
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | z | altitude | m |
//! | W | velocity of the air in the inertial frame (x zonal, y to its left, z up) | m/s |
//! | f, g, h | monotone cubics through the rows; 0 where a component is not given | m/s |
//!
//! Source: [`super::monotone_cubic`] (Fritsch and Butland 1984).
//!
//! Assumptions: steady, the same along the horizontal; no wind is known outside the rows.

use super::knots::{ColumnError, Knots};
use super::monotone_cubic::MonotoneCubic;
use super::zonal_wind;
use glam::DVec3;

/// Velocity of the air over altitude.
#[derive(Debug, Clone, PartialEq)]
pub struct WindProfile {
    knots: Knots,
    x: MonotoneCubic,
    y: Option<MonotoneCubic>,
    z: Option<MonotoneCubic>,
}

impl WindProfile {
    /// A profile of rows: altitude (m, strictly increasing), velocity along x (m/s), and
    /// optionally along y and z (m/s).
    ///
    /// # Errors
    /// Names the column and the row of a value that is not finite or not increasing, and refuses
    /// fewer than two rows and columns of unequal length.
    pub fn new(
        altitude_m: &[f64],
        x_m_s: &[f64],
        y_m_s: Option<&[f64]>,
        z_m_s: Option<&[f64]>,
    ) -> Result<Self, ColumnError> {
        let knots = Knots::new(altitude_m).map_err(|error| error.within("altitude_m"))?;
        let cubic = |column, values| {
            MonotoneCubic::new(&knots, values).map_err(|error| error.within(column))
        };
        let x = cubic("zonal_m_s", x_m_s)?;
        let y = y_m_s.map(|y| cubic("meridional_m_s", y)).transpose()?;
        let z = z_m_s.map(|z| cubic("vertical_m_s", z)).transpose()?;
        Ok(Self { knots, x, y, z })
    }

    /// The zonal wind of Venus near the equator, 0-70 km ([`super::zonal_wind`]).
    pub fn venus_zonal() -> Self {
        let column =
            |index: usize| -> Vec<f64> { zonal_wind::ROWS.iter().map(|row| row[index]).collect() };
        let knots = Knots::from_checked(column(0));
        Self {
            x: MonotoneCubic::from_checked(&knots, &column(1)),
            y: None,
            z: None,
            knots,
        }
    }

    /// The same profile, `factor` times as strong.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            knots: self.knots.clone(),
            x: self.x.scaled(factor),
            y: self.y.as_ref().map(|y| y.scaled(factor)),
            z: self.z.as_ref().map(|z| z.scaled(factor)),
        }
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

    /// Velocity of the air (m/s, inertial frame) at an altitude (m); `None` outside the rows.
    #[inline]
    pub fn velocity_m_s(&self, altitude_m: f64) -> Option<DVec3> {
        self.components(altitude_m, MonotoneCubic::value)
    }

    /// Slope of the velocity over altitude (1/s) at an altitude (m); `None` outside the rows.
    #[inline]
    pub fn slope_per_s(&self, altitude_m: f64) -> Option<DVec3> {
        self.components(altitude_m, MonotoneCubic::slope)
    }

    #[inline]
    fn components(
        &self,
        altitude_m: f64,
        of: impl Fn(&MonotoneCubic, usize, f64) -> f64,
    ) -> Option<DVec3> {
        let interval = self.knots.interval(altitude_m)?;
        let optional = |cubic: &Option<MonotoneCubic>| match cubic {
            Some(cubic) => of(cubic, interval, altitude_m),
            None => 0.0,
        };
        Some(DVec3::new(
            of(&self.x, interval, altitude_m),
            optional(&self.y),
            optional(&self.z),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `venus_zonal()` skips the checks of `new`; here its rows pass them.
    #[test]
    fn the_built_in_profile_passes_every_check_and_its_rows_are_reproduced() {
        let column =
            |index: usize| -> Vec<f64> { zonal_wind::ROWS.iter().map(|row| row[index]).collect() };
        let profile = WindProfile::new(&column(0), &column(1), None, None).unwrap();
        assert_eq!(profile, WindProfile::venus_zonal());
        for [altitude_m, zonal_m_s] in zonal_wind::ROWS {
            let velocity = profile.velocity_m_s(altitude_m).unwrap();
            assert!((velocity - DVec3::new(zonal_m_s, 0.0, 0.0)).length() < 1e-12);
        }
        let at_54_km = profile.velocity_m_s(54_000.0).unwrap().x;
        assert!((57.0..60.0).contains(&at_54_km), "{at_54_km}");
    }

    #[test]
    fn the_slope_is_continuous_and_the_derivative() {
        let profile = WindProfile::venus_zonal();
        let velocity = |z: f64| profile.velocity_m_s(z).unwrap();
        let slope = |z: f64| profile.slope_per_s(z).unwrap();
        for z in (1..14).map(|k| f64::from(k) * 5e3) {
            assert!((slope(z - 1e-6) - slope(z + 1e-6)).length() < 1e-10);
            for z in [z, z + 1_700.0] {
                let secant = (velocity(z + 0.5) - velocity(z - 0.5)) / 1.0;
                assert!((secant - slope(z)).length() < 1e-6, "at {z}");
            }
        }
    }

    #[test]
    fn all_three_components_are_kept_apart() {
        let profile = WindProfile::new(
            &[0.0, 10.0],
            &[1.0, 2.0],
            Some(&[3.0, 5.0]),
            Some(&[0.0, -4.0]),
        )
        .unwrap();
        let halfway = profile.velocity_m_s(5.0).unwrap();
        assert!((halfway - DVec3::new(1.5, 4.0, -2.0)).length() < 1e-15);
        let error = WindProfile::new(&[0.0, 10.0], &[1.0, 2.0], Some(&[1.0, f64::NAN]), None);
        assert_eq!(
            error.unwrap_err().to_string(),
            "meridional_m_s, row 2: NaN is not a finite number"
        );
    }

    #[test]
    fn outside_there_is_no_wind() {
        let profile = WindProfile::venus_zonal();
        for z in [-1.0, 70_000.1, f64::NAN] {
            assert_eq!(profile.velocity_m_s(z), None);
        }
    }
}
