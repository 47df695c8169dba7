//! Conversion from settings to numbers.

use controller::fixed::types::I16F16;
use controller::{AntiWindup, Distributor, LowerLimit, Settings};

use super::SettingValues;
use super::choices::{AT_REFERENCE, BASIS, OFF_ON, PREDICTION, SWITCH_OFF, VENT_VALVE};
use crate::calibration::setting::{SETTING_COUNT, SettingId as Id};
use crate::settings::{EcuSettings, Supervision};

impl SettingValues {
    /// Returns the numbers of these settings.
    pub fn of(settings: &EcuSettings) -> Self {
        let EcuSettings {
            controller,
            vent_valve,
            supervision,
        } = settings;
        let mut values = Self([0; SETTING_COUNT]);
        values.set_controller(controller);
        values.put_choice(Id::VentValve, &VENT_VALVE, *vent_valve);
        values.set_supervision(supervision);
        values
    }

    fn set_controller(&mut self, settings: &Settings) {
        let Settings {
            sample_time_ms,
            gain_pct_per_bar,
            integral_time_ms,
            derivative_time_ms,
            integral_max_pct,
            integral_at_reference,
            anti_windup,
            tolerance_bar,
            prediction,
            prediction_basis,
            switch_off,
            boost,
            distributor,
            duty_min,
            duty_max_fill_pct,
            duty_max_vent_pct,
            supply_pressure_bar,
        } = *settings;
        self.put(Id::SampleTime, sample_time_ms);
        self.put(Id::Gain, gain_pct_per_bar);
        self.put_optional(Id::IntegralAction, Id::IntegralTime, integral_time_ms);
        self.put_optional(Id::DerivativeAction, Id::DerivativeTime, derivative_time_ms);
        self.put(Id::IntegralMax, integral_max_pct);
        self.put_choice(
            Id::IntegralAtReference,
            &AT_REFERENCE,
            integral_at_reference,
        );
        match anti_windup {
            AntiWindup::Off => self.set(Id::AntiWindup, 0),
            AntiWindup::ConditionalIntegration => self.set(Id::AntiWindup, 1),
            AntiWindup::BackCalculation { tracking_time_ms } => {
                self.set(Id::AntiWindup, 2);
                self.put(Id::TrackingTime, tracking_time_ms);
            }
        }
        self.put(Id::Tolerance, tolerance_bar);
        self.put_choice(Id::Prediction, &PREDICTION, prediction);
        self.put_choice(Id::PredictionBasis, &BASIS, prediction_basis);
        self.put_choice(Id::SwitchOff, &SWITCH_OFF, switch_off);
        self.put_choice(Id::Boost, &OFF_ON, boost.is_some());
        if let Some(boost) = boost {
            self.put(Id::BoostRate, boost.rate_pct_per_bar_s);
            self.put(Id::BoostMax, boost.max_pct);
            self.put(Id::BoostResponse, boost.response_bar);
        }
        match distributor {
            Distributor::Traditional => self.set(Id::Distributor, 0),
            Distributor::Scheme1 => self.set(Id::Distributor, 1),
            Distributor::Scheme2 {
                middle_fill_pct,
                middle_vent_pct,
            } => {
                self.set(Id::Distributor, 2);
                self.put(Id::DutyMiddleFill, middle_fill_pct);
                self.put(Id::DutyMiddleVent, middle_vent_pct);
            }
        }
        match duty_min {
            LowerLimit::Constant { fill_pct, vent_pct } => {
                self.set(Id::DutyMin, 0);
                self.put(Id::DutyMinFill, fill_pct);
                self.put(Id::DutyMinVent, vent_pct);
            }
            LowerLimit::PressureDependent { fill, vent } => {
                self.set(Id::DutyMin, 1);
                self.put(Id::DutyMinFill, fill.without_pressure_pct);
                self.put(Id::DutyHalfFill, fill.at_half_pct);
                self.put(
                    Id::DutyMinFillWithSupplyPressure,
                    fill.with_supply_pressure_pct,
                );
                self.put(Id::DutyMinVent, vent.without_pressure_pct);
                self.put(Id::DutyHalfVent, vent.at_half_pct);
                self.put(
                    Id::DutyMinVentWithSupplyPressure,
                    vent.with_supply_pressure_pct,
                );
            }
        }
        self.put(Id::DutyMaxFill, duty_max_fill_pct);
        self.put(Id::DutyMaxVent, duty_max_vent_pct);
        self.put(Id::SupplyPressure, supply_pressure_bar);
    }

    fn set_supervision(&mut self, settings: &Supervision) {
        let Supervision {
            supply_pressure_min_bar,
            supply_pressure_max_bar,
            fill_rate_per_s,
            vent_rate_per_s,
            open_duty_fill_pct,
            open_duty_vent_pct,
            valve_settling_ms,
            ramp_bar_per_s,
            battery_min_v,
            battery_max_v,
            coil_current_min_ma,
            coil_current_max_ma,
        } = *settings;
        self.put(Id::SupplyPressureMin, supply_pressure_min_bar);
        self.put(Id::SupplyPressureMax, supply_pressure_max_bar);
        self.put(Id::FillRate, fill_rate_per_s);
        self.put(Id::VentRate, vent_rate_per_s);
        self.put(Id::OpenDutyFill, open_duty_fill_pct);
        self.put(Id::OpenDutyVent, open_duty_vent_pct);
        self.put(Id::ValveSettling, valve_settling_ms);
        self.put(Id::Ramp, ramp_bar_per_s);
        self.put(Id::BatteryMin, battery_min_v);
        self.put(Id::BatteryMax, battery_max_v);
        self.put(Id::CoilCurrentMin, coil_current_min_ma);
        self.put(Id::CoilCurrentMax, coil_current_max_ma);
    }

    #[inline]
    fn put(&mut self, id: Id, value: I16F16) {
        self.set(id, value.to_bits());
    }

    #[inline]
    fn put_optional(&mut self, action: Id, quantity: Id, value: Option<I16F16>) {
        self.put_choice(action, &OFF_ON, value.is_some());
        self.put(quantity, value.unwrap_or(I16F16::ZERO));
    }

    #[inline]
    fn put_choice<T: PartialEq, const N: usize>(&mut self, id: Id, choices: &[T; N], chosen: T) {
        let numbers = 0..const { N as i32 };
        let number = numbers.zip(choices).find(|(_, choice)| **choice == chosen);
        self.set(id, number.map_or(0, |(number, _)| number));
    }
}
