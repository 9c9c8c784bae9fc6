//! Sizes of objective and constraints, by which a search compares them.

use super::evaluation::{Evaluation, Found};
use super::local_search::Told;
use super::specification::SearchSpec;

/// How much objective and constraints differ over a sample of designs, each in its unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scales {
    objective: f64,
    constraints: Vec<f64>,
}

impl Scales {
    /// Of all designs that did not fail.
    pub(super) fn of(search: &SearchSpec, evaluations: &[Evaluation]) -> Self {
        let found = || evaluations.iter().filter_map(|of| of.found.as_ref().ok());
        let constraints = 0..search.constraints.0.len();
        Self {
            objective: spread(found().map(|found| found.objective)),
            constraints: constraints
                .map(|number| spread(found().map(|found| found.constraints[number])))
                .collect(),
        }
    }

    /// How many margins a design has.
    pub(super) fn margins(&self, search: &SearchSpec) -> usize {
        let limits = search.constraints.0.iter();
        limits.map(|(_, limit)| limit.margins(0.0).count()).sum()
    }

    fn margins_of(&self, search: &SearchSpec, found: &Found) -> Vec<f64> {
        let limits = search.constraints.0.iter();
        let values = found.constraints.iter().zip(&self.constraints);
        let margins = limits.zip(values).flat_map(|((_, limit), (value, scale))| {
            limit.margins(*value).map(move |margin| margin / scale)
        });
        margins.collect()
    }

    /// What a local search is told of an evaluation: it is to keep off the limits by the tolerance, since it comes to
    /// the edge of what it is told from either side. One that failed is as bad as the worst of the others in
    /// everything, so that planes through it are not as steep as they could be.
    pub(super) fn told(
        &self,
        search: &SearchSpec,
        evaluations: &[Evaluation],
        place: usize,
    ) -> Told {
        let of = |found: &Found| Told {
            objective: search.objective.sign() * found.objective / self.objective,
            margins: (self.margins_of(search, found).into_iter())
                .map(|margin| margin - search.search.tolerance)
                .collect(),
        };
        if let Some(Ok(found)) = evaluations.get(place).map(|of| &of.found) {
            return of(found);
        }
        let others = evaluations.iter().filter_map(|of| of.found.as_ref().ok());
        let worst = Told {
            objective: f64::NEG_INFINITY,
            margins: vec![-1.0; self.margins(search)],
        };
        let worst = others.map(of).fold(worst, |worst, other| {
            let margins = worst.margins.iter().zip(&other.margins);
            Told {
                objective: worst.objective.max(other.objective),
                margins: margins.map(|(a, b)| a.min(*b)).collect(),
            }
        });
        Told {
            objective: if worst.objective.is_finite() {
                worst.objective + 1.0
            } else {
                0.0
            },
            ..worst
        }
    }

    /// By how much the constraints are broken together, in parts of their sizes.
    fn violation(&self, search: &SearchSpec, found: &Found) -> f64 {
        let margins = self.margins_of(search, found).into_iter();
        margins.map(|margin| (-margin).max(0.0)).sum()
    }

    /// Good designs first: feasible ones by what they are for, others by how much they break, those that failed.
    pub(super) fn rank(&self, search: &SearchSpec, of: &Evaluation) -> (u8, f64) {
        match (&of.found, of.merit(search)) {
            (_, Some(merit)) => (0, merit),
            (Ok(found), None) => (1, self.violation(search, found)),
            (Err(_), None) => (2, 0.0),
        }
    }

    /// The place of the design that breaks constraints the least, together and in parts of their sizes.
    pub(super) fn least_infeasible(
        &self,
        search: &SearchSpec,
        evaluations: &[Evaluation],
    ) -> Option<usize> {
        let violations = evaluations.iter().enumerate().filter_map(|(place, of)| {
            let found = of.found.as_ref().ok()?;
            Some((self.violation(search, found), place))
        });
        let least = violations.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        least.map(|(_, place)| place)
    }
}

/// The largest difference of values, their size if there is none, 1 if that is zero.
fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let mut range: Option<(f64, f64)> = None;
    for value in values {
        let (low, high) = range.unwrap_or((value, value));
        range = Some((low.min(value), high.max(value)));
    }
    let (low, high) = range.unwrap_or((0.0, 0.0));
    let difference = high - low;
    [difference, high.abs()]
        .into_iter()
        .find(|size| *size > 0.0 && size.is_finite())
        .unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_never_zero() {
        assert_eq!(spread([3.0, -1.0, 2.0].into_iter()), 4.0);
        assert_eq!(spread([-3.0, -3.0].into_iter()), 3.0);
        assert_eq!(spread([0.0].into_iter()), 1.0);
        assert_eq!(spread([].into_iter()), 1.0);
    }
}
