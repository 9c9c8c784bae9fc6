//! The towing case as a text and as tables.

use aerobot_engine::recording::number::number_text;

use super::super::check::Verdict;
use super::super::{Report, Table};
use super::checks::{self, PAPER_SHOWS, TITLE};
use super::{LineShape, TowingSettings, WindResult};

const HEAD: &str = "\
Towing a probe of 4 kg on 9.7 km and 2.3 kg of line below a held balloon (paper, sec. 5.1).

Figure 15 of the paper lays a dynamic simulation beside a static model of the line; the text calls
the result satisfying, puts the differences down to the approaches, and calls the dynamic one more
exact for its inertia, elasticity and distributed loads. The paper leaves out the diameter of the
line, its stiffness, the shear and the atmosphere, so its curves cannot be had again; the values
here are those that `scenes/paper/towing_9700m.ron` states. With the same forces the two must
agree: at rest the discrete line differs from the continuous one by its segments alone, and the
flight ends in the discrete rest.
";

const WIDE_HEADER: &str = "wind_m_s,nodes,\
    continuous_x_m,continuous_depth_m,continuous_top_angle_rad,continuous_top_tension_n,\
    discrete_x_m,discrete_depth_m,discrete_top_angle_rad,discrete_top_tension_n,\
    dynamic_x_m,dynamic_depth_m,dynamic_top_angle_rad,dynamic_top_tension_n,\
    discrete_from_continuous_m,half_nodes,half_nodes_from_continuous_m,order_of_convergence,\
    flown_s,dynamic_from_discrete_m\n";
const SHAPES_HEADER: &str = "wind_m_s,model,point,from_top_m,x_m,z_m\n";
const TENSION_HEADER: &str = "wind_m_s,model,from_top_m,tension_n\n";

pub(super) fn report(settings: &TowingSettings, results: &[WindResult]) -> Report {
    let checks = checks::checks(settings, results);
    Report {
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text: text(settings, results),
        verdict: Verdict::of(&checks, checks::sentence(settings, results)),
        checks,
        tables: vec![
            Table {
                file_name: "towing.csv",
                text: wide(settings, results),
            },
            Table {
                file_name: "towing_shapes.csv",
                text: shapes(results),
            },
            Table {
                file_name: "towing_tension.csv",
                text: tensions(results),
            },
        ],
        stopped: results
            .iter()
            .filter_map(|result| {
                let reason = result.stopped.as_ref()?;
                let (wind, time) = (result.wind_m_s, result.flown_s);
                Some(format!(
                    "towing at {wind} m/s stopped at {time} s: {reason}"
                ))
            })
            .collect(),
    }
}

/// The models of a result with their names.
fn models(result: &WindResult) -> [(&'static str, &LineShape); 3] {
    [
        ("continuous", &result.continuous),
        ("discrete", &result.discrete),
        ("dynamic", &result.dynamic),
    ]
}

fn text(settings: &TowingSettings, results: &[WindResult]) -> String {
    let mut text = HEAD.to_owned();
    text.push_str(&format!(
        "\nWhere the probe is and how the line pulls on the balloon; {} nodes, flown from straight \
         down.\n\n{:>8}  {:<12} {:>12} {:>12} {:>10} {:>12}\n{:>8}  {:<12} {:>12} {:>12} {:>10} \
         {:>12}\n",
        settings.nodes,
        "wind",
        "line",
        "offset",
        "depth",
        "top angle",
        "top tension",
        "m/s",
        "",
        "m",
        "m",
        "deg",
        "N"
    ));
    for result in results {
        let wind = result.wind_m_s.to_string();
        let winds = [wind.as_str(), "", ""];
        for (wind, (model, line)) in winds.iter().zip(models(result)) {
            text.push_str(&format!(
                "{wind:>8}  {model:<12} {:>12.3} {:>12.3} {:>10.4} {:>12.4}\n",
                line.probe().x_m,
                line.depth_m(),
                line.top_angle_rad.to_degrees(),
                line.top_tension_n
            ));
        }
    }
    text.push_str(&convergence(settings, results));
    text
}

fn convergence(settings: &TowingSettings, results: &[WindResult]) -> String {
    let half = settings.nodes / 2;
    let mut text = format!(
        "\nLargest distance along the line: of the discrete rest from the continuous cable, with half \
         the nodes\nand with all, and the power of the segment length in which it falls; of the end of \
         the flight from\nthe discrete rest.\n\n\
         {:>8} {:>14} {:>14} {:>8} {:>16} {:>12}\n{:>8} {:>14} {:>14} {:>8} {:>16} {:>12}\n",
        "wind",
        format!("N = {half}"),
        format!("N = {}", settings.nodes),
        "order",
        "dynamic - rest",
        "flown",
        "m/s",
        "m",
        "m",
        "",
        "m",
        "s"
    );
    for result in results {
        text.push_str(&format!(
            "{:>8} {:>14.6} {:>14.6} {:>8.3} {:>16.6} {:>12}\n",
            result.wind_m_s,
            result.half_nodes_error_m,
            result.error_m(),
            result.order(),
            result.unsettled_m(),
            result.flown_s
        ));
    }
    text
}

fn row(text: &mut String, fields: &[String]) {
    text.push_str(&fields.join(","));
    text.push('\n');
}

fn wide(settings: &TowingSettings, results: &[WindResult]) -> String {
    let mut text = WIDE_HEADER.to_owned();
    for result in results {
        let mut fields = vec![number_text(result.wind_m_s), settings.nodes.to_string()];
        for (_, line) in models(result) {
            fields.extend(
                [
                    line.probe().x_m,
                    line.depth_m(),
                    line.top_angle_rad,
                    line.top_tension_n,
                ]
                .map(number_text),
            );
        }
        fields.push(number_text(result.error_m()));
        fields.push(result.half_nodes.to_string());
        fields.extend(
            [
                result.half_nodes_error_m,
                result.order(),
                result.flown_s,
                result.unsettled_m(),
            ]
            .map(number_text),
        );
        row(&mut text, &fields);
    }
    text
}

fn shapes(results: &[WindResult]) -> String {
    let mut text = SHAPES_HEADER.to_owned();
    for result in results {
        for (model, line) in models(result) {
            for (index, point) in line.points.iter().enumerate() {
                let fields = [
                    number_text(result.wind_m_s),
                    model.to_owned(),
                    index.to_string(),
                    number_text(point.from_top_m),
                    number_text(point.x_m),
                    number_text(point.z_m),
                ];
                row(&mut text, &fields);
            }
        }
    }
    text
}

/// The force on the top at arc length zero, then each segment at its middle.
fn tensions(results: &[WindResult]) -> String {
    let mut text = TENSION_HEADER.to_owned();
    for result in results {
        for (model, line) in models(result) {
            let middles = line.points.windows(2).map(|ends| match ends {
                [upper, lower] => 0.5 * (upper.from_top_m + lower.from_top_m),
                _ => 0.0,
            });
            let segments = middles.zip(line.segment_tensions_n.iter().copied());
            for (from_top_m, tension_n) in [(0.0, line.top_tension_n)].into_iter().chain(segments) {
                let fields = [
                    number_text(result.wind_m_s),
                    model.to_owned(),
                    number_text(from_top_m),
                    number_text(tension_n),
                ];
                row(&mut text, &fields);
            }
        }
    }
    text
}
