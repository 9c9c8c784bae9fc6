//! The tables of the performance case; what a clock says stands apart from what does not change.

use aerobot_engine::recording::number::number_text;

use super::super::Table;
use super::{Costs, Exponent, Extent, Measured, Solver, Study};

const RUNS_HEADER: &str = "elements,length_m,formulation,integration,is_whole,simulated_s,\
    steps,rejected_steps,evaluations,steps_per_simulated_s,evaluations_per_simulated_s,\
    stable_step_s,undamped_stable_step_s,transverse_rad_s,from_explicit_m\n";
const TIMING_HEADER: &str = "study,elements,length_m,formulation,integration,repeats,cpu_s,\
    cpu_s_per_simulated_s,cpu_us_per_step,cpu_us_per_evaluation\n";
const EXPONENTS_HEADER: &str = "study,formulation,integration,quantity,from,to,exponent\n";

pub(super) fn tables(costs: &Costs, exponents: &[Exponent]) -> Vec<Table> {
    let table = |file_name, text| Table { file_name, text };
    vec![
        table("performance_elements.csv", runs(&costs.by_elements)),
        table("performance_length.csv", runs(&costs.by_length)),
        table("performance_exponents.csv", powers(exponents, false)),
        table("performance_timing.csv", timing(costs)),
        table("performance_timing_exponents.csv", powers(exponents, true)),
    ]
}

fn names(solver: Solver) -> [String; 2] {
    [solver.formulation.name(), solver.method.name()].map(str::to_owned)
}

/// A number, or an empty field where there is none.
fn finite(value: Option<f64>) -> String {
    value
        .filter(|value| value.is_finite())
        .map_or_else(String::new, number_text)
}

fn row(text: &mut String, fields: &[String]) {
    text.push_str(&fields.join(","));
    text.push('\n');
}

fn runs(runs: &[Measured]) -> String {
    let mut text = RUNS_HEADER.to_owned();
    for run in runs {
        let mut fields = vec![run.elements.to_string(), number_text(run.length_m)];
        fields.extend(names(run.solver));
        fields.push((run.extent == Extent::Whole).to_string());
        fields.push(number_text(run.simulated_s));
        fields.extend([run.steps, run.rejected_steps, run.evaluations].map(|n| n.to_string()));
        // A run that stopped at its start has no rates.
        fields.extend(
            [
                Some(run.steps_per_simulated_s()),
                Some(run.evaluations_per_simulated_s()),
                Some(run.stable_step_s),
                run.undamped_stable_step_s,
                run.transverse_rad_s,
                run.from_explicit_m,
            ]
            .map(finite),
        );
        row(&mut text, &fields);
    }
    text
}

fn timing(costs: &Costs) -> String {
    let mut text = TIMING_HEADER.to_owned();
    for study in [Study::Elements, Study::Length] {
        for run in costs.of(study) {
            let mut fields = vec![
                study.name().to_owned(),
                run.elements.to_string(),
                number_text(run.length_m),
            ];
            fields.extend(names(run.solver));
            fields.push(run.repeats.to_string());
            fields.extend(
                [
                    run.cpu_s,
                    run.cpu_per_simulated_s(),
                    run.cpu_us_per_step(),
                    run.cpu_us_per_evaluation(),
                ]
                .map(|value| finite(Some(value))),
            );
            row(&mut text, &fields);
        }
    }
    text
}

fn powers(exponents: &[Exponent], timed: bool) -> String {
    let mut text = EXPONENTS_HEADER.to_owned();
    let wanted = exponents
        .iter()
        .filter(|exponent| exponent.quantity.is_timed() == timed);
    for exponent in wanted {
        let mut fields = vec![exponent.study.name().to_owned()];
        fields.extend(names(exponent.solver));
        fields.push(exponent.quantity.name().to_owned());
        fields.extend([exponent.range.0, exponent.range.1, exponent.exponent].map(number_text));
        row(&mut text, &fields);
    }
    text
}
