//! Controller file as a form: the text at each key, and the file with changed texts.

use toml_edit::{DocumentMut, Item, Value};

use super::keys::{KEYS, Key};

/// Returns the text of each key, as a user types it: a number as in the file, a word without its quotes. Missing keys
/// are left out. The result of a file that is not TOML is empty.
pub fn values(text: &str) -> Vec<(&'static Key, String)> {
    let document: DocumentMut = text.parse().unwrap_or_default();
    let typed = |item: &Item| match item.as_str() {
        Some(word) => word.to_owned(),
        None => item.to_string().trim().to_owned(),
    };
    KEYS.iter()
        .filter_map(|key| {
            let mut item = document.get(key.table)?.get(key.name)?.clone();
            item.as_value_mut()?.decor_mut().clear();
            Some((key, typed(&item)))
        })
        .collect()
}

/// Returns the file with changed values, each with `origin` as its comment. `None` removes a key, and a table with its
/// last key. All other text is unchanged. [`super::read`] decides whether the result is valid.
pub fn with_values(text: &str, changes: &[(&'static Key, Option<&str>)], origin: &str) -> String {
    let mut document: DocumentMut = text.parse().unwrap_or_default();
    for (key, typed) in changes {
        let Some(typed) = typed else {
            if let Some(table) = document
                .get_mut(key.table)
                .and_then(Item::as_table_like_mut)
            {
                table.remove(key.name);
                if table.is_empty() {
                    document.remove(key.table);
                }
            }
            continue;
        };
        let mut value = typed_value(typed);
        let comment: String = origin.chars().filter(|c| !c.is_control()).collect();
        value.decor_mut().set_prefix(" ");
        value.decor_mut().set_suffix(format!("   # {comment}"));
        let table = document
            .entry(key.table)
            .or_insert_with(|| Item::Table(toml_edit::Table::new()));
        let Some(table) = table.as_table_like_mut() else {
            continue;
        };
        // Comments before the key stay.
        match table.get_mut(key.name) {
            Some(item) => *item = Item::Value(value),
            None => drop(table.insert(key.name, Item::Value(value))),
        }
    }
    document.to_string()
}

/// Returns a number if the text is one, otherwise a word.
fn typed_value(typed: &str) -> Value {
    let typed = typed.trim();
    match typed.parse::<Value>() {
        Ok(number @ (Value::Integer(_) | Value::Float(_))) => number,
        _ => typed.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{RECOMMENDED_TOML, THESIS_TOML, read, recommended};
    use super::*;

    fn key(path: &str) -> &'static Key {
        KEYS.iter().find(|key| key.path() == path).unwrap()
    }

    #[test]
    fn a_file_that_is_filled_in_with_its_own_values_means_the_same() {
        for text in [THESIS_TOML, RECOMMENDED_TOML] {
            let values = values(text);
            assert!(values.len() > 15);
            let changes: Vec<_> = values
                .iter()
                .map(|(key, typed)| (*key, Some(&typed[..])))
                .collect();
            for begin in [text, ""] {
                let filled = with_values(begin, &changes, "the same");
                assert_eq!(read(&filled, "C").unwrap(), read(text, "C").unwrap());
            }
        }
    }

    #[test]
    fn only_what_was_changed_has_another_comment() {
        let gain = key("pid.gain_pct_per_bar");
        let text = with_values(RECOMMENDED_TOML, &[(gain, Some("30.5"))], "by hand\n[x]");
        let different: Vec<_> = text
            .lines()
            .zip(RECOMMENDED_TOML.lines())
            .filter(|(one, other)| one != other)
            .collect();
        assert_eq!(different.len(), 1);
        assert_eq!(different[0].0, "gain_pct_per_bar = 30.5   # by hand[x]");
    }

    #[test]
    fn an_option_goes_with_its_last_key() {
        let changes: Vec<_> = KEYS
            .iter()
            .filter(|key| key.table == "boost")
            .map(|key| (key, None))
            .collect();
        let settings = read(&with_values(RECOMMENDED_TOML, &changes, ""), "C").unwrap();
        assert_eq!(settings.boost, None);
        assert!(recommended().boost.is_some());
    }

    /// Any typed text becomes one value, and is refused as such.
    #[test]
    fn what_is_typed_cannot_become_another_line() {
        let gain = key("pid.gain_pct_per_bar");
        for typed in [
            "1\n[boost]",
            "\"",
            "nan",
            "{a = 1}",
            "[1]",
            "true",
            "",
            "1979-05-27",
        ] {
            let text = with_values(THESIS_TOML, &[(gain, Some(typed))], "typed");
            let error = read(&text, "C").unwrap_err();
            assert_eq!(error.problems().len(), 1, "{typed:?}: {error}");
            assert!(
                error.to_string().contains("pid.gain_pct_per_bar"),
                "{error}"
            );
        }
    }
}
