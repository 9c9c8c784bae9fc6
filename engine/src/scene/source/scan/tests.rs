use super::super::fixture::SCENE;
use super::super::non_finite;
use super::super::tree::duplicates;
use super::*;

fn error(text: &str) -> (String, Range<usize>) {
    let e = scan(text).expect_err(text);
    (e.message, e.span)
}

fn check(text: &str, message: &str, span: Range<usize>) {
    assert_eq!(error(text), (message.to_owned(), span), "in {text:?}");
}

#[test]
fn the_sample_scene_scans_to_the_places_of_its_text() {
    let root = scan(SCENE).unwrap();
    assert_eq!(root.span, 0..SCENE.trim_end().len());
    assert_eq!(
        root.names(),
        ["name", "about", "environment", "entities", "run"]
    );
    let text = |path: &str| &SCENE[root.get(&path.parse().unwrap()).unwrap().span.clone()];
    assert_eq!(text("entities.tether.Tether.nodes"), "10");
    assert_eq!(text("environment.wind.0.velocity_m_s"), "(5, 0, 0)");
    assert_eq!(text("entities.balloon.Sphere.radius.altitude_m"), "56_000");
    assert_eq!(text("environment.gravity.0"), "8.87");
    assert_eq!(text("entities.balloon.Buoyancy"), "()");
    assert!(duplicates(&root).is_empty());
    assert!(non_finite(&root, SCENE).is_empty());
}

#[test]
fn every_sort_of_value_is_recognised() {
    for (text, kind) in [
        ("1", Scalar::Number),
        ("-2.5e-3", Scalar::Number),
        ("+.5", Scalar::Number),
        ("56_000", Scalar::Number),
        ("0x1F", Scalar::Number),
        ("-0b10_1u8", Scalar::Number),
        ("1e5", Scalar::Number),
        ("1.0f32", Scalar::Number),
        ("inf", Scalar::Number),
        ("-inf", Scalar::Number),
        ("NaN", Scalar::Number),
        ("b'a'", Scalar::Number),
        (r#""a \" b""#, Scalar::Text),
        (r#"r"a \""#, Scalar::Text),
        (r###"r#"a " b"#"###, Scalar::Text),
        (r#"b"a""#, Scalar::Text),
        ("'c'", Scalar::Character),
        (r"'\''", Scalar::Character),
        ("'''", Scalar::Character),
        ("'ä'", Scalar::Character),
        ("true", Scalar::Boolean),
        ("Vira", Scalar::Word),
        ("infinite", Scalar::Word),
        ("r#type", Scalar::Word),
        ("rope", Scalar::Word),
        ("b", Scalar::Word),
        ("größe", Scalar::Word),
    ] {
        let node = scan(text).unwrap_or_else(|e| panic!("{text}: {e:?}"));
        assert_eq!(node.kind, Kind::Scalar(kind), "{text}");
        assert_eq!(node.span, 0..text.len(), "{text}");
    }
}

#[test]
fn brackets_make_structs_tuples_lists_and_maps() {
    let kind = |text: &str| scan(text).unwrap().kind;
    assert!(matches!(kind("()"), Kind::Struct { name: None, fields } if fields.is_empty()));
    assert!(matches!(kind("A ( )"), Kind::Struct { name: Some(n), .. } if n == (0..1)));
    assert!(matches!(kind("A(a: 1,)"), Kind::Struct { fields, .. } if fields[0].name == "a"));
    assert!(matches!(kind("(r#a-b: 1)"), Kind::Struct { fields, .. } if fields[0].name == "a-b"));
    assert!(matches!(kind("(1)"), Kind::Tuple { items, .. } if items.len() == 1));
    assert!(matches!(kind("(A, B,)"), Kind::Tuple { items, .. } if items.len() == 2));
    assert!(matches!(kind("(A)"), Kind::Tuple { items, .. } if items.len() == 1));
    assert!(matches!(kind("(1, A(b: 1))"), Kind::Tuple { items, .. } if items.len() == 2));
    assert!(matches!(kind("[1, [], ]"), Kind::List(items) if items.len() == 2));
    assert!(matches!(kind("{}"), Kind::Map { entries } if entries.is_empty()));
    let Kind::Map { entries } = kind(r#"{"a\u{e4}": 1, r"\b": 2, 3: 4,}"#) else {
        panic!()
    };
    let names: Vec<&str> = entries.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["aä", "\\b", "3"]);
}

#[test]
fn comments_and_attributes_are_skipped() {
    let text = "/* /* a */ b */ #![enable(implicit_some)]\n#![type = \"a]\"] // c\n ( // )\n a /*:*/ : 1 /* , */ , ) // d";
    let root = scan(text).unwrap();
    assert_eq!(root.names(), ["a"]);
    assert_eq!(scan("/* ( */ 1").unwrap().span, 8..9);
}

#[test]
fn an_unclosed_bracket_is_shown_where_it_opens() {
    check("(a: [1, 2", "this `[` is never closed", 4..5);
    check("(a: [1], ", "this `(` is never closed", 0..1);
    check("(a", "this `(` is never closed", 0..1);
    check("(a:", "this `(` is never closed", 0..1);
    check("{ \"a\" ", "this `{` is never closed", 0..1);
    check(
        "{\n \"a\": (b: 1,\n}",
        "this `(` is not closed: `}` at line 3, column 1 stands where its `)` should",
        8..9,
    );
    check(
        "(a: [1)",
        "this `[` is not closed: `)` at line 1, column 7 stands where its `]` should",
        4..5,
    );
    check(
        "[ ( ]",
        "this `(` is not closed: `]` at line 1, column 5 stands where its `)` should",
        2..3,
    );
}

#[test]
fn a_missing_comma_or_colon_is_shown_where_it_belongs() {
    check("(a: 1 b: 2)", "a comma is missing here", 5..5);
    check("[1 2]", "a comma is missing here", 2..2);
    check("{\"a\": 1 \"b\": 2}", "a comma is missing here", 7..7);
    check("(a 1)", "a colon is missing after the field `a`", 2..2);
    check(
        "(a: 1, b 2)",
        "a colon is missing after the field `b`",
        8..8,
    );
    check(
        "{\"a\" 1}",
        "a colon is missing after the key `\"a\"`",
        4..4,
    );
    check(
        "(a: 1, b)",
        "the field `b` has no value: expected `b: value`",
        7..8,
    );
    check(
        "{\"a\"}",
        "the key `\"a\"` has no value: expected `\"a\": value`",
        1..4,
    );
    check("(a: )", "expected a value, found `)`", 4..5);
    check("(a: , b: 1)", "expected a value, found `,`", 4..5);
    check(
        "(a: 1,, b: 1)",
        "expected the name of a field, found `,`",
        6..7,
    );
    check("[a: 1]", "expected a comma, found `:`", 2..3);
    check("(a: 1, 2)", "expected the name of a field, found `2`", 7..8);
    check(
        "(1,\n a: 2)",
        "the field `a` stands among values without names (line 1)",
        5..6,
    );
}

#[test]
fn other_faults_have_their_own_words() {
    check("", "expected a value, found the end of the text", 0..0);
    check(
        " // only\n",
        "expected a value, found the end of the text",
        9..9,
    );
    check("(a: \"b)", "this string is never closed", 4..5);
    check("[\"\\\"]", "this string is never closed", 1..2);
    check(
        "r#\"a\"",
        "this string is never closed: `\"#` is missing",
        2..3,
    );
    check("['a]", "this character is never closed", 1..2);
    check("(a /* b", "this comment is never closed", 3..5);
    check("#![enable(", "this `#![..]` is never closed", 0..1);
    check("# 1", "expected an attribute `#![enable(..)]`", 0..1);
    check(
        "(a: 1) )",
        "expected the end of the text after the value, found `)`",
        7..8,
    );
    check(
        "1 2",
        "expected the end of the text after the value, found `2`",
        2..3,
    );
    check("12abc", "`12abc` is not a number", 0..5);
    check("[1.2.3]", "`1.2.3` is not a number", 1..6);
    check("-", "`-` is not a number", 0..1);
    check("0x", "`0x` is not a number", 0..2);
    check("(a: §)", "expected a value, found `§`", 4..6);
    check("\u{feff}1", "expected a value, found `\u{feff}`", 0..3);
}

#[test]
fn deep_nesting_is_refused_before_the_stack_is_gone() {
    let nested = |n: usize| format!("{}{}", "[".repeat(n), "]".repeat(n));
    assert!(scan(&nested(100)).is_ok());
    check(
        &nested(101),
        "brackets are nested deeper than 100 levels",
        100..101,
    );
    assert!(scan(&"(".repeat(1_000_000)).is_err());
    assert!(scan(&"A(".repeat(1_000_000)).is_err());
    assert!(scan(&"{[(".repeat(1_000_000)).is_err());
    assert!(scan(&"/*".repeat(1_000_000)).is_err());
}

/// Looks at a text in every way; nothing may panic, and every range must cut whole characters.
fn survives(text: &str) {
    match scan(text) {
        Err(e) => assert!(text.get(e.span.clone()).is_some(), "{e:?} in {text:?}"),
        Ok(root) => {
            let _ = duplicates(&root);
            for span in non_finite(&root, text) {
                assert!(text.get(span).is_some());
            }
            for at in 0..text.len() {
                root.innermost(at).map(|(n, _)| n.describe(text));
            }
        }
    }
}

#[test]
fn no_prefix_and_no_suffix_of_a_scene_panics() {
    for (at, _) in SCENE.char_indices() {
        survives(&SCENE[..at]);
        survives(&SCENE[at..]);
        if at + 1 < SCENE.trim_end().len() {
            assert!(scan(&SCENE[..at]).is_err(), "a prefix of {at} bytes scans");
        }
    }
}

#[test]
fn no_mutation_of_a_scene_panics() {
    let odd = [
        "(", ")", "[", "]", "{", "}", ",", ":", "\"", "'", "\\", "/*", "*/", "//", "#", "r#", "b'",
        "é", "𝒳", "\u{301}", "\0", "-", "1", "a", "\n", "",
    ];
    let mut random = 0x2545_F491_4F6C_DD1D_u64;
    let mut below = |n: usize| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        usize::try_from(random % n as u64).unwrap()
    };
    let short = &SCENE[SCENE.find("entities").unwrap()..SCENE.find("\"tether\"").unwrap()];
    for round in 0..4000 {
        let mut text = if round % 2 == 0 {
            "(é: 'ß', \"\": r#\"ü\"#, [-1])"
        } else {
            short
        }
        .to_owned();
        for _ in 0..=below(3) {
            let from = text.floor_char_boundary(below(text.len() + 1));
            let to = text.ceil_char_boundary((from + below(3)).min(text.len()));
            text.replace_range(from..to, odd[below(odd.len())]);
        }
        survives(&text);
    }
    let long_runs = odd.iter().map(|o| o.repeat(300));
    long_runs.for_each(|text| survives(&text));
}

#[test]
fn what_scans_is_what_ron_reads() {
    for text in [
        "(1)",
        "[1, 2,]",
        "{\"a\": 1}",
        "\"a\\n\"",
        "0x1F",
        "'a'",
        "(a: (), b: A(1))",
    ] {
        assert!(scan(text).is_ok(), "{text}");
        assert!(ron::from_str::<ron::Value>(text).is_ok(), "{text}");
    }
}
