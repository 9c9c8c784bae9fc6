//! The designs of a search: in the order in which they were tried, and over each variable.

use aerobot_engine::campaign::quantity::{unit_of, unit_symbol};

use super::super::search::{EvaluatedDesign, SearchRecord};
use super::axis_label;
use crate::figure::{Axis, Figure, Mark, Panel, Series};

impl SearchRecord {
    /// Objective and constraints of every design, and the best so far.
    #[must_use]
    pub fn search(&self) -> Figure {
        let evaluation = |design: &EvaluatedDesign| Some(design.evaluation as f64);
        let mut series = self.points(&evaluation, &|design| design.objective);
        series.push(Series::line("best so far", steps(&self.best_so_far())).with_tone(2));
        let mut panels = vec![panel("evaluation [1]", self.objective_label(), series)];
        let constraints = self.design().map(|design| &design.constraints);
        for (place, limit) in constraints.into_iter().flatten().enumerate() {
            let value = |design: &EvaluatedDesign| design.constraints.get(place).copied()?;
            let mut series = self.points(&evaluation, &value);
            let end = self
                .evaluations
                .last()
                .map_or(0.0, |last| last.evaluation as f64);
            for at in limit.at_least.iter().chain(&limit.at_most) {
                series.push(Series::line("limit", [(0.0, *at), (end, *at)]).with_tone(3));
            }
            let label = axis_label(&limit.name, unit_of(&limit.name));
            panels.push(panel("evaluation [1]", label, series));
        }
        Figure {
            name: "search".to_owned(),
            title: format!("{}: the search for the best design", self.summary.search),
            caption: "Every design in the order of the search; those that failed have no value."
                .to_owned(),
            panels,
        }
    }

    /// The objective over each variable, of every design.
    #[must_use]
    pub fn variables(&self) -> Figure {
        let variables = self.design().map(|design| &design.variables);
        let panels = variables.into_iter().flatten().enumerate();
        let panels = panels.map(|(place, variable)| {
            let value = |design: &EvaluatedDesign| design.variables.get(place).copied();
            let series = self.points(&value, &|design| design.objective);
            panel(
                &variable_label(&variable.name),
                self.objective_label(),
                series,
            )
        });
        Figure {
            name: "search-variables".to_owned(),
            title: format!("{}: the objective over the variables", self.summary.search),
            caption:
                "Every design that has a value; each panel is a view along the other variables."
                    .to_owned(),
            panels: panels.collect(),
        }
    }

    fn objective_label(&self) -> String {
        let goal = match self.minimises() {
            true => "objective, the less the better",
            false => "objective, the more the better",
        };
        let unit = self.design().map(|design| design.objective.unit.as_str());
        match unit.unwrap_or_default() {
            "" => goal.to_owned(),
            unit => format!("{goal} [{}]", unit_symbol(unit)),
        }
    }

    /// Points of feasible designs, and of others.
    fn points(
        &self,
        x: &dyn Fn(&EvaluatedDesign) -> Option<f64>,
        y: &dyn Fn(&EvaluatedDesign) -> Option<f64>,
    ) -> Vec<Series> {
        let of = |name: &str, is_feasible: bool, tone: usize| {
            let designs = self.evaluations.iter();
            let designs = designs.filter(move |design| design.is_feasible == is_feasible);
            let points = designs.filter_map(|of| Some((x(of)?, y(of)?)));
            Series::line(name, points)
                .with_mark(Mark::Points)
                .with_tone(tone)
        };
        vec![of("infeasible", false, 1), of("feasible", true, 0)]
    }
}

/// The name of a variable, or the path of the field that it is, with its unit.
fn variable_label(name: &str) -> String {
    let is_place = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let mut parts = name.split('.');
    let last = parts.rfind(|part| !is_place(part));
    match last.map_or("", unit_of) {
        "" => name.to_owned(),
        unit if name.contains('.') => format!("{name} [{}]", unit_symbol(unit)),
        unit => axis_label(name, unit),
    }
}

fn panel(x: &str, y: String, series: Vec<Series>) -> Panel {
    Panel {
        x: Axis::new(x),
        y: Axis::new(y),
        series,
        ..Panel::default()
    }
}

/// A value that stays until the next comes.
fn steps(values: &[(u64, f64)]) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for (evaluation, value) in values {
        let x = *evaluation as f64;
        if let Some((_, before)) = found.last().copied() {
            found.push((x, before));
        }
        found.push((x, *value));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_have_the_unit_of_their_field() {
        assert_eq!(variable_label("speed_m_s"), "speed [m/s]");
        assert_eq!(
            variable_label("entities.ball.Motion.velocity_m_s.0"),
            "entities.ball.Motion.velocity_m_s.0 [m/s]"
        );
        assert_eq!(
            variable_label("entities.line.Tether.nodes"),
            "entities.line.Tether.nodes"
        );
    }
}
