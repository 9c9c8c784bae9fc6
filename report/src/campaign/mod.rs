//! Campaigns and design searches as they were finished, and figures of what their runs have in common.
//!
//! | module | subject |
//! |---|---|
//! | `record` | the folder of a finished campaign, read back |
//! | `tables` | its tables: a row for each run, percentiles as time goes |
//! | `kind` | which figures there are, and which make sense of a campaign |
//! | `figures` | one room for each of them |
//! | `search` | a design search: its designs, and how its best value came about |

mod figures;
mod kind;
mod record;
mod search;
mod tables;

pub use figures::covariance_ellipse::{Spread, share_within};
pub use kind::CampaignFigure;
pub use record::{CampaignRecord, FailedRun};
pub use search::{EvaluatedDesign, SearchRecord};
pub use tables::{Envelope, RunRows};
