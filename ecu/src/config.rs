//! Configuration: checked settings, converted into limits in the units of a sample.

use controller::fixed::types::I16F16;
use controller::{Config, Distributor};

use crate::duty_scales::DutyScales;
use crate::error::EcuConfigError;
#[cfg(any(test, feature = "fault-seeding"))]
use crate::fault::Fault;
use crate::history::{History, Window};
use crate::mechanism::{Mechanism, Mechanisms};
use crate::settings::{EcuSettings, Supervision, VentValve};
use crate::table::EcuField as Field;

/// Propagates an error as `?` does, which constant functions do not have.
macro_rules! propagate {
    ($result:expr) => {
        match $result {
            Ok(value) => value,
            Err(error) => return Err(error),
        }
    };
}

/// Runnable ECU: the proof that its [`EcuSettings`] are within bounds, and the limits computed from them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EcuConfig {
    pub(crate) controller: Config,
    pub(crate) vent_valve: VentValve,
    /// Whether the distributor drives both valves at the same time.
    pub(crate) drives_both: bool,
    pub(crate) limits: Limits,
}

/// Settings of the supervision in the units of a sample. Pressures (bar), 2⁻¹⁶.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Limits {
    /// Highest plausible chamber pressure: the highest supply pressure plus a margin for the sensor.
    pub(crate) pressure_max: i32,
    pub(crate) reference_max: i32,
    pub(crate) supply_min: i32,
    /// Largest plausible pressure change in a sample: twice the change by the faster valve at the highest supply
    /// pressure.
    pub(crate) jump: i32,
    /// Minimum effect of the open valve, per sample and pressure difference across it, 2⁻³²: half of the nominal rate.
    pub(crate) least_rise: i32,
    pub(crate) least_fall: i32,
    /// Lowest duty cycles at which the valves are certainly open (%), 2⁻¹⁶.
    pub(crate) open_fill: i32,
    pub(crate) open_vent: i32,
    /// Number of samples from a command until the valve has certainly followed it.
    pub(crate) settling: Window,
    /// Change of the reference per sample.
    pub(crate) ramp: i32,
    pub(crate) battery_min_mv: u16,
    pub(crate) battery_max_mv: u16,
    pub(crate) coil_min_ma: u16,
    pub(crate) coil_max_ma: u16,
    pub(crate) elapsed_min_us: u32,
    pub(crate) elapsed_max_us: u32,
    pub(crate) mechanisms: Mechanisms,
}

impl EcuConfig {
    /// Checks every field; also at compile time.
    ///
    /// # Errors
    /// Returns the first field that is out of bounds, with its value and the bound.
    pub const fn new(settings: &EcuSettings) -> Result<Self, EcuConfigError> {
        let controller = match Config::new(&settings.controller) {
            Ok(controller) => controller,
            Err(error) => return Err(EcuConfigError::Controller(error)),
        };
        let is_pulsed = controller.pulses().is_some();
        if is_pulsed && matches!(settings.vent_valve, VentValve::NormallyOpen) {
            return Err(EcuConfigError::PulsesOnNormallyOpen);
        }
        Ok(Self {
            controller,
            vent_valve: settings.vent_valve,
            drives_both: matches!(settings.controller.distributor, Distributor::Scheme2 { .. })
                && !is_pulsed,
            limits: propagate!(Limits::new(
                &settings.supervision,
                settings.controller.sample_time_ms
            )),
        })
    }

    /// Returns the same configuration without one safety mechanism, so that a test can check that the removal is
    /// detected.
    #[cfg(any(test, feature = "fault-seeding"))]
    #[must_use]
    pub const fn without(self, mechanism: Mechanism) -> Self {
        let mechanisms = self.limits.mechanisms.without(mechanism);
        self.with_mechanisms(mechanisms)
    }

    /// Returns the same configuration without the detector of `fault`, so that a test can check that the removal is
    /// detected.
    #[cfg(any(test, feature = "fault-seeding"))]
    #[must_use]
    pub const fn without_detector(self, fault: Fault) -> Self {
        let mechanisms = self.limits.mechanisms.without_detector(fault);
        self.with_mechanisms(mechanisms)
    }

    #[cfg(any(test, feature = "fault-seeding"))]
    const fn with_mechanisms(mut self, mechanisms: Mechanisms) -> Self {
        self.limits.mechanisms = mechanisms;
        self
    }

    #[inline(always)]
    pub(crate) const fn has(&self, mechanism: Mechanism) -> bool {
        self.limits.mechanisms.has(mechanism)
    }
}

/// Lowest duty cycles at which the valves are certainly open (%), 2⁻¹⁶. Above 100 %, no duty cycle opens the valve for
/// certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OpenDuties {
    pub(crate) fill: i32,
    pub(crate) vent: i32,
}

/// Margin for a sensor's error and noise above the highest possible pressure: 0.2 bar, one per cent of its span.
const SENSOR_MARGIN: i64 = I16F16::lit("0.2").to_bits() as i64;
/// Ambient pressure, the difference between gauge and absolute supply pressure, rounded up (bar).
const AMBIENT: i64 = I16F16::lit("1.02").to_bits() as i64;
/// Upper bound of the settling time, because settling is read from the history of the commands.
const SETTLING_SAMPLES_MAX: i64 = History::SAMPLES_MAX as i64;

impl Limits {
    /// Returns whether a supply voltage (mV) is within its window.
    #[inline(always)]
    pub(crate) const fn has_battery(&self, battery_mv: u16) -> bool {
        battery_mv >= self.battery_min_mv && battery_mv <= self.battery_max_mv
    }

    /// Returns a mean coil current (mA) if it is within the window of a healthy coil.
    #[inline(always)]
    pub(crate) fn coil_current(&self, current_ma: Option<u16>) -> Option<u16> {
        current_ma
            .filter(|&current_ma| current_ma >= self.coil_min_ma && current_ma <= self.coil_max_ma)
    }

    /// Returns the duty cycles that open the valves for certain with these factors of the duty limits.
    #[inline(always)]
    pub(crate) fn open_duties(&self, vent_valve: VentValve, scales: DutyScales) -> OpenDuties {
        OpenDuties {
            fill: scales.fill.limit(self.open_fill),
            vent: match vent_valve {
                VentValve::NormallyClosed => scales.vent.limit(self.open_vent),
                VentValve::NormallyOpen => scales.release.limit(self.open_vent),
            },
        }
    }

    const fn new(settings: &Supervision, sample_time_ms: I16F16) -> Result<Self, EcuConfigError> {
        let sample_ms = sample_time_ms.to_bits() as i64;
        let supply_min = propagate!(
            Checked::field(Field::SupplyPressureMin).value(settings.supply_pressure_min_bar)
        );
        let supply_max = propagate!(
            Checked::field(Field::SupplyPressureMax)
                .from(settings.supply_pressure_min_bar)
                .value(settings.supply_pressure_max_bar)
        );
        let fill_rate = propagate!(Checked::field(Field::FillRate).value(settings.fill_rate_per_s));
        let vent_rate = propagate!(Checked::field(Field::VentRate).value(settings.vent_rate_per_s));
        let open_fill =
            propagate!(Checked::field(Field::OpenDutyFill).value(settings.open_duty_fill_pct));
        let open_vent =
            propagate!(Checked::field(Field::OpenDutyVent).value(settings.open_duty_vent_pct));
        let settling = propagate!(
            Checked::field(Field::ValveSettling)
                .up_to(sample_ms.wrapping_mul(SETTLING_SAMPLES_MAX))
                .value(settings.valve_settling_ms)
        );
        let ramp = propagate!(Checked::field(Field::Ramp).value(settings.ramp_bar_per_s));
        let battery_min =
            propagate!(Checked::field(Field::BatteryMin).value(settings.battery_min_v));
        let battery_max = propagate!(
            Checked::field(Field::BatteryMax)
                .from(settings.battery_min_v)
                .value(settings.battery_max_v)
        );
        let coil_min =
            propagate!(Checked::field(Field::CoilCurrentMin).value(settings.coil_current_min_ma));
        let coil_max = propagate!(
            Checked::field(Field::CoilCurrentMax)
                .from(settings.coil_current_min_ma)
                .value(settings.coil_current_max_ma)
        );
        let faster = if fill_rate > vent_rate {
            fill_rate
        } else {
            vent_rate
        };
        // At most 50/s in 1 s, 2⁻¹⁶, times 17 bar, 2⁻¹⁶, which fits into 63 bits.
        let fastest = (share_per_sample(faster, sample_ms) >> 16)
            .wrapping_mul(supply_max.wrapping_add(AMBIENT));
        Ok(Self {
            pressure_max: supply_max.wrapping_add(SENSOR_MARGIN) as i32,
            reference_max: supply_max as i32,
            supply_min: supply_min as i32,
            jump: saturated(fastest >> 15),
            least_rise: saturated(share_per_sample(fill_rate, sample_ms) >> 1),
            least_fall: saturated(share_per_sample(vent_rate, sample_ms) >> 1),
            open_fill: open_fill as i32,
            open_vent: open_vent as i32,
            settling: Window::last(samples(settling, sample_ms)),
            ramp: saturated(share_per_sample(ramp, sample_ms) >> 16).wrapping_add(1),
            battery_min_mv: thousandth(battery_min) as u16,
            battery_max_mv: thousandth(battery_max) as u16,
            coil_min_ma: (coil_min >> 16) as u16,
            coil_max_ma: (coil_max >> 16) as u16,
            elapsed_min_us: (thousandth(sample_ms) >> 1) as u32,
            elapsed_max_us: (thousandth(sample_ms) << 1) as u32,
            mechanisms: Mechanisms::ALL,
        })
    }
}

/// Field with its allowed range.
struct Checked {
    field: Field,
    min: I16F16,
    max: I16F16,
}

impl Checked {
    const fn field(field: Field) -> Self {
        let [min, max] = field.range();
        Self { field, min, max }
    }

    const fn from(self, min: I16F16) -> Self {
        Self { min, ..self }
    }

    const fn up_to(self, bits: i64) -> Self {
        if bits < self.max.to_bits() as i64 {
            let max = I16F16::from_bits(bits as i32);
            Self { max, ..self }
        } else {
            self
        }
    }

    /// Returns the bits of `value`, if it is in the range.
    const fn value(self, value: I16F16) -> Result<i64, EcuConfigError> {
        let Self { field, min, max } = self;
        if value.to_bits() < min.to_bits() || value.to_bits() > max.to_bits() {
            Err(EcuConfigError::OutOfRange {
                field,
                value,
                min,
                max,
            })
        } else {
            Ok(value.to_bits() as i64)
        }
    }
}

/// Returns a rate per second times the sample time, both 2⁻¹⁶, in 2⁻³².
const fn share_per_sample(rate_per_s: i64, sample_ms: i64) -> i64 {
    rate_per_s.wrapping_mul(sample_ms) / 1000
}

/// Returns a duration in samples, rounded up.
const fn samples(duration: i64, sample: i64) -> u8 {
    let up = duration.wrapping_add(sample).wrapping_sub(1);
    match up.checked_div(sample) {
        Some(samples) => samples as u8,
        None => History::SAMPLES_MAX,
    }
}

/// Converts 2⁻¹⁶ of a unit into thousandths of it.
const fn thousandth(bits: i64) -> i64 {
    bits.wrapping_mul(1000) >> 16
}

const fn saturated(value: i64) -> i32 {
    if value > i32::MAX as i64 {
        i32::MAX
    } else {
        value as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(change: impl FnOnce(&mut Supervision)) -> Limits {
        let mut settings = EcuSettings::bench();
        change(&mut settings.supervision);
        EcuConfig::new(&settings).unwrap().limits
    }

    #[test]
    fn each_limit_is_its_setting_in_the_units_of_a_sample() {
        let limits = limits(|_| {});
        let bar = |bits: i32| f64::from(bits) / 65_536.0;
        for (found, expected) in [
            (bar(limits.pressure_max), 10.2),
            (bar(limits.reference_max), 10.0),
            (bar(limits.supply_min), 7.5),
            (bar(limits.ramp), 0.05),
            (bar(limits.open_fill), 75.0),
            (bar(limits.open_vent), 75.0),
        ] {
            assert!((found - expected).abs() < 3e-5, "{found}, {expected}");
        }
        // Half of the valve's effect in 10 ms.
        for (found, rate_per_s) in [(limits.least_rise, 7.13), (limits.least_fall, 7.28)] {
            let share = f64::from(found) / 2.0_f64.powi(32);
            assert!((share - 0.5 * 0.01 * rate_per_s).abs() < 1e-6, "{share}");
        }
        assert_eq!(
            (limits.battery_min_mv, limits.battery_max_mv),
            (16_000, 36_000)
        );
        assert_eq!((limits.coil_min_ma, limits.coil_max_ma), (15, 640));
        assert_eq!(
            (limits.elapsed_min_us, limits.elapsed_max_us),
            (5_000, 20_000)
        );
        assert_eq!(limits.settling, Window::last(6));
    }

    #[test]
    fn the_faster_valve_decides_about_a_jump() {
        let nominal = limits(|_| {}).jump;
        let faster = I16F16::from_num(14.56);
        let fill = limits(|supervision| supervision.fill_rate_per_s = faster).jump;
        let vent = limits(|supervision| supervision.vent_rate_per_s = faster).jump;
        assert_eq!(fill, vent);
        assert!((f64::from(vent) / f64::from(nominal) - 2.0).abs() < 1e-3);
    }

    #[test]
    fn a_settling_time_is_rounded_up_to_samples() {
        for (milliseconds, samples) in [(1, 1), (10, 1), (11, 2), (320, 32)] {
            let limits = limits(|supervision| {
                supervision.valve_settling_ms = I16F16::from_num(milliseconds);
            });
            assert_eq!(limits.settling, Window::last(samples), "{milliseconds} ms");
        }
        let mut settings = EcuSettings::bench();
        settings.supervision.valve_settling_ms = I16F16::from_num(321);
        let refused = EcuConfig::new(&settings);
        assert!(matches!(
            refused,
            Err(EcuConfigError::OutOfRange {
                field: Field::ValveSettling,
                max,
                ..
            }) if max == 320
        ));
    }

    #[test]
    fn shares_beyond_a_word_are_held_at_its_end() {
        assert_eq!(saturated(i64::from(i32::MAX)), i32::MAX);
        assert_eq!(saturated(i64::from(i32::MAX) + 1), i32::MAX);
        assert_eq!(saturated(-5), -5);
    }
}
