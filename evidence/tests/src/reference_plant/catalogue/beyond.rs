//! Effects outside the library.

use super::Kinship::Beyond;
use super::{Form, Parameters};
use crate::reference_plant::departures::Departures;

const fn beyond(
    effect: &'static str,
    law: &'static str,
    (typical, unit): (f64, &'static str),
    same: &'static [&'static str],
    apply: fn(&Parameters<'_>, &mut Departures),
) -> Form {
    Form {
        effect,
        law,
        kinship: Beyond,
        unit,
        typical,
        same,
        parameter: None,
        apply,
    }
}

pub(super) const FORMS: &[Form] = &[
    beyond("supply_pulsation", "sine", (12.0, "mbar"), &[], |p, d| {
        d.supply.pulsation_pa = 100.0 * p.size;
        d.supply.pulsation_hz = p.between(0.2, 3.0);
    }),
    beyond("missed_pulses", "by chance", (0.3, "%"), &[], |p, d| {
        d.pulses.missed_share = (1e-2 * p.size).min(0.2);
        d.pulses.missed_seed = (p.shape * (1_u64 << 53) as f64) as u64;
    }),
    beyond(
        "sensor_bow",
        "parabola between 0 and 8 bar",
        (30.0, "mbar"),
        &[],
        |p, d| d.sensor.bow_pa = 100.0 * p.size,
    ),
    beyond(
        "current_interference",
        "hum, aliased",
        (1.0, "mA"),
        &[],
        |p, d| {
            d.sensor.interference_a = 1e-3 * p.size;
            d.sensor.interference_hz = p.between(0.1, 5.0);
        },
    ),
    beyond(
        "clock_drift",
        "ECU slower than log",
        (66.0, "ppm"),
        &[],
        |p, d| {
            d.pulses.clock_drift = 1e-6 * p.size;
        },
    ),
    beyond(
        "delay_wander",
        "command delay comes and goes",
        (0.52, "ms"),
        &[],
        |p, d| {
            d.pulses.delay_wander_s = 1e-3 * p.size;
            d.pulses.delay_wander_period_s = p.between(20.0, 80.0);
        },
    ),
    beyond(
        "battery_wander",
        "voltage that the log does not show",
        (0.043, "V"),
        &[],
        |p, d| {
            d.driver.wander_v = p.size;
            d.driver.wander_hz = p.between(0.05, 1.0);
        },
    ),
    // A library with friction at rest may use its name for this.
    beyond(
        "sticky_seat",
        "sticks the longer, the longer it has rested",
        (0.63, "N"),
        &["static_friction"],
        |p, d| {
            d.armature.adhesion_n = p.size;
            d.armature.adhesion_s = p.between(0.3, 3.0);
        },
    ),
];
