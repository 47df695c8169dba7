//! Unusual settings, generated from the ECU's own table, so that no choice is forgotten.

use ecu::EcuSettings;
use ecu::calibration::{SETTINGS, Setting, SettingId, SettingValues};
use hil_harness::random::Draws;

/// Returns the bench's settings with a number for each quantity, also for those that its choices do not use.
fn with_every_quantity() -> SettingValues {
    let mut values = SettingValues::of(&EcuSettings::bench());
    for (id, whole) in [
        (SettingId::IntegralTime, 500),
        (SettingId::DerivativeTime, 5),
        (SettingId::TrackingTime, 100),
        (SettingId::BoostRate, 300),
        (SettingId::BoostMax, 20),
        (SettingId::BoostResponse, 1),
        (SettingId::DutyMiddleFill, 54),
        (SettingId::DutyMiddleVent, 51),
        (SettingId::DutyHalfFill, 40),
        (SettingId::DutyHalfVent, 38),
        (SettingId::DutyMinFillWithSupplyPressure, 29),
        (SettingId::DutyMinVentWithSupplyPressure, 26),
    ] {
        if values.get(id) == 0 {
            values.set(id, whole << 16);
        }
    }
    values
}

/// Returns every valid combination of choices.
pub(super) fn combinations() -> Vec<EcuSettings> {
    let mut all = vec![with_every_quantity()];
    for id in SettingId::ALL {
        let choices = 0..id.setting().choices.len() as i32;
        if !choices.is_empty() {
            all = all
                .iter()
                .flat_map(|values| {
                    choices.clone().map(|choice| {
                        let mut chosen = *values;
                        chosen.set(id, choice);
                        chosen
                    })
                })
                .collect();
        }
    }
    all.iter().filter_map(possible).collect()
}

fn possible(values: &SettingValues) -> Option<EcuSettings> {
    values.checked().ok().map(|checked| *checked.settings())
}

/// Returns random choices, with up to four quantities up to sixteen times as large or small as usual.
pub(super) fn drawn(draws: &mut Draws) -> EcuSettings {
    loop {
        let mut values = with_every_quantity();
        for (id, Setting { choices, .. }) in SettingId::ALL.into_iter().zip(&SETTINGS) {
            if !choices.is_empty() {
                values.set(id, draws.below(choices.len() as u32) as i32);
            }
        }
        for _ in 0..draws.below(5) {
            let id = SettingId::ALL[draws.below(SettingId::ALL.len() as u32) as usize];
            if id.setting().choices.is_empty() {
                let factor = draws.between(-4.0, 4.0).exp2();
                values.set(id, (f64::from(values.get(id)) * factor) as i32);
            }
        }
        if let Some(settings) = possible(&values) {
            return settings;
        }
    }
}
