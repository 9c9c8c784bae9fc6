//! What happens during a run, as a scene says it: a time or a condition, and what is done then.

use serde::Deserialize;

use crate::scene_component::FieldReport;

/// One entry of `events`: what happens once, at a time or on a condition.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "event", deny_unknown_fields)]
pub struct EventSpec {
    /// When, s from the start of the run; no step crosses it.
    #[serde(default)]
    pub at_s: Option<f64>,
    /// Or the first instant at which this holds.
    #[serde(default)]
    pub when: Option<Condition>,
    /// What is done.
    #[serde(rename = "do")]
    pub action: Action,
}

/// What is waited for. It may hold at the start; then the event happens there.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "when", deny_unknown_fields)]
pub enum Condition {
    /// Some segment of a tether pulls with at least this.
    TensionAbove {
        /// The tether.
        tether: String,
        /// The tension, N.
        tension_n: f64,
    },
    /// A body is at this altitude or below.
    AltitudeBelow {
        /// The body.
        entity: String,
        /// The altitude, m.
        altitude_m: f64,
    },
    /// A body is at this altitude or above.
    AltitudeAbove {
        /// The body.
        entity: String,
        /// The altitude, m.
        altitude_m: f64,
    },
    /// A body moves through the air at least this fast.
    AirspeedAbove {
        /// The body.
        entity: String,
        /// Speed against the wind where the body is, m/s.
        airspeed_m_s: f64,
    },
}

/// What is done.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "do", deny_unknown_fields)]
pub enum Action {
    /// A segment carries nothing from now on: no tension, no drag.
    Cut {
        /// The tether.
        tether: String,
        /// The segment, counted from 1 at `from`, as the tether is at that time.
        #[serde(default = "first")]
        segment: u32,
    },
    /// Every tether is cut in its segment at this body.
    Release {
        /// The body.
        body: String,
    },
    /// The latch of a body opens, and lets it go from what it is docked to.
    Undock {
        /// The body, which has a `Latch`.
        body: String,
    },
    /// A winch pays out or reels in.
    Reel {
        /// The tether, which has a `Winch`.
        tether: String,
        /// Length of unstretched line that leaves the drum in a second, m/s; negative reels in.
        rate_m_s: f64,
        /// Until this much has been paid out or reeled in, m.
        #[serde(default)]
        length_m: Option<f64>,
        /// Or until this time, s from the start of the run.
        #[serde(default)]
        until_s: Option<f64>,
    },
}

fn first() -> u32 {
    1
}

impl EventSpec {
    /// Reports what is wrong with its own fields.
    pub fn check(&self, report: &mut FieldReport) {
        match (&self.at_s, &self.when) {
            (Some(at_s), None) => report.non_negative("at_s", *at_s),
            (None, Some(condition)) => report.within("when", |report| condition.check(report)),
            (None, None) => report.add(
                "",
                "the event has neither a time nor a condition",
                "give `at_s: ..` or `when: ..`",
            ),
            (Some(_), Some(_)) => report.add(
                "when",
                "the event has a time and a condition",
                "keep one of `at_s` and `when`",
            ),
        }
        report.within("do", |report| self.action.check(self.at_s, report));
    }
}

impl Condition {
    fn check(&self, report: &mut FieldReport) {
        match self {
            Self::TensionAbove { tension_n, .. } => report.positive("tension_n", *tension_n),
            Self::AltitudeBelow { altitude_m, .. } | Self::AltitudeAbove { altitude_m, .. } => {
                report.finite("altitude_m", *altitude_m);
            }
            Self::AirspeedAbove { airspeed_m_s, .. } => {
                report.positive("airspeed_m_s", *airspeed_m_s);
            }
        }
    }
}

impl Action {
    fn check(&self, at_s: Option<f64>, report: &mut FieldReport) {
        match self {
            Self::Cut { segment: 0, .. } => report.add(
                "segment",
                "segments count from 1 at `from`, and there is no segment 0",
                "",
            ),
            Self::Cut { .. } | Self::Release { .. } | Self::Undock { .. } => {}
            Self::Reel {
                rate_m_s,
                length_m,
                until_s,
                ..
            } => check_reel(*rate_m_s, (*length_m, *until_s), at_s, report),
        }
    }
}

fn check_reel(
    rate_m_s: f64,
    (length_m, until_s): (Option<f64>, Option<f64>),
    at_s: Option<f64>,
    report: &mut FieldReport,
) {
    if rate_m_s == 0.0 || !rate_m_s.is_finite() {
        report.add(
            "rate_m_s",
            format!("`rate_m_s` must not be zero, it is {rate_m_s}"),
            "positive pays out, negative reels in",
        );
    }
    match (length_m, until_s) {
        (Some(length_m), None) => report.positive("length_m", length_m),
        (None, Some(until_s)) => {
            if at_s.is_some_and(|at_s| until_s <= at_s) {
                report.add(
                    "until_s",
                    format!("the reel is to end at {until_s} s, not after its start"),
                    "",
                );
            }
        }
        _ => report.add(
            "",
            "a reel ends after a length or at a time",
            "give one of `length_m` and `until_s`",
        ),
    }
}
