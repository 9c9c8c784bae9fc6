//! What can be wrong with design variables before the scene is read.

use aerobot_components::scene_component::FieldReport;

use super::specification::{Scale, SearchSpec, VariableSpec};
use crate::campaign::sobol::MOST_FIELDS;
use crate::campaign::specification::{check_name, entry_path};
use crate::scene::source::{FieldPath, Segment};

/// Whole numbers beyond this are not all there.
const MOST_WHOLE: f64 = 9_007_199_254_740_992.0;

pub(super) fn check_variables(search: &SearchSpec, report: &mut FieldReport) {
    let variables = &search.variables.0;
    if variables.is_empty() {
        let help = "the path of a field and its bounds";
        report.add("variables", "there is nothing to find", help);
    }
    if variables.len() > MOST_FIELDS {
        let message = format!("{} variables are more than {MOST_FIELDS}", variables.len());
        let help = "the sample of designs has coordinates for so many";
        report.add("variables", message, help);
    }
    let mut taken: Vec<(String, &str)> = Vec::new();
    let given = search.set.0.iter().map(|(path, _)| (path.clone(), "set"));
    taken.extend(given);
    let varied = search
        .vary
        .0
        .iter()
        .map(|(path, _)| (path.clone(), "varies"));
    taken.extend(varied);
    for (name, variable) in variables {
        let place = entry_path("variables", name);
        if variable.sets.0.is_empty() {
            check_path(&place, name, &mut taken, report);
        } else {
            check_name(&place, name, report);
        }
        for (path, law) in &variable.sets.0 {
            let at = law_path(name, path);
            check_path(&at, path, &mut taken, report);
            if law.factor == 0.0 || law.power == 0.0 {
                let message = format!("`{path}` does not depend on `{name}`");
                report.add(&at, message, "neither `factor` nor `power` is zero");
            }
            if law.power.fract() != 0.0 && variable.from < 0.0 {
                let message = format!("`{name}` has no power {} below zero", law.power);
                report.add(&at, message, "bounds above zero have every power");
            }
        }
        report.within(&place, |report| variable.check(report));
    }
    let started = variables.iter().filter(|(_, of)| of.start.is_some());
    let (started, all) = (started.count(), variables.len());
    if started != 0 && started != all {
        let missing = variables.iter().find(|(_, of)| of.start.is_none());
        let name = missing.map_or("", |(name, _)| name.as_str());
        let help = "a start is a whole design: give `start` for all variables or for none";
        report.add(&entry_path("variables", name), "`start` is missing", help);
    }
}

/// The path of a law in the text of the search.
pub(super) fn law_path(variable: &str, path: &str) -> String {
    let segments = ["variables", variable, "sets", path];
    let path = segments.iter().fold(FieldPath::default(), |path, name| {
        path.join(Segment::Name((*name).to_owned()))
    });
    path.to_string()
}

fn check_path(place: &str, path: &str, taken: &mut Vec<(String, &str)>, report: &mut FieldReport) {
    if let Err(why) = path.parse::<FieldPath>() {
        report.add(place, why, "a name of your own needs `sets`");
    }
    if path == "run.seed" {
        let help = "every design has the same seeds, so that designs differ by what they are";
        report.add(place, "a seed is no design variable", help);
    }
    match taken.iter().find(|(other, _)| other == path) {
        Some((_, "variable")) => {
            report.add(place, format!("two variables set `{path}`"), "");
        }
        Some((_, how)) => {
            let how = if *how == "set" { "is set" } else { "varies" };
            let message = format!("`{path}` {how} and is a variable");
            report.add(place, message, "keep one of the two");
        }
        None => taken.push((path.to_owned(), "variable")),
    }
}

impl VariableSpec {
    fn check(&self, report: &mut FieldReport) {
        let Self { from, to, .. } = *self;
        if from >= to {
            let message = format!("the bounds are crossed: {from} is not below {to}");
            report.add("to", message, "`from` is the lower one");
            return;
        }
        if self.scale == Scale::Log && from <= 0.0 {
            let message = format!("`Log` needs bounds above zero, `from` is {from}");
            report.add("from", message, "");
        }
        let starts = self.start.map(|start| ("start", start));
        if self.integer {
            let bounds = [("from", from), ("to", to)].into_iter().chain(starts);
            for (field, value) in bounds {
                if value.fract() != 0.0 || value.abs() > MOST_WHOLE {
                    let message = format!("`{field}` is {value}, and no whole number");
                    report.add(field, message, "`integer` has whole numbers only");
                }
            }
        }
        if let Some(start) = self.start
            && !(from..=to).contains(&start)
        {
            let message = format!("`start` is {start}, outside of the bounds {from} and {to}");
            report.add("start", message, "");
        }
    }
}
