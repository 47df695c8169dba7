//! Refusals of a device, in the words of its tables.

use controller::SettingSpec;
use ecu::calibration::SettingId;
use hil_harness::link::LinkError;
use hil_protocol::Refusal;

use crate::failure::Failure;

/// Returns the failure with names and units in place of the device's numbers.
pub(super) fn named(error: LinkError) -> Failure {
    if let LinkError::Refused { refusal, .. } = &error
        && let Some(said) = in_words(refusal)
    {
        return Failure::SettingsRefused { said };
    }
    error.into()
}

fn in_words(refusal: &Refusal) -> Option<String> {
    match *refusal {
        Refusal::OutOfRange {
            id,
            value,
            min,
            max,
            bound_by,
        } => {
            let SettingSpec {
                name,
                unit,
                choices,
                ..
            } = setting(id)?;
            if !choices.is_empty() {
                return Some(format!(
                    "{name}: there is no choice {value}; choose one of {}",
                    choices.join(", ")
                ));
            }
            let [value, min, max] =
                [value, min, max].map(|bits| rounded(f64::from(bits) / 65536.0));
            let by = bound_by.and_then(setting);
            let by = by.map_or_else(String::new, |by| format!("; {} sets the bound", by.name));
            Some(format!(
                "{name} = {value} {unit} is out of range: {min} to {max} {unit}{by}"
            ))
        }
        Refusal::Product {
            id,
            value,
            min,
            max,
        } => {
            let name = setting(id)?.name;
            let [value, min, max] = [value, min, max].map(|bits| bits as f64 / 4_294_967_296.0);
            Some(format!(
                "{name} and the settings that it is multiplied with give {value}: {min} to {max} is possible; change {name} first"
            ))
        }
        _ => None,
    }
}

/// Rounds a number of the device to its resolution.
fn rounded(number: f64) -> f64 {
    (1e4 * number).round() / 1e4
}

fn setting(id: u16) -> Option<&'static SettingSpec> {
    SettingId::ALL.get(usize::from(id)).map(|id| id.spec())
}

#[cfg(test)]
mod tests {
    use ecu::EcuField;

    use super::*;

    #[test]
    fn a_refusal_names_the_setting_its_unit_and_who_sets_the_bound() {
        let refusal = Refusal::OutOfRange {
            id: SettingId::Ecu(EcuField::SupplyPressureMax).number(),
            value: 5 << 16,
            min: 7 << 16,
            max: 15 << 16,
            bound_by: Some(SettingId::Ecu(EcuField::SupplyPressureMin).number()),
        };
        assert_eq!(
            in_words(&refusal).unwrap(),
            "supply_pressure_max_bar = 5 bar gauge is out of range: 7 to 15 bar gauge; supply_pressure_min_bar sets the bound"
        );
        assert!(in_words(&Refusal::Storage).is_none());
    }
}
