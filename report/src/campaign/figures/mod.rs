//! The figures of a campaign, and of a design search.

pub(super) mod convergence;
pub(super) mod covariance_ellipse;
pub(super) mod envelope;
pub(super) mod histogram;
pub(super) mod search;
pub(super) mod tornado;

use aerobot_engine::campaign::quantity::unit_symbol;

/// A name in a table as the label of an axis, its unit in brackets: `swing largest [rad]`.
pub(super) fn axis_label(name: &str, unit: &str) -> String {
    let plain = name.strip_suffix(&format!("_{unit}")).unwrap_or(name);
    let words = plain.replace('_', " ");
    match unit {
        "" => words,
        unit => format!("{words} [{}]", unit_symbol(unit)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_units_in_brackets() {
        assert_eq!(axis_label("drift_m_s", "m_s"), "drift [m/s]");
        assert_eq!(axis_label("phase_at_end", ""), "phase at end");
    }
}
