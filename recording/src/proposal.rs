//! Proposals for lines of a mapping file.

/// Returns a line of a mapping: the signal `name` is the column `key`, which is valid TOML, in `unit`.
pub(crate) fn signal_line(name: &str, key: &str, unit: &str) -> String {
    format!(
        "signal.{} = {{ column = {key}, unit = \"{unit}\" }}",
        toml_key(name)
    )
}

/// Returns a bare key where TOML allows one, otherwise a quoted one.
pub(crate) fn toml_key(name: &str) -> String {
    let bare = name
        .bytes()
        .all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-'));
    if bare {
        name.to_owned()
    } else {
        format!("'{name}'")
    }
}
