//! The file of a design search: what it holds, and what can be wrong with it before its scene is read.
//!
//! Name, scene, `set`, `metrics`, and how runs vary stand as in a campaign; without `runs` a design is run once.

use aerobot_components::scene_component::FieldReport;
use serde::Deserialize;

use super::measure::Measure;
use super::variable_check::check_variables;
use crate::campaign::distributions::Distribution;
use crate::campaign::metrics::MetricSpec;
use crate::campaign::ordered::{Ordered, RonText};
use crate::campaign::specification::{
    CampaignSpec, Faults, KeepSpec, PlanSpec, check_name, check_unit, entry_path, read_as,
};
use crate::scene::SceneError;
use crate::scene::source::Source;

/// The most evaluations of a search.
pub const MOST_EVALUATIONS: u64 = 1_000_000;

/// A design search as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "design search", deny_unknown_fields)]
pub struct SearchSpec {
    /// Its name.
    pub name: String,
    /// What it finds.
    #[serde(default)]
    pub about: String,
    /// The scene, a file relative to the search's own folder.
    pub scene: String,
    /// Fields of the scene that are the same in all runs, by their paths.
    #[serde(default)]
    pub set: Ordered<RonText>,
    /// What is to be found: by the path of a field, or by a name where `sets` has paths.
    pub variables: Ordered<VariableSpec>,
    /// What is to be as small or as large as can be.
    pub objective: Objective,
    /// What a design has to keep to, by names in the table.
    #[serde(default)]
    pub constraints: Ordered<ConstraintSpec>,
    /// Number of runs of each design; without it a design is run once, with the seed of its scene.
    #[serde(default)]
    pub runs: Option<u64>,
    /// Seed of the sample of designs, and of everything that is drawn for the runs of a design.
    #[serde(default)]
    pub seed: u64,
    /// How inputs are spread over the runs of a design.
    #[serde(default)]
    pub plan: PlanSpec,
    /// Fields of the scene that vary from run to run, in the same way for every design.
    #[serde(default)]
    pub vary: Ordered<Distribution>,
    /// One number of each run each, by their names.
    pub metrics: Ordered<MetricSpec>,
    /// How the search goes about it.
    #[serde(default)]
    pub search: EffortSpec,
}

/// A design variable: bounds, and what follows from it.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "variable", deny_unknown_fields)]
pub struct VariableSpec {
    /// Lower bound, in the unit of the field.
    pub from: f64,
    /// Upper bound, in the unit of the field.
    pub to: f64,
    /// How the way between the bounds is measured.
    #[serde(default)]
    pub scale: Scale,
    /// Whether it has whole numbers only.
    #[serde(default)]
    pub integer: bool,
    /// A value to begin with; a search with starts of all its variables begins there.
    #[serde(default)]
    pub start: Option<f64>,
    /// The fields that follow from it, by their paths; the one that it is named after unless given.
    #[serde(default)]
    pub sets: Ordered<Law>,
}

/// How the way between bounds is measured.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
pub enum Scale {
    /// By differences.
    #[default]
    Linear,
    /// By ratios.
    Log,
}

/// How a field follows from a variable: `factor * variable^power`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "law", deny_unknown_fields)]
pub struct Law {
    /// The factor.
    #[serde(default = "one")]
    pub factor: f64,
    /// The power.
    #[serde(default = "one")]
    pub power: f64,
}

fn one() -> f64 {
    1.0
}

/// What is to be as small or as large as can be.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "objective")]
pub enum Objective {
    /// As small as can be.
    Minimise(
        /// Of what.
        Measure,
    ),
    /// As large as can be.
    Maximise(
        /// Of what.
        Measure,
    ),
}

impl Objective {
    /// What is looked at.
    #[must_use]
    pub fn measure(&self) -> &Measure {
        match self {
            Self::Minimise(measure) | Self::Maximise(measure) => measure,
        }
    }

    /// -1 where large is good, 1 where small is.
    #[must_use]
    pub fn sign(&self) -> f64 {
        match self {
            Self::Minimise(_) => 1.0,
            Self::Maximise(_) => -1.0,
        }
    }
}

/// What a design has to keep to.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "constraint", deny_unknown_fields)]
pub struct ConstraintSpec {
    /// What is limited.
    pub of: Measure,
    /// The largest value that is allowed, in its unit.
    #[serde(default)]
    pub at_most: Option<f64>,
    /// The smallest value that is allowed, in its unit.
    #[serde(default)]
    pub at_least: Option<f64>,
}

impl ConstraintSpec {
    /// By how much a value is above or below what is allowed, in its unit; 0 where it is allowed.
    #[must_use]
    pub fn violation(&self, value: f64) -> f64 {
        let above = self.at_most.map_or(0.0, |most| value - most);
        let below = self.at_least.map_or(0.0, |least| least - value);
        above.max(below).max(0.0)
    }

    /// What is left to each limit, in the unit of the value: negative where it is not kept to.
    pub(super) fn margins(&self, value: f64) -> impl Iterator<Item = f64> {
        let above = self.at_most.map(|most| most - value);
        above
            .into_iter()
            .chain(self.at_least.map(|least| value - least))
    }
}

/// How the search goes about it.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename = "search", default, deny_unknown_fields)]
pub struct EffortSpec {
    /// Designs that are spread over the whole box first; 8 for each variable unless given.
    pub sample: Option<u64>,
    /// Local searches, from the best designs of the sample; 2 of one variable and 4 of more unless given.
    pub starts: Option<u64>,
    /// Where local searches end, in parts of the way between the bounds.
    pub tolerance: f64,
    /// The most designs that are evaluated.
    pub evaluations: u64,
}

impl Default for EffortSpec {
    fn default() -> Self {
        Self {
            sample: None,
            starts: None,
            tolerance: 1e-4,
            evaluations: 500,
        }
    }
}

impl EffortSpec {
    /// Designs that are spread over the box of so many variables.
    #[must_use]
    pub fn sample_of(&self, variables: usize) -> u64 {
        self.sample.unwrap_or(8 * variables as u64)
    }

    /// Local searches with so many variables.
    #[must_use]
    pub fn starts_of(&self, variables: usize) -> u64 {
        self.starts.unwrap_or(if variables == 1 { 2 } else { 4 })
    }

    fn check(&self, report: &mut FieldReport) {
        let counts = [
            ("sample", self.sample.unwrap_or(1)),
            ("starts", self.starts.unwrap_or(1)),
            ("evaluations", self.evaluations),
        ];
        for (field, count) in counts {
            if !(1..=MOST_EVALUATIONS).contains(&count) {
                let message =
                    format!("`{field}` must be from 1 to {MOST_EVALUATIONS}, it is {count}");
                report.add(field, message, "");
            }
        }
        if !(1e-12..=0.1).contains(&self.tolerance) {
            let message = format!(
                "`tolerance` must be from 1e-12 to 0.1, it is {}",
                self.tolerance
            );
            report.add("tolerance", message, "in parts of the way between bounds");
        }
    }
}

/// Reads a search from its text; `file_name` stands in messages.
///
/// # Errors
/// Everything that is wrong with the text itself, rendered.
pub fn read_search(file_name: &str, text: &str) -> Result<(SearchSpec, Source), SceneError> {
    let (search, source) = read_as::<SearchSpec>(file_name, text)?;
    let mut faults = Faults::default();
    search.check(&mut faults.0);
    faults.into_result(&source)?;
    Ok((search, source))
}

impl SearchSpec {
    /// The runs of a design as a campaign, with the same paths in its text.
    #[must_use]
    pub fn as_campaign(&self) -> CampaignSpec {
        CampaignSpec {
            name: self.name.clone(),
            about: self.about.clone(),
            scene: self.scene.clone(),
            runs: if self.is_once() { Some(1) } else { self.runs },
            base_samples: None,
            seed: self.seed,
            plan: self.plan.clone(),
            set: self.set.clone(),
            vary: self.vary.clone(),
            metrics: self.metrics.clone(),
            envelopes: Ordered::default(),
            keep: KeepSpec::default(),
        }
    }

    /// Whether a design is run once, as its scene stands.
    #[must_use]
    pub fn is_once(&self) -> bool {
        self.runs.is_none() && self.plan == PlanSpec::MonteCarlo
    }

    /// The measures of a search, with their paths in its text.
    pub(super) fn measures(&self) -> impl Iterator<Item = (String, &Measure)> {
        let objective = ("objective.0".to_owned(), self.objective.measure());
        let constraints = self.constraints.0.iter();
        let constraints = constraints
            .map(|(name, limit)| (format!("{}.of", entry_path("constraints", name)), &limit.of));
        [objective].into_iter().chain(constraints)
    }

    fn check(&self, report: &mut FieldReport) {
        self.as_campaign().check(report);
        check_variables(self, report);
        if self.is_once() && !self.vary.0.is_empty() {
            let help = "how many runs each design has: `runs: 40`";
            report.add("vary", "what varies needs `runs`", help);
        }
        for (path, measure) in self.measures() {
            report.within(&path, |report| measure.check(self, report));
        }
        for (name, limit) in &self.constraints.0 {
            let path = entry_path("constraints", name);
            check_name(&path, name, report);
            check_unit(&path, name, &limit.of.unit(self), report);
            match (limit.at_most, limit.at_least) {
                (None, None) => {
                    let help = "give `at_most`, `at_least`, or both";
                    report.add(&path, "there is no limit", help);
                }
                (Some(most), Some(least)) if least >= most => {
                    let message = format!("the limits are crossed: {least} is not below {most}");
                    report.add(&format!("{path}.at_least"), message, "");
                }
                _ => {}
            }
            if name == "objective" || self.variables.0.iter().any(|(other, _)| other == name) {
                let help = "each is a column of the table of evaluations";
                report.add(&path, format!("the name `{name}` is taken"), help);
            }
        }
        report.within("search", |report| self.search.check(report));
    }
}
