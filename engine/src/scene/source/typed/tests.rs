use serde::Deserialize;
use std::collections::BTreeMap;

use super::super::fixture::SCENE;
use super::super::{Source, parse_override, scan};
use super::*;

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
pub(super) struct Body {
    mass_kg: f64,
    inertia: Inertia,
}

#[derive(Deserialize, Debug, PartialEq)]
pub(super) enum Inertia {
    ThinSphere,
    Box(f64, f64, f64),
}

#[derive(Deserialize, Debug, PartialEq)]
#[serde(deny_unknown_fields)]
struct Gust {
    velocity_m_s: [f64; 3],
    from_s: Option<f64>,
}

#[derive(Deserialize, Debug, PartialEq)]
enum Wind {
    Step(Gust),
}

#[test]
fn the_parts_of_the_sample_scene_parse() {
    let root = scan(SCENE).unwrap();
    let body = root.get(&"entities.gondola.Body".parse().unwrap()).unwrap();
    let parsed: Body = parse_node(SCENE, body, "entities.gondola.Body").unwrap();
    let inertia = Inertia::Box(1.0, 1.0, 1.0);
    assert_eq!(
        parsed,
        Body {
            mass_kg: 100.0,
            inertia
        }
    );
    let radius = root
        .get(&"entities.balloon.Sphere.radius".parse().unwrap())
        .unwrap();
    assert!(parse_node::<Inertia>(SCENE, radius, "x").is_err());
    let wind = "[Step(velocity_m_s: (5, 0, 0), from_s: 10)] // c";
    let parsed: Vec<Wind> = parse_node(wind, &scan(wind).unwrap(), "").unwrap();
    let velocity_m_s = [5.0, 0.0, 0.0];
    assert_eq!(
        parsed,
        [Wind::Step(Gust {
            velocity_m_s,
            from_s: Some(10.0)
        })]
    );
}

#[test]
fn a_node_in_the_middle_of_the_text_reports_in_the_whole_text() {
    let text = "(\n  a: {\"b ä\": (Body: (mas_kg: 1))})";
    let root = scan(text).unwrap();
    let node = root.get(&"a.\"b ä\".Body".parse().unwrap()).unwrap();
    let error = parse_node::<Body>(text, node, "a.\"b ä\".Body").unwrap_err();
    assert_eq!(&text[error.span.clone().unwrap()], "mas_kg");
    assert_eq!(error.path.as_deref(), Some("a.\"b ä\".Body.mas_kg"));
}

#[test]
fn a_fault_in_an_override_is_shown_there() {
    let source = Source::new("a.ron", "(Body: (mass_kg: 1, inertia: ThinSphere))");
    let set = |argument| {
        let source = source
            .with_overrides(&[parse_override(argument).unwrap()])
            .unwrap();
        let root = scan(source.text()).unwrap();
        let node = root.get(&"Body".parse().unwrap()).unwrap();
        let error = parse_node::<Body>(source.text(), node, "Body").unwrap_err();
        source.render(&[error])
    };
    assert_eq!(
        set("Body.mass_kg=\"x\""),
        "error: expected a number, found a string\n \
         --> --set Body.mass_kg=\"x\"\n  |\n  | --set Body.mass_kg=\"x\"\n  |                    ^^^\n"
    );
    assert_eq!(
        set("Body.mass=2"),
        "error: unexpected field `mass` in `Body`, expected one of `mass_kg`, `inertia`\n \
         --> --set Body.mass=2\n  |\n  | --set Body.mass=2\n  |            ^^^^\n  \
         = help: quantities carry their unit: `mass_kg`\n"
    );
}

#[test]
fn whatever_scans_is_parsed_without_a_panic() {
    let texts = [
        "1",
        "-1",
        "1.5",
        "\"a\"",
        "'a'",
        "true",
        "A",
        "A(1)",
        "A(a: 1)",
        "()",
        "(1)",
        "(1, 2)",
        "(a: 1)",
        "[]",
        "[1]",
        "{}",
        "{\"a\": 1}",
        "{1: 2}",
        "Box(1)",
        "Step(1, 2)",
        "(mass_kg: (1, 2))",
        "Step((velocity_m_s: (1, 2, 3)))",
        "Step(velocity_m_s: (1, 2))",
        "(1 /* ä */ , 'ß')",
        "[(((((1)))))]",
        "r#a",
        "r#a-b",
        "b\"x\"",
        "NaN",
        "(r#true: 1)",
    ];
    for text in texts {
        let node = scan(text).unwrap();
        let errors = [
            parse_node::<Body>(text, &node, "p").err(),
            parse_node::<Wind>(text, &node, "p").err(),
            parse_node::<Vec<Inertia>>(text, &node, "p").err(),
            parse_node::<BTreeMap<String, Gust>>(text, &node, "p").err(),
            parse_node::<(u8, f64)>(text, &node, "p").err(),
            parse_node::<(char, bool, String)>(text, &node, "p").err(),
            parse_node::<()>(text, &node, "p").err(),
            parse_node::<i64>(text, &node, "p").err(),
        ];
        for error in errors.into_iter().flatten() {
            assert!(text.get(error.span.clone().unwrap()).is_some(), "{error:?}");
            assert!(error.path.unwrap().starts_with('p'));
        }
    }
}
