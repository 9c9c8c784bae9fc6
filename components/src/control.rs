//! Controllers and schedules: what commands an actuator.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};

/// Name of an entity and of an actuator of it: `("sail", "rudder")`.
pub type ActuatorName = (String, String);

/// Commands of an actuator over time.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Schedule {
    /// The actuator.
    pub actuator: ActuatorName,
    /// Its commands.
    pub commands: Commands,
}

/// Commands over time, in the unit of the actuator.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "commands")]
pub enum Commands {
    /// Each (time in s, command) holds from its time on; zero before the first.
    Steps(Vec<(f64, f64)>),
    /// Straight lines between (time in s, command), the first and the last held before and after. Two at one
    /// time are a step.
    Ramps(Vec<(f64, f64)>),
}

impl Commands {
    /// The points (time in s, command).
    #[must_use]
    pub fn points(&self) -> &[(f64, f64)] {
        match self {
            Self::Steps(points) | Self::Ramps(points) => points,
        }
    }
}

impl SceneComponent for Schedule {
    const NAME: &'static str = "Schedule";
    const EXCLUDES: &'static [&'static str] = &["Controller"];

    fn check(&self, report: &mut FieldReport) {
        let points = self.commands.points();
        if points.is_empty() {
            report.add(
                "commands",
                "a schedule needs a command",
                "such as `Steps([(10, 0.0175), (50, 0)])`: (time in s, command)",
            );
        }
        for (index, (time_s, command)) in points.iter().enumerate() {
            report.finite(&format!("commands.0.{index}.0"), *time_s);
            report.finite(&format!("commands.0.{index}.1"), *command);
        }
        let backwards = points.windows(2).position(|pair| pair[1].0 < pair[0].0);
        if let Some(index) = backwards {
            report.add(
                &format!("commands.0.{}.0", index + 1),
                "the times of a schedule must not go back",
                "",
            );
        }
    }
}

/// A controller: at every multiple of its period it measures, and commands an actuator until the next.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// The actuator.
    pub actuator: ActuatorName,
    /// Time between samples, s.
    pub period_s: f64,
    /// What it makes of what it measures.
    pub law: Law,
    /// Least and largest command, in the unit of the actuator; the actuator's own limits hold in any case.
    #[serde(default)]
    pub saturation: Option<(f64, f64)>,
    /// Largest change of the command, per second.
    #[serde(default)]
    pub rate_limit_per_s: Option<f64>,
}

/// Law of a controller. An error is always target less measured; gains are in units of the actuator per unit of
/// what is measured.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "law", deny_unknown_fields)]
pub enum Law {
    /// u = gain x error (paper, eq. 6).
    Proportional {
        /// What is measured.
        measured: Quantity,
        /// What it should be.
        target: f64,
        /// Command for each unit of the error.
        gain: f64,
    },
    /// u = proportional e + integral of (integral e) + derivative x filtered de/dt.
    Pid {
        /// What is measured.
        measured: Quantity,
        /// What it should be.
        target: f64,
        /// Command for each unit of the error.
        proportional: f64,
        /// Rate of the command for each unit of the error, per second.
        #[serde(default)]
        integral_per_s: f64,
        /// Command for each unit per second of the error's rate, s.
        #[serde(default)]
        derivative_s: f64,
        /// Time constant of the filter of the derivative, s.
        #[serde(default)]
        filter_s: f64,
        /// Time constant by which the integral is taken back while the command is cut, s; proportional over
        /// integral gain unless given.
        #[serde(default)]
        anti_windup_s: Option<f64>,
    },
    /// u = bias + the sum of gain x clipped error over several measured quantities.
    StateFeedback {
        /// The terms of the sum.
        terms: Vec<FeedbackTerm>,
        /// The command where nothing errs.
        #[serde(default)]
        bias: f64,
    },
}

/// A term of state feedback.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "term", deny_unknown_fields)]
pub struct FeedbackTerm {
    /// What is measured.
    pub measured: Quantity,
    /// What it should be; zero unless given.
    #[serde(default)]
    pub target: f64,
    /// Command for each unit of the error.
    pub gain: f64,
    /// Largest error to either side that counts; any unless given.
    #[serde(default)]
    pub clip: Option<f64>,
}

/// What a controller can measure, of an entity with a body.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "measured")]
pub enum Quantity {
    /// Position along x, m.
    X(String),
    /// Position along y, m: the paper's "latitude".
    Y(String),
    /// Position along z, m.
    Altitude(String),
    /// Velocity along x, m/s.
    VelocityX(String),
    /// Velocity along y, m/s.
    VelocityY(String),
    /// Velocity along z, m/s.
    VelocityZ(String),
    /// Angle from the x axis to the bow, counted towards y, rad.
    Heading(String),
    /// Its rate, rad/s.
    HeadingRate(String),
    /// The first less the second.
    Difference(Box<Quantity>, Box<Quantity>),
}

/// A kind of measured quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantityKind {
    /// As [`Quantity::X`].
    X,
    /// As [`Quantity::Y`].
    Y,
    /// As [`Quantity::Altitude`].
    Altitude,
    /// As [`Quantity::VelocityX`].
    VelocityX,
    /// As [`Quantity::VelocityY`].
    VelocityY,
    /// As [`Quantity::VelocityZ`].
    VelocityZ,
    /// As [`Quantity::Heading`].
    Heading,
    /// As [`Quantity::HeadingRate`].
    HeadingRate,
}

impl Quantity {
    /// It as a sum: sign, kind and name of the entity of each part.
    #[must_use]
    pub fn parts(&self) -> Vec<(f64, QuantityKind, &str)> {
        let (kind, name) = match self {
            Self::Difference(first, second) => {
                let mut parts = first.parts();
                let taken = second.parts().into_iter();
                parts.extend(taken.map(|(sign, kind, name)| (-sign, kind, name)));
                return parts;
            }
            Self::X(name) => (QuantityKind::X, name),
            Self::Y(name) => (QuantityKind::Y, name),
            Self::Altitude(name) => (QuantityKind::Altitude, name),
            Self::VelocityX(name) => (QuantityKind::VelocityX, name),
            Self::VelocityY(name) => (QuantityKind::VelocityY, name),
            Self::VelocityZ(name) => (QuantityKind::VelocityZ, name),
            Self::Heading(name) => (QuantityKind::Heading, name),
            Self::HeadingRate(name) => (QuantityKind::HeadingRate, name),
        };
        vec![(1.0, kind, name)]
    }

    /// Whether it is an angle, known but for whole turns.
    #[must_use]
    pub fn is_angle(&self) -> bool {
        match self {
            Self::Heading(_) => true,
            Self::Difference(first, second) => first.is_angle() || second.is_angle(),
            _ => false,
        }
    }
}

impl Law {
    /// What it measures, with the field of the law in which that stands.
    #[must_use]
    pub fn measured(&self) -> Vec<(String, &Quantity)> {
        match self {
            Self::Proportional { measured, .. } | Self::Pid { measured, .. } => {
                vec![("measured".to_owned(), measured)]
            }
            Self::StateFeedback { terms, .. } => {
                let numbered = terms.iter().enumerate();
                numbered
                    .map(|(index, term)| (format!("terms.{index}.measured"), &term.measured))
                    .collect()
            }
        }
    }
}

impl SceneComponent for Controller {
    const NAME: &'static str = "Controller";
    const EXCLUDES: &'static [&'static str] = &["Schedule"];

    fn check(&self, report: &mut FieldReport) {
        report.positive("period_s", self.period_s);
        report.within("law", |report| self.law.check(report));
        if let Some((least, most)) = self.saturation {
            report.finite("saturation.0", least);
            report.finite("saturation.1", most);
            if least > most {
                report.add(
                    "saturation",
                    format!("the least command ({least}) is above the largest ({most})"),
                    "the order is (least, largest)",
                );
            }
        }
        if let Some(rate) = self.rate_limit_per_s {
            report.positive("rate_limit_per_s", rate);
        }
    }
}

impl Law {
    fn check(&self, report: &mut FieldReport) {
        match self {
            Self::Proportional { target, gain, .. } => {
                report.finite("target", *target);
                report.finite("gain", *gain);
            }
            Self::Pid {
                target,
                proportional,
                integral_per_s,
                derivative_s,
                filter_s,
                anti_windup_s,
                ..
            } => {
                report.finite("target", *target);
                report.finite("proportional", *proportional);
                report.finite("integral_per_s", *integral_per_s);
                report.finite("derivative_s", *derivative_s);
                report.non_negative("filter_s", *filter_s);
                if let Some(time_s) = anti_windup_s {
                    report.positive("anti_windup_s", *time_s);
                }
            }
            Self::StateFeedback { terms, bias } => {
                report.finite("bias", *bias);
                if terms.is_empty() {
                    report.add("terms", "state feedback needs a term", "");
                }
                for (index, term) in terms.iter().enumerate() {
                    report.within(&format!("terms.{index}"), |report| {
                        report.finite("target", term.target);
                        report.finite("gain", term.gain);
                        if let Some(clip) = term.clip {
                            report.positive("clip", clip);
                        }
                    });
                }
            }
        }
    }
}

/// A measured quantity of a running world: sign, kind and entity of each part of a sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The parts.
    pub parts: Vec<(f64, QuantityKind, Entity)>,
    /// Whether it is known but for whole turns.
    pub is_angle: bool,
    /// What it should be.
    pub target: f64,
}

/// The controller of a running world: what it measures, and which actuator it commands.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct BoundController {
    /// One for each term of the law.
    pub measurements: Vec<Measurement>,
    /// The actuator.
    pub actuator: Entity,
    /// Least and largest command, the actuator's own limits considered.
    pub range: (f64, f64),
}

/// The actuator of a schedule, in a running world.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundSchedule(pub Entity);

/// What a controller remembers from sample to sample.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct LawState {
    /// Integral part of the command.
    pub integral: f64,
    /// Filtered derivative part of the command.
    pub derivative: f64,
    /// The error of the last sample, if there was one.
    pub error: Option<f64>,
    /// The last command.
    pub command: f64,
}
