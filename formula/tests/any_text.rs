//! Any text: the parser ends with a formula or an error, and never panics.

use formula::{Dimension, Formula, LENGTH_MAX, parse_unit};
use proptest::prelude::*;

/// Parses a text and uses the result in every way.
fn use_up(text: &str) {
    match Formula::parse(text) {
        Ok(formula) => {
            let values = vec![0.7; formula.names().len()];
            let _ = formula.value(&values);
            let _ = formula.dimension(|_| Some(Dimension::NUMBER));
            for name in formula.names() {
                let position = formula.position(name).expect("each name has a place");
                assert!((1..=text.chars().count()).contains(&position), "{text}");
            }
        }
        Err(error) => assert!(
            (1..=text.chars().count() + 1).contains(&error.position) && !error.problem.is_empty(),
            "{text}: {error}"
        ),
    }
    let _ = parse_unit(text);
}

/// Generates texts of the words that formulas contain, in any order.
fn words() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "a",
        "p_x",
        "1",
        "2.5e-3",
        "+",
        "-",
        "*",
        "/",
        "^",
        "(",
        ")",
        ",",
        "min(",
        "sqrt(",
        "\"ü\"",
        "\"",
        " ",
        ".",
        "1e999",
        "Pa^",
        "kg",
        "\u{1f600}",
    ]);
    prop::collection::vec(word, 0..60).prop_map(|words| words.concat())
}

proptest! {
    #[test]
    fn any_text_is_a_formula_or_an_error(text in ".{0,80}") {
        use_up(&text);
    }

    #[test]
    fn any_sequence_of_words_is_a_formula_or_an_error(text in words()) {
        use_up(&text);
    }
}

/// The longest chains of each kind: nothing recurses with the length of the text.
#[test]
fn the_longest_chains_end() {
    for link in ["a^", "a+", "-", "a*", "(", "min(", "a^-", "1/"] {
        let count = (LENGTH_MAX - 1) / link.len();
        use_up(&format!("{}a", link.repeat(count)));
        use_up(&link.repeat(100_000));
    }
    let deep = format!("{}a{}", "min(a,2*(".repeat(10), "))".repeat(10));
    assert!(Formula::parse(&deep).is_ok());
    let chain = format!("{}a", "a^".repeat(200));
    let error = Formula::parse(&chain).unwrap_err().to_string();
    assert!(error.contains("of at most 64"), "{error}");
}
