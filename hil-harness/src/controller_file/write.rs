//! Writer of a controller file that reads back to the same bits.

use controller::fixed::types::I16F16;
use controller::{Field, Form, Settings};

use super::keys::{KEYS, may_be_off};

pub(super) fn write(settings: &Settings) -> String {
    let mut text = "# Controller. The unit is the end of each key; numbers are kept in steps of 2^-16 of it.\n".to_owned();
    let mut table = "";
    for key in KEYS.iter() {
        let Some(value) = value(key.field, key.table, key.name, settings) else {
            continue;
        };
        if key.table != table {
            table = key.table;
            text += &format!("\n[{table}]\n");
        }
        text += &format!("{} = {value}   # {}\n", key.name, key.about);
    }
    text
}

/// Returns the value at this key in its written form; `None` if the settings do not use the key.
fn value(field: Field, table: &str, name: &str, settings: &Settings) -> Option<String> {
    let Some(number) = field.get(settings) else {
        return may_be_off(table, name).then(|| "\"off\"".to_owned());
    };
    if field.key(settings) != Some(name) {
        return None;
    }
    Some(match field.spec().form {
        Form::Number => decimal(I16F16::from_bits(number)),
        Form::Index => number.to_string(),
        Form::Word | Form::NumberOrOff | Form::Section => {
            let word = usize::try_from(number)
                .ok()
                .and_then(|number| field.spec().choices.get(number));
            format!("\"{}\"", word.unwrap_or(&""))
        }
    })
}

/// Returns the number as decimal text that reads back to the same bits.
fn decimal(number: I16F16) -> String {
    // `fixed` prints a decimal within half a step. At a tie (6553 units of 2^-16 print as 0.1, which is 6554) it reads
    // back as the neighbour. Six exact decimals distinguish all steps; f64 can represent them all.
    let short = number.to_string();
    if short.parse::<I16F16>() == Ok(number) {
        short
    } else {
        format!("{:.6}", number.to_num::<f64>())
    }
}
