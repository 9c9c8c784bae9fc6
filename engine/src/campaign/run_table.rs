//! `runs.csv` and `runs.parquet`: a row for each run, with its index, its seed, what varies, how it ended and why,
//! and its metrics.

use super::CampaignError;
use super::definition::Campaign;
use super::finished_runs::FinishedRuns;
use super::paired_table::PairedTable;
use super::quantity::{unit_of, unit_symbol};
use super::record::Outcome;
use crate::recording::parquet_table::{ColumnKind, ColumnSpec};
use crate::scene::source::{FieldPath, Segment};

/// Name of the tables of runs, without its ending.
pub const RUNS: &str = "runs";

/// Writes both tables.
///
/// # Errors
/// What the file system refused.
pub(super) fn write_runs(campaign: &Campaign, runs: &FinishedRuns) -> Result<(), CampaignError> {
    let mut table = PairedTable::create(&campaign.folder, RUNS, &columns(campaign), &[])?;
    for index in 0..runs.count() {
        let inputs = campaign.plan.inputs(index);
        table.whole(index).given(&inputs.seed);
        for (_, value) in &inputs.fields {
            table.given(value);
        }
        let outcome = runs.outcome(index).unwrap_or(Outcome::Refused);
        let reason = match outcome {
            Outcome::Done => String::new(),
            _ => runs.record(campaign, index)?.reason,
        };
        table.text(outcome.word()).text(&reason);
        table.number(runs.simulated_s(index));
        for place in 0..campaign.counts().0 {
            table.number(runs.metric(index, place));
        }
        table.end_row()?;
    }
    table.finish()
}

fn columns(campaign: &Campaign) -> Vec<ColumnSpec> {
    let column = |name: &str, kind, unit: &str| ColumnSpec {
        name: name.to_owned().into(),
        kind,
        unit: unit.to_owned().into(),
    };
    let mut columns = vec![
        ColumnSpec::fixed("run", ColumnKind::Whole, ""),
        ColumnSpec::fixed("seed", ColumnKind::Whole, ""),
    ];
    for (place, name) in campaign.plan.field_names().into_iter().enumerate() {
        let (kind, unit) = match campaign.plan.is_numeric(place) {
            true => (ColumnKind::Number, unit_of_field(name)),
            false => (ColumnKind::Text, String::new()),
        };
        columns.push(column(name, kind, &unit));
    }
    columns.push(ColumnSpec::fixed("outcome", ColumnKind::Text, ""));
    columns.push(ColumnSpec::fixed("reason", ColumnKind::Text, ""));
    columns.push(ColumnSpec::fixed("simulated_s", ColumnKind::Number, "s"));
    for (name, metric) in &campaign.specification.metrics.0 {
        columns.push(column(
            name,
            ColumnKind::Number,
            &unit_symbol(&metric.unit()),
        ));
    }
    columns
}

/// The unit at the end of the last name of a path: a part of `velocity_m_s` has that of the whole.
fn unit_of_field(path: &str) -> String {
    let path = path.parse::<FieldPath>().unwrap_or_default();
    let last = path
        .segments
        .iter()
        .rev()
        .find_map(|segment| match segment {
            Segment::Name(name) => Some(name.as_str()),
            Segment::Index(_) => None,
        });
    unit_symbol(unit_of(last.unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_fields() {
        for (path, unit) in [
            ("entities.a.Body.mass_kg", "kg"),
            ("environment.wind.0.Uniform.velocity_m_s.2", "m/s"),
            ("run.seed", ""),
            ("environment.density_kg_m3", "kg/m3"),
        ] {
            assert_eq!(unit_of_field(path), unit, "{path}");
        }
    }
}
