use super::super::{duplicates, parse_override, scan};
use super::*;

#[test]
fn a_source_keeps_the_file_beside_its_edited_text() {
    let source = Source::new("a.ron", "(\n a: 1,\n b: 2)");
    let set = parse_override("a=1000").unwrap();
    let edited = source.with_overrides(&[set]).unwrap();
    assert_eq!(edited.text(), "(\n a: 1000,\n b: 2)");
    assert_eq!(edited.original, source.original);
    let at = |part: &str| edited.line_column(edited.text().find(part).unwrap());
    assert_eq!(at("b"), Some((3, 2)));
    assert_eq!(at("1000"), None);
    assert_eq!(at(","), Some((2, 6)));
}

#[test]
fn a_diagnostic_is_built_up() {
    let built = Diagnostic::new("m").at(1..2).with_path("p").with_help("h");
    assert_eq!((built.message.as_str(), built.span), ("m", Some(1..2)));
    assert_eq!(
        (built.path.as_deref(), built.help.as_deref()),
        (Some("p"), Some("h"))
    );
    let twice = Diagnostic::from(&duplicates(&scan("(b: (a: 1, a: 2))").unwrap())[0]);
    let expected = Diagnostic::new("`a` is given twice").at(11..12);
    assert_eq!(twice, expected.with_path("b.a"));
    let syntax: Diagnostic = scan("(").unwrap_err().into();
    assert_eq!(syntax, Diagnostic::new("this `(` is never closed").at(0..1));
}
