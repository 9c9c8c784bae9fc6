//! Why the costs grow as they do, in the figures of this very run.

use super::exponents::Quantity::{self, Cpu, CpuPerEvaluation, Steps};
use super::report::{find, power};
use super::{Costs, Exponent, Measured, PerformanceSettings, SOLVERS, Study};

/// The places of the solvers in [`SOLVERS`].
const LUMPED_EXPLICIT: usize = 0;
const LUMPED_IMPLICIT: usize = 1;
const LINKS_EXPLICIT: usize = 2;
const LINKS_IMPLICIT: usize = 3;

/// Fitted powers, by what they are of.
struct Powers<'a>(&'a [Exponent]);

impl Powers<'_> {
    fn small(&self, solver: usize, quantity: Quantity) -> String {
        self.of(Study::Elements, solver, quantity, false)
    }

    fn large(&self, solver: usize, quantity: Quantity) -> String {
        self.of(Study::Elements, solver, quantity, true)
    }

    fn length(&self, solver: usize, quantity: Quantity) -> String {
        self.of(Study::Length, solver, quantity, false)
    }

    fn of(&self, study: Study, solver: usize, quantity: Quantity, many: bool) -> String {
        power(find(self.0, study, SOLVERS[solver], quantity, many))
    }

    /// Whether every study has powers over every range.
    fn are_complete(&self) -> bool {
        let found = |study, many| {
            (0..SOLVERS.len())
                .all(|solver| find(self.0, study, SOLVERS[solver], Steps, many).is_some())
        };
        found(Study::Elements, false) && found(Study::Elements, true) && found(Study::Length, false)
    }
}

/// Whether there are sizes enough to tell why costs grow, and runs in which the gusts have passed.
pub(super) fn are_enough(settings: &PerformanceSettings, exponents: &[Exponent]) -> bool {
    let is_long = settings.duration_s >= PerformanceSettings::default().duration_s;
    is_long && Powers(exponents).are_complete()
}

/// The reasons; none where sizes are lacking to tell, or where runs end before the gusts have passed.
pub(super) fn why(settings: &PerformanceSettings, costs: &Costs, exponents: &[Exponent]) -> String {
    let powers = Powers(exponents);
    if !are_enough(settings, exponents) {
        return "\nToo few sizes, or too short runs, to say why.\n".to_owned();
    }
    let paragraphs = [
        lumped(&powers),
        links(costs, &powers),
        length(&powers),
        accuracy(costs),
    ];
    let mut text = "\nWhy\n".to_owned();
    for paragraph in &paragraphs {
        text.push('\n');
        text.push_str(&filled(paragraph));
    }
    text
}

/// Longest line, in characters.
const WIDTH: usize = 100;

/// The words of a paragraph in lines.
fn filled(paragraph: &str) -> String {
    let mut text = String::new();
    let mut width = 0;
    for word in paragraph.split_whitespace() {
        if width > 0 && width + 1 + word.len() > WIDTH {
            text.push('\n');
            width = 0;
        }
        if width > 0 {
            text.push(' ');
            width += 1;
        }
        text.push_str(word);
        width += word.len();
    }
    text.push('\n');
    text
}

fn lumped(powers: &Powers) -> String {
    let (stable, undamped) = (Quantity::StableStep, Quantity::UndampedStableStep);
    format!(
        "
Lumped masses. The power of CPU time is that of the steps and that of an evaluation: {} + {} from 5
to 20 elements, where much of an evaluation does not depend on n, {} + {} from 40 on. The steps
follow the largest stable step of RK4 for the axial motion, which goes as n^{} and n^{}: each
segment has the damping c (n + 1), each node the mass m/(n + 1). Without that damping stiffness
would set it, and it would go as n^{} and n^{}. So n^3 is that of explicit integration with a
damped tether, and not of the formulation: implicit steps go as n^{} and n^{}, CPU time as n^{} and
n^{}.
",
        powers.small(LUMPED_EXPLICIT, Steps),
        powers.small(LUMPED_EXPLICIT, CpuPerEvaluation),
        powers.large(LUMPED_EXPLICIT, Steps),
        powers.large(LUMPED_EXPLICIT, CpuPerEvaluation),
        powers.small(LUMPED_EXPLICIT, stable),
        powers.large(LUMPED_EXPLICIT, stable),
        powers.small(LUMPED_EXPLICIT, undamped),
        powers.large(LUMPED_EXPLICIT, undamped),
        powers.small(LUMPED_IMPLICIT, Steps),
        powers.large(LUMPED_IMPLICIT, Steps),
        powers.small(LUMPED_IMPLICIT, Cpu),
        powers.large(LUMPED_IMPLICIT, Cpu),
    )
}

fn links(costs: &Costs, powers: &Powers) -> String {
    let mut explicit = costs.by_elements.iter().filter(|run| {
        run.solver == SOLVERS[LINKS_EXPLICIT] && run.elements >= 5 && run.transverse_rad_s.is_some()
    });
    let (few, many) = (explicit.next(), explicit.next_back());
    format!(
        "
DeNOC. Rigid links have no axial motion, but the taut chain vibrates across: the frequency of its
fastest such mode goes as n^{} and n^{}. A mean explicit step turns its phase by {} and by {}; on an undamped
vibration Dormand-Prince is stable up to {DORMAND_PRINCE_RAD:.1} rad. So the steps go as n^{} and n^{}, an evaluation as n^{} and n^{}, and CPU
time as n^{} and n^{}: the evaluation is O(n), a simulated second is not, if the integration is
explicit. Implicit steps go as n^{} and n^{}, CPU time as n^{} and n^{}.
",
        powers.small(LINKS_EXPLICIT, Quantity::Transverse),
        powers.large(LINKS_EXPLICIT, Quantity::Transverse),
        few.map_or_else(String::new, phase),
        many.map_or_else(String::new, phase),
        powers.small(LINKS_EXPLICIT, Steps),
        powers.large(LINKS_EXPLICIT, Steps),
        powers.small(LINKS_EXPLICIT, CpuPerEvaluation),
        powers.large(LINKS_EXPLICIT, CpuPerEvaluation),
        powers.small(LINKS_EXPLICIT, Cpu),
        powers.large(LINKS_EXPLICIT, Cpu),
        powers.small(LINKS_IMPLICIT, Steps),
        powers.large(LINKS_IMPLICIT, Steps),
        powers.small(LINKS_IMPLICIT, Cpu),
        powers.large(LINKS_IMPLICIT, Cpu),
    )
}

/// End of the interval from 0 on which |R(i y)| <= 1, R(z) = sum over k to 5 of z^k/k! + z^6/600, rad.
const DORMAND_PRINCE_RAD: f64 = 1.0;

/// How far a mean step turns the phase of the fastest transverse vibration.
fn phase(run: &Measured) -> String {
    let angle = run.transverse_rad_s.unwrap_or(0.0) / run.steps_per_simulated_s();
    format!("{angle:.2} rad with {} elements", run.elements)
}

fn length(powers: &Powers) -> String {
    format!(
        "
Length. The stable step of lumped masses goes as L^{}, and their explicit steps as L^{}: stiffness
falls and mass grows with length, so it is the short tether that costs. The fastest transverse
vibration of the links goes as L^{}, and their explicit steps as L^{} at the same tolerance: not
independent of the length either. Implicit steps go as L^{} (lumped) and L^{} (DeNOC).
",
        powers.length(LUMPED_EXPLICIT, Quantity::StableStep),
        powers.length(LUMPED_EXPLICIT, Steps),
        powers.length(LINKS_EXPLICIT, Quantity::Transverse),
        powers.length(LINKS_EXPLICIT, Steps),
        powers.length(LUMPED_IMPLICIT, Steps),
        powers.length(LINKS_IMPLICIT, Steps),
    )
}

/// How far apart explicit and implicit runs end, where both are whole.
fn accuracy(costs: &Costs) -> String {
    let runs = costs.by_elements.iter().chain(&costs.by_length);
    let largest_m = runs
        .filter_map(|run| run.from_explicit_m)
        .fold(0.0, f64::max);
    format!(
        "
Explicit and implicit runs of a formulation end within {:.1} mm of each other.
",
        1e3 * largest_m
    )
}
