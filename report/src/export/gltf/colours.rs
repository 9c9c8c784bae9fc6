//! Colours: of roles, and of tensions.

use serde_json::{Value, json};

use crate::animation::appearance::Role;

/// How many colours the tensions of tethers are divided into.
pub(super) const TENSION_COLOURS: usize = 16;

/// Viridis (Smith and van der Walt 2015) at every eighth of its way, sRGB.
const VIRIDIS: [u32; 9] = [
    0x44_01_54, 0x47_2d_7b, 0x3b_52_8b, 0x2c_72_8e, 0x21_91_8c, 0x28_ae_80, 0x5e_c9_62, 0xad_dc_30,
    0xfd_e7_25,
];

/// The material of a role.
pub(super) fn of_role(role: Role) -> Value {
    let (name, colour) = match role {
        Role::Balloon => ("balloon", 0xe8_e2_d4),
        Role::Body => ("body", 0xc9_7b_2d),
        Role::Sail => ("sail", 0x3f_7c_c4),
        Role::Drone => ("drone", 0x8e_44_8f),
        Role::Anchor => ("anchor", 0x5a_5a_5a),
    };
    material(name, &channels(colour))
}

/// The material of tensions in this part of their scale, from 0 to `TENSION_COLOURS` - 1.
pub(super) fn of_tension(part: usize, greatest_n: f64) -> Value {
    let scale = 8.0 * part as f64 / (TENSION_COLOURS - 1) as f64;
    let below = (scale as usize).min(7);
    let [from, to] = [VIRIDIS[below], VIRIDIS[below + 1]].map(channels);
    let way = scale - below as f64;
    let colour: Vec<f64> = from
        .iter()
        .zip(&to)
        .map(|(from, to)| from + way * (to - from))
        .collect();
    let step_n = greatest_n / TENSION_COLOURS as f64;
    let name = format!(
        "largest tension {:.4} to {:.4} N",
        step_n * part as f64,
        step_n * (part + 1) as f64
    );
    material(&name, &colour)
}

/// Which part of the scale from 0 to the greatest tension this one is in.
pub(super) fn part_of(tension_n: f64, greatest_n: f64) -> usize {
    let part = TENSION_COLOURS as f64 * tension_n / greatest_n;
    // What is no number, because nothing is under tension, is zero.
    (part as usize).min(TENSION_COLOURS - 1)
}

fn channels(colour: u32) -> [f64; 3] {
    [16, 8, 0].map(|shift| f64::from(colour >> shift & 0xff) / 255.0)
}

fn material(name: &str, srgb: &[f64]) -> Value {
    let linear = srgb.iter().map(|value| linear(*value) as f32 as f64);
    let colour: Vec<f64> = linear.chain([1.0]).collect();
    json!({
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": colour,
            "metallicFactor": 0.0,
            "roughnessFactor": 0.8,
        },
    })
}

/// Linear light of a value of sRGB (IEC 61966-2-1).
fn linear(value: f64) -> f64 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        libm::pow((value + 0.055) / 1.055, 2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_has_both_ends() {
        assert_eq!(part_of(0.0, 100.0), 0);
        assert_eq!(part_of(-1.0, 100.0), 0);
        assert_eq!(part_of(100.0, 100.0), TENSION_COLOURS - 1);
        assert_eq!(part_of(0.0, 0.0), 0);
        let colour = of_tension(TENSION_COLOURS - 1, 100.0);
        let red = &colour["pbrMetallicRoughness"]["baseColorFactor"][0];
        // 253 / 255 of sRGB, from a table of that function.
        assert!((red.as_f64().unwrap_or(0.0) - 0.98225).abs() < 1e-5);
    }
}
