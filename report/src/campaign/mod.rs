//! A campaign as it was finished, and figures of what its runs have in common.
//!
//! | module | subject |
//! |---|---|
//! | `record` | the folder of a finished campaign, read back |
//! | `tables` | its tables: a row for each run, percentiles as time goes |
//! | `kind` | which figures there are, and which make sense of a campaign |
//! | `figures` | one room for each of them |

mod figures;
mod kind;
mod record;
mod tables;

pub use figures::covariance_ellipse::{Spread, share_within};
pub use kind::CampaignFigure;
pub use record::{CampaignRecord, FailedRun};
pub use tables::{Envelope, RunRows};
