//! Numbers as text: one decimal separator per file, thousands separators only where a mapping declares them.

/// Decimal separator of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimal {
    /// `3.14`
    Point,
    /// `3,14`
    Comma,
}

impl Decimal {
    /// Returns the separator character.
    pub fn symbol(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }
}

/// Number format of one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Style {
    pub(super) decimal: Decimal,
    pub(super) thousands: Option<char>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberError {
    Text,
    NotFinite,
    Thousands,
}

/// Parses the number in `cell`, which is not empty and has no outer spaces. `scratch` saves an allocation per cell.
pub(super) fn parse(cell: &str, style: Style, scratch: &mut String) -> Result<f64, NumberError> {
    if style
        == (Style {
            decimal: Decimal::Point,
            thousands: None,
        })
    {
        return finite(cell, cell);
    }
    scratch.clear();
    let (whole, rest) = match cell.find(style.decimal.symbol()) {
        Some(at) if style.thousands != Some(style.decimal.symbol()) => cell.split_at(at),
        _ => match cell.find(['e', 'E']) {
            Some(at) => cell.split_at(at),
            None => (cell, ""),
        },
    };
    match style.thousands {
        Some(separator) => push_grouped(whole, separator, scratch)?,
        None => scratch.push_str(whole),
    }
    if style.decimal == Decimal::Comma && (scratch.contains('.') || rest.contains('.')) {
        return Err(classify(cell));
    }
    match rest.strip_prefix(style.decimal.symbol()) {
        Some(fraction) => {
            scratch.push('.');
            scratch.push_str(fraction);
        }
        None => scratch.push_str(rest),
    }
    finite(scratch, cell)
}

fn finite(text: &str, cell: &str) -> Result<f64, NumberError> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(NumberError::NotFinite),
        Err(_) => Err(classify(cell)),
    }
}

/// Joins `1.234.567` to `1234567`; groups after the first have three digits.
fn push_grouped(whole: &str, separator: char, joined: &mut String) -> Result<(), NumberError> {
    let digits = whole.strip_prefix(['+', '-']).unwrap_or(whole);
    joined.push_str(&whole[..whole.len() - digits.len()]);
    let mut grouped = false;
    for (index, group) in digits.split(separator).enumerate() {
        grouped |= index > 0;
        let right_length = if index == 0 {
            !group.is_empty()
        } else {
            group.len() == 3
        };
        if !right_length || !group.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(NumberError::Text);
        }
        joined.push_str(group);
    }
    // A first group of four digits or more has lost its separators, or never had them.
    if grouped && digits.find(separator).is_some_and(|length| length > 3) {
        return Err(NumberError::Text);
    }
    Ok(())
}

/// Classifies a cell that is no number in this format: grouped number or text.
fn classify(cell: &str) -> NumberError {
    let digits = cell.strip_prefix(['+', '-']).unwrap_or(cell);
    let separators = digits
        .bytes()
        .filter(|byte| matches!(byte, b'.' | b',' | b'\'' | b' '))
        .count();
    let others_are_digits = digits
        .bytes()
        .all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b',' | b'\'' | b' '));
    if others_are_digits && separators >= 1 && separators < digits.len() && looks_grouped(digits) {
        NumberError::Thousands
    } else {
        NumberError::Text
    }
}

fn looks_grouped(digits: &str) -> bool {
    let mut groups = digits.split(['.', ',', '\'', ' ']);
    let first = groups.next().unwrap_or("");
    (1..=3).contains(&first.len()) && groups.next().is_some_and(|group| group.len() == 3)
}

/// Evidence of the decimal separator from one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Evidence {
    /// No evidence: an integer, or no number.
    None,
    /// A decimal point.
    Point,
    /// A decimal comma.
    Comma,
    /// `1,234`: decimal or grouped.
    CommaOrGroup,
    /// Both separators, or one of them twice.
    Grouped,
}

/// Returns whether the cell consists of digits and the marks of numbers, in any order.
pub(super) fn is_number_like(cell: &str) -> bool {
    let mark = |byte: u8| matches!(byte, b'.' | b',' | b'e' | b'E' | b'+' | b'-');
    cell.bytes().any(|byte| byte.is_ascii_digit())
        && cell.bytes().all(|byte| byte.is_ascii_digit() || mark(byte))
}

pub(super) fn evidence(cell: &str) -> Evidence {
    let digits = cell.strip_prefix(['+', '-']).unwrap_or(cell);
    let count = |wanted: u8| digits.bytes().filter(|&byte| byte == wanted).count();
    if !is_number_like(cell) {
        return Evidence::None;
    }
    match (count(b'.'), count(b',')) {
        (0, 0) => Evidence::None,
        (1, 0) => Evidence::Point,
        (0, 1) => match digits.split_once(',') {
            Some((whole, fraction))
                if (1..=3).contains(&whole.len())
                    && !whole.starts_with('0')
                    && fraction.len() == 3
                    && fraction.bytes().all(|byte| byte.is_ascii_digit()) =>
            {
                Evidence::CommaOrGroup
            }
            _ => Evidence::Comma,
        },
        _ => Evidence::Grouped,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Style = Style {
        decimal: Decimal::Point,
        thousands: None,
    };
    const COMMA: Style = Style {
        decimal: Decimal::Comma,
        thousands: None,
    };
    const POINT_GROUPS: Style = Style {
        decimal: Decimal::Comma,
        thousands: Some('.'),
    };
    const ONLY_GROUPS: Style = Style {
        decimal: Decimal::Point,
        thousands: Some('.'),
    };

    fn check(style: Style, cell: &str, expected: Result<f64, NumberError>) {
        assert_eq!(
            parse(cell, style, &mut String::new()),
            expected,
            "{cell:?} as {style:?}"
        );
    }

    #[test]
    fn a_number_is_read_with_the_separators_of_its_column_only() {
        check(POINT, "-3.25e-2", Ok(-0.0325));
        check(COMMA, "-3,25e-2", Ok(-0.0325));
        check(COMMA, "1,234", Ok(1.234));
        check(POINT_GROUPS, "1.234.567,25", Ok(1_234_567.25));
        check(POINT_GROUPS, "-1.234", Ok(-1234.0));
        check(ONLY_GROUPS, "143.863.000", Ok(143_863_000.0));
        check(ONLY_GROUPS, "0.000", Ok(0.0));
        check(
            Style {
                decimal: Decimal::Point,
                thousands: Some(','),
            },
            "1,234.5e2",
            Ok(123_450.0),
        );
        check(
            Style {
                decimal: Decimal::Point,
                thousands: Some(','),
            },
            "1,234e2",
            Ok(123_400.0),
        );
    }

    #[test]
    fn text_groups_and_numbers_that_are_not_finite_are_distinguished() {
        for cell in [
            "3,14", "1_000", "0x10", "1 2", "--1", "12a", "1.2.3", ".", "-", "1,23,4",
        ] {
            check(POINT, cell, Err(NumberError::Text));
        }
        for cell in ["nan", "NaN", "inf", "-Infinity", "1e999", "-1e999"] {
            check(POINT, cell, Err(NumberError::NotFinite));
        }
        for cell in ["1,234", "1.234.567", "1'234", "12 345", "1.234,5"] {
            check(POINT, cell, Err(NumberError::Thousands));
        }
        check(COMMA, "1.234", Err(NumberError::Thousands));
        check(COMMA, "1.5", Err(NumberError::Text));
        for cell in [
            "1.23", "1.2345", "1234.567", ".123", "1..234", "1.234.", "a.bcd",
        ] {
            check(ONLY_GROUPS, cell, Err(NumberError::Text));
        }
    }

    #[test]
    fn only_three_digits_after_a_short_nonzero_part_leave_a_comma_open() {
        for cell in ["1,234", "12,345", "999,000", "-1,234"] {
            assert_eq!(evidence(cell), Evidence::CommaOrGroup, "{cell}");
        }
        for cell in ["0,234", "1,23", "1,2345", "1234,567", ",5", "1,5e3"] {
            assert_eq!(evidence(cell), Evidence::Comma, "{cell}");
        }
        assert_eq!(evidence("1.234"), Evidence::Point);
        for cell in ["1.234,5", "1,234,567", "1.000.000"] {
            assert_eq!(evidence(cell), Evidence::Grouped, "{cell}");
        }
        for cell in ["12", "", "abc", "1a,5", ",", "2024-01-02"] {
            assert_eq!(evidence(cell), Evidence::None, "{cell}");
        }
    }
}
