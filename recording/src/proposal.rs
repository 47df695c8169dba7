//! What a person may write into a mapping file.

/// A line of a mapping: the signal `name` is the column `key`, which is TOML already, in `unit`.
pub(crate) fn signal_line(name: &str, key: &str, unit: &str) -> String {
    format!(
        "signal.{} = {{ column = {key}, unit = \"{unit}\" }}",
        toml_key(name)
    )
}

/// A bare key where TOML allows one.
fn toml_key(name: &str) -> String {
    let bare = name
        .bytes()
        .all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
    if bare {
        name.to_owned()
    } else {
        format!("'{name}'")
    }
}
