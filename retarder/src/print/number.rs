//! Formats of numbers in the text.

/// Formats `value` with `digits` significant digits: 0.375, 86.8, 1234, 2.89e-7.
pub(super) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 {
            "0".to_owned()
        } else {
            "-".to_owned()
        };
    }
    // Exponent of the rounded value: with three digits, 9.996 has two digits before the point.
    let exponent = format!("{value:.*e}", (digits - 1).max(0) as usize)
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse::<i32>().ok())
        .unwrap_or_default();
    if exponent < -4 {
        return format!("{value:.*e}", (digits - 1).max(0) as usize);
    }
    let decimals = (digits - 1 - exponent).max(0);
    format!("{value:.*}", decimals as usize)
}

/// Formats a number like [`significant`], with its sign.
pub(super) fn signed(value: f64, digits: i32) -> String {
    let text = significant(value.abs(), digits);
    if value == 0.0 || !value.is_finite() {
        text
    } else if value > 0.0 {
        format!("+{text}")
    } else {
        format!("-{text}")
    }
}

/// Formats a parameter value; long rows of zeros become an exponent.
pub(super) fn value(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// Formats a share from 0 to 1 in percent.
pub(super) fn percent(share: f64) -> String {
    let percent = (100.0 * share).round();
    // Avoids -0.
    format!("{} %", percent + 0.0)
}

/// Formats the value, or a dash if there is none.
pub(super) fn or_dash<T>(value: Option<T>, format: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), format)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones() {
        for (value, expected) in [
            (0.0, "0"),
            (0.375_44, "0.375"),
            (86.84, "86.8"),
            (9.996, "10.0"),
            (1234.5, "1234"),
            (-0.004_321, "-0.00432"),
            (2.887e-7, "2.89e-7"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(significant(value, 3), expected);
        }
        assert_eq!(signed(0.5, 2), "+0.50");
        assert_eq!(signed(-0.5, 2), "-0.50");
        assert_eq!(percent(-0.001), "0 %");
        assert_eq!(value(7.5e-5), "7.5e-5");
        assert_eq!(value(82.2), "82.2");
    }
}
