//! Units out of the names of channels: `reel_rate_m_s` is a reel rate in m/s.

/// Endings with their units, the longest first.
const UNITS: [(&str, &str); 31] = [
    ("_kg_m2_s", "kg m2/s"),
    ("_kg_m_s", "kg m/s"),
    ("_kg_m3", "kg/m3"),
    ("_n_m_s", "N m s"),
    ("_rad_s2", "rad/s2"),
    ("_rad_m", "rad/m"),
    ("_rad_s", "rad/s"),
    ("_deg_s", "deg/s"),
    ("_m_s2", "m/s2"),
    ("_j_kg", "J/kg"),
    ("_n_m", "N m"),
    ("_n_s", "N s"),
    ("_m_s", "m/s"),
    ("_per_s", "1/s"),
    ("_per_m", "1/m"),
    ("_pa_s", "Pa s"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_m2", "m2"),
    ("_m3", "m3"),
    ("_kg", "kg"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_w", "W"),
    ("_j", "J"),
    ("_k", "K"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_v", "V"),
    ("_a", "A"),
];

/// What a channel shows, in words, and its unit; empty where it has none.
pub(super) fn of_channel(channel: &str) -> (String, &'static str) {
    let found = UNITS
        .into_iter()
        .find(|(ending, _)| channel.len() > ending.len() && channel.ends_with(ending));
    let (name, unit) = match found {
        Some((ending, unit)) => (&channel[..channel.len() - ending.len()], unit),
        None => (channel, ""),
    };
    (name.replace('_', " "), unit)
}

/// The label of an axis that shows a channel: `reel rate [m/s]`.
pub(super) fn label(channel: &str) -> String {
    match of_channel(channel) {
        (name, "") => format!("{name} [1]"),
        (name, unit) => format!("{name} [{unit}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_ending_is_the_unit() {
        assert_eq!(label("reel_rate_m_s"), "reel rate [m/s]");
        assert_eq!(label("momentum_x_kg_m_s"), "momentum x [kg m/s]");
        assert_eq!(label("heading_rad"), "heading [rad]");
        assert_eq!(label("docking_phase"), "docking phase [1]");
        assert_eq!(label("work_j"), "work [J]");
    }
}
