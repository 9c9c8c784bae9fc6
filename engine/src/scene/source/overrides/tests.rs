use super::super::fixture::SCENE;
use super::*;

fn set(argument: &str) -> Override {
    parse_override(argument).unwrap()
}

fn applied(text: &str, arguments: &[&str]) -> EditedText {
    let overrides: Vec<Override> = arguments.iter().map(|a| set(a)).collect();
    apply(text, &overrides).unwrap()
}

/// Applies, and sees to it that the result scans and that `ron` reads it.
fn text_after(text: &str, arguments: &[&str]) -> String {
    let edited = applied(text, arguments).text().to_owned();
    scan(&edited).unwrap_or_else(|e| panic!("{e:?} in {edited}"));
    ron::from_str::<ron::Value>(&edited).unwrap_or_else(|e| panic!("{e} in {edited}"));
    edited
}

fn refusal(text: &str, argument: &str) -> String {
    let error = apply(text, &[set(argument)]).unwrap_err();
    assert_eq!((error.span, error.path, error.help), (None, None, None));
    error.message
}

#[test]
fn an_argument_is_split_at_its_first_equals_sign() {
    let read = set("a.b = 'Exponential(x: \"=\")'".replace('\'', "").as_str());
    assert_eq!(read.path.to_string(), "a.b");
    assert_eq!(read.value_text, "Exponential(x: \"=\")");
    assert_eq!(&read.original[read.value_offset..], read.value_text);
    assert_eq!(set("a=5 // five").value_text, "5");
    assert_eq!(set("a.\"x=y\"=5").path.segments[1].plain(), "x=y");
}

#[test]
fn arguments_that_cannot_be_read_say_why() {
    for (argument, message) in [
        ("a.b", "`--set a.b`: expected `PATH=VALUE`"),
        ("=5", "`--set =5`: the path `` has an empty part"),
        (
            "a..b=5",
            "`--set a..b=5`: the path `a..b` has an empty part",
        ),
        (
            "a=",
            "`--set a=`: in the value: expected a value, found the end of the text",
        ),
        (
            "a=(1",
            "`--set a=(1`: in the value: this `(` is never closed",
        ),
        (
            "a=my scene",
            "`--set a=my scene`: in the value: expected the end of the text after the value, \
             found `s`",
        ),
    ] {
        assert_eq!(parse_override(argument), Err(message.to_owned()));
    }
}

#[test]
fn a_value_is_replaced_where_it_stands_and_nothing_else_changes() {
    let edited = text_after(SCENE, &["entities.tether.Tether.nodes=20"]);
    assert_eq!(edited, SCENE.replace("nodes: 10,", "nodes: 20,"));
    let air = "Exponential(density_kg_m3: 0.8183, altitude_m: 56000, scale_height_m: 8200)";
    let edited = text_after(SCENE, &[&format!("environment.atmosphere={air}")]);
    assert_eq!(
        edited,
        SCENE.replace("atmosphere: Vira", &format!("atmosphere: {air}"))
    );
    let edited = text_after(SCENE, &["environment.wind.0.velocity_m_s.1=-3.5"]);
    assert_eq!(edited, SCENE.replace("(5, 0, 0)", "(5, -3.5, 0)"));
    let edited = text_after(SCENE, &["entities.balloon.Sphere.radius.altitude_m=55e3"]);
    assert_eq!(edited, SCENE.replace("56_000)", "55e3)"));
    let edited = text_after(SCENE, &["environment.gravity.0=9.81"]);
    assert_eq!(edited, SCENE.replace("8.87", "9.81"));
}

#[test]
fn a_new_last_part_goes_to_the_end_of_its_struct_or_map() {
    for (text, argument, expected) in [
        ("()", "a=1", "(a: 1)"),
        ("A( /* c */ )", "a=1", "A(a: 1 /* c */ )"),
        ("(// c\n)", "a=1", "(a: 1// c\n)"),
        ("{}", "a=1", "{\"a\": 1}"),
        ("(a: 1)", "b=2", "(a: 1, b: 2)"),
        ("(a: 1, )", "b=2", "(a: 1, b: 2, )"),
        ("(a: 1 /* c */)", "b=2", "(a: 1, b: 2 /* c */)"),
        ("{\"a\": 1}", "b=2", "{\"a\": 1, \"b\": 2}"),
        (
            "{\"a\": 1}",
            "\"b \\\" \\\\\"=2",
            "{\"a\": 1, \"b \\\" \\\\\": 2}",
        ),
        ("{\"a\": 1}", "7=2", "{\"a\": 1, \"7\": 2}"),
        ("(a: Some((b: 1)))", "a.c=2", "(a: Some((b: 1, c: 2)))"),
        ("(a: E(b: 1))", "a.c=2", "(a: E(b: 1, c: 2))"),
        ("(a: ())", "a.c=2", "(a: (c: 2))"),
        (
            "(\n    a: 1, // c\n)",
            "b=2",
            "(\n    a: 1, // c\n    b: 2,\n)",
        ),
        (
            "(\n    a: 1 // c\n)",
            "b=2",
            "(\n    a: 1, // c\n    b: 2,\n)",
        ),
        ("(\r\n\ta: 1\r\n\t)", "b=2", "(\r\n\ta: 1,\r\n\tb: 2,\n\t)"),
        ("(a: (\n  1),\n)", "b=2", "(a: (\n  1),\nb: 2,\n)"),
        (
            "{\n  \"a\": 1 /* , */\n}",
            "b=2",
            "{\n  \"a\": 1, /* , */\n  \"b\": 2,\n}",
        ),
    ] {
        assert_eq!(
            text_after(text, &[argument]),
            expected,
            "{argument} in {text}"
        );
    }
    let edited = text_after(SCENE, &["entities.tether.Tether.slack=false"]);
    let end = "tangential: 0.03),\n";
    assert_eq!(
        edited,
        SCENE.replace(end, &format!("{end}                slack: false,\n"))
    );
    let edited = text_after(SCENE, &["entities.balloon.Buoyancy.volume_m3=3"]);
    assert_eq!(
        edited,
        SCENE.replace("Buoyancy: ()", "Buoyancy: (volume_m3: 3)")
    );
    let edited = text_after(
        SCENE,
        &["entities.drone=(Body: (mass_kg: 3))", "run.seed=7"],
    );
    assert!(edited.contains("        \"drone\": (Body: (mass_kg: 3)),\n    },\n"));
    assert!(edited.contains("(relative_tolerance: 1e-8), seed: 7),\n)"));
}

#[test]
fn a_path_that_leads_nowhere_names_the_part_that_does_not_exist() {
    for (argument, message) in [
        (
            "entities.tehter.Tether.nodes=20",
            "there is no `tehter` in `entities`; did you mean `tether`?",
        ),
        (
            "entites.tether.Tether.nodes=20",
            "there is no `entites` in the scene; did you mean `entities`?",
        ),
        (
            "entities.sail.Sail.area_m2=2",
            "there is no `sail` in `entities`; it has `balloon`, `gondola`, `tether`",
        ),
        (
            "environment.wind.1.from_s=2",
            "there is no `1` in `environment.wind`, which has 1 value, counted from 0",
        ),
        (
            "environment.wind.1=2",
            "there is no `1` in `environment.wind`, which has 1 value, counted from 0",
        ),
        (
            "environment.gravity.g0=2",
            "there is no `g0` in `environment.gravity`, which has 1 value, counted from 0",
        ),
        (
            "environment.wind.0.velocity_m_s.x=2",
            "there is no `x` in `environment.wind.0.velocity_m_s`, which has 3 values, counted \
             from 0",
        ),
        (
            "environment.atmosphere.density_kg_m3=1",
            "there is no `density_kg_m3` in `environment.atmosphere`, which is the name `Vira` \
             without parts",
        ),
        ("run.\"a b\"=1", "`a b` cannot be the name of a field"),
        ("run.0=1", "`0` cannot be the name of a field"),
    ] {
        assert_eq!(refusal(SCENE, argument), message, "{argument}");
    }
}

/// A block that the scene leaves to its defaults is written as far as the path needs it.
#[test]
fn a_field_of_a_block_that_is_not_written_brings_the_block() {
    let edited = text_after(
        SCENE,
        &["run.record.nodes=Never", "run.record.bodies=Output"],
    );
    assert!(
        edited.contains("record: (nodes: Never, bodies: Output)"),
        "{edited}"
    );
}

#[test]
fn a_text_that_does_not_scan_is_refused_at_its_place() {
    let error = apply("(a: [", &[set("a=1")]).unwrap_err();
    assert_eq!(error.message, "this `[` is never closed");
    assert_eq!(error.span, Some(4..5));
    let deep = format!("a={}{}", "[".repeat(100), "]".repeat(100));
    let error = apply("(a: 1)", &[set(&deep), set("a=1")]).unwrap_err();
    assert!(error.message.ends_with("nested deeper than 100 levels"));
    assert_eq!(error.span, None);
}

#[test]
fn later_overrides_apply_on_top_of_earlier_ones() {
    let argument = "entities.tether.Tether.nodes=20";
    let new = "entities.tether.Tether.slack=false";
    assert_eq!(
        text_after(SCENE, &[argument, new, argument, new]),
        text_after(SCENE, &[argument, new]),
    );
    assert_eq!(
        text_after("(a: 1)", &["a=(b: 2)", "a.b=3", "a.c=4"]),
        "(a: (b: 3, c: 4))"
    );
    assert_eq!(text_after("(a: 1)", &["a=(b: 2)", "a=5"]), "(a: 5)");
    assert_eq!(
        text_after("()", &["a={}", "a.x=()", "a.x.y=1"]),
        "(a: {\"x\": (y: 1)})"
    );
    let one_by_one = text_after(&text_after(SCENE, &[argument]), &[new]);
    assert_eq!(one_by_one, text_after(SCENE, &[argument, new]));
}

#[test]
fn comments_survive_every_override() {
    let root = scan(SCENE).unwrap();
    let mut paths = Vec::new();
    collect_paths(&root, &FieldPath::default(), &mut paths);
    assert!(paths.len() > 50);
    for path in paths {
        let edited = text_after(
            SCENE,
            &[&format!("{path}=(new: 7)"), &format!("{path}.more=8")],
        );
        let root = scan(&edited).unwrap();
        let value = root.get(&path).unwrap();
        assert_eq!(&edited[value.span.clone()], "(new: 7, more: 8)");
        for comment in [
            "// area: pi R^2 unless given\n",
            "// Bottom of a sphere: (0, 0, -R)\n",
        ] {
            let place = scan(SCENE).unwrap().get(&path).unwrap().span.clone();
            let inside = place.contains(&SCENE.find(comment).unwrap());
            assert!(inside || edited.contains(comment), "{path}");
        }
    }
}

fn collect_paths(node: &Node, path: &FieldPath, paths: &mut Vec<FieldPath>) {
    for (segment, _, child) in node.children() {
        let inner = path.join(segment);
        paths.push(inner.clone());
        collect_paths(child, &inner, paths);
    }
}
