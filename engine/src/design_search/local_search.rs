//! A local search: COBYLA (M. J. D. Powell, in Advances in Optimization and Numerical Analysis, Kluwer 1994, p. 51),
//! which takes objective and constraints as planes through the corners of a simplex, and moves and shrinks that.
//!
//! Of a smooth problem it finds a local optimum about as well as its tolerance says, which is no guarantee: of a
//! percentile over a few runs, which has kinks, the best that it passed is the result, and not where it ended.

use std::cell::RefCell;

use cobyla::{Func, RhoBeg, StopTols, minimize};

/// What a local search is told of a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// What is to be small.
    pub objective: f64,
    /// What is to be at least zero, always the same number of them.
    pub margins: Vec<f64>,
}

/// Where a local search begins and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// The place to begin at, in a box with sides from 0 to 1.
    pub start: Vec<f64>,
    /// First changes along each side.
    pub radius: Vec<f64>,
    /// Changes at which it ends.
    pub tolerance: f64,
    /// How many margins there are.
    pub margins: usize,
    /// The most places that it asks for.
    pub most: usize,
}

struct Asking<'a> {
    ask: &'a mut dyn FnMut(&[f64]) -> Option<Told>,
    last: Option<(Vec<f64>, Told)>,
    /// Nobody answers any more.
    is_over: bool,
}

impl Asking<'_> {
    /// Objective and margins come from one evaluation, whatever order they are asked for in.
    fn told(&mut self, place: &[f64], margins: usize) -> Told {
        // What is not finite is no place; the last answer stands in for it, and the search ends at its limit.
        let is_place = place.iter().all(|part| part.is_finite());
        if let Some((last, told)) = &self.last
            && (self.is_over || !is_place || last == place)
        {
            return told.clone();
        }
        let answer = is_place.then(|| (self.ask)(place)).flatten();
        self.is_over |= answer.is_none();
        let told = answer.unwrap_or_else(|| Told {
            objective: 0.0,
            margins: vec![0.0; margins],
        });
        self.last = Some((place.to_vec(), told.clone()));
        told
    }
}

/// Goes down from a place; `ask` evaluates places, and ends the search with `None`. What is found is what was
/// asked for.
pub fn go_down(reach: &Reach, ask: &mut dyn FnMut(&[f64]) -> Option<Told>) {
    let asking = RefCell::new(Asking {
        ask,
        last: None,
        is_over: false,
    });
    let told = |place: &[f64]| asking.borrow_mut().told(place, reach.margins);
    let objective = |place: &[f64], _: &mut ()| told(place).objective;
    let margins: Vec<_> = (0..reach.margins)
        .map(|number| {
            move |place: &[f64], _: &mut ()| {
                let told = told(place);
                told.margins.get(number).copied().unwrap_or(0.0)
            }
        })
        .collect();
    let margins: Vec<&dyn Func<()>> = margins.iter().map(|margin| margin as _).collect();
    let tolerances = StopTols {
        xtol_abs: vec![reach.tolerance; reach.start.len()],
        ..StopTols::default()
    };
    // How it ended says nothing that the places have not said.
    let _ = minimize(
        objective,
        &reach.start,
        &vec![(0.0, 1.0); reach.start.len()],
        &margins,
        (),
        reach.most,
        RhoBeg::Set(reach.radius.clone()),
        Some(tolerances),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn best(
        start: &[f64],
        of: impl Fn(&[f64]) -> (f64, Vec<f64>),
        margins: usize,
    ) -> (Vec<f64>, usize) {
        let reach = Reach {
            start: start.to_vec(),
            radius: vec![0.2; start.len()],
            tolerance: 1e-7,
            margins,
            most: 2000,
        };
        let mut found: Option<(f64, Vec<f64>)> = None;
        let mut count = 0;
        go_down(&reach, &mut |place| {
            count += 1;
            assert!(
                place.iter().all(|part| (0.0..=1.0).contains(part)),
                "{place:?}"
            );
            let (objective, margins) = of(place);
            let is_kept = margins.iter().all(|margin| *margin >= -1e-6);
            if is_kept && found.as_ref().is_none_or(|(least, _)| objective < *least) {
                found = Some((objective, place.to_vec()));
            }
            Some(Told { objective, margins })
        });
        (found.unwrap().1, count)
    }

    /// Fletcher, Practical Methods of Optimization, eq. 9.1.15: least -x - y in the unit circle above y = x^2 is at
    /// sqrt(1/2) along both.
    #[test]
    fn a_known_optimum_with_a_constraint() {
        let (place, count) = best(
            &[0.2, 0.9],
            |p| {
                let margins = vec![p[1] - p[0] * p[0], 1.0 - p[0] * p[0] - p[1] * p[1]];
                (-p[0] - p[1], margins)
            },
            2,
        );
        let half = libm::sqrt(0.5);
        assert!(
            place.iter().all(|part| (part - half).abs() < 1e-3),
            "{place:?}"
        );
        assert!(count < 200, "{count}");
    }

    #[test]
    fn a_smooth_valley_and_a_side_of_the_box() {
        let (place, _) = best(
            &[0.8, 0.8],
            |p| ((p[0] - 0.3) * (p[0] - 0.3) + p[1], Vec::new()),
            0,
        );
        assert!(
            (place[0] - 0.3).abs() < 1e-3 && place[1] == 0.0,
            "{place:?}"
        );
    }

    #[test]
    fn nobody_answering_ends_it() {
        let reach = Reach {
            start: vec![0.5],
            radius: vec![0.1],
            tolerance: 1e-9,
            margins: 1,
            most: 100,
        };
        let mut count = 0;
        go_down(&reach, &mut |place| {
            count += 1;
            (count < 4).then(|| Told {
                objective: place[0],
                margins: vec![1.0],
            })
        });
        assert_eq!(count, 4);
    }
}
