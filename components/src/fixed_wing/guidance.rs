//! What a fixed-wing drone is to do, as a scene writes it.

use glam::DVec3;
use serde::Deserialize;

use crate::scene_component::FieldReport;

/// What the drone is to do.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "guidance", deny_unknown_fields)]
pub enum GuidanceSpec {
    /// Nothing: the controls stay where they are at the start.
    #[default]
    None,
    /// Holds a course through the (steady) air, an altitude and an airspeed.
    Hold {
        /// Course through the air, from x towards y, deg.
        course_deg: f64,
        /// Altitude, m.
        altitude_m: f64,
        /// Airspeed, m/s.
        airspeed_m_s: f64,
    },
    /// Follows a straight line that moves with its reference.
    Line {
        /// What the line goes through.
        through: Reference,
        /// Its direction; any length above zero, inertial frame.
        along: DVec3,
        /// Airspeed, m/s.
        airspeed_m_s: f64,
        /// Distance from the line at which it is approached at half the right angle, m.
        #[serde(default = "approach_m")]
        approach_m: f64,
    },
    /// Follows a level circle that moves with its reference.
    Orbit {
        /// Its centre.
        about: Reference,
        /// Its radius, m.
        radius_m: f64,
        /// Whether it is flown clockwise as seen from above.
        #[serde(default)]
        clockwise: bool,
        /// Airspeed, m/s.
        airspeed_m_s: f64,
    },
    /// Pursues a target that moves, to a station beside it or to the target itself.
    Pursue(Pursuit),
}

/// A point that may move.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "reference", deny_unknown_fields)]
pub enum Reference {
    /// A point, with a steady velocity of its own.
    Point {
        /// Where it is at time zero, inertial frame, m.
        position_m: DVec3,
        /// Its velocity, inertial frame, m/s; at rest unless given.
        #[serde(default)]
        velocity_m_s: DVec3,
    },
    /// A body or an anchor of the scene.
    Entity(String),
}

/// Pursuit of a target.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Pursuit {
    /// The body or anchor that is pursued.
    pub target: String,
    /// The station against the target, inertial axes, m.
    #[serde(default)]
    pub offset_m: DVec3,
    /// Distance from the station's line of flight at which it is approached at half the right angle, m.
    #[serde(default = "approach_m")]
    pub approach_m: f64,
    /// Speed gained for a metre behind the station, 1/s.
    #[serde(default = "closing_per_s")]
    pub closing_per_s: f64,
    /// Distance from the station within which the drone has it, m.
    #[serde(default = "station_m")]
    pub station_m: f64,
    /// Airspeeds it may ask for, m/s; what level flight allows unless given.
    #[serde(default)]
    pub airspeeds_m_s: Option<(f64, f64)>,
    /// Time for which the target must have been out of reach before that is said, s.
    #[serde(default = "patience_s")]
    pub patience_s: f64,
    /// The last part of the way, to the target itself; without it the drone stays on station.
    #[serde(default)]
    pub end_game: Option<EndGame>,
}

/// Proportional navigation: an acceleration across the line of sight, N times the closing speed times the
/// rate at which that line turns.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct EndGame {
    /// Distance from the target at which it begins, m.
    pub within_m: f64,
    /// The constant N.
    #[serde(default = "navigation_constant")]
    pub navigation_constant: f64,
    /// Airspeed, m/s.
    pub airspeed_m_s: f64,
}

fn approach_m() -> f64 {
    60.0
}

fn closing_per_s() -> f64 {
    0.15
}

fn station_m() -> f64 {
    2.0
}

fn patience_s() -> f64 {
    10.0
}

fn navigation_constant() -> f64 {
    3.0
}

impl GuidanceSpec {
    /// The entity of the scene that it names, with the field that does.
    #[must_use]
    pub fn names(&self) -> Option<(&'static str, &str)> {
        match self {
            Self::Line {
                through: Reference::Entity(name),
                ..
            } => Some(("through", name)),
            Self::Orbit {
                about: Reference::Entity(name),
                ..
            } => Some(("about", name)),
            Self::Pursue(pursuit) => Some(("target", &pursuit.target)),
            _ => None,
        }
    }

    pub(super) fn check(&self, report: &mut FieldReport) {
        match self {
            Self::None => {}
            Self::Hold {
                course_deg,
                altitude_m,
                airspeed_m_s,
            } => {
                report.finite("course_deg", *course_deg);
                report.finite("altitude_m", *altitude_m);
                report.positive("airspeed_m_s", *airspeed_m_s);
            }
            Self::Line {
                through,
                along,
                airspeed_m_s,
                approach_m,
            } => {
                report.within("through", |report| through.check(report));
                report.positive("airspeed_m_s", *airspeed_m_s);
                report.positive("approach_m", *approach_m);
                let level = along.truncate().length();
                if !(along.is_finite() && level > 0.0) {
                    report.add(
                        "along",
                        "the line needs a direction that is not upright",
                        "",
                    );
                }
            }
            Self::Orbit {
                about,
                radius_m,
                airspeed_m_s,
                ..
            } => {
                report.within("about", |report| about.check(report));
                report.positive("radius_m", *radius_m);
                report.positive("airspeed_m_s", *airspeed_m_s);
            }
            Self::Pursue(pursuit) => pursuit.check(report),
        }
    }
}

impl Reference {
    fn check(&self, report: &mut FieldReport) {
        if let Self::Point {
            position_m,
            velocity_m_s,
        } = self
        {
            report.finite_vector("position_m", *position_m);
            report.finite_vector("velocity_m_s", *velocity_m_s);
        }
    }
}

impl Pursuit {
    fn check(&self, report: &mut FieldReport) {
        report.finite_vector("offset_m", self.offset_m);
        report.positive("approach_m", self.approach_m);
        report.positive("closing_per_s", self.closing_per_s);
        report.positive("station_m", self.station_m);
        report.positive("patience_s", self.patience_s);
        if let Some((least, most)) = self.airspeeds_m_s {
            report.positive("airspeeds_m_s.0", least);
            if !(most.is_finite() && most > least) {
                report.add(
                    "airspeeds_m_s.1",
                    format!("the highest airspeed ({most}) must be above the lowest ({least})"),
                    "",
                );
            }
        }
        if let Some(end_game) = self.end_game {
            report.within("end_game", |report| {
                report.positive("within_m", end_game.within_m);
                report.positive("airspeed_m_s", end_game.airspeed_m_s);
                if !(end_game.navigation_constant > 2.0 && end_game.navigation_constant <= 10.0) {
                    report.add(
                        "navigation_constant",
                        format!(
                            "`navigation_constant` must lie above 2 and not above 10, it is {}",
                            end_game.navigation_constant
                        ),
                        "below 2 the acceleration grows without bound; 3 to 5 is usual",
                    );
                }
            });
        }
    }
}
