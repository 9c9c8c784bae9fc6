use super::super::scan;
use super::*;

#[test]
fn duplicates_are_found_at_every_level_in_the_order_of_the_text() {
    let text =
        r#"(a: (x: 1, y: 2, x: 3, x: 4), b: {"k": 1, "j": [(z: 1, z: 2)], "\u{6b}": 3}, a: 5)"#;
    let root = scan(text).unwrap();
    let found: Vec<(String, &str, &str)> = duplicates(&root)
        .into_iter()
        .map(|d| (d.path.to_string(), &text[d.first], &text[d.second]))
        .collect();
    let expected = [
        ("a.x", "x", "x"),
        ("a.x", "x", "x"),
        ("b.j.0.z", "z", "z"),
        ("b.k", "\"k\"", "\"\\u{6b}\""),
        ("a", "a", "a"),
    ];
    let expected: Vec<_> = (expected.iter())
        .map(|&(p, a, b)| (p.to_owned(), a, b))
        .collect();
    assert_eq!(found, expected);
    let first = &duplicates(&root)[0];
    assert_eq!((first.first.clone(), first.second.clone()), (5..6, 17..18));
    assert_eq!(first.name, "x");
}

#[test]
fn the_innermost_value_at_a_byte_may_be_a_key() {
    let text = r#"(a: {"k": [1, 22]})"#;
    let root = scan(text).unwrap();
    let at = |offset| &text[root.innermost(offset).unwrap().0.span.clone()];
    let path = |offset| root.innermost(offset).unwrap().1.to_string();
    assert_eq!([path(0), path(6), path(15)], ["", "a.k", "a.k.1"]);
    assert_eq!(at(0), text);
    assert_eq!(at(6), "\"k\"");
    assert_eq!(at(10), "[1, 22]");
    assert_eq!(at(15), "22");
    assert!(root.innermost(text.len()).is_none());
}

#[test]
fn values_are_described_in_words() {
    for (text, words) in [
        ("1", "a number"),
        ("\"a\"", "a string"),
        ("'a'", "a character"),
        ("true", "`true`"),
        ("Vira", "the name `Vira`"),
        ("()", "`()`"),
        ("(a: 1)", "named fields `(name: value, ..)`"),
        ("(1)", "one value in parentheses"),
        ("(1, 2)", "a tuple of 2 values"),
        ("A(1)", "`A(..)`"),
        ("A(a: 1)", "`A(..)`"),
        ("[1]", "a list `[..]`"),
        ("{}", "a map `{..}`"),
    ] {
        assert_eq!(scan(text).unwrap().describe(text), words);
    }
}

#[test]
fn a_value_opens_at_its_name_or_its_bracket() {
    let opening = |text: &str| scan(text).unwrap().opening();
    assert_eq!(opening("Abc(a: 1)"), 0..3);
    assert_eq!(opening(" (a: 1)"), 1..2);
    assert_eq!(opening("1.5"), 0..3);
    assert_eq!(opening("[1]"), 0..1);
}
