use super::super::scan;
use super::*;

fn path(text: &str) -> FieldPath {
    text.parse().unwrap()
}

#[test]
fn paths_read_back_as_they_are_shown() {
    for text in [
        "entities.tether.Tether.nodes",
        "environment.wind.0.velocity_m_s",
        "a",
        "0",
        "007",
        "entities.lines/1.Body",
        "entities.\"a.b\".x",
        "entities.\"a \\\" \\\\ = b\".x",
        "\"\"",
        "größe.x",
    ] {
        assert_eq!(path(text).to_string(), text);
    }
    let quoted = path("a.\"b.c\".1");
    assert_eq!(
        quoted.segments,
        [
            Segment::Name("a".into()),
            Segment::Name("b.c".into()),
            Segment::Index(1)
        ]
    );
}

#[test]
fn bad_paths_are_refused() {
    for (text, message) in [
        ("", "the path `` has an empty part"),
        ("a..b", "the path `a..b` has an empty part"),
        ("a.", "the path `a.` has an empty part"),
        ("a.\"b", "the path `a.\"b` has an unclosed quote"),
        (
            "\"a\"b",
            "the path `\"a\"b` lacks a `.` after a quoted part",
        ),
    ] {
        assert_eq!(text.parse::<FieldPath>(), Err(message.to_owned()));
    }
}

#[test]
fn a_path_leads_through_fields_keys_positions_and_variants() {
    let text = r#"(a: {"k.l": Some((x: 1)), "7": 2}, b: V(c: W([3, (4, 5)])), r#d: T(6))"#;
    let root = scan(text).unwrap();
    let get = |p: &str| root.get(&path(p)).map(|n| &text[n.span.clone()]);
    assert_eq!(get("a.\"k.l\".x"), Some("1"));
    assert_eq!(get("a.\"k.l\".0.x"), Some("1"));
    assert_eq!(get("a.7"), Some("2"));
    assert_eq!(get("b.c.0.1.0"), Some("4"));
    assert_eq!(get("d.0"), Some("6"));
    assert_eq!(get("d.1"), None);
    assert_eq!(get("d.x"), None);
    assert_eq!(get("b.V.c"), None);
    let (node, steps) = root.reach(&path("b.x.y"));
    assert_eq!(
        (&text[node.span.clone()], steps),
        ("V(c: W([3, (4, 5)]))", 1)
    );
    assert_eq!(root.get(&FieldPath::default()), Some(&root));
}

#[test]
fn a_path_can_stand_below_another() {
    assert_eq!(path("a.0").below("x.y"), "x.y.a.0");
    assert_eq!(path("a").below(""), "a");
    assert_eq!(FieldPath::default().below("x"), "x");
    assert_eq!(path("a.b.c").head(2), path("a.b"));
}
