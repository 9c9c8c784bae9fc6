//! What was found of a design.

use super::design::Design;
use super::measure::Judged;
use super::specification::SearchSpec;
use crate::campaign::record::{Outcome, Record};
use crate::recording::number::number_text;
use crate::scene::{Scene, SceneError};

/// What was found of a design. Numbers are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Its number, from 0, in the order of the search.
    pub index: u64,
    /// What the search did with it, in a word.
    pub stage: &'static str,
    /// The design.
    pub design: Design,
    /// What was found; of a design that failed, why.
    pub found: Result<Found, String>,
}

/// The numbers of a design that did not fail.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The objective, in its unit.
    pub objective: f64,
    /// What is limited, in the order of the constraints, each in its unit.
    pub constraints: Vec<f64>,
}

impl Found {
    /// Whether every constraint is kept to, with no tolerance.
    #[must_use]
    pub fn is_feasible(&self, search: &SearchSpec) -> bool {
        let mut limits = search.constraints.0.iter().zip(&self.constraints);
        limits.all(|((_, limit), value)| limit.violation(*value) == 0.0)
    }
}

impl Evaluation {
    /// Whether the design did not fail and keeps to every constraint.
    #[must_use]
    pub fn is_feasible(&self, search: &SearchSpec) -> bool {
        let found = self.found.as_ref();
        found.is_ok_and(|found| found.is_feasible(search))
    }

    /// The objective of a feasible design, made such that small is good.
    #[must_use]
    pub fn merit(&self, search: &SearchSpec) -> Option<f64> {
        let found = self.found.as_ref().ok()?;
        let merit = search.objective.sign() * found.objective;
        found.is_feasible(search).then_some(merit)
    }

    /// Why a design is not feasible; empty if it is.
    #[must_use]
    pub fn reason(&self, search: &SearchSpec) -> String {
        let found = match &self.found {
            Ok(found) => found,
            Err(reason) => return reason.clone(),
        };
        let limits = search.constraints.0.iter().zip(&found.constraints);
        let broken = limits.filter_map(|((name, limit), value)| {
            let value_text = number_text(*value);
            let above = limit.at_most.filter(|most| value > most);
            let below = limit.at_least.filter(|least| value < least);
            let above = above.map(|most| format!("above {}", number_text(most)));
            let how = above.or_else(|| Some(format!("below {}", number_text(below?))))?;
            Some(format!("{name} is {value_text}, {how}"))
        });
        broken.collect::<Vec<_>>().join("; ")
    }
}

/// Folds the runs of a design, in the order of their indices. `scene` is there if a measure needs it.
pub(super) fn judge(
    search: &SearchSpec,
    design: &Design,
    scene: Option<Result<Scene, SceneError>>,
    runs: &[&Record],
) -> Result<Found, String> {
    if let Some(failed) = runs.iter().find(|run| run.outcome != Outcome::Done) {
        let word = failed.outcome.word();
        let reason = &failed.reason;
        return Err(if runs.len() == 1 {
            format!("{word}: {reason}")
        } else {
            format!("run {} {word}: {reason}", failed.index)
        });
    }
    let scene = scene.transpose();
    let scene = scene.map_err(|error| crate::campaign::one_run::first_line(&error))?;
    let metrics: Vec<&[Option<f64>]> = runs.iter().map(|run| run.metrics.as_slice()).collect();
    let judged = Judged {
        search,
        variables: &design.values,
        scene: scene.as_ref(),
        runs: &metrics,
    };
    let missing = |name: &str| format!("`{name}` has no value in one of its runs");
    let objective = search.objective.measure().value(&judged);
    let limits = search.constraints.0.iter();
    let constraints = limits.map(|(name, limit)| {
        let value = limit.of.value(&judged);
        value.ok_or_else(|| missing(name))
    });
    Ok(Found {
        objective: objective.ok_or_else(|| missing("objective"))?,
        constraints: constraints.collect::<Result<_, _>>()?,
    })
}
