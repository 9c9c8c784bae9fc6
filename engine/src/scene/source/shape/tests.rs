use serde::Deserialize;
use std::collections::BTreeMap;

use super::super::{parse_node, scan};

#[derive(Deserialize, Debug)]
#[serde(deny_unknown_fields)]
#[expect(dead_code)]
struct Coefficient {
    coefficient: f64,
}

#[derive(Deserialize, Debug)]
#[expect(dead_code)]
enum Shape {
    Plain,
    Newtype(f64),
    Tuple(f64, f64, f64),
    Fields(Coefficient),
    Vector([f64; 3]),
}

/// The message, the text at fault and the path of the error in a text; gives the help.
fn check<T: serde::de::DeserializeOwned + std::fmt::Debug>(
    text: &str,
    message: &str,
    at: &str,
    path: &str,
) -> Option<String> {
    let error = parse_node::<T>(text, &scan(text).unwrap(), "b").expect_err(text);
    let found = &text[error.span.clone().unwrap()];
    let got = (error.message.as_str(), found, error.path.as_deref());
    assert_eq!(got, (message, at, Some(path)), "in {text}");
    error.help
}

#[test]
fn a_scalar_of_another_type_is_marked() {
    check::<(f64, f64)>(
        "(1, \"2\")",
        "expected a number, found a string",
        "\"2\"",
        "b.1",
    );
    check::<f64>(
        "Vira",
        "expected a number, found the name `Vira`",
        "Vira",
        "b",
    );
    check::<f64>("true", "expected a number, found `true`", "true", "b");
    check::<f64>(
        "(1, 2)",
        "expected a number, found a tuple of 2 values",
        "(1, 2)",
        "b",
    );
    check::<f64>("A(1)", "expected a number, found `A(..)`", "A(1)", "b");
    check::<u8>("\"2\"", "expected an integer, found a string", "\"2\"", "b");
    check::<u8>(
        "abc",
        "expected an integer, found the name `abc`",
        "abc",
        "b",
    );
    check::<Vec<u8>>("[1, 1e5]", "expected an integer, found `1e5`", "1e5", "b.1");
    check::<Vec<u8>>(
        "[1, 10.5, 2]",
        "expected an integer, found `10.5`",
        "10.5",
        "b.1",
    );
    check::<BTreeMap<String, u8>>(
        "{\"a\": 1.5}",
        "expected an integer, found `1.5`",
        "1.5",
        "b.a",
    );
    check::<u8>("1.5", "expected an integer, found `1.5`", "1.5", "b");
    check::<u8>("-3", "the integer `-3` is out of range", "-3", "b");
    check::<Vec<u8>>("[300]", "the integer `300` is out of range", "300", "b.0");
}

#[test]
fn a_name_or_a_text_of_another_type_is_marked() {
    check::<bool>("1", "expected `true` or `false`, found `1`", "1", "b");
    check::<char>("1", "expected a character, found `1`", "1", "b");
    check::<()>("1", "expected `()`, found `1`", "1", "b");
    check::<String>("1", "expected a string, found `1`", "1", "b");
    let help = check::<String>("abc", "expected a string, found the name `abc`", "abc", "b");
    assert_eq!(help.as_deref(), Some("write it in quotes: `\"abc\"`"));
    let help = check::<BTreeMap<String, u8>>(
        "{ab: 1}",
        "expected a string, found the name `ab`",
        "ab",
        "b.ab",
    );
    assert_eq!(help.as_deref(), Some("write it in quotes: `\"ab\"`"));
}

#[test]
fn brackets_of_another_kind_are_marked() {
    check::<Vec<f64>>("5", "expected a list `[..]`, found `5`", "5", "b");
    check::<Vec<f64>>(
        "A(b: 1)",
        "expected a list `[..]`, found `A(..)`",
        "A(b: 1)",
        "b",
    );
    check::<Vec<f64>>(
        "(1, 2)",
        "expected a list `[..]`, found a tuple of 2 values",
        "(1, 2)",
        "b",
    );
    let map = "expected a map `{..}`, found named fields `(name: value, ..)`";
    check::<BTreeMap<String, f64>>("(a: 1)", map, "(a: 1)", "b");
    let tuple = "expected values in parentheses, found a list `[..]`";
    check::<[f64; 3]>("[1, 2, 3]", tuple, "[1, 2, 3]", "b");
    check::<[f64; 3]>("5", "expected values in parentheses, found `5`", "5", "b");
    check::<[f64; 3]>(
        "A",
        "expected values in parentheses, found the name `A`",
        "A",
        "b",
    );
    check::<[f64; 2]>(
        "(x: 1, y: 2)",
        "expected values without names, found named fields `(name: value, ..)`",
        "(x: 1, y: 2)",
        "b",
    );
    check::<Coefficient>(
        "5",
        "expected the fields of `Coefficient` in parentheses, found `5`",
        "5",
        "b",
    );
    check::<Coefficient>(
        "{\"coefficient\": 1}",
        "expected the fields of `Coefficient` in parentheses, found a map `{..}`",
        "{\"coefficient\": 1}",
        "b",
    );
    check::<Coefficient>(
        "(1, 2)",
        "expected named fields `(name: value, ..)`, found a tuple of 2 values",
        "(1, 2)",
        "b",
    );
}

#[test]
fn variants_with_values_they_lack_or_do_not_take_are_marked() {
    check::<(Shape, f64)>(
        "(Plain(1), 2)",
        "`Plain` takes no values: write `Plain` alone",
        "Plain(1)",
        "b.0",
    );
    check::<Shape>(
        "Plain ()",
        "`Plain` takes no values: write `Plain` alone",
        "Plain ()",
        "b",
    );
    check::<(Shape, f64)>(
        "(Newtype , 2)",
        "`Newtype` needs its values in parentheses: `Newtype(..)`",
        "Newtype",
        "b.0",
    );
    check::<Shape>(
        "Tuple",
        "`Tuple` needs its values in parentheses: `Tuple(..)`",
        "Tuple",
        "b",
    );
}

#[test]
fn values_too_many_or_without_their_names_are_marked() {
    check::<Shape>(
        "Newtype(1, 2)",
        "too many values: expected one value",
        "2",
        "b",
    );
    check::<Shape>(
        "Tuple(1, 2, 3, 4, 5)",
        "too many values: expected 3 values",
        "4",
        "b",
    );
    check::<(f64, f64)>(
        "(1, 2, A(3))",
        "too many values: expected 2 values",
        "A(3)",
        "b",
    );
    check::<Shape>(
        "Fields(0.47)",
        "the values of `Fields` need their names: `Fields(name: value, ..)`",
        "Fields(0.47)",
        "b",
    );
    check::<Shape>(
        "Vector((1, 2, 3))",
        "expected a number, found a tuple of 3 values",
        "(1, 2, 3)",
        "b.0",
    );
    check::<Shape>("5", "expected a name, found `5`", "5", "b");
    check::<Shape>(
        "\"Plain\"",
        "expected a name, found a string",
        "\"Plain\"",
        "b",
    );
}
