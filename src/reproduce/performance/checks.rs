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
    let of = |study, solver: usize, quantity, many| {
        let found = find(exponents, study, SOLVERS[solver], quantity, many);
        found.map_or(f64::NAN, |found| found.exponent)
    };
    let steps = |what: &str, study, solver: usize, many| {
        let what = format!("power of the steps, {what}, {}", SOLVERS[solver].name());
        Check::of(what, "", of(study, solver, Quantity::Steps, many))
    };
    let by_elements = "40 elements or more";
    let implicit = "no limit of stability";
    let mut checks = vec![
        steps(by_elements, Study::Elements, LUMPED_EXPLICIT, true).against(
            2.0,
            Tolerance::Absolute(0.1),
            "the stable step of damped segments, as 1/n^2",
        ),
        steps(by_elements, Study::Elements, LINKS_EXPLICIT, true).against(
            1.0,
            Tolerance::Absolute(0.25),
            "the fastest transverse vibration, as n",
        ),
    ];
    for solver in [LUMPED_IMPLICIT, LINKS_IMPLICIT] {
        let many = steps(by_elements, Study::Elements, solver, true);
        checks.push(many.against(0.0, Tolerance::Absolute(0.1), implicit));
        let length = steps("length", Study::Length, solver, false);
        checks.push(length.against(0.0, Tolerance::Absolute(0.1), implicit));
    }
    checks.push(
        steps("length", Study::Length, LUMPED_EXPLICIT, false)
            .paper("strongly dependent")
            .against(
                -1.0,
                Tolerance::Absolute(0.1),
                "the stable step of damped segments, as L",
            ),
    );
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
    let links = of(Study::Length, LINKS_EXPLICIT, Quantity::Steps, false);
    checks.push(
        Check::of("power of the steps, length, DeNOC explicit", "", links)
            .paper(0.0)
            .as_in_paper("within 0.1 of 0", links.abs() <= 0.1),
    );
    for (solver, power) in [
        (LUMPED_EXPLICIT, 3.0),
        (LUMPED_IMPLICIT, 3.0),
        (LINKS_EXPLICIT, 1.0),
        (LINKS_IMPLICIT, 1.0),
    ] {
        let ours = of(Study::Elements, solver, Quantity::Cpu, true);
        let what = format!(
            "power of the CPU time, {by_elements}, {}",
            SOLVERS[solver].name()
        );
        checks.push(Check::of(what, "", ours).paper(power).as_in_paper(
            format!("within 0.3 of {power}"),
            (ours - power).abs() <= 0.3,
        ));
    }
    checks
}

/// Nothing that a clock says stands here, so that the sentence is the same on every machine.
pub(super) fn sentence() -> String {
    "The paper's O(n^3) is that of explicit integration of a damped tether, whose stable step falls as 1/n^2, and not of lumped \
     masses: implicitly they are O(n) and cost less than links. Links are O(n) for each evaluation as the paper says, but \
     explicitly a simulated second is not, nor is it independent of the length, since the taut chain vibrates across."
        .to_owned()
}
