//! U.S. Standard Atmosphere (1976): the Earth's air from -5 to 86 km.
//!
//! ```text
//! H = r0 Z / (r0 + Z)
//! T = T_b + L_b (H - H_b)
//! p = p_b (T_b / T)^(c / L_b)          where L_b != 0
//!   = p_b exp(-c (H - H_b) / T_b)      where L_b = 0
//! rho = p M0 / (R* T),                 c = g0 M0 / R*
//! d rho / dZ = -rho (c + L_b) / T (r0 / (r0 + Z))^2
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | Z, H | geometric and geopotential altitude above sea level | m |
//! | r0 | radius of the Earth, 6356766 | m |
//! | `H_b`, `T_b`, `L_b`, `p_b` | base, temperature, lapse rate and pressure of a layer | m, K, K/m, Pa |
//! | g0 | gravity, 9.80665 | m/s2 |
//! | M0, R* | molar mass 28.9644, gas constant 8314.32 | kg/kmol, J/(kmol K) |
//!
//! Source: U.S. Standard Atmosphere (1976), NOAA, NASA and USAF, equations 18, 23, 33 and 42,
//! table 4. The pressures of the bases are computed from 101325 Pa at sea level with the same
//! equations in 40 digits, so that layers join without a step.
//!
//! Assumptions: T is the molecular-scale temperature, which exceeds the kinetic one by 0.04 % at
//! most, above 80 km; density and pressure do not depend on the difference. The lowest layer is
//! continued below sea level. Density is continuous at the bases of layers, its slope is not.

/// The lowest geometric altitude, m.
pub const LOWEST_M: f64 = -5_000.0;
/// The highest geometric altitude, m.
pub const HIGHEST_M: f64 = 86_000.0;

const EARTH_RADIUS_M: f64 = 6_356_766.0;
const MOLAR_MASS_KG_KMOL: f64 = 28.9644;
const GAS_CONSTANT_J_KMOL_K: f64 = 8_314.32;
/// c = g0 M0 / R*, K/m.
const HYDROSTATIC_K_M: f64 = 9.80665 * MOLAR_MASS_KG_KMOL / GAS_CONSTANT_J_KMOL_K;

struct Layer {
    base_m: f64,
    temperature_k: f64,
    lapse_k_m: f64,
    pressure_pa: f64,
}

const fn layer(base_m: f64, temperature_k: f64, lapse_k_m: f64, pressure_pa: f64) -> Layer {
    Layer {
        base_m,
        temperature_k,
        lapse_k_m,
        pressure_pa,
    }
}

const LAYERS: [Layer; 7] = [
    layer(0.0, 288.15, -0.0065, 101_325.0),
    layer(11_000.0, 216.65, 0.0, 22_632.063_973_462_93),
    layer(20_000.0, 216.65, 0.001, 5_474.888_669_677_78),
    layer(32_000.0, 228.65, 0.0028, 868.018_684_755_227_4),
    layer(47_000.0, 270.65, 0.0, 110.906_305_554_965_88),
    layer(51_000.0, 270.65, -0.0028, 66.938_873_118_687_27),
    layer(71_000.0, 214.65, -0.002, 3.956_420_428_040_728_7),
];

/// The air at one altitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Slope of the density over geometric altitude, kg/m3 per m.
    pub density_slope_kg_m4: f64,
    /// Pressure, Pa.
    pub pressure_pa: f64,
    /// Temperature, K.
    pub temperature_k: f64,
}

/// The air at a geometric altitude (m); `None` outside [`LOWEST_M`] to [`HIGHEST_M`] and for NaN.
#[inline]
pub fn air(altitude_m: f64) -> Option<Air> {
    if !(LOWEST_M..=HIGHEST_M).contains(&altitude_m) {
        return None;
    }
    let geopotential_m = geopotential_altitude_m(altitude_m);
    let layer = layer_at(geopotential_m);
    let above_base_m = geopotential_m - layer.base_m;
    let temperature_k = layer.temperature_k + layer.lapse_k_m * above_base_m;
    let pressure_pa = if layer.lapse_k_m == 0.0 {
        layer.pressure_pa * libm::exp(-HYDROSTATIC_K_M * above_base_m / layer.temperature_k)
    } else {
        let ratio = layer.temperature_k / temperature_k;
        layer.pressure_pa * libm::pow(ratio, HYDROSTATIC_K_M / layer.lapse_k_m)
    };
    let density_kg_m3 = pressure_pa * MOLAR_MASS_KG_KMOL / (GAS_CONSTANT_J_KMOL_K * temperature_k);
    let shrink = EARTH_RADIUS_M / (EARTH_RADIUS_M + altitude_m);
    let relative_slope = -(HYDROSTATIC_K_M + layer.lapse_k_m) / temperature_k * shrink * shrink;
    Some(Air {
        density_kg_m3,
        density_slope_kg_m4: density_kg_m3 * relative_slope,
        pressure_pa,
        temperature_k,
    })
}

/// Geopotential altitude (m) of a geometric one (m).
#[inline]
pub fn geopotential_altitude_m(geometric_m: f64) -> f64 {
    EARTH_RADIUS_M * geometric_m / (EARTH_RADIUS_M + geometric_m)
}

/// Geometric altitude (m) of a geopotential one (m).
#[inline]
pub fn geometric_altitude_m(geopotential_m: f64) -> f64 {
    EARTH_RADIUS_M * geopotential_m / (EARTH_RADIUS_M - geopotential_m)
}

#[inline]
fn layer_at(geopotential_m: f64) -> &'static Layer {
    LAYERS
        .iter()
        .rev()
        .find(|layer| geopotential_m >= layer.base_m)
        .unwrap_or(&LAYERS[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_geopotential(altitude_m: f64) -> Air {
        air(geometric_altitude_m(altitude_m)).unwrap()
    }

    fn assert_close(value: f64, expected: f64, relative: f64) {
        assert!(
            (value / expected - 1.0).abs() < relative,
            "{value}, expected {expected}"
        );
    }

    /// Published values, to the digits printed: geopotential altitude, temperature, pressure.
    #[test]
    fn agrees_with_the_published_bases_of_layers() {
        for (altitude_m, temperature_k, pressure_pa) in [
            (0.0, 288.15, 101_325.0),
            (11_000.0, 216.65, 22_632.06),
            (20_000.0, 216.65, 5_474.889),
            (32_000.0, 228.65, 868.0187),
            (47_000.0, 270.65, 110.9063),
            (51_000.0, 270.65, 66.93887),
            (71_000.0, 214.65, 3.956420),
        ] {
            let air = at_geopotential(altitude_m);
            assert_close(air.temperature_k, temperature_k, 1e-12);
            assert_close(air.pressure_pa, pressure_pa, 3e-7);
        }
        assert_close(air(0.0).unwrap().density_kg_m3, 1.2250, 2e-5);
        assert_close(at_geopotential(11_000.0).density_kg_m3, 0.363_918, 2e-6);
    }

    #[test]
    fn layers_join_without_a_step() {
        for upper in &LAYERS[1..] {
            let joint = geometric_altitude_m(upper.base_m);
            let (below, above) = (air(joint - 1e-6).unwrap(), air(joint + 1e-6).unwrap());
            assert_close(below.pressure_pa, above.pressure_pa, 1e-9);
            assert_close(below.density_kg_m3, above.density_kg_m3, 1e-9);
            assert_close(below.temperature_k, above.temperature_k, 1e-9);
        }
    }

    /// dp/dZ = -rho g0 (r0 / (r0 + Z))^2, and the slope of the density is its derivative.
    #[test]
    fn is_hydrostatic_and_its_slope_is_the_derivative() {
        for km in (-4..86).step_by(3) {
            let z = f64::from(km) * 1e3 + 200.0;
            let (middle, low, high) = (
                air(z).unwrap(),
                air(z - 1.0).unwrap(),
                air(z + 1.0).unwrap(),
            );
            let gravity_m_s2 = 9.80665 * (EARTH_RADIUS_M / (EARTH_RADIUS_M + z)).powi(2);
            assert_close(
                (high.pressure_pa - low.pressure_pa) / 2.0,
                -middle.density_kg_m3 * gravity_m_s2,
                1e-6,
            );
            assert_close(
                (high.density_kg_m3 - low.density_kg_m3) / 2.0,
                middle.density_slope_kg_m4,
                1e-6,
            );
        }
    }

    #[test]
    fn is_bounded() {
        assert!(air(LOWEST_M).is_some() && air(HIGHEST_M).is_some());
        for altitude_m in [-5_000.1, 86_000.1, f64::NAN, f64::INFINITY] {
            assert_eq!(air(altitude_m), None);
        }
    }
}
