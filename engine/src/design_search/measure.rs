//! What a design is judged by: a number of its runs, of its scene, or of itself.

use aerobot_components::body::Body;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::tether::Tether;
use serde::Deserialize;

use crate::campaign::quantity::unit_of;
use crate::campaign::statistics::percentile;
use crate::scene::Scene;
use crate::scene::source::nearest;

use super::specification::SearchSpec;

/// A number of a design.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "measure", deny_unknown_fields)]
pub enum Measure {
    /// The value of a design variable.
    Variable(
        /// Its name.
        String,
    ),
    /// Mass of bodies (gas included) and tethers together, kg, as the scene has them at its start.
    Mass(
        /// Their names; one that stands for others counts with all of them.
        Vec<String>,
    ),
    /// A metric of a design that is run once.
    Value(
        /// The metric.
        String,
    ),
    /// The mean of a metric over the runs of a design.
    Mean(
        /// The metric.
        String,
    ),
    /// A percentile of a metric over the runs of a design, straight between neighbours.
    Percentile {
        /// The metric.
        metric: String,
        /// The part of the runs that lies below, %.
        percent: f64,
    },
    /// The largest value of a metric over the runs of a design.
    Largest(
        /// The metric.
        String,
    ),
    /// The smallest value of a metric over the runs of a design.
    Smallest(
        /// The metric.
        String,
    ),
    /// The part of the runs of a design whose metric is within limits, from 0 to 1.
    FractionWithin {
        /// The metric.
        metric: String,
        /// Lower limit, in the metric's unit; none unless given.
        #[serde(default)]
        low: Option<f64>,
        /// Upper limit, in the metric's unit; none unless given.
        #[serde(default)]
        high: Option<f64>,
    },
    /// A number over `factor * variable^power`: a stress, of a tension and a diameter.
    Quotient {
        /// The number above.
        of: Box<Measure>,
        /// The variable below.
        variable: String,
        /// The factor below; 1 unless given.
        #[serde(default = "one")]
        factor: f64,
        /// The power below; 1 unless given.
        #[serde(default = "one")]
        power: f64,
        /// The unit of the quotient, as it stands at the end of names: `pa`.
        unit: String,
    },
}

fn one() -> f64 {
    1.0
}

impl Measure {
    /// The metric that it looks at itself, if any, and the field in which it stands.
    fn metric(&self) -> Option<(&str, &'static str)> {
        match self {
            Self::Variable(_) | Self::Mass(_) | Self::Quotient { .. } => None,
            Self::Value(metric)
            | Self::Mean(metric)
            | Self::Largest(metric)
            | Self::Smallest(metric) => Some((metric, "0")),
            Self::Percentile { metric, .. } | Self::FractionWithin { metric, .. } => {
                Some((metric, "metric"))
            }
        }
    }

    /// Its unit, as it stands at the end of names; empty if it has none.
    #[must_use]
    pub fn unit(&self, search: &SearchSpec) -> String {
        match self {
            Self::Variable(name) => unit_of(name).to_owned(),
            Self::Mass(_) => "kg".to_owned(),
            Self::FractionWithin { .. } => String::new(),
            Self::Quotient { unit, .. } => unit.clone(),
            _ => {
                let metrics = search.metrics.0.iter();
                let metric = self.metric().and_then(|(metric, _)| {
                    metrics
                        .clone()
                        .find_map(|(name, of)| (name == metric).then_some(of))
                });
                metric.map_or_else(String::new, |metric| metric.unit())
            }
        }
    }

    /// Reports what does not belong to the search.
    pub(super) fn check(&self, search: &SearchSpec, report: &mut FieldReport) {
        let known = |kind: &str, name: &str, names: Vec<&str>| {
            (!names.contains(&name)).then(|| {
                let near = nearest(name, names.iter().copied());
                let help = near.map_or_else(
                    || format!("there is `{}`", names.join("`, `")),
                    |near| format!("did you mean `{near}`?"),
                );
                (format!("there is no {kind} `{name}`"), help)
            })
        };
        let names =
            |names: &mut dyn Iterator<Item = &String>| -> Vec<String> { names.cloned().collect() };
        if let Some((metric, field)) = self.metric() {
            let all = names(&mut search.metrics.0.iter().map(|(name, _)| name));
            if let Some((message, help)) =
                known("metric", metric, all.iter().map(String::as_str).collect())
            {
                report.add(field, message, help);
            }
        }
        match self {
            Self::Variable(variable) | Self::Quotient { variable, .. } => {
                let all = names(&mut search.variables.0.iter().map(|(name, _)| name));
                let all = all.iter().map(String::as_str).collect();
                if let Some((message, help)) = known("variable", variable, all) {
                    let field = match self {
                        Self::Variable(_) => "0",
                        _ => "variable",
                    };
                    report.add(field, message, help);
                }
                self.check_quotient(search, report);
            }
            Self::Mass(entities) if entities.is_empty() => {
                report.add("0", "the mass of nothing", "name one entity or more");
            }
            Self::Value(_) if !search.is_once() => report.add(
                "",
                "a design has many runs, and `Value` is that of one",
                "`Mean`, `Percentile`, `Largest`, `Smallest` or `FractionWithin`",
            ),
            Self::Percentile { percent, .. } if !(0.0..=100.0).contains(percent) => {
                let message = format!("`percent` must be from 0 to 100, it is {percent}");
                report.add("percent", message, "");
            }
            Self::FractionWithin {
                low: None,
                high: None,
                ..
            } => report.add("", "there is no limit", "give `low`, `high`, or both"),
            Self::FractionWithin {
                low: Some(low),
                high: Some(high),
                ..
            } if low >= high => {
                let message = format!("the limits are crossed: {low} is not below {high}");
                report.add("high", message, "`low` is the lower one");
            }
            _ => {}
        }
    }

    /// What a quotient says of its parts.
    fn check_quotient(&self, search: &SearchSpec, report: &mut FieldReport) {
        let Self::Quotient {
            of,
            variable,
            factor,
            power,
            ..
        } = self
        else {
            return;
        };
        report.within("of", |report| of.check(search, report));
        if *factor == 0.0 {
            report.add("factor", "a number over zero is none", "");
        }
        let mut variables = search.variables.0.iter();
        let below = variables.find_map(|(name, of)| (name == variable).then_some(of));
        if below.is_some_and(|below| below.from <= 0.0) {
            let message = format!("`{variable}` to the power {power} may be zero or no number");
            report.add("variable", message, "its bounds have to be above zero");
        }
    }

    /// Reports entities of the scene that are not there or have no mass.
    pub(super) fn check_scene(&self, scene: &Scene, report: &mut FieldReport) {
        let entities = match self {
            Self::Mass(entities) => entities,
            Self::Quotient { of, .. } => {
                return report.within("of", |report| of.check_scene(scene, report));
            }
            _ => return,
        };
        for (place, name) in entities.iter().enumerate() {
            if mass_kg(scene, name).is_none() {
                let all = scene.entities.iter().map(|entity| entity.name.as_str());
                let help = nearest(name, all).map_or_else(String::new, |near| {
                    if near == name {
                        "bodies and tethers have a mass".to_owned()
                    } else {
                        format!("did you mean `{near}`?")
                    }
                });
                let message = format!("there is no mass of `{name}`");
                report.add(&format!("0.{place}"), message, help);
            }
        }
    }

    /// Whether it needs the scene of a design.
    pub(super) fn needs_scene(&self) -> bool {
        match self {
            Self::Mass(_) => true,
            Self::Quotient { of, .. } => of.needs_scene(),
            _ => false,
        }
    }

    /// Its value of a design, with names and values of its variables, and the values of each metric over its runs.
    /// The scene has to be there if it is needed. `None` if there is nothing to take it of.
    pub(super) fn value(&self, of: &Judged<'_>) -> Option<f64> {
        match self {
            Self::Variable(name) => of.variable(name),
            Self::Mass(entities) => {
                let masses = entities.iter().map(|name| mass_kg(of.scene?, name));
                masses.sum()
            }
            Self::Quotient {
                of: above,
                variable,
                factor,
                power,
                ..
            } => {
                let below = libm::pow(of.variable(variable)?, *power);
                Some(above.value(of)? / (factor * below))
            }
            _ => {
                let values = of.metric(self.metric()?.0)?;
                self.statistic(&values)
            }
        }
        .filter(|value| value.is_finite())
    }

    fn statistic(&self, values: &[f64]) -> Option<f64> {
        let count = values.len() as f64;
        match self {
            Self::Mean(_) | Self::Value(_) => Some(values.iter().map(|value| value / count).sum()),
            Self::Percentile { percent, .. } => {
                let mut sorted = values.to_vec();
                sorted.sort_by(f64::total_cmp);
                percentile(&sorted, *percent)
            }
            Self::Largest(_) => values.iter().copied().reduce(f64::max),
            Self::Smallest(_) => values.iter().copied().reduce(f64::min),
            Self::FractionWithin { low, high, .. } => {
                let is_within = |value: &&f64| {
                    low.is_none_or(|low| **value >= low) && high.is_none_or(|high| **value <= high)
                };
                Some(values.iter().filter(is_within).count() as f64 / count)
            }
            Self::Variable(_) | Self::Mass(_) | Self::Quotient { .. } => None,
        }
    }
}

/// A design with everything that measures look at.
pub(super) struct Judged<'a> {
    pub(super) search: &'a SearchSpec,
    /// Values of the variables in their order.
    pub(super) variables: &'a [f64],
    /// The design's scene, if a measure needs it.
    pub(super) scene: Option<&'a Scene>,
    /// The metrics of each run.
    pub(super) runs: &'a [&'a [Option<f64>]],
}

impl Judged<'_> {
    fn variable(&self, name: &str) -> Option<f64> {
        let mut names = self.search.variables.0.iter();
        let place = names.position(|(variable, _)| variable == name)?;
        self.variables.get(place).copied()
    }

    /// The values of a metric; `None` if a run has none.
    fn metric(&self, name: &str) -> Option<Vec<f64>> {
        let mut names = self.search.metrics.0.iter();
        let place = names.position(|(metric, _)| metric == name)?;
        let values = self.runs.iter().map(|metrics| *metrics.get(place)?);
        values.collect()
    }
}

/// Mass of an entity with all that it stands for, kg; `None` if there is none.
fn mass_kg(scene: &Scene, name: &str) -> Option<f64> {
    let belongs = |entity: &str| {
        let below = entity.strip_prefix(name);
        below.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
    };
    let entities = scene.entities.iter().filter(|entity| belongs(&entity.name));
    let masses = entities.filter_map(|entity| {
        let body = entity.get::<Body>().map(|body| body.mass_kg);
        body.or_else(|| Some(entity.get::<Tether>()?.mass_kg()))
    });
    masses.reduce(|sum, mass_kg| sum + mass_kg)
}
