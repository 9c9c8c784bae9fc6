//! Stochastic gusts as a scene describes them: per axis a random process in time, over altitude the same
//! everywhere or correlated with a decay length.

use serde::Deserialize;

use crate::scene_component::FieldReport;

/// A stochastic gust, one source of wind (paper, sec. 3.5): along each axis that is given, a random
/// velocity with the autocorrelation e^(-alpha tau) cos(omega tau), independent of the other axes.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "Gust", deny_unknown_fields)]
pub struct GustSpec {
    /// Along x, downwind of the zonal wind; none unless given.
    #[serde(default)]
    pub zonal: Option<GustAxisSpec>,
    /// Along y, horizontal, to the left of x; none unless given.
    #[serde(default)]
    pub meridional: Option<GustAxisSpec>,
    /// Along z, up; none unless given.
    #[serde(default)]
    pub vertical: Option<GustAxisSpec>,
    /// Over what the gust is the same.
    #[serde(default)]
    pub coherence: CoherenceSpec,
    /// Which random numbers it draws, beside the seed of the run: its place among the gusts of the
    /// scene, from 0, unless given.
    #[serde(default)]
    pub stream: Option<u32>,
    /// Whether grids may lose more than 1 % of the variance by interpolation.
    #[serde(default)]
    pub allow_loss: bool,
    /// At how many knots a step of an integrator with step control ends at the latest, 1 unless given: it sees
    /// the wind at a few times only, and what it misses adds up. 0 lets it pass as many as it likes. This
    /// changes the number of steps and their error, not the wind.
    #[serde(default = "GustSpec::one")]
    pub knots_per_step: u32,
}

/// What a gust does along one axis.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "axis", deny_unknown_fields)]
pub struct GustAxisSpec {
    /// alpha: how fast the autocorrelation decays, 1/s.
    pub decay_per_s: f64,
    /// omega: the frequency with which it oscillates, rad/s; none unless given.
    #[serde(default)]
    pub frequency_rad_s: f64,
    /// The distribution of the velocity at any one time.
    pub marginal: MarginalSpec,
    /// Mean of the velocity, m/s: the marginal is moved to it. Unless given, a normal one has none and
    /// the others have their own.
    #[serde(default)]
    pub mean_m_s: Option<f64>,
    /// Which process has the autocorrelation that `decay_per_s` and `frequency_rad_s` describe.
    #[serde(default)]
    pub autocorrelation: AutocorrelationSpec,
    /// Time between the knots at which the process is drawn, s; linear between them. Chosen so that
    /// this loses at most 0.5 % of the variance unless given.
    #[serde(default)]
    pub grid_s: Option<f64>,
}

/// The distribution of a gust's velocity at any one time.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "marginal", deny_unknown_fields)]
pub enum MarginalSpec {
    /// Normal, about zero.
    Normal {
        /// Standard deviation, m/s.
        standard_deviation_m_s: f64,
    },
    /// A velocity whose logarithm is normal.
    Lognormal {
        /// Median, m/s.
        median_m_s: f64,
        /// Standard deviation of the natural logarithm, 1.
        log_standard_deviation: f64,
    },
    /// P(Y > y) = exp(-(y/scale)^shape).
    Weibull {
        /// Scale, m/s.
        scale_m_s: f64,
        /// Shape, 1.
        shape: f64,
    },
    /// As the velocities in a CSV file beside the scene are distributed: one column, `speed_m_s`.
    Empirical {
        /// The file, relative to the scene.
        file: String,
    },
}

/// Which process has the autocorrelation that is stated.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "autocorrelation")]
pub enum AutocorrelationSpec {
    /// The normal process that is carried to the marginal, which bends it (paper, sec. 3.5).
    #[default]
    Parent,
    /// The velocity itself: that of the normal process is corrected for the bending (Nataf 1962).
    Target,
}

/// Over what a gust is the same.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "coherence", deny_unknown_fields)]
pub enum CoherenceSpec {
    /// One gust everywhere (the paper's).
    #[default]
    Everywhere,
    /// Correlated over altitude as e^(-|dz|/L) at equal times, the same along the horizontal.
    Altitude {
        /// L, m.
        decay_length_m: f64,
        /// The lowest altitude at which there is air to know the gust of, m.
        from_m: f64,
        /// The highest, m.
        to_m: f64,
        /// Distance of the levels at which the gust is drawn, m; linear between them. Chosen so that
        /// this loses at most 0.5 % of the variance unless given.
        #[serde(default)]
        level_m: Option<f64>,
    },
}

impl GustSpec {
    fn one() -> u32 {
        1
    }

    /// The axes with their names in a scene, x, y and z in this order.
    #[must_use]
    pub fn axes(&self) -> [(&'static str, Option<&GustAxisSpec>); 3] {
        [
            ("zonal", self.zonal.as_ref()),
            ("meridional", self.meridional.as_ref()),
            ("vertical", self.vertical.as_ref()),
        ]
    }

    /// Reports what is wrong with the fields.
    pub fn check(&self, report: &mut FieldReport) {
        if self.axes().iter().all(|(_, axis)| axis.is_none()) {
            report.add(
                "",
                "a gust along no axis",
                "give one or more of `zonal`, `meridional` and `vertical`",
            );
        }
        for (name, axis) in self.axes() {
            if let Some(axis) = axis {
                report.within(name, |report| axis.check(report));
            }
        }
        report.within("coherence", |report| self.coherence.check(report));
    }
}

impl GustAxisSpec {
    fn check(&self, report: &mut FieldReport) {
        report.positive("decay_per_s", self.decay_per_s);
        report.non_negative("frequency_rad_s", self.frequency_rad_s);
        if let Some(mean_m_s) = self.mean_m_s {
            report.finite("mean_m_s", mean_m_s);
            check_speed("mean_m_s", mean_m_s, report);
        }
        if let Some(grid_s) = self.grid_s {
            report.positive("grid_s", grid_s);
        }
        report.within("marginal", |report| self.marginal.check(report));
    }
}

impl MarginalSpec {
    fn check(&self, report: &mut FieldReport) {
        match self {
            Self::Normal {
                standard_deviation_m_s,
            } => {
                report.non_negative("standard_deviation_m_s", *standard_deviation_m_s);
                check_speed("standard_deviation_m_s", *standard_deviation_m_s, report);
            }
            Self::Lognormal {
                median_m_s,
                log_standard_deviation,
            } => {
                report.positive("median_m_s", *median_m_s);
                check_speed("median_m_s", *median_m_s, report);
                report.positive("log_standard_deviation", *log_standard_deviation);
                // Beyond it a lognormal has no variance that a record of any length would show.
                if *log_standard_deviation > MOST_LOG_STANDARD_DEVIATION {
                    report.add(
                        "log_standard_deviation",
                        format!(
                            "`log_standard_deviation` must not exceed {MOST_LOG_STANDARD_DEVIATION}, it \
                             is {log_standard_deviation}"
                        ),
                        "it is that of the natural logarithm of the velocity, a pure number",
                    );
                }
            }
            Self::Weibull { scale_m_s, shape } => {
                report.positive("scale_m_s", *scale_m_s);
                check_speed("scale_m_s", *scale_m_s, report);
                report.positive("shape", *shape);
                if (0.0..LEAST_SHAPE).contains(shape) && *shape > 0.0 {
                    report.add(
                        "shape",
                        format!("`shape` must be at least {LEAST_SHAPE}, it is {shape}"),
                        "winds have 1 to 4",
                    );
                }
            }
            Self::Empirical { .. } => {}
        }
    }
}

/// No wind has a speed near this, m/s, and its powers stay numbers.
pub const MOST_SPEED_M_S: f64 = 1e6;

fn check_speed(field: &str, speed_m_s: f64, report: &mut FieldReport) {
    if speed_m_s.abs() > MOST_SPEED_M_S {
        let message =
            format!("`{field}` must not exceed {MOST_SPEED_M_S:e} m/s, it is {speed_m_s:e}");
        report.add(field, message, "");
    }
}

/// The largest standard deviation of a logarithm that a scene may have.
const MOST_LOG_STANDARD_DEVIATION: f64 = 2.0;
/// The smallest shape of a Weibull distribution that a scene may have.
const LEAST_SHAPE: f64 = 0.5;

impl CoherenceSpec {
    fn check(&self, report: &mut FieldReport) {
        let Self::Altitude {
            decay_length_m,
            from_m,
            to_m,
            level_m,
        } = self
        else {
            return;
        };
        report.positive("decay_length_m", *decay_length_m);
        report.finite("from_m", *from_m);
        report.finite("to_m", *to_m);
        if let Some(level_m) = level_m {
            report.positive("level_m", *level_m);
        }
        if to_m <= from_m {
            report.add(
                "to_m",
                format!(
                    "the altitudes end below where they begin: {to_m} m is not above {from_m} m"
                ),
                "",
            );
        }
    }
}
