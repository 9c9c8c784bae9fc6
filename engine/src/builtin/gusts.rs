//! The stochastic gusts of a scene: from what it says to processes that can be drawn, and what is wrong.

use aerobot_components::environment::WindSpec;
use aerobot_components::gust::{
    AutocorrelationSpec, CoherenceSpec, GustAxisSpec, GustSpec, MarginalSpec,
};
use aerobot_components::run::IntegratorSpec;
use aerobot_components::scene_component::FieldReport;
use aerobot_systems::environment::gust::GustAxis;
use aerobot_systems::environment::gust::design::{GustDesign, GustParameters, Layers};
use aerobot_systems::environment::gust::refusal::GustField;
use aerobot_systems::stochastic::complex_ornstein_uhlenbeck::ComplexOrnsteinUhlenbeck;
use aerobot_systems::stochastic::marginal::Marginal;

use super::environment::given_altitude;
use crate::recording::number::number_text;
use crate::scene::tables::Tables;
use crate::scene::{Scene, SetupError};

/// More knots than this in one run are a slip of the pen.
const MOST_KNOTS: f64 = 1e9;

/// Whether a scene has any.
pub(crate) fn has_gusts(scene: &Scene) -> bool {
    gusts(scene).next().is_some()
}

/// All gusts of a scene, each along one axis, under the seed of its run.
///
/// # Errors
/// One that cannot be.
pub(crate) fn draw(scene: &Scene) -> Result<Vec<GustAxis>, SetupError> {
    let mut drawn = Vec::new();
    for gust in gusts(scene) {
        for (path, parameters) in gust.axes(&scene.tables) {
            let axis = GustAxis::new(parameters, scene.run.seed);
            drawn.push(
                axis.map_err(|error| SetupError::new(path, error.to_string(), &error.help()))?,
            );
        }
    }
    Ok(drawn)
}

/// One source of wind that is a gust.
struct NumberedGust<'a> {
    /// Its place in the list of winds.
    place: usize,
    spec: &'a GustSpec,
    stream: u32,
    knots_per_step: u32,
}

/// The gusts of a scene; each draws from the stream of its number among them, unless it names one.
fn gusts(scene: &Scene) -> impl Iterator<Item = NumberedGust<'_>> {
    let winds = scene.environment.wind.iter().enumerate();
    let gusts = winds.filter_map(|(place, wind)| match wind {
        WindSpec::Gust(spec) => Some((place, spec)),
        _ => None,
    });
    // Who asks for fixed steps gets them.
    let is_fixed = matches!(scene.run.integrator, IntegratorSpec::Fixed { .. });
    (0..)
        .zip(gusts)
        .map(move |(number, (place, spec))| NumberedGust {
            place,
            spec,
            stream: spec.stream.unwrap_or(number),
            knots_per_step: if is_fixed { 0 } else { spec.knots_per_step },
        })
}

impl NumberedGust<'_> {
    fn path(&self) -> String {
        format!("environment.wind.{}", self.place)
    }

    /// What each axis consists of, with its path; without one whose sample could not be read.
    fn axes(&self, tables: &Tables) -> Vec<(String, GustParameters)> {
        let axes = self.spec.axes();
        let axes = axes.iter().enumerate().filter_map(|(axis, (name, spec))| {
            let parameters = self.parameters(axis, (*spec)?, tables)?;
            Some((format!("{}.{name}", self.path()), parameters))
        });
        axes.collect()
    }

    fn parameters(
        &self,
        axis: usize,
        spec: &GustAxisSpec,
        tables: &Tables,
    ) -> Option<GustParameters> {
        Some(GustParameters {
            axis,
            process: ComplexOrnsteinUhlenbeck {
                decay_per_s: spec.decay_per_s,
                frequency_rad_s: spec.frequency_rad_s,
            },
            marginal: marginal(&spec.marginal, tables)?,
            mean_m_s: spec.mean_m_s,
            is_target: spec.autocorrelation == AutocorrelationSpec::Target,
            grid_s: spec.grid_s,
            layers: layers(&self.spec.coherence),
            allow_loss: self.spec.allow_loss,
            stream: self.stream,
            knots_per_step: self.knots_per_step,
        })
    }
}

fn marginal(spec: &MarginalSpec, tables: &Tables) -> Option<Marginal> {
    Some(match spec {
        MarginalSpec::Normal {
            standard_deviation_m_s,
        } => Marginal::Normal {
            standard_deviation_m_s: *standard_deviation_m_s,
        },
        MarginalSpec::Lognormal {
            median_m_s,
            log_standard_deviation,
        } => Marginal::Lognormal {
            median_m_s: *median_m_s,
            log_standard_deviation: *log_standard_deviation,
        },
        MarginalSpec::Weibull { scale_m_s, shape } => Marginal::Weibull {
            scale_m_s: *scale_m_s,
            shape: *shape,
        },
        MarginalSpec::Empirical { file } => Marginal::of_sample(tables.samples.get(file)?.clone()),
    })
}

fn layers(coherence: &CoherenceSpec) -> Option<Layers> {
    match *coherence {
        CoherenceSpec::Everywhere => None,
        CoherenceSpec::Altitude {
            decay_length_m,
            from_m,
            to_m,
            level_m,
        } => Some(Layers {
            decay_length_m,
            from_m,
            to_m,
            level_m,
        }),
    }
}

/// What is wrong with gusts beyond their own fields.
pub(crate) fn check(scene: &Scene, report: &mut FieldReport) {
    let mut streams: Vec<(u32, usize)> = Vec::new();
    for gust in gusts(scene) {
        let taken = streams.iter().find(|(stream, _)| *stream == gust.stream);
        if let Some((stream, place)) = taken {
            report.add(
                &format!("{}.stream", gust.path()),
                format!("this gust and that in `environment.wind.{place}` both draw from stream {stream}"),
                "they would be one and the same noise: give one of them another `stream`",
            );
        }
        streams.push((gust.stream, gust.place));
        let mut own = FieldReport::default();
        gust.spec.check(&mut own);
        // Said already; of such numbers nothing follows.
        if own.into_violations().is_empty() {
            check_design(scene, &gust, report);
            check_altitudes(scene, &gust, report);
        }
    }
}

fn check_design(scene: &Scene, gust: &NumberedGust, report: &mut FieldReport) {
    for (path, parameters) in gust.axes(&scene.tables) {
        match GustDesign::new(parameters) {
            Ok(design) => check_knots(scene, &path, &design, report),
            Err(error) => {
                let field = match error.field() {
                    GustField::OfSource(field) => format!("{}.{field}", gust.path()),
                    GustField::OfAxis(field) => format!("{path}.{field}"),
                };
                report.add(&field, error.to_string(), error.help());
            }
        }
    }
}

fn check_knots(scene: &Scene, path: &str, design: &GustDesign, report: &mut FieldReport) {
    let knots = scene.run.duration_s / design.grid_s;
    if knots > MOST_KNOTS {
        report.add(
            &format!("{path}.grid_s"),
            format!(
                "{} s with a knot every {} s are more than {MOST_KNOTS:e} knots",
                scene.run.duration_s,
                number_text(design.grid_s)
            ),
            "a grid need not be finer than a small part of 1/`decay_per_s`",
        );
    }
}

/// What is in the air must start where the gust is known.
fn check_altitudes(scene: &Scene, gust: &NumberedGust, report: &mut FieldReport) {
    let Some(layers) = layers(&gust.spec.coherence) else {
        return;
    };
    for entity in &scene.entities {
        let Some((field, altitude_m)) = given_altitude(entity) else {
            continue;
        };
        if altitude_m < layers.from_m || altitude_m > layers.to_m {
            report.add(
                &format!("entities.{}.{field}", entity.name),
                format!(
                    "an altitude of {altitude_m} m is outside the gust in `{}.coherence`",
                    gust.path()
                ),
                format!(
                    "it is drawn from {} m to {} m; z is the altitude",
                    layers.from_m, layers.to_m
                ),
            );
        }
    }
}

/// A line for each gust and axis, for a person.
#[must_use]
pub fn describe(gusts: &[&GustAxis]) -> Vec<String> {
    let axes = ["zonal", "meridional", "vertical"];
    let lines = gusts.iter().map(|gust| {
        let design = gust.design();
        let process = &design.parameters.process;
        let levels = design.levels.as_ref().map_or_else(String::new, |levels| {
            format!(
                ", a level every {} m ({:.2} %)",
                levels.spacing_m,
                100.0 * design.loss_in_altitude()
            )
        });
        format!(
            "gust {}, {}: {}, mean {:.4} m/s, decay {} 1/s, frequency {} rad/s; a knot every {} s, between \
             which {:.2} % of the variance is lost{levels}",
            design.parameters.stream,
            axes[design.parameters.axis],
            describe_marginal(&design.parameters.marginal),
            design.mean_m_s(),
            number_text(process.decay_per_s),
            number_text(process.frequency_rad_s),
            number_text(design.grid_s),
            100.0 * design.loss_in_time(),
        )
    });
    lines.collect()
}

fn describe_marginal(marginal: &Marginal) -> String {
    match marginal {
        Marginal::Normal {
            standard_deviation_m_s,
        } => format!("normal, standard deviation {standard_deviation_m_s} m/s"),
        Marginal::Lognormal {
            median_m_s,
            log_standard_deviation,
        } => format!("lognormal, median {median_m_s} m/s, log {log_standard_deviation}"),
        Marginal::Weibull { scale_m_s, shape } => {
            format!("Weibull, scale {scale_m_s} m/s, shape {shape}")
        }
        Marginal::Empirical(sample) => format!("as {} values", sample.len()),
    }
}
