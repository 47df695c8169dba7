//! Command lines that a person can paste into a shell.

/// Quotes an argument for a shell.
pub(crate) fn quoted(argument: &str) -> String {
    let is_plain = argument
        .chars()
        .all(|character| character.is_alphanumeric() || "-_./=,:+".contains(character));
    if is_plain && !argument.is_empty() {
        argument.to_owned()
    } else {
        format!("'{}'", argument.replace('\'', "'\\''"))
    }
}
