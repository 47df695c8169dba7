//! Checked settings of the mode, converted into the units of a sample.

use fixed::types::I16F16;

use crate::error::ConfigError;
use crate::pressure::ERROR_SHIFT;
use crate::pulses::adaptation::Bounds;
use crate::pulses::flow::fill_cells_per_bar;
use crate::pulses::pulse_table::PulseTable;
use crate::pulses::tables::{nominal_1_3_mm, nominal_1_9_mm};
use crate::range::{Range, checked, propagate};
use crate::settings::Settings;
use crate::table::Field;

/// Sample time and PWM period of the tables.
pub(super) const PERIOD_US: i32 = 10_000;
const PERIOD_MS: I16F16 = I16F16::lit("10");
/// Orifice from which on the table of 1.9 mm is the nearer one (mm), 2⁻¹⁶: 1.6 mm.
const LARGE_ORIFICE: i32 = 104_858;

/// Coefficients of the model-based pulses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseConfig {
    is_large: bool,
    /// Time from a sample to its pulse (µs).
    pub(super) delay_us: i32,
    /// Deadband (bar), 2⁻¹⁶.
    pub(super) deadband: i32,
    /// Cells of the fill valve's table of the flow coordinate per bar, 2⁻¹⁶.
    pub(super) fill_cells_per_bar: i32,
    /// Open time per unit of the flow coordinate (µs).
    pub(super) fill_us: i32,
    pub(super) vent_us: i32,
    pub(super) bounds: Bounds,
    /// Largest drift that the feed-forward follows (bar per sample), 2⁻²⁵.
    pub(super) leak_max: i32,
    /// Largest lag (µs).
    pub(super) lag_max: i32,
}

impl PulseConfig {
    /// Returns the coefficients; `None` if the pulses are off.
    pub(crate) const fn new(settings: &Settings) -> Result<Option<Self>, ConfigError> {
        let Some(pulses) = settings.pulses else {
            return Ok(None);
        };
        let period = Range::between(PERIOD_MS, PERIOD_MS);
        propagate!(period.checked(Field::SampleTime, settings.sample_time_ms));
        let deadband = propagate!(checked(Field::PulseDeadband, pulses.deadband_bar));
        let supply = propagate!(checked(Field::SupplyPressure, settings.supply_pressure_bar));
        let orifice = propagate!(checked(Field::PulseOrifice, pulses.orifice_mm));
        let fill = propagate!(checked(Field::PulseFillRate, pulses.fill_rate_per_s));
        let vent = propagate!(checked(Field::PulseVentRate, pulses.vent_rate_per_s));
        let delay = propagate!(checked(Field::PulseDelay, pulses.command_delay_ms));
        let offset = propagate!(checked(Field::PulseOffsetMax, pulses.offset_max_ms));
        let gain = propagate!(checked(Field::PulseGainMax, pulses.gain_max_pct));
        let lag = propagate!(checked(Field::PulseLagMax, pulses.lag_max_ms));
        let leak = propagate!(checked(Field::PulseLeakMax, pulses.leak_max_bar_per_s));
        Ok(Some(Self {
            is_large: orifice >= LARGE_ORIFICE,
            delay_us: thousandfold(delay),
            deadband,
            fill_cells_per_bar: fill_cells_per_bar(supply),
            fill_us: (1_000_000_i64 << 16).wrapping_div(fill as i64 | 1) as i32,
            vent_us: (1_000_000_i64 << 16).wrapping_div(vent as i64 | 1) as i32,
            lag_max: thousandfold(lag),
            bounds: Bounds::new(thousandfold(offset), gain),
            // Per second to per sample, a hundredth, and 2⁻¹⁶ to 2⁻²⁵.
            leak_max: (((leak as i64) << ERROR_SHIFT) / 100) as i32,
        }))
    }

    /// Returns the tables of the nearest nominal plant.
    #[inline(always)]
    pub(super) const fn table(&self) -> &'static PulseTable {
        if self.is_large {
            &nominal_1_9_mm::TABLE
        } else {
            &nominal_1_3_mm::TABLE
        }
    }
}

/// Converts milliseconds (2⁻¹⁶) into microseconds.
const fn thousandfold(milliseconds: i32) -> i32 {
    ((milliseconds as i64).wrapping_mul(1000) >> 16) as i32
}
