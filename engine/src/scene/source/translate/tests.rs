use serde::Deserialize;
use std::collections::BTreeMap;

use super::super::{parse_node, scan};

#[derive(Deserialize, Debug)]
#[serde(deny_unknown_fields)]
#[expect(dead_code)]
struct Body {
    mass_kg: f64,
    inertia: Inertia,
    #[serde(default)]
    nodes: u8,
    #[serde(default)]
    positive: Option<Positive>,
}

#[derive(Deserialize, Debug)]
enum Inertia {
    ThinSphere,
    #[expect(dead_code)]
    Box(f64, f64, f64),
}

#[derive(Deserialize, Debug)]
#[serde(try_from = "f64")]
struct Positive;

impl TryFrom<f64> for Positive {
    type Error = String;
    fn try_from(value: f64) -> Result<Self, String> {
        (value > 0.0)
            .then_some(Self)
            .ok_or_else(|| format!("{value} is not positive"))
    }
}

#[derive(Deserialize, Debug)]
#[serde(deny_unknown_fields)]
#[expect(dead_code)]
struct Coefficient {
    coefficient: f64,
}

#[derive(Deserialize, Debug)]
#[serde(deny_unknown_fields)]
#[expect(dead_code)]
enum Drag {
    Constant(Coefficient),
    Table { length_m: f64 },
    Many(Vec<Coefficient>),
}

#[derive(Deserialize, Debug)]
#[serde(deny_unknown_fields)]
struct Empty {}

/// The message, the text at fault, the path and the help of the error in a text.
fn check<T: serde::de::DeserializeOwned + std::fmt::Debug>(
    text: &str,
    message: &str,
    at: &str,
    path: &str,
    help: Option<&str>,
) {
    let error = parse_node::<T>(text, &scan(text).unwrap(), "b").expect_err(text);
    let found = &text[error.span.clone().unwrap()];
    let got = (
        error.message.as_str(),
        found,
        error.path.as_deref(),
        error.help.as_deref(),
    );
    assert_eq!(got, (message, at, Some(path), help), "in {text}");
}

#[test]
fn an_unknown_field_is_marked_by_its_name() {
    let fields = "expected one of `mass_kg`, `inertia`, `nodes`, `positive`";
    check::<Body>(
        "(mass_kg: 1, /* inertai */ inertai: ThinSphere, nodes: 2)",
        &format!("unexpected field `inertai` in `Body`, {fields}"),
        "inertai",
        "b.inertai",
        Some("did you mean `inertia`?"),
    );
    check::<Body>(
        "(mass: 1)",
        &format!("unexpected field `mass` in `Body`, {fields}"),
        "mass",
        "b.mass",
        Some("quantities carry their unit: `mass_kg`"),
    );
    check::<Body>(
        "(colour: 1)",
        &format!("unexpected field `colour` in `Body`, {fields}"),
        "colour",
        "b.colour",
        None,
    );
    check::<Empty>(
        "(a: 1)",
        "unexpected field `a` in `Empty`, which has no fields",
        "a",
        "b.a",
        None,
    );
    check::<BTreeMap<String, Vec<Coefficient>>>(
        r#"{"x.y": [(coefficient: 1), (coeff: 2)]}"#,
        "unexpected field `coeff` in `Coefficient`, expected `coefficient`",
        "coeff",
        "b.\"x.y\".1.coeff",
        Some("did you mean `coefficient`?"),
    );
}

#[test]
fn variants_are_looked_through() {
    check::<Drag>(
        "Constant(coefficent: 1)",
        "unexpected field `coefficent` in `Constant`, expected `coefficient`",
        "coefficent",
        "b.coefficent",
        Some("did you mean `coefficient`?"),
    );
    check::<Drag>(
        "Table(length: 1)",
        "unexpected field `length` in `Table`, expected `length_m`",
        "length",
        "b.length",
        Some("quantities carry their unit: `length_m`"),
    );
    check::<Drag>(
        "Many([(coefficient: 1), (coefficient: \"x\")])",
        "expected a number, found a string",
        "\"x\"",
        "b.0.1.coefficient",
        None,
    );
    check::<Drag>(
        "Many([(coefficient: 'x')])",
        "expected a number, found a character",
        "'x'",
        "b.0.0.coefficient",
        None,
    );
}

#[test]
fn a_missing_field_is_marked_where_its_struct_opens() {
    check::<Body>(
        " (mass_kg: 1)",
        "`Body` needs the field `inertia`",
        "(",
        "b",
        None,
    );
    check::<Body>(
        "Body(inertia: ThinSphere)",
        "`Body` needs the field `mass_kg`",
        "Body",
        "b",
        None,
    );
    check::<Body>("()", "`Body` needs the field `mass_kg`", "(", "b", None);
    check::<Drag>(
        "Constant()",
        "`Constant` needs the field `coefficient`",
        "Constant",
        "b",
        None,
    );
    check::<Vec<Drag>>(
        "[Table()]",
        "`Table` needs the field `length_m`",
        "Table",
        "b.0",
        None,
    );
}

#[test]
fn an_unknown_variant_lists_the_variants() {
    let variants = "expected one of `ThinSphere`, `Box`";
    check::<Body>(
        "(mass_kg: 1, inertia: Thinsphere)",
        &format!("unknown variant `Thinsphere` for `Inertia`, {variants}"),
        "Thinsphere",
        "b.inertia",
        Some("did you mean `ThinSphere`?"),
    );
    check::<(f64, Inertia)>(
        "(1, Bx(1, 2, 3))",
        &format!("unknown variant `Bx` for `Inertia`, {variants}"),
        "Bx",
        "b.1",
        Some("did you mean `Box`?"),
    );
    check::<Inertia>(
        "Tensor",
        &format!("unknown variant `Tensor` for `Inertia`, {variants}"),
        "Tensor",
        "b",
        None,
    );
}

#[test]
fn other_messages_of_types_are_kept() {
    check::<Body>(
        "(mass_kg: 1, positive: -2.5, inertia: ThinSphere)",
        "-2.5 is not positive",
        "-2.5",
        "b.positive",
        None,
    );
    check::<Body>(
        "(mass_kg: 1, mass_kg: 2)",
        "the field `mass_kg` is given twice",
        "mass_kg",
        "b.mass_kg",
        None,
    );
    check::<[f64; 3]>(
        "(1, 2)",
        "expected an array of length 3, found 2 values",
        "(1, 2)",
        "b",
        None,
    );
    check::<Body>(
        "Bdy(mass_kg: 1)",
        "expected `Body(..)`, found `Bdy`",
        "Bdy",
        "b",
        None,
    );
}
