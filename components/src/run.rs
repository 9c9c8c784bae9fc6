//! How a scene is run: formulation, time, integrator, and what is recorded.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::scene_component::FieldReport;

/// The `run` block of a scene.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "run", deny_unknown_fields)]
pub struct RunSpec {
    /// Which equations move the tethers.
    #[serde(default)]
    pub formulation: Formulation,
    /// Of what the links of `Denoc` are made.
    #[serde(default)]
    pub links: LinkMass,
    /// Whether the links of `Denoc` stretch by the tether's stiffness and damping; rigid unless said.
    #[serde(default)]
    pub elastic_links: bool,
    /// The body from which the tree of `Denoc` grows. Unless given it is the one called `gondola`, or else
    /// the one with most tethers; an anchor always is. It changes coordinates and so the errors of steps,
    /// nothing else.
    #[serde(default)]
    pub base: Option<String>,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Time between outputs, s; output k stands at k times this.
    pub output_every_s: f64,
    /// The integrator and its accuracy.
    #[serde(default)]
    pub integrator: IntegratorSpec,
    /// Seed of every random draw.
    #[serde(default)]
    pub seed: u64,
    /// What is recorded, and how often.
    #[serde(default)]
    pub record: RecordSpec,
}

impl RunSpec {
    /// Reports what is wrong with the fields.
    pub fn check(&self, report: &mut FieldReport) {
        report.positive("duration_s", self.duration_s);
        report.positive("output_every_s", self.output_every_s);
        check_count(
            "output_every_s",
            self.duration_s,
            self.output_every_s,
            report,
        );
        report.within("integrator", |report| self.integrator.check(report));
        report.within("record", |report| {
            self.record.check(self.duration_s, report)
        });
    }
}

/// More outputs than this in one run are a slip of the pen.
const MOST_OUTPUTS: f64 = 1e8;

fn check_count(path: &str, duration_s: f64, period_s: f64, report: &mut FieldReport) {
    if duration_s / period_s > MOST_OUTPUTS {
        report.add(
            path,
            format!(
                "{duration_s} s in steps of {period_s} s are more than {MOST_OUTPUTS:e} outputs"
            ),
            "",
        );
    }
}

/// The equations that move tethers.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "formulation")]
pub enum Formulation {
    /// Point masses joined by Kelvin-Voigt segments.
    #[default]
    LumpedMass,
    /// Chains of rigid links in recursive form.
    Denoc,
}

impl Formulation {
    /// The name in files and on the command line.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::LumpedMass => "lumped-mass",
            Self::Denoc => "denoc",
        }
    }
}

/// Of what the links of the second formulation are made.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "links")]
pub enum LinkMass {
    /// Uniform thin rods, whatever the tether's `lumping` says.
    #[default]
    Rod,
    /// Massless links with point masses at the joints, and at the ends as the tether's `lumping` says: what
    /// the lumped formulation becomes where tethers do not stretch.
    PointMass,
}

/// The integrator and its accuracy.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "integrator", deny_unknown_fields)]
pub enum IntegratorSpec {
    /// Implicit where tethers are stiff, explicit where that is cheaper, with steps chosen for an
    /// accuracy.
    Auto {
        /// Wanted accuracy of the positions of bodies, m; the error of every step is held to a part of it.
        #[serde(default = "IntegratorSpec::accuracy_m")]
        accuracy_m: f64,
        /// Longest step, s; without limit unless given.
        #[serde(default)]
        longest_step_s: Option<f64>,
    },
    /// Implicit throughout (ROS34PW2), with steps chosen for an accuracy.
    Implicit {
        /// Wanted accuracy of the positions of bodies, m; the error of every step is held to a part of it.
        #[serde(default = "IntegratorSpec::accuracy_m")]
        accuracy_m: f64,
        /// Longest step, s; without limit unless given.
        #[serde(default)]
        longest_step_s: Option<f64>,
    },
    /// Dormand-Prince 5(4) with step control.
    Adaptive {
        /// Largest error of a step, relative to 1 m, 1 m/s, 1 rad, 1 rad/s, or to the displacement
        /// from the start where that is more.
        #[serde(default = "IntegratorSpec::relative_tolerance")]
        relative_tolerance: f64,
        /// Longest step, s; without limit unless given.
        #[serde(default)]
        longest_step_s: Option<f64>,
    },
    /// A fixed step.
    Fixed {
        /// The step, s; a safe fraction of the largest stable one unless given.
        #[serde(default)]
        step_s: Option<f64>,
        /// The method.
        #[serde(default)]
        method: FixedMethod,
    },
}

/// Methods with a fixed step.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "method")]
pub enum FixedMethod {
    /// The classical Runge-Kutta method of fourth order.
    #[default]
    RungeKutta4,
    /// ROS34PW2, linearly implicit, of third order: stable with any step.
    Rosenbrock,
}

impl Default for IntegratorSpec {
    fn default() -> Self {
        Self::Auto {
            accuracy_m: Self::accuracy_m(),
            longest_step_s: None,
        }
    }
}

impl IntegratorSpec {
    fn accuracy_m() -> f64 {
        1e-3
    }

    fn relative_tolerance() -> f64 {
        1e-8
    }

    fn check(&self, report: &mut FieldReport) {
        match *self {
            Self::Auto {
                accuracy_m,
                longest_step_s,
            }
            | Self::Implicit {
                accuracy_m,
                longest_step_s,
            } => {
                // Round-off of positions at 56 km is some 1e-11 m.
                if !(1e-12..=1e3).contains(&accuracy_m) {
                    report.add(
                        "accuracy_m",
                        format!(
                            "`accuracy_m` must lie between 1e-12 and 1000 m, it is {accuracy_m}"
                        ),
                        "",
                    );
                }
                if let Some(longest_step_s) = longest_step_s {
                    report.positive("longest_step_s", longest_step_s);
                }
            }
            Self::Adaptive {
                relative_tolerance,
                longest_step_s,
            } => {
                if !(relative_tolerance > 1e-15 && relative_tolerance < 1.0) {
                    report.add(
                        "relative_tolerance",
                        format!(
                            "`relative_tolerance` must lie between 1e-15 and 1, it is \
                             {relative_tolerance}"
                        ),
                        "",
                    );
                }
                if let Some(longest_step_s) = longest_step_s {
                    report.positive("longest_step_s", longest_step_s);
                }
            }
            Self::Fixed { step_s, method } => match step_s {
                Some(step_s) => report.positive("step_s", step_s),
                None if method == FixedMethod::Rosenbrock => report.add(
                    "step_s",
                    "`Rosenbrock` is stable with any step, so the step must be given",
                    "give `step_s`, or use `Implicit()`, which chooses its steps",
                ),
                None => {}
            },
        }
    }
}

/// What is recorded, and how often.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "record", deny_unknown_fields)]
pub struct RecordSpec {
    /// Bodies and anchors in `states.csv`.
    #[serde(default)]
    pub bodies: Cadence,
    /// Nodes of tethers in `states.csv`.
    #[serde(default)]
    pub nodes: Cadence,
    /// Segments in `tethers.csv`.
    #[serde(default)]
    pub tethers: Cadence,
    /// Built-in channels in `channels.csv`: which ones.
    #[serde(default)]
    pub channels: ChannelSelection,
    /// Built-in channels: how often. Instruments have a period of their own.
    #[serde(default)]
    pub channels_at: Cadence,
    /// Channels of instruments and controllers.
    #[serde(default)]
    pub instruments: InstrumentSelection,
}

impl RecordSpec {
    fn check(&self, duration_s: f64, report: &mut FieldReport) {
        for (field, cadence) in [
            ("bodies", self.bodies),
            ("nodes", self.nodes),
            ("tethers", self.tethers),
            ("channels_at", self.channels_at),
        ] {
            if let Cadence::Every { period_s } = cadence {
                let path = format!("{field}.period_s");
                report.positive(&path, period_s);
                check_count(&path, duration_s, period_s, report);
            }
        }
    }
}

/// How often something is recorded.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub enum Cadence {
    /// At every output time.
    #[default]
    Output,
    /// At the multiples of a period of its own, and at the end.
    Every {
        /// The period, s.
        period_s: f64,
    },
    /// Never.
    Never,
}

/// Which built-in channels are recorded.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "channels")]
pub enum ChannelSelection {
    /// Airspeed, tilt, heading, swing and attachment tensions of everything that has them.
    #[default]
    Standard,
    /// These and the energy of the whole system with the work of non-conservative forces.
    All,
    /// None.
    None,
    /// These: for each entity the names of its channels; the whole system is `"system"`.
    Only(BTreeMap<String, Vec<String>>),
}

/// Whether the channels of instruments and controllers are recorded.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "instruments")]
pub enum InstrumentSelection {
    /// All of them.
    #[default]
    All,
    /// None.
    None,
    /// Those of these entities.
    Only(Vec<String>),
}
