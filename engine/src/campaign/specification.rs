//! The campaign file: what it holds, and what can be wrong with it before its scene is read.

use aerobot_components::scene_component::FieldReport;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::distributions::Distribution;
use super::envelopes::EnvelopeSpec;
use super::metrics::MetricSpec;
use super::ordered::{Ordered, RonText};
use super::quantity::Quantity;
use crate::scene::SceneError;
use crate::scene::load::{echoes, locate, read_tree, text_diagnostics};
use crate::scene::source::{Diagnostic, FieldPath, Segment, Source, parse_fields};

/// The most runs of a campaign.
pub const MOST_RUNS: u64 = 100_000_000;

/// A campaign as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "campaign", deny_unknown_fields)]
pub struct CampaignSpec {
    /// Its name.
    pub name: String,
    /// What it shows.
    #[serde(default)]
    pub about: String,
    /// The scene, a file relative to the campaign's own folder.
    pub scene: String,
    /// Number of runs; a plan in steps knows its own.
    #[serde(default)]
    pub runs: Option<u64>,
    /// Number of base samples of a `Saltelli` plan, each of which takes a run for each factor and two more.
    #[serde(default)]
    pub base_samples: Option<u64>,
    /// Seed of everything that is drawn.
    #[serde(default)]
    pub seed: u64,
    /// How inputs are spread over the runs.
    #[serde(default)]
    pub plan: PlanSpec,
    /// Fields of the scene that are the same in all runs, by their paths.
    #[serde(default)]
    pub set: Ordered<RonText>,
    /// Fields of the scene that vary, by their paths.
    #[serde(default)]
    pub vary: Ordered<Distribution>,
    /// One number of each run each, by their names in the table.
    pub metrics: Ordered<MetricSpec>,
    /// Percentiles over all runs as time goes, by their names in the table.
    #[serde(default)]
    pub envelopes: Ordered<EnvelopeSpec>,
    /// Of which runs everything is kept.
    #[serde(default)]
    pub keep: KeepSpec,
}

/// How inputs are spread over the runs.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "plan")]
pub enum PlanSpec {
    /// Every run draws from the distributions by itself: its inputs follow from the seed and its index alone.
    #[default]
    MonteCarlo,
    /// Each field is cut into as many parts of the same probability as there are runs, and each part is
    /// taken once: inputs follow from the seed, the index and the number of runs.
    LatinHypercube,
    /// Sobol's sequence, shifted by the seed: inputs follow from the seed and the index alone.
    Sobol,
    /// For Sobol indices (Saltelli et al., Computer Physics Communications 181, 259 (2010)): of each base sample two
    /// independent runs A and B, and for each factor one that is A with that factor of B. Factors are the fields
    /// that vary and `run.seed`, which stands for chance, unless it is set. A and B are two halves of one point of
    /// the shifted Sobol sequence.
    Saltelli,
    /// Every combination of the fields in steps, the last field fastest; others are drawn as in `MonteCarlo`.
    Grid,
    /// The fields in steps go side by side; others are drawn as in `MonteCarlo`.
    Lists,
    /// A CSV file, relative to the campaign's own folder, with paths in its first row and a row for each
    /// run; fields of `vary` are drawn as in `MonteCarlo`.
    Table(String),
}

/// Of which runs everything is kept that `aerobot run` would write.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "keep", deny_unknown_fields)]
pub struct KeepSpec {
    /// Runs that stopped before their end.
    #[serde(default)]
    pub failures: bool,
    /// Runs 0, n, 2n and so on; none unless given.
    #[serde(default)]
    pub every: Option<u64>,
    /// Runs by their index.
    #[serde(default)]
    pub runs: Vec<u64>,
    /// The runs with the largest and the smallest value of these metrics.
    #[serde(default)]
    pub extremes_of: Vec<String>,
}

/// What is wrong with a campaign, shown in its text.
#[derive(Default)]
pub(crate) struct Faults(pub(crate) FieldReport);

impl Faults {
    /// The message, if there is anything wrong.
    pub(crate) fn into_result(self, source: &Source) -> Result<(), SceneError> {
        let violations = self.0.into_violations();
        if violations.is_empty() {
            return Ok(());
        }
        Err(refuse(source, &locate(source, violations)))
    }
}

fn refuse(source: &Source, diagnostics: &[Diagnostic]) -> SceneError {
    SceneError {
        text: source.render(diagnostics).trim_end().to_owned(),
    }
}

/// The path of an entry of a map as it stands in reports: `vary."run.seed"`.
pub(crate) fn entry_path(map: &str, name: &str) -> String {
    let path = FieldPath::default()
        .join(Segment::Name(map.to_owned()))
        .join(Segment::Name(name.to_owned()));
    path.to_string()
}

/// Reads a campaign from its text; `file_name` stands in messages.
///
/// # Errors
/// Everything that is wrong with the text itself, rendered.
pub fn read_specification(
    file_name: &str,
    text: &str,
) -> Result<(CampaignSpec, Source), SceneError> {
    let (specification, source) = read_as::<CampaignSpec>(file_name, text)?;
    let mut faults = Faults::default();
    specification.check(&mut faults.0);
    faults.into_result(&source)?;
    Ok((specification, source))
}

/// Reads a specification of any type; what it says is not checked yet.
pub(crate) fn read_as<T: DeserializeOwned>(
    file_name: &str,
    text: &str,
) -> Result<(T, Source), SceneError> {
    let source = Source::new(file_name, text);
    let root = read_tree(&source).map_err(|diagnostic| refuse(&source, &[diagnostic]))?;
    let in_text = text_diagnostics(&source, &root);
    let read = parse_fields::<T>(source.text(), &root, "");
    match read {
        Ok(specification) if in_text.is_empty() => Ok((specification, source)),
        found => {
            let mut diagnostics = found.err().unwrap_or_default();
            diagnostics.retain(|diagnostic| !echoes(diagnostic, &in_text));
            diagnostics.extend(in_text);
            Err(refuse(&source, &diagnostics))
        }
    }
}

impl CampaignSpec {
    pub(crate) fn check(&self, report: &mut FieldReport) {
        check_name("name", &self.name, report);
        let set: Vec<(&str, &String)> = self.set.0.iter().map(|(path, _)| ("set", path)).collect();
        let vary: Vec<(&str, &String)> =
            self.vary.0.iter().map(|(path, _)| ("vary", path)).collect();
        for (map, path) in set.iter().chain(&vary) {
            if let Err(why) = path.parse::<FieldPath>() {
                report.add(&entry_path(map, path), why, "");
            }
        }
        for (_, path) in &vary {
            if set.iter().any(|(_, other)| other == path) {
                let message = format!("`{path}` is set and varies");
                report.add(&entry_path("vary", path), message, "keep one of the two");
            }
        }
        for (path, distribution) in &self.vary.0 {
            report.within(&entry_path("vary", path), |report| {
                distribution.check(report)
            });
            self.check_steps(path, distribution, report);
        }
        self.check_runs(report);
        if self.metrics.0.is_empty() {
            report.add(
                "metrics",
                "a campaign without a metric finds nothing",
                "give one or more",
            );
        }
        for (name, metric) in &self.metrics.0 {
            let path = entry_path("metrics", name);
            check_name(&path, name, report);
            report.within(&path, |report| metric.check(report));
            check_unit(&path, name, &metric.unit(), report);
        }
        for (name, envelope) in &self.envelopes.0 {
            let path = entry_path("envelopes", name);
            check_name(&path, name, report);
            check_unit(&path, name, envelope.quantity().unit(), report);
        }
        for (index, name) in self.keep.extremes_of.iter().enumerate() {
            if !self.metrics.0.iter().any(|(metric, _)| metric == name) {
                let names = self.metrics.0.iter().map(|(name, _)| name.as_str());
                let near = crate::scene::source::nearest(name, names);
                let help = near.map_or_else(String::new, |near| format!("did you mean `{near}`?"));
                let message = format!("there is no metric `{name}`");
                report.add(&format!("keep.extremes_of.{index}"), message, help);
            }
        }
        if self.keep.every == Some(0) {
            report.add("keep.every", "`every` must be 1 or more", "");
        }
    }

    /// Values in steps and plans in steps belong together.
    fn check_steps(&self, path: &str, distribution: &Distribution, report: &mut FieldReport) {
        let steps_fit = matches!(self.plan, PlanSpec::Grid | PlanSpec::Lists);
        if distribution.steps().is_some() && !steps_fit {
            report.add(
                &entry_path("vary", path),
                "values in steps need `plan: Grid` or `plan: Lists`",
                "`Choice([..])` draws one of several values",
            );
        }
    }

    fn check_runs(&self, report: &mut FieldReport) {
        let of_base_samples = self.plan == PlanSpec::Saltelli && self.base_samples.is_some();
        let knows_itself = matches!(
            self.plan,
            PlanSpec::Grid | PlanSpec::Lists | PlanSpec::Table(_)
        );
        if self.base_samples.is_some() && self.plan != PlanSpec::Saltelli {
            let message = "only `plan: Saltelli` has base samples";
            report.add("base_samples", message, "leave it out, or give `runs`");
        }
        for (field, count) in [("runs", self.runs), ("base_samples", self.base_samples)] {
            if let Some(count) = count.filter(|count| *count == 0 || *count > MOST_RUNS) {
                let message = format!("`{field}` must be from 1 to {MOST_RUNS}, it is {count}");
                report.add(field, message, "");
            }
        }
        if self.runs.is_none() && !knows_itself && !of_base_samples {
            let help = match self.plan {
                PlanSpec::Saltelli => "how many base samples: `base_samples: 256`",
                _ => "how many runs: `runs: 1000`",
            };
            report.add("", "`runs` is missing", help);
        }
    }

    /// Everything that metrics and envelopes look at, with the path of its channel in the text.
    pub(super) fn quantities(&self) -> Vec<(String, Quantity)> {
        let metrics = self
            .metrics
            .0
            .iter()
            .map(|(name, metric)| (entry_path("metrics", name), metric.quantity()));
        let envelopes = self
            .envelopes
            .0
            .iter()
            .map(|(name, envelope)| (entry_path("envelopes", name), envelope.quantity()));
        metrics.chain(envelopes).collect()
    }
}

pub(crate) fn check_name(path: &str, name: &str, report: &mut FieldReport) {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
        let message = format!("`{name}` cannot be a name here");
        report.add(
            path,
            message,
            "it stands in tables: use letters, digits, `-`, `_` and `.`",
        );
    }
}

/// A name in a table ends with the unit of what it names.
pub(crate) fn check_unit(path: &str, name: &str, unit: &str, report: &mut FieldReport) {
    if !unit.is_empty() && !name.ends_with(&format!("_{unit}")) {
        report.add(
            path,
            format!("the name `{name}` does not end with its unit `_{unit}`"),
            format!("call it `{name}_{unit}`"),
        );
    }
}
