//! A figure as a part of a page: data and layout for plotly.js, drawn by `assets/charts.js`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

use super::tone::Tone;
use super::{Axis, Figure, Mark, Panel, Scale, Series};

/// Height of a panel, of one with equal axes, and of what is above and below all panels, pixels.
const PANEL_HEIGHT: f64 = 230.0;
const SQUARE_HEIGHT: f64 = 520.0;
const MARGINS: f64 = 70.0;
/// Height between panels, and what the name of an axis and a title add to it, pixels.
const GAP: f64 = 26.0;
const AXIS_NAME: f64 = 32.0;
const PANEL_TITLE: f64 = 14.0;

impl Figure {
    /// The figure for plotly.js: `{"data": .., "layout": .., "time_axes": [..]}`.
    #[must_use]
    pub fn interactive(&self) -> Value {
        let gaps = self.panels.windows(2).map(|pair| gap(&pair[0], &pair[1]));
        let inner = self.panels.iter().map(height).sum::<f64>() + gaps.sum::<f64>();
        let mut drawing = Drawing::default();
        let mut top = inner;
        for (index, panel) in self.panels.iter().enumerate() {
            let next = self.panels.get(index + 1);
            let bottom = top - height(panel);
            drawing.add(panel, next, [bottom.max(0.0) / inner, top / inner]);
            top = bottom - next.map_or(0.0, |next| gap(panel, next));
        }
        drawing.finish(inner + MARGINS)
    }
}

/// Whether the axis of the next panel says what this one shows.
fn is_named_below(panel: &Panel, next: &Panel) -> bool {
    panel.x.is_time && next.x.is_time
}

fn gap(panel: &Panel, next: &Panel) -> f64 {
    let name = if is_named_below(panel, next) {
        0.0
    } else {
        AXIS_NAME
    };
    let title = if next.title.is_empty() {
        0.0
    } else {
        PANEL_TITLE
    };
    GAP + name + title
}

/// A figure while its panels are added.
#[derive(Default)]
struct Drawing<'a> {
    data: Vec<Value>,
    layout: Map<String, Value>,
    annotations: Vec<Value>,
    named: Vec<&'a str>,
    time_axes: Vec<String>,
    panels: usize,
}

impl<'a> Drawing<'a> {
    fn add(&mut self, panel: &'a Panel, next: Option<&Panel>, domain: [f64; 2]) {
        self.panels += 1;
        let suffix = match self.panels {
            1 => String::new(),
            number => number.to_string(),
        };
        for series in &panel.series {
            let is_new = !series.name.is_empty() && !self.named.contains(&series.name.as_str());
            if is_new {
                self.named.push(&series.name);
            }
            self.data.extend(traces(series, &suffix, is_new));
        }
        let mut x = axis(&panel.x, decades(panel, |series| &series.x));
        x.insert("anchor".into(), json!(format!("y{suffix}")));
        if panel.x.is_time {
            if let Some(first) = self.time_axes.first() {
                x.insert("matches".into(), json!(first.replace("axis", "")));
            }
            self.time_axes.push(format!("xaxis{suffix}"));
        }
        if next.is_some_and(|next| is_named_below(panel, next)) {
            x.remove("title");
        }
        let mut y = axis(&panel.y, decades(panel, |series| &series.y));
        y.insert("domain".into(), json!(domain));
        y.insert("anchor".into(), json!(format!("x{suffix}")));
        y.insert(
            "title".into(),
            json!({"text": panel.y.lines().join("<br>"), "standoff": 8}),
        );
        if let Some(range) = least_width(panel) {
            x.insert("range".into(), json!(range));
        }
        if panel.equal_axes {
            y.insert("scaleanchor".into(), json!(format!("x{suffix}")));
            x.insert("constrain".into(), json!("domain"));
        }
        self.layout
            .insert(format!("xaxis{suffix}"), Value::Object(x));
        self.layout
            .insert(format!("yaxis{suffix}"), Value::Object(y));
        self.annotations.extend(labels(panel, &suffix));
        self.annotations.extend(title(panel, domain[1]));
    }

    fn finish(self, height: f64) -> Value {
        let mut layout = self.layout;
        layout.insert("annotations".into(), Value::Array(self.annotations));
        layout.insert("height".into(), json!(height));
        layout.insert("margin".into(), json!({"l": 78, "r": 20, "t": 24, "b": 46}));
        layout.insert("hovermode".into(), json!("closest"));
        layout.insert("showlegend".into(), json!(!self.named.is_empty()));
        json!({"data": self.data, "layout": layout, "time_axes": self.time_axes})
    }
}

fn height(panel: &Panel) -> f64 {
    let names = panel.y.names.len();
    if panel.equal_axes {
        SQUARE_HEIGHT
    } else if names > 0 {
        PANEL_HEIGHT.max(26.0 * names as f64)
    } else {
        PANEL_HEIGHT
    }
}

/// What the horizontal of equal axes shows where the data are narrow: half of what the vertical does.
fn least_width(panel: &Panel) -> Option<[f64; 2]> {
    if !panel.equal_axes || panel.x.range.is_some() {
        return None;
    }
    let extent = |values: fn(&Series) -> &Vec<f64>| {
        let finite = panel
            .series
            .iter()
            .flat_map(values)
            .filter(|v| v.is_finite());
        finite.fold((f64::MAX, f64::MIN), |(low, high), value| {
            (low.min(*value), high.max(*value))
        })
    };
    let ((left, right), (low, high)) = (extent(|series| &series.x), extent(|series| &series.y));
    let (middle, half) = (0.5 * (left + right), 0.25 * (high - low));
    (right - left < 2.0 * half).then_some([middle - half, middle + half])
}

/// How many decades the positive numbers of a panel span.
fn decades(panel: &Panel, values: fn(&Series) -> &Vec<f64>) -> f64 {
    let values = panel.series.iter().flat_map(values);
    let positive = values.filter(|value| value.is_finite() && **value > 0.0);
    let (low, high) = positive.fold((f64::MAX, f64::MIN_POSITIVE), |(low, high), value| {
        (low.min(*value), high.max(*value))
    });
    libm::log10(high) - libm::log10(low)
}

fn axis(axis: &Axis, decades: f64) -> Map<String, Value> {
    let mut out = Map::new();
    out.insert("title".into(), json!({"text": axis.label, "standoff": 8}));
    match axis.scale {
        Scale::Log => {
            out.insert("type".into(), json!("log"));
            out.insert("exponentformat".into(), json!("power"));
            if decades > 1.5 {
                // One tick a decade, or fewer.
                out.insert("dtick".into(), json!((decades / 8.0).ceil()));
            }
        }
        // Metres, not kilometres by a `k` behind the number; powers of ten from a million on.
        Scale::Linear => {
            out.insert("exponentformat".into(), json!("power"));
            out.insert("minexponent".into(), json!(5));
        }
    }
    if let Some((low, high)) = axis.range {
        let ends = match axis.scale {
            Scale::Linear => [low, high],
            Scale::Log => [libm::log10(low), libm::log10(high)],
        };
        out.insert("range".into(), json!(ends));
    }
    if !axis.names.is_empty() {
        let places: Vec<usize> = (0..axis.names.len()).collect();
        out.insert("tickvals".into(), json!(places));
        out.insert("ticktext".into(), json!(axis.names));
    }
    // A wide number of a tick moves the axis, and is not cut off.
    out.insert("automargin".into(), json!(true));
    out
}

fn title(panel: &Panel, top: f64) -> Option<Value> {
    (!panel.title.is_empty()).then(|| {
        json!({
            "text": panel.title, "xref": "paper", "yref": "paper", "x": 0, "y": top,
            "xanchor": "left", "yanchor": "bottom", "showarrow": false, "font": {"size": 13},
        })
    })
}

fn labels<'a>(panel: &'a Panel, suffix: &'a str) -> impl Iterator<Item = Value> + 'a {
    panel.labels.iter().map(move |label| {
        // Annotations of a logarithmic axis are placed by the logarithm.
        let place = |axis: &Axis, value: f64| match axis.scale {
            Scale::Linear => value,
            Scale::Log => libm::log10(value),
        };
        json!({
            "text": label.text, "xref": format!("x{suffix}"), "yref": format!("y{suffix}"),
            "x": place(&panel.x, label.x), "y": place(&panel.y, label.y),
            "ax": 0, "ay": -22, "arrowhead": 0, "arrowwidth": 1, "arrowcolor": "#666",
            "font": {"size": 11},
        })
    })
}

/// The traces of a series; a band needs two.
fn traces(series: &Series, suffix: &str, in_legend: bool) -> Vec<Value> {
    let tone = Tone::of(series.tone);
    let mut trace = json!({
        "x": array(&series.x),
        "y": array(&series.y),
        "name": series.name,
        "legendgroup": series.name,
        "showlegend": in_legend,
        "xaxis": format!("x{suffix}"),
        "yaxis": format!("y{suffix}"),
        "type": "scatter",
        "mode": "lines",
        "line": {"color": tone.css(), "width": 1.6, "dash": dash(tone)},
    });
    let marker = json!({"color": tone.css(), "size": 6});
    match &series.mark {
        Mark::Line => {}
        Mark::Points => {
            trace["mode"] = json!("markers");
            trace["marker"] = marker;
        }
        Mark::LineAndPoints => {
            trace["mode"] = json!("lines+markers");
            trace["marker"] = marker;
        }
        Mark::Bars { width } => {
            trace["type"] = json!("bar");
            trace["width"] = json!(width);
            trace["marker"] = json!({"color": tone.css_with_opacity(0.75)});
        }
        Mark::LyingBars { from, width } => {
            let lengths: Vec<f64> = series
                .x
                .iter()
                .zip(from)
                .map(|(x, from)| x - from)
                .collect();
            trace["type"] = json!("bar");
            trace["orientation"] = json!("h");
            trace["base"] = array(from);
            trace["x"] = array(&lengths);
            trace["width"] = json!(width);
            trace["marker"] = json!({"color": tone.css_with_opacity(0.75)});
        }
        Mark::Band { to } => {
            let mut edge = trace.clone();
            edge["y"] = array(to);
            edge["showlegend"] = json!(false);
            edge["hoverinfo"] = json!("skip");
            for part in [&mut edge, &mut trace] {
                part["line"] = json!({"width": 0});
            }
            trace["fill"] = json!("tonexty");
            trace["fillcolor"] = json!(tone.css_with_opacity(0.22));
            return vec![edge, trace];
        }
    }
    vec![trace]
}

fn dash(tone: Tone) -> String {
    if tone.dashes.is_empty() {
        return "solid".to_owned();
    }
    let pixels: Vec<String> = tone
        .dashes
        .iter()
        .map(|pixels| format!("{pixels}px"))
        .collect();
    pixels.join(",")
}

/// Numbers as plotly.js reads them: single precision where that shows a series, and a thousandth part of it too.
fn array(values: &[f64]) -> Value {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = finite().fold((f64::MAX, f64::MIN), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let resolution = low.abs().max(high.abs()) * f64::from(f32::EPSILON);
    let (kind, bytes): (&str, Vec<u8>) = if resolution <= 1e-6 * (high - low) {
        (
            "f4",
            values
                .iter()
                .flat_map(|value| (*value as f32).to_le_bytes())
                .collect(),
        )
    } else {
        (
            "f8",
            values
                .iter()
                .flat_map(|value| value.to_le_bytes())
                .collect(),
        )
    };
    json!({"dtype": kind, "bdata": STANDARD.encode(bytes)})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn precision_is_that_of_what_is_seen() {
        assert_eq!(array(&[0.0, 1.0])["dtype"], "f4");
        // A millimetre at 56 km.
        assert_eq!(array(&[56_000.0, 56_000.001])["dtype"], "f8");
        assert_eq!(array(&[1.0, f64::NAN, 2.0])["dtype"], "f4");
    }

    #[test]
    fn a_name_stands_once_in_the_legend() {
        let panel = || Panel {
            x: Axis::time(),
            series: vec![
                Series::line("a", [(0.0, 1.0)]),
                Series::line("b", [(0.0, 1.0)]),
            ],
            ..Panel::default()
        };
        let figure = Figure {
            panels: vec![panel(), panel()],
            ..Figure::default()
        };
        let drawn = figure.interactive();
        let shown = drawn["data"].as_array().unwrap().iter();
        assert_eq!(shown.filter(|trace| trace["showlegend"] == true).count(), 2);
        assert_eq!(drawn["time_axes"], json!(["xaxis", "xaxis2"]));
        assert_eq!(drawn["layout"]["xaxis2"]["matches"], "x");
    }

    /// A long name is written beside its axis in two lines; a line straight down has a width to be seen in.
    #[test]
    fn names_and_shapes_can_be_read() {
        let panel = Panel {
            y: Axis::new("CPU time per simulated second [s/s]"),
            equal_axes: true,
            series: vec![Series::line("", [(0.0, 0.0), (2.0, 100.0)])],
            ..Panel::default()
        };
        let figure = Figure {
            panels: vec![panel],
            ..Figure::default()
        };
        let layout = &figure.interactive()["layout"];
        let name = "CPU time per<br>simulated second [s/s]";
        assert_eq!(layout["yaxis"]["title"]["text"], name);
        assert_eq!(layout["xaxis"]["range"], json!([-24.0, 26.0]));
    }
}
