//! What the costs are held against, and what they come to.

use super::super::check::{Check, Tolerance, largest};
use super::report::find;
use super::{Costs, Exponent, PerformanceSettings, Quantity, SOLVERS, Study, why};

pub(super) const TITLE: &str = "What a simulated second costs (sec. 4.3, figures 7 and 8)";

pub(super) const PAPER_SHOWS: &str = "Figure 7 shows the run time over the number of elements, 1 to 20 on 1000 m, figure 8 that over the length, 50 to 1550 m \
with 5 elements. The text finds lumped masses to be O(n^3) and strongly dependent on the length, DeNOC to be O(n) and \
independent of it. Integrator, tolerance and stiffness are not given.";

/// The places of the solvers in [`SOLVERS`].
const LUMPED_EXPLICIT: usize = 0;
const LUMPED_IMPLICIT: usize = 1;
const LINKS_EXPLICIT: usize = 2;
const LINKS_IMPLICIT: usize = 3;

/// What must be so of steps follows from the largest stable step; what a clock says is held against the paper alone,
/// since a machine that is busy could contradict anything.
pub(super) fn checks(
    settings: &PerformanceSettings,
    costs: &Costs,
    exponents: &[Exponent],
) -> Vec<Check> {
    if !why::are_enough(settings, exponents) {
        return Vec::new();
    }
    let mut checks = by_elements(exponents);
    checks.extend(by_length(exponents));
    let runs = costs.by_elements.iter().chain(&costs.by_length);
    let apart_m = largest(runs.filter_map(|run| run.from_explicit_m));
    checks.push(
        Check::of(
            "largest distance between the ends of explicit and implicit runs",
            "m",
            apart_m,
        )
        .vanishes(0.05, "the other integrator"),
    );
    checks.extend(by_clock(exponents));
    checks
}

/// The power in which a quantity of a solver grows.
fn power(exponents: &[Exponent], study: Study, solver: usize, quantity: Quantity) -> (String, f64) {
    let many = study == Study::Elements;
    let found = find(exponents, study, SOLVERS[solver], quantity, many);
    let range = if many { MANY } else { "by length" };
    let words = match quantity {
        Quantity::Cpu => "CPU time",
        _ => "steps",
    };
    (
        format!("power of the {words}, {range}, {}", SOLVERS[solver].name()),
        found.map_or(f64::NAN, |found| found.exponent),
    )
}

fn steps(exponents: &[Exponent], study: Study, solver: usize) -> Check {
    let (what, power) = power(exponents, study, solver, Quantity::Steps);
    Check::of(what, "", power)
}

const MANY: &str = "40 elements or more";
const IMPLICIT: &str = "no limit of stability";

fn by_elements(exponents: &[Exponent]) -> Vec<Check> {
    let of = |solver| steps(exponents, Study::Elements, solver);
    vec![
        of(LUMPED_EXPLICIT).against(
            2.0,
            Tolerance::Absolute(0.1),
            "the stable step of damped segments, as 1/n^2",
        ),
        of(LINKS_EXPLICIT).against(
            1.0,
            Tolerance::Absolute(0.25),
            "the fastest transverse vibration, as n",
        ),
        of(LUMPED_IMPLICIT).against(0.0, Tolerance::Absolute(0.1), IMPLICIT),
        of(LINKS_IMPLICIT).against(0.0, Tolerance::Absolute(0.1), IMPLICIT),
    ]
}

fn by_length(exponents: &[Exponent]) -> Vec<Check> {
    let of = |solver| steps(exponents, Study::Length, solver);
    let (what, links) = power(exponents, Study::Length, LINKS_EXPLICIT, Quantity::Steps);
    vec![
        of(LUMPED_EXPLICIT).paper("strongly dependent").against(
            -1.0,
            Tolerance::Absolute(0.1),
            "the stable step of damped segments, as L",
        ),
        of(LUMPED_IMPLICIT).against(0.0, Tolerance::Absolute(0.1), IMPLICIT),
        of(LINKS_IMPLICIT).against(0.0, Tolerance::Absolute(0.1), IMPLICIT),
        Check::of(what, "", links)
            .paper("independent")
            .as_in_paper("within 0.1 of 0", links.abs() <= 0.1),
    ]
}

fn by_clock(exponents: &[Exponent]) -> Vec<Check> {
    let of = |(solver, paper): (usize, f64)| {
        let (what, ours) = power(exponents, Study::Elements, solver, Quantity::Cpu);
        Check::of(what, "", ours).paper(paper).as_in_paper(
            format!("within 0.3 of {paper}"),
            (ours - paper).abs() <= 0.3,
        )
    };
    [
        (LUMPED_EXPLICIT, 3.0),
        (LUMPED_IMPLICIT, 3.0),
        (LINKS_EXPLICIT, 1.0),
        (LINKS_IMPLICIT, 1.0),
    ]
    .map(of)
    .into()
}

/// Nothing that a clock says stands here, so that the sentence is the same on every machine.
pub(super) fn sentence() -> String {
    "The paper's O(n^3) is that of explicit integration of a damped tether, whose stable step falls as 1/n^2, and not of lumped \
     masses: implicitly they are O(n) and cost less than links. Links are O(n) for each evaluation as the paper says, but \
     explicitly a simulated second is not, nor is it independent of the length, since the taut chain vibrates across."
        .to_owned()
}
