//! Settings of a running device.

mod refusal;

use std::thread;
use std::time::Duration;

use controller::SettingSpec;
use ecu::calibration::{SETTING_COUNT, SettingId, SettingValues};
use hil_harness::ecu_under_test::{carry_out, set};
use hil_harness::link::{Link, LinkError};
use hil_protocol::{Refusal, Reply, Request, SettingsSource};

use crate::cli::{ReadArgs, WriteArgs};
use crate::failure::Failure;

/// Number of attempts to save while the valves are in use.
const SAVES_REFUSED: usize = 100;
/// Time between two attempts.
const BETWEEN_SAVES: Duration = Duration::from_millis(20);

/// Requested settings with the values in effect.
pub(crate) struct Settings {
    /// Identity of the device.
    pub(crate) device: String,
    /// Source of the settings, or what was done with them.
    pub(crate) note: String,
    /// Name, value and unit.
    pub(crate) rows: Vec<(SettingId, String)>,
}

/// Reads settings.
pub(crate) fn read(args: &ReadArgs) -> Result<Settings, Failure> {
    let wanted: Vec<SettingId> = match args.settings.as_slice() {
        [] => SettingId::ALL.to_vec(),
        names => names
            .iter()
            .map(|name| setting(name))
            .collect::<Result<_, _>>()?,
    };
    let mut session = args.device.dut.session(args.device.image.as_deref())?;
    let values = in_effect(session.as_mut())?;
    Ok(Settings {
        device: session.identity(),
        note: origin(session.device().settings_source),
        rows: rows(&wanted, &values),
    })
}

fn origin(source: SettingsSource) -> String {
    match source {
        SettingsSource::Stored {
            copy,
            sequence,
            other_damaged,
        } => {
            let damage = match other_damaged {
                true => "; the other copy is damaged, the next save mends it",
                false => "",
            };
            format!("Stored in copy {copy} by save {sequence}{damage}.")
        }
        SettingsSource::DefaultsNeverSaved => "Built in: none were ever saved.".to_owned(),
        SettingsSource::DefaultsDamaged => {
            "Built in: what was saved is damaged, or not of this image. Check and save them."
                .to_owned()
        }
        SettingsSource::Link => "Set over the link since the start.".to_owned(),
    }
}

/// Changes settings, all in the same sample, and saves them if requested.
pub(crate) fn write(args: &WriteArgs) -> Result<Settings, Failure> {
    let changes: Vec<(SettingId, i32)> = args
        .assignments
        .iter()
        .map(|text| assignment(text))
        .collect::<Result<_, _>>()?;
    let mut session = args.device.dut.session(args.device.image.as_deref())?;
    let link = session.as_mut();
    let mut values = match args.defaults {
        true => SettingValues::of(&ecu::EcuSettings::bench()),
        false => in_effect(link)?,
    };
    for &(id, value) in &changes {
        values.set(id, value);
    }
    set(link, &values).map_err(refusal::named)?;
    if args.save {
        save(link)?;
    }
    let changed: Vec<SettingId> = changes.iter().map(|(id, _)| *id).collect();
    Ok(Settings {
        device: session.identity(),
        note: match args.save {
            true => "In effect, and kept for the next start.".to_owned(),
            false => "In effect until the device starts again; --save keeps them.".to_owned(),
        },
        rows: rows(&changed, &in_effect(session.as_mut())?),
    })
}

/// Saves; waits a while until the valves are at rest, since a device that has just started may still empty the chamber.
fn save(link: &mut (impl Link + ?Sized)) -> Result<(), LinkError> {
    for _ in 0..SAVES_REFUSED {
        match carry_out(link, &Request::Save) {
            Err(LinkError::Refused {
                refusal: Refusal::ValvesInUse,
                ..
            }) => thread::sleep(BETWEEN_SAVES),
            other => return other,
        }
    }
    carry_out(link, &Request::Save)
}

fn in_effect(link: &mut (impl Link + ?Sized)) -> Result<SettingValues, LinkError> {
    let mut values = SettingValues::from_array([0; SETTING_COUNT]);
    let mut first = 0;
    while usize::from(first) < SETTING_COUNT {
        let request = Request::Settings { first };
        match link.ask(&request)? {
            Reply::Values { values: part, .. } if !part.is_empty() => {
                values
                    .set_from(first, &part)
                    .map_err(|refusal| LinkError::refused(&request, refusal))?;
                first += part.len() as u16;
            }
            other => return Err(LinkError::unexpected(&request, &other)),
        }
    }
    Ok(values)
}

fn rows(wanted: &[SettingId], values: &SettingValues) -> Vec<(SettingId, String)> {
    wanted
        .iter()
        .map(|&id| (id, text(id.spec(), values.get(id))))
        .collect()
}

/// Formats a number of the settings table.
fn text(setting: &SettingSpec, value: i32) -> String {
    if setting.choices.is_empty() {
        return (f64::from(value) / 65536.0).to_string();
    }
    let choice = usize::try_from(value)
        .ok()
        .and_then(|at| setting.choices.get(at));
    choice.map_or_else(|| value.to_string(), |choice| (*choice).to_owned())
}

fn setting(name: &str) -> Result<SettingId, Failure> {
    SettingId::named(name).ok_or_else(|| Failure::NoSuchSetting {
        name: name.to_owned(),
    })
}

fn assignment(assignment: &str) -> Result<(SettingId, i32), Failure> {
    let wrong = |expected: String| Failure::SettingValue {
        assignment: assignment.to_owned(),
        expected,
    };
    let (name, value) = assignment
        .split_once('=')
        .ok_or_else(|| wrong("SETTING=VALUE, such as gain_pct_per_bar=30".to_owned()))?;
    let id = setting(name.trim())?;
    let SettingSpec { unit, choices, .. } = *id.spec();
    let value = value.trim();
    if let Some(choice) = choices.iter().position(|choice| *choice == value) {
        return Ok((id, choice as i32));
    }
    if !choices.is_empty() {
        return Err(wrong(format!("one of {}", choices.join(", "))));
    }
    let number: f64 = value
        .parse()
        .map_err(|_| wrong(format!("a number in {unit}, with a decimal point")))?;
    let bits = (number * 65536.0).round();
    if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&bits) {
        return Err(wrong(format!("a number in {unit} within -32768 and 32767")));
    }
    Ok((id, bits as i32))
}

#[cfg(test)]
mod tests {
    use controller::Field;

    use super::*;

    #[test]
    fn an_assignment_is_a_number_in_the_tables_unit_or_the_name_of_a_choice() {
        assert_eq!(
            assignment("gain_pct_per_bar = 30.5").unwrap(),
            (SettingId::Controller(Field::Gain), (30 << 16) + (1 << 15))
        );
        assert_eq!(
            assignment("boost=on").unwrap(),
            (SettingId::Controller(Field::Boost), 1)
        );
        for (text, said) in [
            ("gain_pct_per_bar", "SETTING=VALUE"),
            ("gain_pct_per_bar=3,5", "a number in %/bar"),
            ("gain_pct_per_bar=1e9", "within -32768"),
            ("boost=maybe", "one of off, on"),
            ("gian=3", "gain_pct_per_bar"),
        ] {
            let error = assignment(text).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
