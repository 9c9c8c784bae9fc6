//! A page as an HTML document.

use std::fmt::Write as _;

use plotly::Plot;

use super::view::{self, view};
use super::{Block, Row, Section, TextTable, json_in_html, text_in_html};
use crate::figure::Figure;
use crate::figure::thinning::MOST_POINTS;

/// What documents say of themselves, so that they are known again.
const GENERATOR: &str = "<meta name=\"generator\" content=\"aerobot ";
/// Where they say it, bytes from the start at most.
const HEAD: usize = 1000;

const STYLE: &str = include_str!("../../assets/page.css");
const CHARTS: &str = include_str!("../../assets/charts.js");

/// A page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// What it is about, in a sentence.
    pub about: String,
    /// Its sections.
    pub sections: Vec<Section>,
    /// Whether sections are of different runs: their time axes are not zoomed together.
    pub zooms_by_section: bool,
}

impl Page {
    /// The document, with every script, style and number in it.
    #[must_use]
    pub fn html(&self) -> String {
        let mut body = String::new();
        let mut contents = String::new();
        for (index, section) in self.sections.iter().enumerate() {
            let title = text_in_html(&section.title);
            let name = text_in_html(section.name.as_ref().unwrap_or(&section.title));
            let _ = writeln!(contents, "<a href=\"#s{index}\">{name}</a>");
            let _ = writeln!(
                body,
                "<section class=\"part\" id=\"s{index}\">\n<h2>{title}</h2>"
            );
            for (place, block) in section.blocks.iter().enumerate() {
                write_block(&mut body, block, &format!("s{index}-{place}"));
            }
            body.push_str("</section>\n");
        }
        let blocks = || self.sections.iter().flat_map(|section| &section.blocks);
        let has_figures = blocks().any(|block| matches!(block, Block::Figure(_)));
        let has_views = blocks().any(|block| matches!(block, Block::View(_)));
        let mut scripts = String::new();
        if has_figures {
            scripts.push_str(&plotly_script());
            let _ = writeln!(scripts, "<script>\n{CHARTS}</script>");
        }
        let mut styles = STYLE.to_owned();
        if has_views {
            styles.push_str(view::STYLE);
            let _ = writeln!(scripts, "<script>\n{}</script>", view::SCRIPT);
        }
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             {GENERATOR}{version}\">\n\
             <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{styles}</style>\n</head>\n\
             <body>\n<header>\n<h1>{title}</h1>\n<p>{about}</p>\n</header>\n<nav>\n{contents}</nav>\n\
             <main{zoom}>\n{body}</main>\n{scripts}</body>\n</html>\n",
            version = env!("CARGO_PKG_VERSION"),
            title = text_in_html(&self.title),
            zoom = if self.zooms_by_section {
                " data-zoom=\"section\""
            } else {
                ""
            },
            about = text_in_html(&self.about),
        )
    }
}

/// Whether the bytes of a file are those of a page of this program.
#[must_use]
pub fn is_page(bytes: &[u8]) -> bool {
    String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]).contains(GENERATOR)
}

/// The script element of plotly.js that the crate carries: the first of those that it offers.
fn plotly_script() -> String {
    const END: &str = "</script>";
    let all = Plot::offline_js_sources();
    let end = all.find(END).map_or(all.len(), |end| end + END.len());
    all[..end].to_owned() + "\n"
}

fn write_block(out: &mut String, block: &Block, id: &str) {
    let written = match block {
        Block::Text(text) => writeln!(out, "<p>{}</p>", text_in_html(text)),
        Block::Verdict { holds, sentence } => {
            let (class, word) = mark(*holds);
            let sentence = text_in_html(sentence);
            writeln!(
                out,
                "<p class=\"verdict {class}\"><strong>{word}</strong> {sentence}</p>"
            )
        }
        Block::Table(table) => {
            write_table(out, table);
            Ok(())
        }
        Block::Figure(figure) => {
            write_figure(out, figure, id);
            Ok(())
        }
        Block::View(runs) => {
            let runs: Vec<_> = runs
                .iter()
                .map(|(label, run)| (label.as_str(), run))
                .collect();
            writeln!(out, "{}", view(&runs))
        }
        Block::Folded { summary, text } => writeln!(
            out,
            "<details><summary>{}</summary><pre>{}</pre></details>",
            text_in_html(summary),
            text_in_html(text)
        ),
        Block::Link { text, to } => {
            let (text, to) = (text_in_html(text), text_in_html(to));
            writeln!(out, "<p><a href=\"{to}\">{text}</a></p>")
        }
        Block::Command(command) => writeln!(
            out,
            "<pre class=\"command\">{}</pre>",
            text_in_html(command)
        ),
    };
    // A string takes everything.
    written.unwrap_or_default();
}

fn mark(holds: bool) -> (&'static str, &'static str) {
    match holds {
        true => ("holds", "Holds."),
        false => ("fails", "Does not hold."),
    }
}

fn write_table(out: &mut String, table: &TextTable) {
    out.push_str("<div class=\"scroll\"><table>\n");
    if !table.head.is_empty() {
        let head = table
            .head
            .iter()
            .map(|name| format!("<th>{}</th>", text_in_html(name)));
        let _ = writeln!(out, "<thead><tr>{}</tr></thead>", head.collect::<String>());
    }
    out.push_str("<tbody>\n");
    for Row { fields, holds } in &table.rows {
        let class = match holds {
            Some(holds) => format!(" class=\"{}\"", mark(*holds).0),
            None => String::new(),
        };
        let mut cells = fields.iter().map(|field| text_in_html(field));
        let first = cells.next().unwrap_or_default();
        let rest = cells.map(|cell| format!("<td>{cell}</td>"));
        let rest: String = rest.collect();
        let _ = writeln!(out, "<tr{class}><th scope=\"row\">{first}</th>{rest}</tr>");
    }
    out.push_str("</tbody></table></div>\n");
}

fn write_figure(out: &mut String, figure: &Figure, id: &str) {
    let drawn = figure.clone().thinned(MOST_POINTS).interactive();
    let caption = text_in_html(&figure.caption);
    let _ = writeln!(
        out,
        "<figure class=\"chart\" id=\"{id}\" data-name=\"{name}\">\n<h3>{title}</h3>\n\
         <div class=\"plot\" style=\"min-height:{height}px\"></div>\n<figcaption>{caption}</figcaption>\n\
         <script type=\"application/json\">{data}</script>\n</figure>",
        name = text_in_html(&figure.name),
        title = text_in_html(&figure.title),
        height = drawn["layout"]["height"].as_f64().unwrap_or(300.0),
        data = json_in_html(&drawn),
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Panel, Series};

    fn page() -> Page {
        let figure = Figure {
            name: "altitude".into(),
            title: "Altitude of <b>".into(),
            panels: vec![Panel {
                x: Axis::time(),
                series: vec![Series::line("</script>", [(0.0, 1.0), (1.0, 2.0)])],
                ..Panel::default()
            }],
            ..Figure::default()
        };
        Page {
            title: "a & b".into(),
            about: "what it is".into(),
            sections: vec![Section::new("first", vec![Block::Figure(Box::new(figure))])],
            ..Page::default()
        }
    }

    #[test]
    fn a_page_has_everything_in_it() {
        let html = page().html();
        for part in [
            "<!DOCTYPE html>",
            "a &amp; b",
            "Altitude of &lt;b&gt;",
            "plotly.js v",
        ] {
            assert!(html.contains(part), "{part}");
        }
        // Every script element ends, and none is fetched.
        assert_eq!(
            html.matches("<script").count(),
            html.matches("</script>").count()
        );
        let tags = html
            .split('<')
            .filter(|tag| tag.starts_with("script") || tag.starts_with("link "));
        for tag in tags {
            let head = tag.split('>').next().unwrap();
            assert!(!head.contains("src=") && !head.contains("http"), "{head}");
        }
        assert_eq!(html, page().html());
        assert!(is_page(html.as_bytes()));
        assert!(!is_page(b"<!DOCTYPE html>"));
    }
}
