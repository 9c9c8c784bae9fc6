//! The environment as a scene describes it: gravity, air and wind.

use glam::DVec3;
use serde::Deserialize;

use crate::gust::GustSpec;
use crate::scene_component::FieldReport;

/// Gravity, air and wind of a scene.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "environment", deny_unknown_fields)]
pub struct Environment {
    /// Gravity; Venus' 8.87 m/s^2, constant, unless said.
    #[serde(default)]
    pub gravity: Gravity,
    /// The air; the Venus International Reference Atmosphere unless said.
    #[serde(default)]
    pub atmosphere: AtmosphereSpec,
    /// The wind: the sum of these; still air where there is none.
    #[serde(default)]
    pub wind: Vec<WindSpec>,
}

impl Environment {
    /// Reports what is wrong with the fields.
    pub fn check(&self, report: &mut FieldReport) {
        report.within("gravity", |report| self.gravity.check(report));
        report.within("atmosphere", |report| self.atmosphere.check(report));
        for (index, wind) in self.wind.iter().enumerate() {
            report.within(&format!("wind.{index}"), |report| wind.check(report));
        }
    }
}

/// The pull of the planet, along -z.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "gravity", deny_unknown_fields)]
pub enum Gravity {
    /// The same everywhere, m/s^2.
    Constant(f64),
    /// g0 (R / (R + z))^2.
    InverseSquare {
        /// g0: the acceleration at altitude zero, m/s^2.
        surface_m_s2: f64,
        /// R: the radius of the planet at altitude zero, m; Venus' 6 051 800 unless given.
        #[serde(default = "Gravity::venus_radius_m")]
        radius_m: f64,
    },
}

impl Default for Gravity {
    fn default() -> Self {
        Self::Constant(8.87)
    }
}

impl Gravity {
    fn venus_radius_m() -> f64 {
        6_051_800.0
    }

    /// Acceleration along -z at an altitude in m, m/s^2.
    #[inline]
    #[must_use]
    pub fn acceleration_m_s2(&self, altitude_m: f64) -> f64 {
        match *self {
            Self::Constant(acceleration) => acceleration,
            Self::InverseSquare {
                surface_m_s2,
                radius_m,
            } => {
                let ratio = radius_m / (radius_m + altitude_m);
                surface_m_s2 * ratio * ratio
            }
        }
    }

    /// Potential energy of a unit mass against altitude zero, J/kg.
    #[must_use]
    pub fn potential_j_kg(&self, altitude_m: f64) -> f64 {
        match *self {
            Self::Constant(acceleration) => acceleration * altitude_m,
            Self::InverseSquare {
                surface_m_s2,
                radius_m,
            } => surface_m_s2 * radius_m * altitude_m / (radius_m + altitude_m),
        }
    }

    fn check(&self, report: &mut FieldReport) {
        match *self {
            Self::Constant(acceleration) => report.non_negative("0", acceleration),
            Self::InverseSquare {
                surface_m_s2,
                radius_m,
            } => {
                report.non_negative("surface_m_s2", surface_m_s2);
                report.positive("radius_m", radius_m);
            }
        }
    }
}

/// The air of a scene.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "atmosphere", deny_unknown_fields)]
pub enum AtmosphereSpec {
    /// The Venus International Reference Atmosphere, latitude 0-30 deg, 0-100 km (Seiff et al. 1985).
    #[default]
    Vira,
    /// No air at all.
    Vacuum,
    /// The same density everywhere.
    Uniform {
        /// Density, kg/m^3.
        density_kg_m3: f64,
        /// Temperature, K: needed where a Reynolds number is.
        #[serde(default)]
        temperature_k: Option<f64>,
        /// Which viscosity it has.
        #[serde(default)]
        gas: GasSpec,
    },
    /// rho = rho_0 exp(-(z - z_0) / H).
    Exponential {
        /// Density rho_0 at `altitude_m`, kg/m^3.
        density_kg_m3: f64,
        /// The altitude z_0, m.
        altitude_m: f64,
        /// Scale height H, m.
        scale_height_m: f64,
        /// Temperature, K: needed where a Reynolds number is.
        #[serde(default)]
        temperature_k: Option<f64>,
        /// Which viscosity it has.
        #[serde(default)]
        gas: GasSpec,
    },
    /// A table from a CSV file beside the scene: `altitude_m`, `density_kg_m3` and, where known,
    /// `temperature_k` and `pressure_pa`.
    Table {
        /// The file, relative to the scene.
        file: String,
        /// Which viscosity it has.
        #[serde(default)]
        gas: GasSpec,
    },
    /// The U.S. Standard Atmosphere of 1976, for test flights on Earth (up to 86 km).
    StandardAtmosphere1976,
}

/// The gas whose viscosity the air has.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "gas")]
pub enum GasSpec {
    /// Carbon dioxide, for Venus.
    #[default]
    CarbonDioxide,
    /// Air, for Earth.
    Air,
}

impl AtmosphereSpec {
    fn check(&self, report: &mut FieldReport) {
        match self {
            Self::Uniform {
                density_kg_m3,
                temperature_k,
                ..
            } => {
                report.non_negative("density_kg_m3", *density_kg_m3);
                if let Some(temperature_k) = temperature_k {
                    report.positive("temperature_k", *temperature_k);
                }
            }
            Self::Exponential {
                density_kg_m3,
                altitude_m,
                scale_height_m,
                temperature_k,
                ..
            } => {
                report.non_negative("density_kg_m3", *density_kg_m3);
                report.finite("altitude_m", *altitude_m);
                report.positive("scale_height_m", *scale_height_m);
                if let Some(temperature_k) = temperature_k {
                    report.positive("temperature_k", *temperature_k);
                }
            }
            Self::Vira | Self::Vacuum | Self::Table { .. } | Self::StandardAtmosphere1976 => {}
        }
    }
}

/// One source of wind; the wind of a scene is the sum of its sources.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "wind", deny_unknown_fields)]
pub enum WindSpec {
    /// The same everywhere and always.
    Uniform {
        /// Velocity of the air, m/s.
        velocity_m_s: DVec3,
    },
    /// A linear shear that is zero at an altitude.
    Shear {
        /// The altitude at which it is zero, m.
        altitude_m: f64,
        /// Change of speed with altitude, 1/s.
        gradient_per_s: f64,
        /// Direction of the wind; along x unless given.
        #[serde(default = "WindSpec::along_x")]
        direction: DVec3,
    },
    /// A gust that begins and ends at once, on [from, until).
    Step {
        /// Velocity of the air, m/s.
        velocity_m_s: DVec3,
        /// When it begins, s.
        from_s: f64,
        /// When it ends, s.
        until_s: f64,
    },
    /// The built-in zonal wind of Venus against altitude (0-70 km), along x.
    VenusZonal,
    /// A profile over altitude from a CSV file beside the scene: `altitude_m`, `zonal_m_s` and,
    /// where known, `meridional_m_s` and `vertical_m_s`.
    Profile {
        /// The file, relative to the scene.
        file: String,
    },
    /// A stochastic gust.
    Gust(Box<GustSpec>),
}

impl WindSpec {
    fn along_x() -> DVec3 {
        DVec3::X
    }

    fn check(&self, report: &mut FieldReport) {
        match self {
            Self::Uniform { velocity_m_s } => report.finite_vector("velocity_m_s", *velocity_m_s),
            Self::Shear {
                altitude_m,
                gradient_per_s,
                direction,
            } => {
                report.finite("altitude_m", *altitude_m);
                report.finite("gradient_per_s", *gradient_per_s);
                report.finite_vector("direction", *direction);
                if (direction.length() - 1.0).abs() > 1e-6 {
                    let message = format!(
                        "`direction` must have length 1, it has {}",
                        direction.length()
                    );
                    report.add("direction", message, "the default is (1, 0, 0)");
                }
            }
            Self::Step {
                velocity_m_s,
                from_s,
                until_s,
            } => {
                report.finite_vector("velocity_m_s", *velocity_m_s);
                report.finite("from_s", *from_s);
                report.finite("until_s", *until_s);
                if until_s <= from_s {
                    report.add(
                        "until_s",
                        format!(
                            "a gust must end after it begins: {until_s} s is not after {from_s} s"
                        ),
                        "",
                    );
                }
            }
            Self::VenusZonal | Self::Profile { .. } => {}
            Self::Gust(gust) => gust.check(report),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_potential_is_the_integral_of_gravity() {
        let gravity = Gravity::InverseSquare {
            surface_m_s2: 8.87,
            radius_m: 6_051_800.0,
        };
        let (low, high, count) = (50_000.0, 60_000.0, 1000);
        let step = (high - low) / f64::from(count);
        let work: f64 = (0..count)
            .map(|k| gravity.acceleration_m_s2(low + (f64::from(k) + 0.5) * step) * step)
            .sum();
        let difference = gravity.potential_j_kg(high) - gravity.potential_j_kg(low);
        assert!(
            (work - difference).abs() < 1e-8 * difference,
            "{work} {difference}"
        );
    }
}
