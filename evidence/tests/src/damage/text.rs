//! Damage for texts of any kind, for tables of rows and columns, and for keys and values.

use std::ops::Range;

use super::bytes::{Mutation, place};
use super::values::{MAPPED_UNITS, NUMBERS, STRUCTURES, UNITS, WORDS};
use crate::chance::Chance;

/// Kinds of damage for the numbers of any text.
pub const NUMBER: [Mutation; 5] = [
    ("number nudged", |text, chance| {
        set_number(text, chance, |number, chance| {
            (number * (1.0 + 0.5 * chance.normal())).to_string()
        });
    }),
    ("number set to a bound", |text, chance| {
        set_number(text, chance, |_, chance| chance.one_of(&NUMBERS).to_owned());
    }),
    ("number scaled", |text, chance| {
        set_number(text, chance, |number, chance| {
            let factor = 10_f64.powi(chance.whole(0, 24) as i32 - 12);
            let sign = if chance.happens(0.3) { -1.0 } else { 1.0 };
            (number * factor * sign).to_string()
        });
    }),
    ("word for a number", |text, chance| {
        set_number(text, chance, |_, chance| chance.one_of(&WORDS).to_owned());
    }),
    ("many digits", |text, chance| {
        set_number(text, chance, |number, chance| {
            let digits = "1234567890".repeat(chance.one_of(&[2, 5, 30, 40, 400, 7000]));
            format!("{number}{digits}")
        });
    }),
];

/// Kinds of damage for any text.
pub const ANY: [Mutation; 10] = [
    ("line dropped", |text, chance| {
        lines(text, chance, |lines, at, _| drop(lines.remove(at)))
    }),
    ("line doubled", |text, chance| {
        lines(text, chance, |lines, at, _| {
            lines.insert(at, lines[at].clone())
        });
    }),
    ("lines swapped", |text, chance| {
        lines(text, chance, |lines, at, chance| {
            let other = chance.whole(0, lines.len() - 1);
            lines.swap(at, other);
        });
    }),
    ("lines shuffled", |text, chance| {
        lines(text, chance, |lines, at, chance| {
            chance.shuffle(&mut lines[at..])
        });
    }),
    ("lines cut out", |text, chance| {
        lines(text, chance, |lines, at, chance| {
            let end = chance.whole(at, lines.len());
            lines.drain(at..end);
        });
    }),
    ("lines repeated", |text, chance| {
        lines(text, chance, |lines, at, chance| {
            let end = chance.whole(at, (at + 20).min(lines.len()));
            let block = lines[at..end].to_vec();
            lines.splice(end..end, block);
        });
    }),
    ("words swapped", swap_words),
    ("word mistyped", mistype),
    ("nested deeply", nest),
    ("line ends changed", |text, chance| {
        let end: &[u8] = chance.one_of(&[b"\r\n".as_slice(), b"\r", b"\n\n", b"\n\r", b""]);
        *text = text
            .split(|byte| *byte == b'\n')
            .collect::<Vec<_>>()
            .join(end);
    }),
];

/// Kinds of damage for tables: rows of cells between separators, below a header.
pub const TABLE: [Mutation; 12] = [
    ("column set to a bound", |text, chance| {
        let value = any_value(chance);
        cells(text, chance, |_, _, _| value.to_owned());
    }),
    ("rows of a column set to a bound", |text, chance| {
        let value = any_value(chance);
        let share = chance.share();
        cells(text, chance, |cell, place, _| {
            let is_in = (share..share + 0.35).contains(&place);
            if is_in {
                value.to_owned()
            } else {
                cell.to_owned()
            }
        });
    }),
    ("column shifted and scaled", |text, chance| {
        let offset: f64 = chance.one_of(&NUMBERS).parse().expect("a number");
        let factor = chance.one_of(&[1.0, -1.0, 0.0, 1e-3, 1e3, 10.0, 0.1, 1e-6, 1e6, 14.5, 1e12]);
        let offset = if chance.happens(0.5) { offset } else { 0.0 };
        cells(text, chance, |cell, _, _| {
            match cell.trim().parse::<f64>() {
                Ok(value) => (value * factor + offset).to_string(),
                Err(_) => cell.to_owned(),
            }
        });
    }),
    ("cells of a column missing", |text, chance| {
        let share = chance.share();
        cells(text, chance, |cell, _, chance| {
            if chance.happens(share) {
                String::new()
            } else {
                cell.to_owned()
            }
        });
    }),
    ("column frozen", |text, chance| {
        let (from, mut held) = (chance.share(), None);
        cells(text, chance, |cell, place, _| {
            if place < from {
                cell.to_owned()
            } else {
                held.get_or_insert_with(|| cell.to_owned()).clone()
            }
        });
    }),
    ("column of noise", |text, chance| {
        let size = chance.one_of(&[1e-6, 1.0, 10.0, 1e3, 1e9]);
        cells(text, chance, |_, _, chance| {
            (size * chance.normal()).to_string()
        });
    }),
    ("column dropped", |text, chance| {
        columns(text, chance, |row, at, _| {
            if at < row.len() {
                row.remove(at);
            }
        });
    }),
    ("columns swapped", |text, chance| {
        columns(text, chance, |row, at, other| {
            if at.max(other) < row.len() {
                row.swap(at, other);
            }
        });
    }),
    ("column doubled", |text, chance| {
        columns(text, chance, |row, at, other| {
            if let Some(cell) = row.get(at).cloned() {
                row.insert(other.min(row.len()), cell);
            }
        });
    }),
    ("unit of a column changed", |text, chance| {
        let unit = chance.one_of(&UNITS);
        header(text, chance, |name| {
            let known = UNITS
                .iter()
                .filter(|known| !known.is_empty() && name.ends_with(**known));
            let length = known.map(|known| known.len()).max().unwrap_or(0);
            format!("{}{unit}", &name[..name.len() - length])
        });
    }),
    ("pause in time", |text, chance| {
        let pause: f64 = chance.one_of(&[
            0.015, 0.05, 0.2, 0.7, 10.0, 3600.0, 1e6, 1e9, 1e15, -0.5, -10.0,
        ]);
        let from = chance.share();
        first_cells(text, |cell, place| match cell.trim().parse::<f64>() {
            Ok(time) if place >= from => (time + pause).to_string(),
            _ => cell.to_owned(),
        });
    }),
    ("separators changed", |text, chance| {
        let (from, to) = (chance.one_of(b",;.\t"), chance.one_of(b",;.\t| "));
        for byte in text.iter_mut().filter(|byte| **byte == from) {
            *byte = to;
        }
    }),
];

/// Kinds of damage for keys and values, TOML and JSON.
pub const KEYS: [Mutation; 6] = [
    ("value set to a bound", |text, chance| {
        let value = chance.one_of(&NUMBERS).to_owned();
        set_value(text, chance, value);
    }),
    ("value of another kind", |text, chance| {
        let value = chance.one_of(&STRUCTURES).to_owned();
        set_value(text, chance, value);
    }),
    ("unit of a mapping changed", |text, chance| {
        let value = chance.one_of(&MAPPED_UNITS).to_owned();
        set_value(text, chance, value);
    }),
    ("value taken from elsewhere", |text, chance| {
        let values = values(text);
        if !values.is_empty() {
            let from = values[chance.whole(0, values.len() - 1)].clone();
            let value = String::from_utf8_lossy(&text[from]).into_owned();
            set_value(text, chance, value);
        }
    }),
    ("section called another", |text, chance| {
        let sections: Vec<Range<usize>> = spans(text, |byte| byte != b'\n')
            .into_iter()
            .filter(|line| text[line.start] == b'[')
            .collect();
        if sections.len() > 1 {
            let name = text[sections[chance.whole(0, sections.len() - 1)].clone()].to_vec();
            let at = sections[chance.whole(0, sections.len() - 1)].clone();
            text.splice(at, name);
        }
    }),
    ("comment opened", |text, chance| {
        let at = place(text, chance);
        text.splice(
            at..at,
            chance
                .one_of(&["#", "\"\"\"", "'''", "/*", "\\", "\"", "'"])
                .bytes(),
        );
    }),
];

fn any_value(chance: &mut Chance) -> &'static str {
    if chance.happens(0.85) {
        chance.one_of(&NUMBERS)
    } else {
        chance.one_of(&WORDS)
    }
}

/// Returns the longest runs of bytes for which `is_in` is true.
fn spans(text: &[u8], is_in: impl Fn(u8) -> bool) -> Vec<Range<usize>> {
    let mut spans: Vec<Range<usize>> = Vec::new();
    for (at, _) in text.iter().enumerate().filter(|(_, byte)| is_in(**byte)) {
        match spans.last_mut() {
            Some(last) if last.end == at => last.end += 1,
            _ => spans.push(at..at + 1),
        }
    }
    spans
}

fn number(span: &[u8]) -> Option<f64> {
    std::str::from_utf8(span).ok()?.parse().ok()
}

/// Replaces one number by the result of `new`.
fn set_number(text: &mut Vec<u8>, chance: &mut Chance, new: impl Fn(f64, &mut Chance) -> String) {
    let is_in =
        |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'e' | b'E' | b'+');
    let stands_alone = |span: &Range<usize>| {
        let before = span.start.checked_sub(1).map(|at| text[at]);
        let after = text.get(span.end).copied();
        !before.is_some_and(is_word) && !after.is_some_and(is_word)
    };
    let numbers: Vec<_> = spans(text, is_in)
        .into_iter()
        .filter(stands_alone)
        .filter_map(|span| Some((number(&text[span.clone()])?, span)))
        .collect();
    if numbers.is_empty() {
        return;
    }
    let (number, span) = numbers[chance.whole(0, numbers.len() - 1)].clone();
    let new = new(number, chance);
    text.splice(span, new.into_bytes());
}

/// Changes the lines, one of which is drawn.
fn lines(
    text: &mut Vec<u8>,
    chance: &mut Chance,
    change: impl Fn(&mut Vec<Vec<u8>>, usize, &mut Chance),
) {
    let mut lines: Vec<Vec<u8>> = text
        .split_inclusive(|byte| *byte == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    if lines.is_empty() {
        return;
    }
    // Half of them among the first lines, which have headers and sections.
    let last = lines.len() - 1;
    let at = if chance.happens(0.5) {
        chance.whole(0, last)
    } else {
        chance.whole(0, last.min(3))
    };
    change(&mut lines, at, chance);
    *text = lines.concat();
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

fn words(text: &[u8]) -> Vec<Range<usize>> {
    let starts_as_word = |span: &Range<usize>| text[span.start].is_ascii_alphabetic();
    spans(text, is_word)
        .into_iter()
        .filter(starts_as_word)
        .collect()
}

fn swap_words(text: &mut Vec<u8>, chance: &mut Chance) {
    let words = words(text);
    if words.len() < 2 {
        return;
    }
    let first = chance.whole(0, words.len() - 2);
    let second = chance.whole(first + 1, words.len() - 1);
    let (first, second) = (words[first].clone(), words[second].clone());
    let (a, b) = (text[first.clone()].to_vec(), text[second.clone()].to_vec());
    text.splice(second, a);
    text.splice(first, b);
}

/// Drops, doubles or changes one letter of a word, or changes its case.
fn mistype(text: &mut Vec<u8>, chance: &mut Chance) {
    let words = words(text);
    if words.is_empty() {
        return;
    }
    let word = words[chance.whole(0, words.len() - 1)].clone();
    let at = chance.whole(word.start, word.end - 1);
    match chance.whole(0, 3) {
        0 => drop(text.remove(at)),
        1 => text.insert(at, text[at]),
        2 => text[at] = chance.whole(usize::from(b'a'), usize::from(b'z')) as u8,
        _ => text[at] ^= 0x20,
    }
}

fn nest(text: &mut Vec<u8>, chance: &mut Chance) {
    let (open, close) = chance.one_of(&[
        ("[", "]"),
        ("{a=", "}"),
        ("{\"a\":", "}"),
        ("(", ")"),
        ("\"", "\""),
        ("a.", ""),
    ]);
    let depth = chance.one_of(&[20, 200, 5000, 100_000]);
    let mut nested = open.repeat(depth);
    nested += chance.one_of(&["1", ""]);
    if chance.happens(0.7) {
        nested += &close.repeat(depth);
    }
    let values = values(text);
    let at = if values.is_empty() || chance.happens(0.3) {
        let at = place(text, chance);
        at..at
    } else {
        values[chance.whole(0, values.len() - 1)].clone()
    };
    text.splice(at, nested.into_bytes());
}

/// Returns the texts after `=` or `:` up to a comma, a comment or the end of the line.
fn values(text: &[u8]) -> Vec<Range<usize>> {
    let mut values = Vec::new();
    for (at, _) in text
        .iter()
        .enumerate()
        .filter(|(_, byte)| matches!(byte, b'=' | b':'))
    {
        let end = text[at + 1..]
            .iter()
            .position(|byte| matches!(byte, b'\n' | b'#' | b','));
        values.push(at + 1..end.map_or(text.len(), |end| at + 1 + end));
    }
    values
}

fn set_value(text: &mut Vec<u8>, chance: &mut Chance, value: String) {
    let values = values(text);
    if !values.is_empty() {
        let at = values[chance.whole(0, values.len() - 1)].clone();
        text.splice(at, format!(" {value}").into_bytes());
    }
}

/// Returns the rows of cells, and the separator between them.
fn table(text: &[u8]) -> (Vec<Vec<String>>, &'static str) {
    let text = String::from_utf8_lossy(text);
    let separator = if text
        .lines()
        .next()
        .is_some_and(|header| header.contains(';'))
    {
        ";"
    } else {
        ","
    };
    let row = |line: &str| line.split(separator).map(str::to_owned).collect();
    (text.lines().map(row).collect(), separator)
}

fn write_table(rows: &[Vec<String>], separator: &str) -> Vec<u8> {
    let lines = rows.iter().map(|row| row.join(separator) + "\n");
    lines.collect::<String>().into_bytes()
}

/// Changes each cell of one column below the header; `change` gets its relative position in the column, from 0 to 1.
fn cells(
    text: &mut Vec<u8>,
    chance: &mut Chance,
    mut change: impl FnMut(&str, f64, &mut Chance) -> String,
) {
    let (mut rows, separator) = table(text);
    let width = rows.first().map_or(0, Vec::len);
    if width == 0 {
        return;
    }
    let (column, count) = (chance.whole(0, width - 1), rows.len() as f64);
    for (index, row) in rows.iter_mut().enumerate().skip(1) {
        if let Some(cell) = row.get_mut(column) {
            *cell = change(cell, index as f64 / count, chance);
        }
    }
    *text = write_table(&rows, separator);
}

/// Changes each cell of the first column, which has the time.
fn first_cells(text: &mut Vec<u8>, change: impl Fn(&str, f64) -> String) {
    let (mut rows, separator) = table(text);
    let count = rows.len() as f64;
    for (index, row) in rows.iter_mut().enumerate().skip(1) {
        row[0] = change(&row[0], index as f64 / count);
    }
    *text = write_table(&rows, separator);
}

/// Changes each row, including the header; `change` gets two columns.
fn columns(
    text: &mut Vec<u8>,
    chance: &mut Chance,
    change: impl Fn(&mut Vec<String>, usize, usize),
) {
    let (mut rows, separator) = table(text);
    let width = rows.first().map_or(0, Vec::len);
    if width == 0 {
        return;
    }
    let (first, second) = (chance.whole(0, width - 1), chance.whole(0, width - 1));
    for row in &mut rows {
        change(row, first, second);
    }
    *text = write_table(&rows, separator);
}

/// Changes one name of the header.
fn header(text: &mut Vec<u8>, chance: &mut Chance, change: impl Fn(&str) -> String) {
    let (mut rows, separator) = table(text);
    if let Some(names) = rows.first_mut() {
        let at = chance.whole(0, names.len() - 1);
        names[at] = change(&names[at]);
    }
    *text = write_table(&rows, separator);
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "time_s,duty_fill_pct,p_ch_bar_gauge\n0.00,0,0.1\n0.01,50,0.2\n0.02,50,0.3\n";

    fn way(ways: &[Mutation], name: &str) -> fn(&mut Vec<u8>, &mut Chance) {
        let found = ways.iter().find(|(known, _)| *known == name);
        found.unwrap_or_else(|| panic!("no way is called {name}")).1
    }

    /// Returns the damaged log for some seeds.
    fn damaged(ways: &[Mutation], name: &str) -> Vec<String> {
        let once = |seed| {
            let mut text = LOG.as_bytes().to_vec();
            way(ways, name)(&mut text, &mut Chance::new(seed));
            String::from_utf8(text).unwrap()
        };
        (0..30).map(once).collect()
    }

    #[test]
    fn a_number_in_a_cell_gives_way_to_a_bound() {
        let all = damaged(&NUMBER, "number set to a bound");
        assert!(all.iter().all(|text| text.starts_with("time_s")), "{all:?}");
        let changed = all.iter().filter(|text| **text != LOG).count();
        assert!(changed >= 25, "{changed} of {all:?}");
    }

    #[test]
    fn a_column_set_to_a_bound_has_it_in_every_row() {
        for text in damaged(&TABLE, "column set to a bound") {
            let (rows, _) = table(text.as_bytes());
            let same = |column: usize| rows[1..].iter().all(|row| row[column] == rows[1][column]);
            assert!((0..3).any(same), "{text}");
        }
    }

    #[test]
    fn a_unit_is_replaced_and_not_appended() {
        let all = damaged(&TABLE, "unit of a column changed");
        assert!(
            all.iter().any(|text| text.contains("p_ch_psi")
                || text.contains("p_ch_mA")
                || text.contains("p_ch_V")),
            "{all:?}"
        );
    }

    #[test]
    fn values_of_keys_are_found_without_their_comments() {
        let text = b"[a]\nb = 1 # why\nc = \"d\"\n";
        let found: Vec<_> = values(text).into_iter().map(|at| &text[at]).collect();
        assert_eq!(found, [b" 1 ".as_slice(), b" \"d\""]);
    }
}
