//! Settings of the supervision on a rig, in the oracle's units.

use crate::campaign::bounds;
use crate::duty_factors::resistance_ratios;
use crate::scenario::Scenario;

/// Settings of the supervision, in the form that the rules need.
#[derive(Debug)]
pub(super) struct Rig {
    pub(super) supply_min_bar: f64,
    pub(super) supply_max_bar: f64,
    pub(super) jump_bar: f64,
    /// Minimum change per sample and pressure difference.
    pub(super) rise: f64,
    pub(super) fall: f64,
    /// Open duty cycles of fill and vent valve (%).
    pub(super) open_pct: [f64; 2],
    /// Lowest and highest supply voltage (mV).
    pub(super) battery_mv: [f64; 2],
    /// Minimum current of a driven coil and maximum current of any coil (mA).
    pub(super) coil_ma: [f64; 2],
}

const SAMPLE_S: f64 = 0.01;
const AMBIENT_BAR: f64 = 1.02;

impl Rig {
    pub(super) fn new(scenario: &Scenario) -> Self {
        let known = &scenario.supervision;
        let [fill_factor, vent_factor] = open_factors(scenario);
        let rate = |rate: f64| rate * SAMPLE_S;
        let fill = rate(known.fill_rate_per_s.to_num());
        let vent = rate(known.vent_rate_per_s.to_num());
        let supply_max_bar: f64 = known.supply_pressure_max_bar.to_num();
        Self {
            supply_min_bar: known.supply_pressure_min_bar.to_num(),
            supply_max_bar,
            jump_bar: bounds::JUMP_FACTOR * fill.max(vent) * (supply_max_bar + AMBIENT_BAR),
            rise: bounds::RESPONSE_FACTOR * fill,
            fall: bounds::RESPONSE_FACTOR * vent,
            open_pct: [
                fill_factor * known.open_duty_fill_pct.to_num::<f64>(),
                vent_factor * known.open_duty_vent_pct.to_num::<f64>(),
            ],
            battery_mv: [known.battery_min_v, known.battery_max_v]
                .map(|volt| 1e3 * volt.to_num::<f64>()),
            coil_ma: [known.coil_current_min_ma, known.coil_current_max_ma].map(|ma| ma.to_num()),
        }
    }
}

/// Returns the factors of the open duty cycles of fill and vent valve: with compensation, more current is needed for
/// certain if the coil has a higher resistance, as far as the ECU measures it.
fn open_factors(scenario: &Scenario) -> [f64; 2] {
    match scenario.controller.compensation {
        Some(compensation) => resistance_ratios(&scenario.plant, compensation)
            .map(|ratio| ratio.max(1.0) * bounds::RESISTANCE_ERROR),
        None => [1.0; 2],
    }
}
