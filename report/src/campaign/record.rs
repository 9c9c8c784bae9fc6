//! The folder of a finished campaign, read back.

use std::fs;
use std::path::{Path, PathBuf};

use aerobot_engine::campaign::CampaignError;
use aerobot_engine::campaign::manifest::{INPUT, MANIFEST};
use aerobot_engine::campaign::preparation::CAMPAIGN_FILE;
use aerobot_engine::campaign::results::SUMMARY_FILE;
use aerobot_engine::campaign::specification::{CampaignSpec, PlanSpec, read_specification};
use aerobot_engine::campaign::summary::CampaignSummary;

use super::tables::{Envelope, RunRows, read_envelopes, read_runs};

/// A finished campaign.
#[derive(Clone, Debug)]
pub struct CampaignRecord {
    /// What readers call it: the name of its folder.
    pub label: String,
    /// Its folder.
    pub folder: PathBuf,
    /// The campaign as written.
    pub specification: CampaignSpec,
    /// What its runs have in common.
    pub summary: CampaignSummary,
    /// Its runs, in the order of their indices.
    pub runs: RunRows,
    /// Percentiles as time goes, in the order of the campaign.
    pub envelopes: Vec<Envelope>,
}

/// A run that did not get to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedRun {
    /// Its index.
    pub run: u64,
    /// `stopped` or `refused`.
    pub outcome: String,
    /// Why.
    pub reason: String,
    /// The command that repeats it with everything that it writes.
    pub replay: String,
}

impl CampaignRecord {
    /// Reads the folder of a finished campaign.
    ///
    /// # Errors
    /// It is not one, or what is in it cannot be read.
    pub fn read(folder: &Path) -> Result<Self, CampaignError> {
        let input = Path::new(INPUT).join(CAMPAIGN_FILE);
        for needed in [
            Path::new(MANIFEST),
            &input,
            Path::new("runs.csv"),
            Path::new(SUMMARY_FILE),
        ] {
            if !folder.join(needed).is_file() {
                let message = format!(
                    "`{}` is not the folder of a finished campaign: it has no `{}`",
                    folder.display(),
                    needed.display()
                );
                let help = "`aerobot campaign run FILE --out DIR` makes one; of shards, `aerobot campaign merge DIR`";
                return Err(CampaignError::refused(message, help));
            }
        }
        let file = folder.join(input);
        let text = fs::read_to_string(&file);
        let text = text.map_err(|error| CampaignError::unreadable(&file, &error))?;
        let (specification, _) = read_specification(&file.display().to_string(), &text)?;
        let label = folder.file_name().unwrap_or(folder.as_os_str());
        Ok(Self {
            label: label.to_string_lossy().into_owned(),
            folder: folder.to_owned(),
            runs: read_runs(folder, &specification)?,
            envelopes: read_envelopes(folder, &specification)?,
            summary: read_summary(&folder.join(SUMMARY_FILE))?,
            specification,
        })
    }

    /// The place of a metric in the campaign.
    #[must_use]
    pub fn metric_place(&self, name: &str) -> Option<usize> {
        let metrics = &self.specification.metrics.0;
        metrics.iter().position(|(metric, _)| metric == name)
    }

    /// Whether a run counts for means, percentiles and correlations: of a Saltelli plan those of A and B.
    pub fn independence(&self) -> impl Fn(u64) -> bool + use<> {
        let is_saltelli = self.specification.plan == PlanSpec::Saltelli;
        let indices = &self.summary.sobol_indices;
        let metric = indices.first().map(|index| &index.metric);
        let factors = indices.iter().filter(|index| Some(&index.metric) == metric);
        let runs_each = factors.count() as u64 + 2;
        move |run| !is_saltelli || run % runs_each < 2
    }

    /// The values of a metric (by its place) of the runs that count and have it, in the order of the runs.
    #[must_use]
    pub fn values(&self, place: usize) -> Vec<f64> {
        let Some(column) = self.runs.metrics.get(place) else {
            return Vec::new();
        };
        let rows = self.runs.indices.iter().zip(column);
        let counts = self.independence();
        rows.filter(|(run, _)| counts(**run))
            .filter_map(|(_, value)| *value)
            .collect()
    }

    /// The runs that did not get to their end, in the order of their indices.
    #[must_use]
    pub fn failures(&self) -> Vec<FailedRun> {
        let failures = self.runs.failures.iter();
        failures
            .map(|(run, outcome, reason)| FailedRun {
                run: *run,
                outcome: outcome.clone(),
                reason: reason.clone(),
                replay: format!(
                    "aerobot campaign replay {} --run {run}",
                    self.folder.display()
                ),
            })
            .collect()
    }
}

fn read_summary(file: &Path) -> Result<CampaignSummary, CampaignError> {
    let text = fs::read_to_string(file);
    let text = text.map_err(|error| CampaignError::unreadable(file, &error))?;
    serde_json::from_str(&text).map_err(|error| {
        let message = format!(
            "{}:{}:{}: this is not the summary of a campaign: {error}",
            file.display(),
            error.line(),
            error.column()
        );
        CampaignError::refused(message, "")
    })
}
