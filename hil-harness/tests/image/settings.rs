//! Unusual settings, generated from the ECU's own table, so that no choice is forgotten.

use controller::{Field, Settings};
use ecu::EcuSettings;
use ecu::calibration::{SettingId, SettingValues};
use hil_harness::random::Draws;

/// Returns the bench's settings with a number for each quantity, also for those that its choices do not use.
fn with_every_quantity() -> SettingValues {
    let mut values = SettingValues::of(&EcuSettings::bench());
    for (id, whole) in [
        (SettingId::Controller(Field::IntegralTime), 500),
        (SettingId::Controller(Field::DerivativeTime), 5),
        (SettingId::Controller(Field::TrackingTime), 100),
        (SettingId::Controller(Field::BoostRate), 300),
        (SettingId::Controller(Field::BoostMax), 20),
        (SettingId::Controller(Field::BoostResponse), 1),
        (SettingId::Controller(Field::DutyMiddleFill), 54),
        (SettingId::Controller(Field::DutyMiddleVent), 51),
        (SettingId::Controller(Field::DutyHalfFill), 40),
        (SettingId::Controller(Field::DutyHalfVent), 38),
        (
            SettingId::Controller(Field::DutyMinFillWithSupplyPressure),
            29,
        ),
        (
            SettingId::Controller(Field::DutyMinVentWithSupplyPressure),
            26,
        ),
    ] {
        if values.get(id) == 0 {
            values.set(id, whole << 16);
        }
    }
    let pulses = with_pulses();
    for field in Field::ALL.into_iter().skip(Field::PulseOrifice as usize) {
        let id = SettingId::Controller(field);
        values.set(id, pulses.get(id));
    }
    values
}

fn with_pulses() -> SettingValues {
    SettingValues::of(&EcuSettings {
        controller: Settings::pulses(),
        ..EcuSettings::bench()
    })
}

/// Returns every valid combination of choices of the PID controller, and the pulses, which use no other choice.
pub(super) fn combinations() -> Vec<EcuSettings> {
    let mut all = vec![with_every_quantity()];
    for id in SettingId::ALL {
        let choices = 0..id.spec().choices.len() as i32;
        let is_pulses = id == SettingId::Controller(Field::Pulses);
        if !choices.is_empty() && !is_pulses {
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
    all.push(with_pulses());
    all.iter().filter_map(possible).collect()
}

fn possible(values: &SettingValues) -> Option<EcuSettings> {
    values.checked().ok().map(|checked| *checked.settings())
}

/// Returns random choices, with up to four quantities up to sixteen times as large or small as usual.
pub(super) fn drawn(draws: &mut Draws) -> EcuSettings {
    loop {
        let mut values = with_every_quantity();
        for id in SettingId::ALL {
            let choices = id.spec().choices;
            if !choices.is_empty() {
                values.set(id, draws.below(choices.len() as u32) as i32);
            }
        }
        for _ in 0..draws.below(5) {
            let id = SettingId::ALL[draws.below(SettingId::ALL.len() as u32) as usize];
            if id.spec().choices.is_empty() {
                let factor = draws.between(-4.0, 4.0).exp2();
                values.set(id, (f64::from(values.get(id)) * factor) as i32);
            }
        }
        if let Some(settings) = possible(&values) {
            return settings;
        }
    }
}
