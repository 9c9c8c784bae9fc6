//! Campaigns: many runs of one scene with inputs that vary, and what they have in common.
//!
//! [`specification`] is the file as written; [`preparation`] checks it against its scene and makes of it a folder
//! that needs nothing outside of itself; [`definition`] opens such a folder, and [`one_run`] does a run of it.
//! Runs go to a [`journal`] for each shard, line by line, and [`results`] folds journals in the order of the
//! runs' indices: nothing that is written depends on workers, shards, or how often the program was ended and
//! started again. Histories are never kept: runs of which everything is wanted are run once more.

pub mod comma_separated;
pub mod definition;
pub mod distributions;
pub mod envelope_table;
pub mod envelopes;
mod error;
pub mod fingerprint;
pub mod finished_runs;
pub mod journal;
pub mod latin_hypercube;
pub mod line_journal;
pub mod manifest;
pub mod metrics;
pub mod one_run;
pub mod ordered;
pub(crate) mod paired_table;
pub mod plan;
pub mod plan_tables;
pub mod preparation;
mod probe;
pub mod quantity;
pub mod random_stream;
pub mod record;
pub mod results;
pub mod run_set;
pub mod run_table;
pub mod running;
pub mod saltelli;
pub mod sensitivity;
pub mod shards;
pub mod slurm;
pub mod sobol;
pub mod sobol_indices;
pub mod specification;
pub mod statistics;
pub mod submission;
pub mod summary;
pub mod worker_pool;

pub use error::CampaignError;
