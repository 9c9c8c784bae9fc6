//! `envelopes.csv` and `envelopes.parquet`: percentiles at each time over the runs that got there.

use super::CampaignError;
use super::definition::Campaign;
use super::envelopes::{PERCENTILES, percentiles_of};
use super::paired_table::PairedTable;
use super::quantity::unit_symbol;
use super::record::Outcome;
use super::running::Records;
use crate::recording::parquet_table::{ColumnKind, ColumnSpec};

/// Name of the tables of envelopes, without its ending.
pub const ENVELOPES: &str = "envelopes";

/// Writes both tables, if there are envelopes.
///
/// # Errors
/// What the file system refused.
pub(super) fn write_envelopes(campaign: &Campaign, records: &Records) -> Result<(), CampaignError> {
    let envelopes = &campaign.specification.envelopes.0;
    if envelopes.is_empty() {
        return Ok(());
    }
    let units: Vec<(String, String)> = (envelopes.iter())
        .map(|(name, envelope)| (name.clone(), unit_symbol(envelope.quantity().unit())))
        .collect();
    let mut table = PairedTable::create(&campaign.folder, ENVELOPES, &columns(), &units)?;
    for (place, (name, envelope)) in envelopes.iter().enumerate() {
        let done = || {
            let records = records.values();
            let done = records.filter(|record| record.outcome == Outcome::Done);
            done.filter_map(|record| record.envelopes.get(place))
        };
        let times = done().map(Vec::len).max().unwrap_or(0);
        for time in 0..times {
            let mut values: Vec<f64> = done().filter_map(|run| run.get(time).copied()).collect();
            table
                .text(name)
                .number(Some(time as f64 * envelope.every_s));
            table.whole(values.len() as u64);
            for value in percentiles_of(&mut values) {
                table.number(value);
            }
            table.end_row()?;
        }
    }
    table.finish()
}

/// The unit of a percentile is that of the envelope, by its name.
fn columns() -> Vec<ColumnSpec> {
    let mut columns = vec![
        ColumnSpec::fixed("envelope", ColumnKind::Text, ""),
        ColumnSpec::fixed("time_s", ColumnKind::Number, "s"),
        ColumnSpec::fixed("runs", ColumnKind::Whole, ""),
    ];
    columns.extend(PERCENTILES.map(|percent| ColumnSpec {
        name: format!("p{percent:02}").into(),
        kind: ColumnKind::Number,
        unit: "".into(),
    }));
    columns
}
