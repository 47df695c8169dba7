//! Settings of the controller, in engineering units.

use fixed::types::I16F16;

/// Settings of the controller: plain numbers with their unit in the name, in steps of 2⁻¹⁶ of the unit.
///
/// `I16F16` parses decimal text without a float in between (`"28.5".parse()`), so a host and a target that read the
/// same file have the same bits. Nothing is checked here; [`Config::new`](crate::Config::new) checks everything once.
/// [`Field`](crate::Field) has the unit, the range and the meaning of each setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// Sample time T_s (ms): the time between two calls of [`step`](crate::step()) (equation 6.2).
    pub sample_time_ms: I16F16,
    /// Gain K of equation 6.2 (%/bar).
    pub gain_pct_per_bar: I16F16,
    /// Integral action time T_i of equation 6.2 (ms); `None` gives a P or PD controller.
    pub integral_time_ms: Option<I16F16>,
    /// Derivative action time T_d of equation 6.2 (ms); `None` gives a P or PI controller.
    pub derivative_time_ms: Option<I16F16>,
    /// Bound of the integral part (% of u). It also applies when anti-windup is off.
    pub integral_max_pct: I16F16,
    /// Behaviour of the integral part when the reference is reached.
    pub integral_at_reference: IntegralAtReference,
    /// Behaviour of the integral part when u is saturated (section 6.5.1).
    pub anti_windup: AntiWindup,
    /// Deadband P_tol (bar): both valves are off while |e| is smaller (section 6.3.1). With 0 they are off only at
    /// e = 0 (equation 6.5).
    pub tolerance_bar: I16F16,
    /// Prediction horizon of the error, which switches the valves off early (section 6.5.2).
    pub prediction: Prediction,
    /// Signal that the prediction extrapolates.
    pub prediction_basis: PredictionBasis,
    /// Predicted errors that switch the valves off.
    pub switch_off: SwitchOff,
    /// Extra integrator of section 6.5.3; `None` switches it off.
    pub boost: Option<Boost>,
    /// Conversion of u into two duty cycles (section 6.3).
    pub distributor: Distributor,
    /// Lower limit DC_min of each valve's duty cycle (section 6.3.1, section 7.2); not used by [`Distributor::Traditional`].
    pub duty_min: LowerLimit,
    /// Upper limit DC_max of the fill valve's duty cycle (%), at least DC_min: full lift without over-magnetising.
    pub duty_max_fill_pct: I16F16,
    /// Upper limit DC_max of the vent valve's duty cycle (%), at least DC_min.
    pub duty_max_vent_pct: I16F16,
    /// Supply pressure p_sup (bar gauge): the end of a pressure-dependent lower limit.
    pub supply_pressure_bar: I16F16,
    /// Duty limits that follow supply voltage and coil resistance; `None` leaves them constant.
    pub compensation: Option<Compensation>,
    /// Model-based pulses in place of PID controller and distributor; `None`: off.
    pub pulses: Option<Pulses>,
}

/// Model-based pulses: in each sample the one pulse that lands on the reference, from tables of a nominal plant.
///
/// `supply_pressure_bar` is their supply pressure. They need a [`Compensation`] to follow the supply voltage. Where it
/// leaves the coils too little current, the ECU uses the PID controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pulses {
    /// Deadband (bar): a smaller error gets no pulse.
    pub deadband_bar: I16F16,
    /// Diameter of the orifices (mm). There are tables for 1.3 and 1.9 mm; the nearest one is used.
    pub orifice_mm: I16F16,
    /// Rate k of the open fill valve (1/s): choked flow over supply pressure and volume.
    pub fill_rate_per_s: I16F16,
    /// Rate k of the open vent valve (1/s): choked flow over chamber pressure and volume.
    pub vent_rate_per_s: I16F16,
    /// Time from a sample to the begin of its pulse (ms).
    pub command_delay_ms: I16F16,
    /// Bound of the adapted opening delay (ms).
    pub offset_max_ms: I16F16,
    /// Bound of the adapted gain (%).
    pub gain_max_pct: I16F16,
    /// Bound of the adapted lag of the measured pressure (ms).
    pub lag_max_ms: I16F16,
    /// Bound of the leak whose drift is fed forward (bar/s).
    pub leak_max_bar_per_s: I16F16,
}

/// Supply voltage and coil resistance at which the duty limits were found. The limits are multiplied by U₀/U · R/R₀; those
/// of a normally open vent valve are shifted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Compensation {
    /// Nominal supply voltage U₀ (V).
    pub nominal_voltage_v: I16F16,
    /// Resistance R₀ of a coil at the temperature at which the limits were found (ohm).
    pub nominal_resistance_ohm: I16F16,
    /// Shift of the duty cycles of a normally open vent valve (%) where its coil needs e times the mean voltage.
    pub release_shift_pct: I16F16,
}

/// Anti-windup: keeps the integral part from growing while a valve cannot open further (section 6.5.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AntiWindup {
    /// Equation 6.2 as printed; only `integral_max_pct` bounds the integral part.
    Off,
    /// Conditional integration: the error is not summed while u is saturated and the error drives it further.
    ConditionalIntegration,
    /// Back-calculation: the part of u that saturation cuts off is fed back into the integral part.
    BackCalculation {
        /// Tracking time constant T_t (ms), at least T_s, with which the integral part is reduced.
        tracking_time_ms: I16F16,
    },
}

/// Behaviour of the integral part when the reference is reached: |e| is inside the deadband, or e changed its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum IntegralAtReference {
    /// The integral part is frozen inside the deadband and kept, like the single sum of equation 6.2.
    Hold,
    /// The integral part restarts from zero, so that the part needed to fill does not oppose venting.
    Clear,
}

/// Prediction horizon: number of samples ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Prediction {
    /// No prediction: only the deadband switches the valves off.
    Off,
    /// eₙ₊₁ = 2eₙ - eₙ₋₁ (equation 6.8).
    OneStep,
    /// eₙ₊₂ = 3eₙ - 2eₙ₋₁ (equation 6.10).
    TwoStep,
}

/// Change of the error per sample, as the prediction and the derivative part compute it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PredictionBasis {
    /// eₙ - eₙ₋₁ (equation 6.7): a jump of the reference counts as a motion of the pressure in that sample.
    Error,
    /// pₙ₋₁ - pₙ: equal to the change of the error while the reference is constant, and independent of its jumps. The
    /// derivative part still responds to a jump of the reference away from the pressure, which speeds up the response.
    /// It ignores a jump towards the pressure, which would open the other valve far from the reference.
    Pressure,
}

/// Predicted errors that switch the valves off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SwitchOff {
    /// Errors inside the deadband (figure 6.9). The predicted error of a fast pressure can be beyond the deadband,
    /// which does not switch off.
    InsideTolerance,
    /// Errors inside the deadband or on its other side.
    InsideOrBeyond,
}

/// Extra integrator that runs only while the pressure does not respond and |e| is outside the deadband (section 6.5.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Boost {
    /// Rate (% of u per second and bar of error).
    pub rate_pct_per_bar_s: I16F16,
    /// Bound of the boost (% of u).
    pub max_pct: I16F16,
    /// Smallest pressure change towards the reference in one sample (bar) that counts as a response.
    pub response_bar: I16F16,
}

/// Conversion of the control signal into two duty cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Distributor {
    /// |u| to the fill valve for u > 0, to the vent valve for u < 0 (equations 6.3 to 6.5).
    Traditional,
    /// |u| from 0 to 100 % onto DC_min to DC_max of the same valve (figure 6.4, right).
    Scheme1,
    /// Both valves around one middle duty cycle each (section 6.3.2). At u = 0 both get their middle, at u = 100 % the
    /// fill valve gets DC_max and the vent valve DC_min, at u = -100 % the reverse, linear in between.
    Scheme2 {
        /// Middle of the fill valve (%), largest DC_min ..= DC_max.
        middle_fill_pct: I16F16,
        /// Middle of the vent valve (%), largest DC_min ..= DC_max.
        middle_vent_pct: I16F16,
    },
}

/// Lower limit of the duty cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LowerLimit {
    /// Constant limit, the same at every pressure (section 6.3.1).
    Constant {
        /// Limit of the fill valve (%).
        fill_pct: I16F16,
        /// Limit of the vent valve (%).
        vent_pct: I16F16,
    },
    /// Duty cycle that just opens the valve at this chamber pressure (section 7.2). The pressure difference is p_sup -
    /// p_ch for the fill valve and p_ch for the vent valve.
    PressureDependent {
        /// Opening duty cycle of the fill valve.
        fill: OpeningDuty,
        /// Opening duty cycle of the vent valve.
        vent: OpeningDuty,
    },
}

/// Duty cycle that just opens one valve, over the pressure difference that helps to open it.
///
/// It is the parabola through three points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OpeningDuty {
    /// Opening duty cycle without pressure difference (%), table 4.2.
    pub without_pressure_pct: I16F16,
    /// Opening duty cycle at half the supply pressure (%), in the middle half between the other two, so that the
    /// parabola falls along its whole length.
    pub at_half_pct: I16F16,
    /// Opening duty cycle at the supply pressure (%), at most `without_pressure_pct` (table 4.1).
    pub with_supply_pressure_pct: I16F16,
}

impl OpeningDuty {
    /// Creates the straight line of section 7.2.
    ///
    /// Between its ends the line lies below the duty cycle that opens the valve (2.0 % below at half the supply
    /// pressure with the fill valve's figures). A dead zone remains there, but no valve opens early.
    pub const fn linear(without_pressure_pct: I16F16, with_supply_pressure_pct: I16F16) -> Self {
        let sum = (without_pressure_pct.to_bits() as i64)
            .wrapping_add(with_supply_pressure_pct.to_bits() as i64);
        Self {
            without_pressure_pct,
            // The mean of two values of a type fits into that type.
            at_half_pct: I16F16::from_bits((sum >> 1) as i32),
            with_supply_pressure_pct,
        }
    }

    /// Creates the curve of the force balance (section 5.1.3). The magnetic force is proportional to i², i is
    /// proportional to the duty cycle, and the pressure takes over a share of the preload. Therefore duty² falls
    /// linearly with the pressure difference. The parabola meets this curve at both ends and in the middle.
    pub const fn force_balance(
        without_pressure_pct: I16F16,
        with_supply_pressure_pct: I16F16,
    ) -> Self {
        let a = without_pressure_pct.to_bits().unsigned_abs() as u64;
        let b = with_supply_pressure_pct.to_bits().unsigned_abs() as u64;
        // Each square is at most 2⁶²; the root of their mean is at most 2³¹, which is one too many for the type.
        let root = (a.wrapping_mul(a).wrapping_add(b.wrapping_mul(b)) / 2).isqrt();
        let bits = root.saturating_sub(root >> 31) as i32;
        Self {
            without_pressure_pct,
            at_half_pct: I16F16::from_bits(bits),
            with_supply_pressure_pct,
        }
    }
}

impl Settings {
    /// Returns the controller of the thesis: PID, anti-windup, Scheme 1 with 25.5 % as lower limit in all conditions,
    /// deadband, prediction two samples ahead, boost. The thesis does not print its gains; these have the order of
    /// magnitude of its figures.
    pub const fn thesis() -> Self {
        // Constants, so that the compiler parses the decimal text and not the target.
        const THESIS: Settings = Settings {
            sample_time_ms: I16F16::lit("10"),
            gain_pct_per_bar: I16F16::lit("40"),
            integral_time_ms: Some(I16F16::lit("1000")),
            derivative_time_ms: Some(I16F16::lit("10")),
            integral_max_pct: I16F16::lit("100"),
            integral_at_reference: IntegralAtReference::Hold,
            anti_windup: AntiWindup::ConditionalIntegration,
            tolerance_bar: I16F16::lit("0.1"),
            prediction: Prediction::TwoStep,
            prediction_basis: PredictionBasis::Error,
            switch_off: SwitchOff::InsideTolerance,
            boost: Some(Boost {
                rate_pct_per_bar_s: I16F16::lit("1000"),
                max_pct: I16F16::lit("60"),
                response_bar: I16F16::lit("0.02"),
            }),
            distributor: Distributor::Scheme1,
            duty_min: LowerLimit::Constant {
                fill_pct: I16F16::lit("25.5"),
                vent_pct: I16F16::lit("25.5"),
            },
            duty_max_fill_pct: I16F16::lit("82"),
            duty_max_vent_pct: I16F16::lit("80"),
            supply_pressure_bar: I16F16::lit("8.4"),
            compensation: None,
            pulses: None,
        };
        THESIS
    }

    /// Returns the model-based pulses for the nominal plant with orifices of 1.9 mm. Without them, the settings are those
    /// of the recommended controller.
    pub const fn pulses() -> Self {
        const PULSES: Settings = Settings {
            pulses: Some(Pulses {
                deadband_bar: I16F16::lit("0.07"),
                orifice_mm: I16F16::lit("1.9"),
                fill_rate_per_s: I16F16::lit("7.13"),
                vent_rate_per_s: I16F16::lit("7.28"),
                command_delay_ms: I16F16::lit("15"),
                offset_max_ms: I16F16::lit("2"),
                gain_max_pct: I16F16::lit("20"),
                lag_max_ms: I16F16::lit("20"),
                leak_max_bar_per_s: I16F16::lit("1.5"),
            }),
            ..Settings::recommended()
        };
        PULSES
    }

    /// Returns the controller recommended for a truck: the thesis' controller with four changes. Its lower limits
    /// depend on the pressure (section 7.2), its prediction ignores jumps of the reference, its integral part restarts
    /// when the reference is reached, and its duty limits follow supply voltage and coil resistance. The numbers were
    /// tuned on simulated rigs; `hil-harness/controllers/recommended.toml` gives the reason for each.
    pub const fn recommended() -> Self {
        const RECOMMENDED: Settings = Settings {
            gain_pct_per_bar: I16F16::lit("35"),
            integral_time_ms: Some(I16F16::lit("700")),
            derivative_time_ms: Some(I16F16::lit("16")),
            integral_at_reference: IntegralAtReference::Clear,
            tolerance_bar: I16F16::lit("0.085"),
            prediction: Prediction::OneStep,
            prediction_basis: PredictionBasis::Pressure,
            switch_off: SwitchOff::InsideOrBeyond,
            boost: Some(Boost {
                rate_pct_per_bar_s: I16F16::lit("250"),
                max_pct: I16F16::lit("100"),
                response_bar: I16F16::lit("0.3"),
            }),
            duty_min: LowerLimit::PressureDependent {
                fill: OpeningDuty::force_balance(I16F16::lit("54.5"), I16F16::lit("28.5")),
                vent: OpeningDuty::force_balance(I16F16::lit("51.5"), I16F16::lit("25.5")),
            },
            compensation: Some(Compensation {
                nominal_voltage_v: I16F16::lit("24"),
                nominal_resistance_ohm: I16F16::lit("82.2"),
                release_shift_pct: I16F16::lit("41.5"),
            }),
            ..Settings::thesis()
        };
        RECOMMENDED
    }
}
