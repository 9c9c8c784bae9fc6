use super::super::{parse_override, scan};
use super::*;

fn check(source: &Source, diagnostics: &[Diagnostic], lines: &[&str]) {
    assert_eq!(source.render(diagnostics), lines.join("\n") + "\n");
}

fn at(source: &Source, part: &str) -> Range<usize> {
    let start = source.text().find(part).unwrap();
    start..start + part.len()
}

#[test]
fn a_diagnostic_shows_its_line_and_place() {
    let text = "(\n  entities: {\n    \"gondola\": (\n    Body: (mas_kg: 20.0),\n  )}\n)";
    let source = Source::new("scenes/chain.ron", text);
    let message = "unexpected field `mas_kg` in `Body`, expected one of `mass_kg`, `inertia`";
    let error = Diagnostic::new(message)
        .at(at(&source, "mas_kg"))
        .with_path("entities.gondola.Body.mas_kg")
        .with_help("did you mean `mass_kg`?");
    check(
        &source,
        &[error],
        &[
            "error: unexpected field `mas_kg` in `Body`, expected one of `mass_kg`, `inertia`",
            " --> scenes/chain.ron:4:12  (at entities.gondola.Body.mas_kg)",
            "  |",
            "4 |     Body: (mas_kg: 20.0),",
            "  |            ^^^^^^",
            "  = help: did you mean `mass_kg`?",
        ],
    );
}

#[test]
fn several_are_sorted_and_counted_and_the_gutter_adapts() {
    let text = format!("{}[1,\n\tä, b]", "\n".repeat(98));
    let source = Source::new("a.ron", text);
    let errors = [
        Diagnostic::new("nowhere"),
        Diagnostic::new("third").at(at(&source, "b")),
        Diagnostic::new("second").at(at(&source, "ä")).with_path(""),
        Diagnostic::new("first").at(at(&source, "[")).with_help("h"),
    ];
    check(
        &source,
        &errors,
        &[
            "error: first",
            "  --> a.ron:99:1",
            "   |",
            "99 | [1,",
            "   | ^",
            "   = help: h",
            "",
            "error: second",
            "   --> a.ron:100:2",
            "    |",
            "100 | \tä, b]",
            "    | \t^",
            "",
            "error: third",
            "   --> a.ron:100:5",
            "    |",
            "100 | \tä, b]",
            "    | \t   ^",
            "",
            "error: nowhere",
            " --> a.ron",
            "",
            "error: 4 problems in a.ron",
        ],
    );
}

#[test]
fn empty_and_long_ranges_mark_what_they_can() {
    let source = Source::new("a.ron", "(a: 1\r\n  b: (\r\n))");
    let comma = scan(source.text()).unwrap_err().into();
    check(
        &source,
        &[comma],
        &[
            "error: a comma is missing here",
            " --> a.ron:1:6",
            "  |",
            "1 | (a: 1",
            "  |      ^",
        ],
    );
    let whole = Diagnostic::new("whole").at(10..source.text().len());
    let marked = [
        "error: whole",
        " --> a.ron:2:4",
        "  |",
        "2 |   b: (",
        "  |    ^^^",
    ];
    check(&source, &[whole], &marked);
    let end = Diagnostic::new("end").at(source.text().len()..source.text().len());
    check(
        &source,
        &[end],
        &["error: end", " --> a.ron:3:3", "  |", "3 | ))", "  |   ^"],
    );
    let beyond = Diagnostic::new("end").at(900..1000);
    check(
        &source,
        &[beyond],
        &["error: end", " --> a.ron:3:3", "  |", "3 | ))", "  |   ^"],
    );
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let source = Source::new("a.ron", "\u{1b}[31m x");
    let error = Diagnostic::new("m").at(at(&source, "x"));
    assert!(
        source
            .render(&[error])
            .contains("1 | \u{FFFD}[31m x\n  |       ^\n")
    );
}

fn with(text: &str, arguments: &[&str]) -> Source {
    let overrides: Vec<Override> = (arguments.iter())
        .map(|a| parse_override(a).unwrap())
        .collect();
    Source::new("a.ron", text)
        .with_overrides(&overrides)
        .unwrap()
}

#[test]
fn text_of_an_override_is_shown_against_its_argument() {
    let source = with("(nodes: 10, c: 1)", &["nodes=-3"]);
    let error = Diagnostic::new("the integer `-3` is out of range").at(at(&source, "-3"));
    check(
        &source,
        &[error.with_path("nodes")],
        &[
            "error: the integer `-3` is out of range",
            " --> --set nodes=-3",
            "  |",
            "  | --set nodes=-3",
            "  |             ^^",
        ],
    );
    let source = with("(a: 1)", &["a=(x: 1,\n y: 2)"]);
    let error = Diagnostic::new("no")
        .at(at(&source, "y: 2"))
        .with_path("a.y");
    check(
        &source,
        &[error],
        &[
            "error: no",
            " --> --set a=(x: 1,  y: 2)  (at a.y)",
            "  |",
            "  |  y: 2)",
            "  |  ^^^^",
        ],
    );
}

#[test]
fn a_field_that_an_override_added_is_shown_in_its_path() {
    let source = with("(a: (x: 1))", &["a.noodes=20"]);
    let error = Diagnostic::new("unexpected").at(at(&source, "noodes"));
    check(
        &source,
        &[error],
        &[
            "error: unexpected",
            " --> --set a.noodes=20",
            "  |",
            "  | --set a.noodes=20",
            "  |         ^^^^^^",
        ],
    );
}

#[test]
fn the_file_is_shown_as_it_was_read() {
    let source = with(
        "(a: 1,\n b: (c: 2, d: 3), e: 4)",
        &["b.c=2222222", "a=[\n\n]"],
    );
    let error = Diagnostic::new("e").at(at(&source, "e: 4"));
    let lines = [
        "error: e",
        " --> a.ron:2:19",
        "  |",
        "2 |  b: (c: 2, d: 3), e: 4)",
    ];
    check(
        &source,
        &[error],
        &[&lines[..], &["  |                   ^^^^"]].concat(),
    );
    let around = Diagnostic::new("b").at(at(&source, "(c: 2222222, d: 3)"));
    let lines = [
        "error: b",
        " --> a.ron:2:5",
        "  |",
        "2 |  b: (c: 2, d: 3), e: 4)",
    ];
    check(
        &source,
        &[around],
        &[&lines[..], &["  |     ^^^^^^^^^^^^"]].concat(),
    );
}

#[test]
fn no_range_panics() {
    let source = with("(ä: \"ö\",\n\tb: 'ü')", &["b=\"→\"", "\"ä\"=(é: 1)", "é=3"]);
    let n = source.text().len() + 3;
    for start in 0..n {
        for end in start..n {
            let _ = source.render(&[Diagnostic::new("m").at(start..end)]);
        }
        let _ = source.render(&[Diagnostic::new("m").at(start..0)]);
    }
}
