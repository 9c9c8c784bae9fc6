//! Which figures of campaigns there are, and which make sense of a campaign.

use std::fmt;
use std::str::FromStr;

use super::CampaignRecord;
use super::figures::{convergence, covariance_ellipse, envelope, histogram, tornado};
use crate::figure::Figure;

/// A figure of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CampaignFigure {
    /// Percentiles as time goes.
    Envelope,
    /// How often each metric has which values.
    Histogram,
    /// Where bodies end.
    Ellipse,
    /// Which field drives which metric.
    Tornado,
    /// How the mean of each metric settles as runs come in.
    Convergence,
}

impl CampaignFigure {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Envelope,
        Self::Histogram,
        Self::Ellipse,
        Self::Tornado,
        Self::Convergence,
    ];

    /// Its name, by which it is asked for.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Envelope => "envelope",
            Self::Histogram => "histogram",
            Self::Ellipse => "ellipse",
            Self::Tornado => "tornado",
            Self::Convergence => "convergence",
        }
    }

    /// What it shows, in a few words.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::Envelope => "of a campaign: percentiles as time goes",
            Self::Histogram => "of a campaign: how often each metric has which values",
            Self::Ellipse => "of a campaign: where bodies end, with ellipses of their covariance",
            Self::Tornado => "of a campaign: which field drives which metric",
            Self::Convergence => "of a campaign: how means settle as runs come in",
        }
    }
}

impl fmt::Display for CampaignFigure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for CampaignFigure {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("there is no figure `{name}` of a campaign; there are {names}")
        })
    }
}

impl CampaignRecord {
    /// A figure of the campaign.
    ///
    /// # Errors
    /// Why it has none of this kind.
    pub fn figure(&self, kind: CampaignFigure) -> Result<Figure, String> {
        match kind {
            CampaignFigure::Envelope => envelope::figure(self),
            CampaignFigure::Histogram => histogram::figure(self),
            CampaignFigure::Ellipse => covariance_ellipse::figure(self),
            CampaignFigure::Tornado => tornado::figure(self),
            CampaignFigure::Convergence => convergence::figure(self),
        }
    }

    /// The figures that make sense of it.
    #[must_use]
    pub fn kinds(&self) -> Vec<CampaignFigure> {
        let all = CampaignFigure::ALL.into_iter();
        all.filter(|kind| self.figure(*kind).is_ok()).collect()
    }
}
