//! Figures of several runs in one.

use crate::figure::{Figure, Series};

/// One figure of several of one kind: panels of one title have the series of all, named after their runs if
/// `are_named`. Nothing if there is none.
#[must_use]
pub fn overlay(figures: Vec<(&str, Figure)>, are_named: bool) -> Option<Figure> {
    let mut all: Option<Figure> = None;
    for (run, mut figure) in figures {
        if are_named {
            let series = figure.panels.iter_mut().flat_map(|panel| &mut panel.series);
            for series in series.filter(|series| !series.name.is_empty()) {
                series.name = format!("{}, {run}", series.name);
            }
        }
        match &mut all {
            None => all = Some(figure),
            Some(all) => join(all, figure),
        }
    }
    if are_named && let Some(all) = &mut all {
        retone(all);
    }
    all
}

fn join(all: &mut Figure, other: Figure) {
    for panel in other.panels {
        let same = |own: &&mut crate::figure::Panel| {
            own.title == panel.title && own.x.label == panel.x.label && own.y.label == panel.y.label
        };
        match all.panels.iter_mut().find(same) {
            Some(own) => {
                own.series.extend(panel.series);
                own.labels.extend(panel.labels);
            }
            None => all.panels.push(panel),
        }
    }
}

/// Tones in the order of names, so that the two runs of one body differ.
fn retone(figure: &mut Figure) {
    let mut names: Vec<String> = Vec::new();
    let mut tone = |series: &mut Series| {
        let place = names.iter().position(|name| *name == series.name);
        series.tone = place.unwrap_or_else(|| {
            names.push(series.name.clone());
            names.len() - 1
        });
    };
    let panels = figure.panels.iter_mut();
    panels
        .flat_map(|panel| &mut panel.series)
        .for_each(&mut tone);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Panel;

    #[test]
    fn panels_of_one_title_are_one() {
        let figure = |y: f64| Figure {
            panels: vec![Panel {
                title: "x".into(),
                series: vec![Series::line("gondola", [(0.0, y)])],
                ..Panel::default()
            }],
            ..Figure::default()
        };
        let both = overlay(vec![("a", figure(1.0)), ("b", figure(2.0))], true).unwrap();
        assert_eq!(both.panels.len(), 1);
        let names: Vec<&str> = both.panels[0]
            .series
            .iter()
            .map(|s| s.name.as_str())
            .collect();
        assert_eq!(names, ["gondola, a", "gondola, b"]);
        assert_ne!(both.panels[0].series[0].tone, both.panels[0].series[1].tone);
    }
}
