//! Conversion from numbers to settings, which may still be invalid.

use controller::fixed::types::I16F16;
use controller::{AntiWindup, Boost, Distributor, LowerLimit, OpeningDuty, Settings};
use hil_protocol::Refusal;

use super::SettingValues;
use super::choices::{AT_REFERENCE, BASIS, OFF_ON, PREDICTION, SWITCH_OFF, VENT_VALVE};
use crate::calibration::setting::SettingId as Id;
use crate::settings::{EcuSettings, Supervision};

impl SettingValues {
    /// Returns the settings with these numbers. Only the choices are checked here.
    ///
    /// # Errors
    /// Returns the first choice that does not exist.
    pub fn settings(&self) -> Result<EcuSettings, Refusal> {
        Ok(EcuSettings {
            controller: self.controller()?,
            vent_valve: self.chosen(Id::VentValve, &VENT_VALVE)?,
            supervision: self.supervision(),
        })
    }

    fn controller(&self) -> Result<Settings, Refusal> {
        Ok(Settings {
            sample_time_ms: self.quantity(Id::SampleTime),
            gain_pct_per_bar: self.quantity(Id::Gain),
            integral_time_ms: self.optional(Id::IntegralAction, Id::IntegralTime)?,
            derivative_time_ms: self.optional(Id::DerivativeAction, Id::DerivativeTime)?,
            integral_max_pct: self.quantity(Id::IntegralMax),
            integral_at_reference: self.chosen(Id::IntegralAtReference, &AT_REFERENCE)?,
            anti_windup: self.anti_windup()?,
            tolerance_bar: self.quantity(Id::Tolerance),
            prediction: self.chosen(Id::Prediction, &PREDICTION)?,
            prediction_basis: self.chosen(Id::PredictionBasis, &BASIS)?,
            switch_off: self.chosen(Id::SwitchOff, &SWITCH_OFF)?,
            boost: self.boost()?,
            distributor: self.distributor()?,
            duty_min: self.duty_min()?,
            duty_max_fill_pct: self.quantity(Id::DutyMaxFill),
            duty_max_vent_pct: self.quantity(Id::DutyMaxVent),
            supply_pressure_bar: self.quantity(Id::SupplyPressure),
        })
    }

    fn anti_windup(&self) -> Result<AntiWindup, Refusal> {
        let choices = [
            AntiWindup::Off,
            AntiWindup::ConditionalIntegration,
            AntiWindup::BackCalculation {
                tracking_time_ms: self.quantity(Id::TrackingTime),
            },
        ];
        self.chosen(Id::AntiWindup, &choices)
    }

    fn boost(&self) -> Result<Option<Boost>, Refusal> {
        let boost = Boost {
            rate_pct_per_bar_s: self.quantity(Id::BoostRate),
            max_pct: self.quantity(Id::BoostMax),
            response_bar: self.quantity(Id::BoostResponse),
        };
        Ok(self.chosen(Id::Boost, &OFF_ON)?.then_some(boost))
    }

    fn distributor(&self) -> Result<Distributor, Refusal> {
        let choices = [
            Distributor::Traditional,
            Distributor::Scheme1,
            Distributor::Scheme2 {
                middle_fill_pct: self.quantity(Id::DutyMiddleFill),
                middle_vent_pct: self.quantity(Id::DutyMiddleVent),
            },
        ];
        self.chosen(Id::Distributor, &choices)
    }

    fn duty_min(&self) -> Result<LowerLimit, Refusal> {
        let fill_pct = self.quantity(Id::DutyMinFill);
        let vent_pct = self.quantity(Id::DutyMinVent);
        let choices = [
            LowerLimit::Constant { fill_pct, vent_pct },
            LowerLimit::PressureDependent {
                fill: OpeningDuty {
                    without_pressure_pct: fill_pct,
                    at_half_pct: self.quantity(Id::DutyHalfFill),
                    with_supply_pressure_pct: self.quantity(Id::DutyMinFillWithSupplyPressure),
                },
                vent: OpeningDuty {
                    without_pressure_pct: vent_pct,
                    at_half_pct: self.quantity(Id::DutyHalfVent),
                    with_supply_pressure_pct: self.quantity(Id::DutyMinVentWithSupplyPressure),
                },
            },
        ];
        self.chosen(Id::DutyMin, &choices)
    }

    fn supervision(&self) -> Supervision {
        Supervision {
            supply_pressure_min_bar: self.quantity(Id::SupplyPressureMin),
            supply_pressure_max_bar: self.quantity(Id::SupplyPressureMax),
            fill_rate_per_s: self.quantity(Id::FillRate),
            vent_rate_per_s: self.quantity(Id::VentRate),
            open_duty_fill_pct: self.quantity(Id::OpenDutyFill),
            open_duty_vent_pct: self.quantity(Id::OpenDutyVent),
            valve_settling_ms: self.quantity(Id::ValveSettling),
            ramp_bar_per_s: self.quantity(Id::Ramp),
            battery_min_v: self.quantity(Id::BatteryMin),
            battery_max_v: self.quantity(Id::BatteryMax),
            coil_current_min_ma: self.quantity(Id::CoilCurrentMin),
            coil_current_max_ma: self.quantity(Id::CoilCurrentMax),
        }
    }

    fn quantity(&self, id: Id) -> I16F16 {
        I16F16::from_bits(self.get(id))
    }

    fn optional(&self, action: Id, quantity: Id) -> Result<Option<I16F16>, Refusal> {
        let on = self.chosen(action, &OFF_ON)?;
        Ok(on.then_some(self.quantity(quantity)))
    }

    fn chosen<T: Copy, const N: usize>(&self, id: Id, choices: &[T; N]) -> Result<T, Refusal> {
        let value = self.get(id);
        let choice = usize::try_from(value)
            .ok()
            .and_then(|index| choices.get(index));
        choice.copied().ok_or(Refusal::OutOfRange {
            id: id as u16,
            value,
            min: 0,
            max: const { N as i32 - 1 },
            bound_by: None,
        })
    }
}
