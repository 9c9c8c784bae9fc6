//! Shapes of the tethers at some instants, from two sides, a metre as long along every axis.

use glam::DVec3;

use super::{INSTANTS, instant_name, nothing};
use crate::animation::Animation;
use crate::figure::{Axis, Figure, Panel, Series};
use crate::record::Record;

/// The shapes from the side and from behind, from the highest body of the first instant.
pub(super) fn shapes(record: &Record) -> Result<Figure, String> {
    let animation = Animation::of(record, 40 * INSTANTS);
    let frames = animation.times_s.len();
    if animation.tethers.is_empty() || frames == 0 {
        return nothing("no tether was recorded with its nodes (`run.record.nodes`)");
    }
    let first = animation.bodies.iter();
    let Some(top) = first.max_by(|a, b| a.positions_m[0].z.total_cmp(&b.positions_m[0].z)) else {
        return nothing("there is no body");
    };
    let instants: Vec<usize> = (0..INSTANTS.min(frames))
        .map(|index| index * (frames - 1) / (INSTANTS.min(frames) - 1).max(1))
        .collect();
    let panel = |axis: usize, name: &str| Panel {
        x: Axis::new(format!("{name} from `{}` [m]", top.name)),
        y: Axis::new(format!("z from `{}` [m]", top.name)),
        equal_axes: true,
        series: instants
            .iter()
            .enumerate()
            .map(|(tone, frame)| {
                let origin_m = top.positions_m[*frame];
                let points = points(&animation, *frame);
                let points = points.map(|at| ((at - origin_m)[axis], (at - origin_m).z));
                Series::line(instant_name(animation.times_s[*frame]), points).with_tone(tone)
            })
            .collect(),
        ..Panel::default()
    };
    let mut panels = vec![panel(0, "x")];
    let across = panel(1, "y");
    let is_flat = |panel: &Panel| {
        let x = panel.series.iter().flat_map(|series| &series.x);
        x.filter(|x| x.is_finite()).all(|x| x.abs() < 1e-6)
    };
    if !is_flat(&across) {
        panels.push(across);
    }
    Ok(Figure {
        title: "Shapes of the tethers".to_owned(),
        caption: "A metre is as long along both axes.".to_owned(),
        panels,
        ..Figure::default()
    })
}

/// The points of every tether, a gap after each.
fn points(animation: &Animation, frame: usize) -> impl Iterator<Item = DVec3> + '_ {
    animation.tethers.iter().flat_map(move |tether| {
        let points = tether.points_m[frame].iter().copied();
        points.chain([DVec3::NAN])
    })
}
