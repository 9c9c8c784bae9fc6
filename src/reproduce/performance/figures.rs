//! Figures 7 and 8 of the paper: cost over number of elements and over length.

use aerobot_report::figure::{Axis, Figure, Mark, Panel, Series};

use super::solver::SOLVERS;
use super::{Costs, Measured, Study};

pub(super) fn figures(costs: &Costs) -> Vec<Figure> {
    let elements = |run: &Measured| f64::from(run.elements);
    let length = |run: &Measured| run.length_m;
    vec![
        figure(
            "performance-elements",
            "Cost over the number of elements (figure 7)",
            "elements of the tether [1]",
            costs.of(Study::Elements),
            &elements,
        ),
        figure(
            "performance-length",
            "Cost over the length (figure 8)",
            "length of the tether [m]",
            costs.of(Study::Length),
            &length,
        ),
    ]
}

fn figure(
    name: &str,
    title: &str,
    x: &str,
    runs: &[Measured],
    size: &dyn Fn(&Measured) -> f64,
) -> Figure {
    let panel = |y: &str, value: &dyn Fn(&Measured) -> f64| Panel {
        x: Axis::log(x),
        y: Axis::log(y),
        series: SOLVERS
            .into_iter()
            .enumerate()
            .map(|(tone, solver)| {
                let own = runs.iter().filter(|run| run.solver == solver);
                let points = own.map(|run| (size(run), value(run)));
                Series::line(solver.name(), points)
                    .with_mark(Mark::LineAndPoints)
                    .with_tone(tone)
            })
            .collect(),
        ..Panel::default()
    };
    Figure {
        name: name.to_owned(),
        title: title.to_owned(),
        caption: "The paper shows one integrator of each formulation; the slopes are what can be compared.".to_owned(),
        panels: vec![
            panel("CPU time per simulated second [s/s]", &|run| run.cpu_s / run.simulated_s),
            panel("steps per simulated second [1/s]", &Measured::steps_per_simulated_s),
        ],
    }
}
