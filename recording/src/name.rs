use crate::{Quantity, Unit};

/// Longest name of a signal in bytes.
pub const NAME_BYTES_MAX: usize = 256;

/// What is wrong with the name of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameError {
    /// Nothing but white space.
    #[error("a name has at least one visible character")]
    Empty,
    /// Longer than [`NAME_BYTES_MAX`].
    #[error("a name has at most {NAME_BYTES_MAX} bytes, this one {0}")]
    Long(usize),
    /// Control or bidirectional-override characters, which make a terminal or a page show something else.
    #[error("a name has no control characters, this one has U+{:04X}", *.0 as u32)]
    Control(char),
    /// White space at an end, which no reader would see.
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

/// Characters that change how the rest of a line is shown, or are not shown at all.
pub(crate) fn is_unprintable(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

/// Whether a column of this name and unit is the time base and no signal. `t_degC` is a temperature.
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
