//! List of all keys, in the order of a file.

use std::sync::LazyLock;

use controller::{Field, Form, SettingSpec};

/// Key of a controller file. [`controller::Field`] has the table that the keys come from.
#[derive(Debug)]
pub struct Key {
    /// TOML table.
    pub table: &'static str,
    /// TOML key; that of a number ends in its unit.
    pub name: &'static str,
    /// Description for the user.
    pub about: &'static str,
    /// Setting at this key.
    pub field: Field,
}

impl Key {
    /// Returns `table.key`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.table, self.name)
    }

    /// Returns the description of the setting at this key.
    pub fn spec(&self) -> &'static SettingSpec {
        self.field.spec()
    }
}

/// All keys, in the order of a file: the tables in the order of their first settings.
pub static KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| {
    let keys = |table: &'static str| {
        Field::ALL
            .into_iter()
            .filter(move |field| field.spec().section == table && has_own_key(*field))
            .flat_map(keys_of)
    };
    tables().into_iter().flat_map(keys).collect()
});

/// Returns whether the setting has a key that no other setting uses.
fn has_own_key(field: Field) -> bool {
    match field.spec().form {
        Form::Number | Form::Word | Form::Index => true,
        Form::NumberOrOff | Form::Section => false,
    }
}

fn keys_of(field: Field) -> impl Iterator<Item = Key> {
    let SettingSpec {
        section,
        keys,
        about,
        ..
    } = *field.spec();
    keys.iter().map(move |name| Key {
        table: section,
        name,
        about,
        field,
    })
}

/// Returns all tables, in the order of a file.
pub(super) fn tables() -> Vec<&'static str> {
    let mut tables = Vec::new();
    for field in Field::ALL {
        if !tables.contains(&field.spec().section) {
            tables.push(field.spec().section);
        }
    }
    tables
}

/// Returns whether the word `off` may stand at this key in place of a number.
pub(super) fn may_be_off(table: &str, name: &str) -> bool {
    Field::ALL.into_iter().map(Field::spec).any(|spec| {
        spec.form == Form::NumberOrOff && spec.section == table && spec.keys.contains(&name)
    })
}
