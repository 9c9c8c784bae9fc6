use super::super::scan;
use super::*;

#[test]
fn infinite_numbers_are_listed_wherever_they_stand() {
    let text = "(a: inf, b: [-inf, NaN, 1e999], c: {1e400: -1e400}, d: A(inff64), e: (1e308, 0xFFF), \
                f: \"inf\", inf: 1, g: infinite)";
    let root = scan(text).unwrap();
    let found: Vec<&str> = non_finite(&root, text)
        .into_iter()
        .map(|s| &text[s])
        .collect();
    assert_eq!(
        found,
        ["inf", "-inf", "NaN", "1e999", "1e400", "-1e400", "inff64"]
    );
}

#[test]
fn an_integer_of_many_digits_overflows_too() {
    let text = "1".repeat(400);
    let found = non_finite(&scan(&text).unwrap(), &text);
    assert_eq!((found.len(), &found[0]), (1, &(0..400)));
}
