//! Table of all settings of the controller.
//!
//! Checking, the calibration, controller files, help and `docs/settings.md` follow from it. CONTRIBUTING.md has the steps
//! of a new setting.

use fixed::types::I16F16;

use crate::settings::{
    AntiWindup, Boost, Compensation, Distributor, IntegralAtReference, LowerLimit, OpeningDuty,
    Prediction, PredictionBasis, Pulses, Settings, SwitchOff,
};

const ZERO: I16F16 = I16F16::ZERO;

const NO_BOOST: Boost = Boost {
    rate_pct_per_bar_s: ZERO,
    max_pct: ZERO,
    response_bar: ZERO,
};

const NO_COMPENSATION: Compensation = Compensation {
    nominal_voltage_v: ZERO,
    nominal_resistance_ohm: ZERO,
    release_shift_pct: ZERO,
};

const NO_PULSES: Pulses = Pulses {
    deadband_bar: ZERO,
    orifice_mm: ZERO,
    fill_rate_per_s: ZERO,
    vent_rate_per_s: ZERO,
    command_delay_ms: ZERO,
    offset_max_ms: ZERO,
    gain_max_pct: ZERO,
    lag_max_ms: ZERO,
    leak_max_bar_per_s: ZERO,
};

const CLOSED: OpeningDuty = OpeningDuty {
    without_pressure_pct: ZERO,
    at_half_pct: ZERO,
    with_supply_pressure_pct: ZERO,
};

crate::settings_table! {
    /// Setting of the controller: a row of the table of settings.
    Field of Settings, number as x;

    SampleTime: number ("sample_time_ms" ["ms"] "0.1" ..= "1000",
        "sample time T_s, the ECU's period (equation 6.2)",
        sample { sample_time_ms: Settings { sample_time_ms: x, .. } });

    Gain: number ("gain_pct_per_bar" ["%/bar"] "0.01" ..= "1000",
        "gain K: control signal per bar of error (equation 6.2)",
        pid { gain_pct_per_bar: Settings { gain_pct_per_bar: x, .. } });
    IntegralAction: choice ("integral_action" NumberOrOff,
        "integral part of the PID controller (equation 6.2)",
        pid { integral_time_ms }, integral_time_ms { "off" = None, "on" = Some(ZERO) });
    IntegralTime: number ("integral_time_ms" ["ms"] "1" ..= "30000",
        "integral action time T_i (equation 6.2), or \"off\"",
        pid { integral_time_ms: Settings { integral_time_ms: Some(x), .. } });
    DerivativeAction: choice ("derivative_action" NumberOrOff,
        "derivative part of the PID controller (equation 6.2)",
        pid { derivative_time_ms }, derivative_time_ms { "off" = None, "on" = Some(ZERO) });
    DerivativeTime: number ("derivative_time_ms" ["ms"] "0" ..= "30000",
        "derivative action time T_d (equation 6.2), or \"off\"",
        pid { derivative_time_ms: Settings { derivative_time_ms: Some(x), .. } });
    IntegralMax: number ("integral_max_pct" ["%"] "0" ..= "1000",
        "bound of the integral part, also without anti-windup",
        pid { integral_max_pct: Settings { integral_max_pct: x, .. } });
    IntegralAtReference: choice ("integral_at_reference" Word,
        "\"hold\": the integral part is remembered when the reference is reached; \"clear\": it starts again from 0",
        pid { integral_at_reference }, integral_at_reference {
            "hold" = IntegralAtReference::Hold,
            "clear" = IntegralAtReference::Clear,
        });
    AntiWindup: choice ("anti_windup" Word,
        "\"off\", \"conditional_integration\" or \"back_calculation\" (section 6.5.1)",
        pid { anti_windup }, anti_windup {
            "off" = AntiWindup::Off,
            "conditional_integration" = AntiWindup::ConditionalIntegration,
            "back_calculation" = AntiWindup::BackCalculation { tracking_time_ms: ZERO },
        });
    TrackingTime: number ("tracking_time_ms" ["ms"] "0.1" ..= "30000",
        "time constant T_t of the back-calculation, at least the sample time",
        pid { tracking_time_ms: Settings { anti_windup: AntiWindup::BackCalculation { tracking_time_ms: x }, .. } });

    Tolerance: number ("tolerance_bar" ["bar"] "0" ..= "10",
        "P_tol: both valves are off while the error is smaller (section 6.3.1)",
        tolerance { tolerance_bar: Settings { tolerance_bar: x, .. } });

    Prediction: choice ("prediction" Index,
        "number of samples that the error is predicted ahead: 0 is off, 1 is equation 6.8, 2 is equation 6.10",
        prediction { horizon_samples }, prediction {
            "off" = Prediction::Off,
            "one_step" = Prediction::OneStep,
            "two_step" = Prediction::TwoStep,
        });
    PredictionBasis: choice ("prediction_basis" Word,
        "\"error\": its change is extrapolated (equation 6.7); \"pressure\": that of the pressure, blind to jumps of the reference",
        prediction { basis }, prediction_basis {
            "error" = PredictionBasis::Error,
            "pressure" = PredictionBasis::Pressure,
        });
    SwitchOff: choice ("switch_off" Word,
        "predicted errors that turn both valves off: \"inside_tolerance\" (figure 6.9) or \"inside_or_beyond\"",
        prediction { switch_off }, switch_off {
            "inside_tolerance" = SwitchOff::InsideTolerance,
            "inside_or_beyond" = SwitchOff::InsideOrBeyond,
        });

    Boost: choice ("boost" Section,
        "extra integrator (section 6.5.3); without the table [boost] it is off",
        boost { boost }, boost { "off" = None, "on" = Some(NO_BOOST) });
    BoostRate: number ("boost_rate_pct_per_bar_s" ["%/(bar s)"] "0.1" ..= "30000",
        "rate of the extra integrator (section 6.5.3); without the table [boost] it is off",
        boost { rate_pct_per_bar_s: Settings { boost: Some(Boost { rate_pct_per_bar_s: x, .. }), .. } });
    BoostMax: number ("boost_max_pct" ["%"] "0" ..= "1000",
        "bound of the boost",
        boost { max_pct: Settings { boost: Some(Boost { max_pct: x, .. }), .. } });
    BoostResponse: number ("boost_response_bar" ["bar"] "0" ..= "10",
        "the pressure responds when it moves this much towards the reference in a sample",
        boost { response_bar: Settings { boost: Some(Boost { response_bar: x, .. }), .. } });

    Distributor: choice ("distributor" Word,
        "\"traditional\" (6.3 to 6.5), \"scheme_1\" (section 6.3.1) or \"scheme_2\" (both valves, section 6.3.2)",
        distributor { scheme }, distributor {
            "traditional" = Distributor::Traditional,
            "scheme_1" = Distributor::Scheme1,
            "scheme_2" = Distributor::Scheme2 { middle_fill_pct: ZERO, middle_vent_pct: ZERO },
        });
    DutyMiddleFill: number ("middle_fill_pct" ["%"] "0" ..= "100",
        "duty cycle of the fill valve at u = 0 (Scheme 2), DC_min to DC_max",
        distributor { middle_fill_pct:
            Settings { distributor: Distributor::Scheme2 { middle_fill_pct: x, .. }, .. } });
    DutyMiddleVent: number ("middle_vent_pct" ["%"] "0" ..= "100",
        "duty cycle of the vent valve at u = 0 (Scheme 2), DC_min to DC_max",
        distributor { middle_vent_pct:
            Settings { distributor: Distributor::Scheme2 { middle_vent_pct: x, .. }, .. } });

    DutyMin: choice ("duty_min" Word,
        "lower limit DC_min: \"constant\" (section 6.3.1) or \"pressure_dependent\" (section 7.2)",
        duty_min { law }, duty_min {
            "constant" = LowerLimit::Constant { fill_pct: ZERO, vent_pct: ZERO },
            "pressure_dependent" = LowerLimit::PressureDependent { fill: CLOSED, vent: CLOSED },
        });
    DutyMinFill: number ("duty_min_fill_pct" ["%"] "0" ..= "100",
        "lower limit of the fill valve: at every pressure, or what opens it without pressure difference (table 4.2)",
        duty_min {
            fill_pct: Settings { duty_min: LowerLimit::Constant { fill_pct: x, .. }, .. },
            fill_without_pressure_pct: Settings {
                duty_min: LowerLimit::PressureDependent { fill: OpeningDuty { without_pressure_pct: x, .. }, .. }, ..
            },
        });
    DutyHalfFill: number ("duty_min_fill_at_half_supply_pressure_pct" ["%"] "0" ..= "100",
        "the same at half the supply pressure; \"force_balance\" and \"linear\" compute it from the ends",
        duty_min { fill_at_half_supply_pressure_pct: Settings {
            duty_min: LowerLimit::PressureDependent { fill: OpeningDuty { at_half_pct: x, .. }, .. }, ..
        } });
    DutyMinFillWithSupplyPressure: number ("duty_min_fill_with_supply_pressure_pct" ["%"] "0" ..= "100",
        "the same at the full supply pressure (table 4.1)",
        duty_min { fill_with_supply_pressure_pct: Settings {
            duty_min: LowerLimit::PressureDependent { fill: OpeningDuty { with_supply_pressure_pct: x, .. }, .. }, ..
        } });
    DutyMinVent: number ("duty_min_vent_pct" ["%"] "0" ..= "100",
        "lower limit of the vent valve: at every pressure, or what opens it without pressure difference (table 4.2)",
        duty_min {
            vent_pct: Settings { duty_min: LowerLimit::Constant { vent_pct: x, .. }, .. },
            vent_without_pressure_pct: Settings {
                duty_min: LowerLimit::PressureDependent { vent: OpeningDuty { without_pressure_pct: x, .. }, .. }, ..
            },
        });
    DutyHalfVent: number ("duty_min_vent_at_half_supply_pressure_pct" ["%"] "0" ..= "100",
        "the same at half the supply pressure, or \"force_balance\" or \"linear\"",
        duty_min { vent_at_half_supply_pressure_pct: Settings {
            duty_min: LowerLimit::PressureDependent { vent: OpeningDuty { at_half_pct: x, .. }, .. }, ..
        } });
    DutyMinVentWithSupplyPressure: number ("duty_min_vent_with_supply_pressure_pct" ["%"] "0" ..= "100",
        "the same at the full supply pressure (table 4.1)",
        duty_min { vent_with_supply_pressure_pct: Settings {
            duty_min: LowerLimit::PressureDependent { vent: OpeningDuty { with_supply_pressure_pct: x, .. }, .. }, ..
        } });
    DutyMaxFill: number ("duty_max_fill_pct" ["%"] "0" ..= "100",
        "upper limit DC_max of the fill valve, at least DC_min: full lift without over-magnetising (table 4.1)",
        distributor { duty_max_fill_pct: Settings { duty_max_fill_pct: x, .. } });
    DutyMaxVent: number ("duty_max_vent_pct" ["%"] "0" ..= "100",
        "upper limit DC_max of the vent valve, at least DC_min (table 4.1)",
        distributor { duty_max_vent_pct: Settings { duty_max_vent_pct: x, .. } });
    SupplyPressure: number ("supply_pressure_bar" ["bar gauge"] "1" ..= "15",
        "supply pressure p_sup",
        distributor { supply_pressure_bar: Settings { supply_pressure_bar: x, .. } });

    Compensation: choice ("compensation" Section,
        "duty limits follow supply voltage and coil resistance; without the table [compensation] they are constant",
        compensation { compensation }, compensation { "off" = None, "on" = Some(NO_COMPENSATION) });
    NominalVoltage: number ("nominal_voltage_v" ["V"] "9" ..= "36",
        "supply voltage U_0 at which the duty limits were found",
        compensation { nominal_voltage_v:
            Settings { compensation: Some(Compensation { nominal_voltage_v: x, .. }), .. } });
    NominalResistance: number ("nominal_resistance_ohm" ["ohm"] "1" ..= "1000",
        "resistance R_0 of a coil at the temperature at which the duty limits were found; the nominal plant's is that at 20 °C",
        compensation { nominal_resistance_ohm:
            Settings { compensation: Some(Compensation { nominal_resistance_ohm: x, .. }), .. } });
    ReleaseShift: number ("release_shift_pct" ["%"] "0" ..= "100",
        "shift of the duty cycles of a normally open vent valve where U_0/U R/R_0 is e: the current of its coil decays that much sooner; 0: none",
        compensation { release_shift_pct:
            Settings { compensation: Some(Compensation { release_shift_pct: x, .. }), .. } });

    Pulses: choice ("pulses" Section,
        "model-based pulses in place of PID controller and distributor, while the coils get current enough; without the table [pulses] they are off",
        pulses { pulses }, pulses { "off" = None, "on" = Some(NO_PULSES) });
    PulseDeadband: number ("pulse_deadband_bar" ["bar"] "0" ..= "10",
        "deadband of the pulses: a smaller error gets none",
        pulses { deadband_bar: Settings { pulses: Some(Pulses { deadband_bar: x, .. }), .. } });
    PulseOrifice: number ("pulse_orifice_mm" ["mm"] "0.5" ..= "5",
        "diameter of the orifices; of the tables for 1.3 and 1.9 mm the nearest one is used",
        pulses { orifice_mm: Settings { pulses: Some(Pulses { orifice_mm: x, .. }), .. } });
    PulseFillRate: number ("pulse_fill_rate_per_s" ["1/s"] "0.5" ..= "50",
        "rate k of the open fill valve: choked flow over supply pressure and volume",
        pulses { fill_rate_per_s: Settings { pulses: Some(Pulses { fill_rate_per_s: x, .. }), .. } });
    PulseVentRate: number ("pulse_vent_rate_per_s" ["1/s"] "0.5" ..= "50",
        "rate k of the open vent valve: choked flow over chamber pressure and volume",
        pulses { vent_rate_per_s: Settings { pulses: Some(Pulses { vent_rate_per_s: x, .. }), .. } });
    PulseDelay: number ("pulse_command_delay_ms" ["ms"] "0" ..= "30",
        "time from a sample to the begin of its pulse",
        pulses { command_delay_ms: Settings { pulses: Some(Pulses { command_delay_ms: x, .. }), .. } });
    PulseOffsetMax: number ("pulse_offset_max_ms" ["ms"] "0" ..= "5",
        "bound of the adapted opening delay; 0 switches its adaptation off",
        pulses { offset_max_ms: Settings { pulses: Some(Pulses { offset_max_ms: x, .. }), .. } });
    PulseGainMax: number ("pulse_gain_max_pct" ["%"] "0" ..= "50",
        "bound of the adapted gain; 0 switches its adaptation off",
        pulses { gain_max_pct: Settings { pulses: Some(Pulses { gain_max_pct: x, .. }), .. } });
    PulseLagMax: number ("pulse_lag_max_ms" ["ms"] "0" ..= "50",
        "bound of the adapted lag of the measured pressure behind the flow, such as that of a slow sensor",
        pulses { lag_max_ms: Settings { pulses: Some(Pulses { lag_max_ms: x, .. }), .. } });
    PulseLeakMax: number ("pulse_leak_max_bar_per_s" ["bar/s"] "0" ..= "10",
        "bound of the leak that is fed forward; 0 switches the feed-forward off",
        pulses { leak_max_bar_per_s: Settings { pulses: Some(Pulses { leak_max_bar_per_s: x, .. }), .. } });
}
