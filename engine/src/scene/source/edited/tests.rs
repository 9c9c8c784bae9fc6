use super::super::{apply, parse_override};
use super::*;

fn applied(text: &str, arguments: &[&str]) -> EditedText {
    let overrides: Vec<Override> = (arguments.iter())
        .map(|a| parse_override(a).unwrap())
        .collect();
    apply(text, &overrides).unwrap()
}

fn values(edited: &EditedText) -> Vec<Option<&str>> {
    (0..edited.overrides().len())
        .map(|i| edited.value_range(i).map(|r| &edited.text()[r]))
        .collect()
}

#[test]
fn value_ranges_move_with_later_edits() {
    let edited = applied("(a: 1, b: 2, c: 3)", &["c=33", "a=111", "d=4", "b=(x: 1)"]);
    assert_eq!(edited.text(), "(a: 111, b: (x: 1), c: 33, d: 4)");
    assert_eq!(
        values(&edited),
        [Some("33"), Some("111"), Some("4"), Some("(x: 1)")]
    );
    let edited = applied("(a: 1)", &["a=(x: 1, y: 2)", "a.x=77", "a.z=3"]);
    assert_eq!(
        values(&edited),
        [Some("(x: 77, y: 2, z: 3)"), Some("77"), Some("3")]
    );
    let edited = applied("(a: (b: 1))", &["a.b=2", "a=(c: 3)", "a=4"]);
    assert_eq!(values(&edited), [None, None, Some("4")]);
    assert_eq!(edited.value_range(9), None);
}

#[test]
fn unedited_text_maps_back_to_the_file() {
    let file = "(\n  a: 1, // ä\n  b: 2,\n  c: (d: 3)\n)";
    let edited = applied(file, &["b=2222", "e=5", "a=()", "c.f=6"]);
    let mut from_file = 0;
    for at in 0..edited.text().len() {
        if let Some(back) = edited.original_offset(at) {
            assert_eq!(file.as_bytes()[back], edited.text().as_bytes()[at]);
            from_file += 1;
        } else {
            let (index, place) = edited.argument_offset(at).unwrap();
            assert!(place <= edited.overrides()[index].original.len());
        }
    }
    assert_eq!(from_file, file.len() - "12".len());
    assert_eq!(
        edited.original_offset(edited.text().len()),
        Some(file.len())
    );
    assert_eq!(edited.original_offset(9999), None);
}

#[test]
fn overridden_text_maps_back_to_its_argument() {
    let edited = applied("(a: 1)", &["a=(x: 1)", "a.yy=(z: 2)", "b=3"]);
    assert_eq!(edited.text(), "(a: (x: 1, yy: (z: 2)), b: 3)");
    let back = |part: &str| {
        let (index, at) = edited
            .argument_offset(edited.text().find(part).unwrap())
            .unwrap();
        (index, &edited.overrides()[index].original[at..])
    };
    assert_eq!(back("(x"), (0, "(x: 1)"));
    assert_eq!(back("x: 1"), (0, "x: 1)"));
    assert_eq!(back("yy"), (1, "yy=(z: 2)"));
    assert_eq!(back(": (z"), (1, "(z: 2)"));
    assert_eq!(back("z: 2"), (1, "z: 2)"));
    assert_eq!(back("), b"), (0, ")"));
    assert_eq!(back("b: "), (2, "b=3"));
}

#[test]
fn an_unedited_text_is_its_own_original() {
    let text = EditedText::unedited("(a: 1)");
    assert_eq!(text.text(), "(a: 1)");
    assert_eq!(text.original_offset(4), Some(4));
    assert_eq!(text.argument_offset(4), None);
    assert_eq!(EditedText::unedited("").original_offset(0), Some(0));
}
