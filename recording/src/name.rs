use crate::{Quantity, Unit};

/// Maximum length of a signal's name (bytes).
pub const NAME_BYTES_MAX: usize = 256;

/// Problem of a signal's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameError {
    /// The name has no visible character.
    #[error("a name has at least one visible character")]
    Empty,
    /// The name is longer than [`NAME_BYTES_MAX`].
    #[error("a name has at most {NAME_BYTES_MAX} bytes, this one {0}")]
    Long(usize),
    /// The name has control or bidirectional-override characters, which change what a terminal or a page shows.
    #[error("a name has no control characters, this one has U+{:04X}", *.0 as u32)]
    Control(char),
    /// The name begins or ends with white space, which is not visible.
    #[error("a name neither begins nor ends with white space")]
    OuterSpace,
}

pub(crate) fn check_name(name: &str) -> Result<(), NameError> {
    if name.trim().is_empty() {
        return Err(NameError::Empty);
    }
    if name.len() > NAME_BYTES_MAX {
        return Err(NameError::Long(name.len()));
    }
    if let Some(character) = name.chars().find(|&character| is_unprintable(character)) {
        return Err(NameError::Control(character));
    }
    if name.trim() != name {
        return Err(NameError::OuterSpace);
    }
    Ok(())
}

/// Returns whether a character changes how the rest of a line is shown, or is not shown at all.
pub(crate) fn is_unprintable(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

/// Returns whether a column with this name and unit is the time base and no signal. `t_degC` is a temperature.
pub(crate) fn is_time_column(name: &str, unit: Unit) -> bool {
    unit.quantity() == Quantity::Time
        && ["time", "t", "timestamp", "zeit"]
            .iter()
            .any(|word| name.eq_ignore_ascii_case(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_refused_at_the_bound_and_not_before() {
        assert_eq!(check_name(&"n".repeat(NAME_BYTES_MAX)), Ok(()));
        assert_eq!(
            check_name(&"n".repeat(NAME_BYTES_MAX + 1)),
            Err(NameError::Long(NAME_BYTES_MAX + 1))
        );
        assert_eq!(check_name("p ch"), Ok(()));
        assert_eq!(check_name(" "), Err(NameError::Empty));
        assert_eq!(check_name("p_ch "), Err(NameError::OuterSpace));
        assert_eq!(check_name("p\u{1b}[31m"), Err(NameError::Control('\u{1b}')));
        assert_eq!(
            check_name("p\u{202e}hc"),
            Err(NameError::Control('\u{202e}'))
        );
    }

    #[test]
    fn only_a_unit_of_time_makes_t_the_time() {
        assert!(is_time_column("t", Unit::Millisecond) && is_time_column("Time", Unit::Second));
        assert!(
            !is_time_column("t", Unit::DegreeCelsius) && !is_time_column("dead_time", Unit::Second)
        );
    }
}
