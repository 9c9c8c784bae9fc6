//! `envelopes.csv` and `envelopes.parquet`: percentiles at each time over the runs that got there.

use super::CampaignError;
use super::definition::Campaign;
use super::envelopes::{PERCENTILES, percentiles_of};
use super::finished_runs::FinishedRuns;
use super::paired_table::PairedTable;
use super::quantity::unit_symbol;
use super::record::number;
use crate::recording::parquet_table::{ColumnKind, ColumnSpec};

/// Name of the tables of envelopes, without its ending.
pub const ENVELOPES: &str = "envelopes";

/// Writes both tables, if there are envelopes.
///
/// # Errors
/// What the file system refused.
pub(super) fn write_envelopes(
    campaign: &Campaign,
    runs: &FinishedRuns,
) -> Result<(), CampaignError> {
    let envelopes = &campaign.specification.envelopes.0;
    if envelopes.is_empty() {
        return Ok(());
    }
    let units: Vec<(String, String)> = (envelopes.iter())
        .map(|(name, envelope)| (name.clone(), unit_symbol(envelope.quantity().unit())))
        .collect();
    let mut table = PairedTable::create(&campaign.folder, ENVELOPES, &columns(), &units)?;
    let bins: Vec<Bin> = (runs.times().iter().enumerate())
        .flat_map(|(envelope, times)| (0..*times).map(move |time| Bin { envelope, time }))
        .collect();
    for bins in bins.chunks(bins_at_once(runs.done())) {
        for (bin, mut values) in bins.iter().zip(values_of(campaign, runs, bins)?) {
            let (name, envelope) = &envelopes[bin.envelope];
            let time_s = bin.time as f64 * envelope.every_s;
            table.text(name).number(Some(time_s));
            table.whole(values.len() as u64);
            for value in percentiles_of(&mut values) {
                table.number(value);
            }
            table.end_row()?;
        }
    }
    table.finish()
}

/// Memory for the values of the times that are folded at once, bytes: those of a million runs at 8 times.
const MEMORY: u64 = 64 << 20;

/// A time of an envelope, by their places.
#[derive(Clone, Copy, Debug)]
struct Bin {
    envelope: usize,
    time: usize,
}

/// Of how many times the values of so many runs are held at once.
fn bins_at_once(runs: u64) -> usize {
    usize::try_from(MEMORY / (8 * runs.max(1))).map_or(1, |bins| bins.max(1))
}

/// The values of all runs at each of some times that follow each other: one pass through the journals.
fn values_of(
    campaign: &Campaign,
    runs: &FinishedRuns,
    bins: &[Bin],
) -> Result<Vec<Vec<f64>>, CampaignError> {
    let done = usize::try_from(runs.done()).unwrap_or(0);
    let mut values: Vec<Vec<f64>> = bins.iter().map(|_| Vec::with_capacity(done)).collect();
    runs.each_done(campaign, &mut |line| {
        let mut start = 0;
        for bins in bins.chunk_by(|a, b| a.envelope == b.envelope) {
            let texts = line.envelope(bins[0].envelope).skip(bins[0].time);
            for (values, text) in values[start..start + bins.len()].iter_mut().zip(texts) {
                values.extend(number(text));
            }
            start += bins.len();
        }
    })?;
    Ok(values)
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
