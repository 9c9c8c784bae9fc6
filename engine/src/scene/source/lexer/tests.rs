use super::*;

#[test]
fn numbers_have_the_value_that_ron_gives_them() {
    for text in [
        "1", "-2.5", "1e5", "56_000", ".5", "2.", "1.5f64", "-inf", "inf", "+3", "1e999",
    ] {
        assert_eq!(value_of(text), ron::from_str::<f64>(text).ok(), "{text}");
    }
    assert_eq!(value_of("7u8"), Some(7.0));
    assert_eq!(value_of("56_000"), Some(56_000.0));
    assert_eq!(value_of("-1e999"), Some(f64::NEG_INFINITY));
    assert_eq!(value_of("1e39f32"), Some(f64::INFINITY));
    assert_eq!(value_of("0x10"), None);
    assert_eq!(value_of("infinity"), None);
    assert_eq!(value_of("nan"), None);
    assert!(value_of("NaN").is_some_and(f64::is_nan));
}

#[test]
fn a_field_may_have_a_plain_name_only() {
    for name in ["mass_kg", "_a", "größe", "Body"] {
        assert!(is_name(name), "{name}");
    }
    for name in ["", "1a", "a-b", "a b", "a.b"] {
        assert!(!is_name(name), "{name}");
    }
}

#[test]
fn lines_and_columns_count_characters_from_one() {
    let lexer = Lexer::new("ä\nöü");
    assert_eq!(lexer.line_column(0), (1, 1));
    assert_eq!(lexer.line_column(5), (2, 2));
}
