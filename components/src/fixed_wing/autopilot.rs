//! The autopilot of a fixed-wing drone as a scene writes it: bandwidths, limits, period.

use serde::Deserialize;

use crate::scene_component::FieldReport;

/// Loops with their bandwidths; the gains follow from the aircraft at trim.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "autopilot", default, deny_unknown_fields)]
pub struct AutopilotSpec {
    /// Time between samples, s; commands are held in between.
    pub period_s: f64,
    /// Roll, by the aileron.
    pub roll: LoopSpec,
    /// Course, by roll.
    pub course: LoopSpec,
    /// Pitch, by the elevator.
    pub pitch: LoopSpec,
    /// Altitude, by pitch.
    pub altitude: LoopSpec,
    /// Airspeed, by the throttle.
    pub airspeed: LoopSpec,
    /// Rudder for a rate of yaw, s, through a washout.
    pub yaw_damper: YawDamper,
    /// Largest roll asked for, deg.
    pub roll_limit_deg: f64,
    /// Largest pitch asked for above and below that of trim, deg.
    pub pitch_limit_deg: f64,
    /// Largest rate of climb asked for, m/s.
    pub climb_limit_m_s: f64,
    /// Time over which the autopilot averages the wind that it takes as steady, s.
    pub wind_average_s: f64,
}

/// What a loop is to do: the pair of poles that its gains place.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct LoopSpec {
    /// Natural frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Damping ratio, 0 to 1.
    #[serde(default = "LoopSpec::damping")]
    pub damping: f64,
}

impl LoopSpec {
    fn damping() -> f64 {
        std::f64::consts::FRAC_1_SQRT_2
    }

    const fn of(frequency_rad_s: f64, damping: f64) -> Self {
        Self {
            frequency_rad_s,
            damping,
        }
    }

    fn check(&self, report: &mut FieldReport) {
        report.positive("frequency_rad_s", self.frequency_rad_s);
        if !(self.damping > 0.0 && self.damping < 1.0) {
            report.add(
                "damping",
                format!("`damping` must lie between 0 and 1, it is {}", self.damping),
                "0.7 hardly overshoots",
            );
        }
    }
}

/// The yaw damper: rudder = gain s/(s + washout) r.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct YawDamper {
    /// Gain, s.
    pub gain_s: f64,
    /// Corner of the washout, rad/s: below it a turn is left alone.
    pub washout_rad_s: f64,
}

impl Default for AutopilotSpec {
    fn default() -> Self {
        Self {
            period_s: 0.01,
            roll: LoopSpec::of(20.0, 0.707),
            course: LoopSpec::of(1.0, 0.9),
            pitch: LoopSpec::of(20.0, 0.707),
            altitude: LoopSpec::of(0.6, 0.9),
            airspeed: LoopSpec::of(1.5, 0.9),
            yaw_damper: YawDamper {
                gain_s: 0.2,
                washout_rad_s: 0.45,
            },
            roll_limit_deg: 45.0,
            pitch_limit_deg: 15.0,
            climb_limit_m_s: 4.0,
            wind_average_s: 5.0,
        }
    }
}

impl AutopilotSpec {
    pub(super) fn check(&self, report: &mut FieldReport) {
        report.positive("period_s", self.period_s);
        for (name, of) in [
            ("roll", self.roll),
            ("course", self.course),
            ("pitch", self.pitch),
            ("altitude", self.altitude),
            ("airspeed", self.airspeed),
        ] {
            report.within(name, |report| {
                of.check(report);
                // A loop sees its own samples late by half a period.
                if of.frequency_rad_s * self.period_s > 0.5 {
                    report.add(
                        "frequency_rad_s",
                        format!(
                            "a loop of {} rad/s is too fast for samples every {} s",
                            of.frequency_rad_s, self.period_s
                        ),
                        "the frequency times the period may be 0.5 at most",
                    );
                }
            });
        }
        for (name, one, other_name, other) in [
            ("course", self.course, "roll", self.roll),
            ("airspeed", self.airspeed, "pitch", self.pitch),
            ("altitude", self.altitude, "pitch", self.pitch),
            ("altitude", self.altitude, "airspeed", self.airspeed),
        ] {
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
            if near(one.frequency_rad_s, other.frequency_rad_s) && near(one.damping, other.damping)
            {
                report.add(
                    name,
                    format!("`{name}` and `{other_name}` cannot have the same pair of poles"),
                    "let one of them be slower",
                );
            }
        }
        report.within("yaw_damper", |report| {
            report.non_negative("gain_s", self.yaw_damper.gain_s);
            report.positive("washout_rad_s", self.yaw_damper.washout_rad_s);
        });
        report.positive("climb_limit_m_s", self.climb_limit_m_s);
        report.positive("wind_average_s", self.wind_average_s);
        for (name, degrees) in [
            ("roll_limit_deg", self.roll_limit_deg),
            ("pitch_limit_deg", self.pitch_limit_deg),
        ] {
            if !(degrees > 0.0 && degrees <= 75.0) {
                report.add(
                    name,
                    format!("`{name}` must lie between 0 and 75 deg, it is {degrees}"),
                    "",
                );
            }
        }
    }
}
