//! What a person chooses, in engineering units.

use fixed::types::I16F16;

/// Everything that can be chosen about the controller: plain numbers with their unit in the name, 2⁻¹⁶ of the unit fine.
///
/// `I16F16` reads decimal text without a float in between (`"28.5".parse()`), so a host and a target that read the same
/// file hold the same bits. Nothing is checked here; [`Config::new`](crate::Config::new) does that, once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// Sample time T_s \[ms\], 0.1 ..= 1000: the time between two calls of [`step`](crate::step()) (equation 6.2).
    pub sample_time_ms: I16F16,
    /// Gain K [%/bar], 0.01 ..= 1000 (equation 6.2).
    pub gain_pct_per_bar: I16F16,
    /// Integral action time T_i \[ms\], 1 ..= 30 000 (equation 6.2); `None` is a P or PD controller.
    pub integral_time_ms: Option<I16F16>,
    /// Derivative action time T_d \[ms\], 0 ..= 30 000 (equation 6.2); `None` is a P or PI controller.
    pub derivative_time_ms: Option<I16F16>,
    /// Bound of the integral part [% of u], 0 ..= 1000: the last fence, also when anti-windup is off.
    pub integral_max_pct: I16F16,
    /// What the integral part does when the reference is reached.
    pub integral_at_reference: IntegralAtReference,
    /// What the integral part does when u is saturated (section 6.5.1).
    pub anti_windup: AntiWindup,
    /// Tolerance P_tol \[bar\], 0 ..= 10: both valves are off while |e| is smaller (section 6.3.1). 0 leaves only e = 0 (equation 6.5).
    pub tolerance_bar: I16F16,
    /// How far the error is predicted to switch the valves off ahead (section 6.5.2).
    pub prediction: Prediction,
    /// What the prediction extrapolates.
    pub prediction_basis: PredictionBasis,
    /// Which predicted errors switch the valves off.
    pub switch_off: SwitchOff,
    /// The extra integrator of section 6.5.3; `None` is off.
    pub boost: Option<Boost>,
    /// How u becomes two duty cycles (section 6.3).
    pub distributor: Distributor,
    /// Lower limit DC_min of each valve's duty cycle (section 6.3.1, section 7.2); not used by [`Distributor::Traditional`].
    pub duty_min: LowerLimit,
    /// Upper limit DC_max of the fill valve's duty cycle [%], DC_min ..= 100: full lift without over-magnetising.
    pub duty_max_fill_pct: I16F16,
    /// Upper limit DC_max of the vent valve's duty cycle [%], DC_min ..= 100.
    pub duty_max_vent_pct: I16F16,
    /// Supply pressure p_sup [bar gauge], 1 ..= 15: where a pressure-dependent lower limit ends.
    pub supply_pressure_bar: I16F16,
}

/// Anti-windup: what keeps the integral part from growing while a valve cannot open further (section 6.5.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AntiWindup {
    /// Equation 6.2 as printed; only `integral_max_pct` bounds the integral part.
    Off,
    /// The error is not summed while u is saturated and the error drives it further.
    ConditionalIntegration,
    /// What saturation cuts off u flows back into the integral part.
    BackCalculation {
        /// Tracking time T_t \[ms\], T_s ..= 30 000: the integral part gives way with this time constant.
        tracking_time_ms: I16F16,
    },
}

/// What the integral part does when the reference is reached: |e| inside the tolerance, or e changed its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum IntegralAtReference {
    /// It is frozen inside the tolerance and remembered, as the one sum of equation 6.2 is.
    Hold,
    /// It starts again from zero, so that what was needed to fill does not oppose venting.
    Clear,
}

/// How many samples ahead the error is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Prediction {
    /// The valves are switched off by the tolerance only.
    Off,
    /// eₙ₊₁ = 2eₙ - eₙ₋₁ (equation 6.8).
    OneStep,
    /// eₙ₊₂ = 3eₙ - 2eₙ₋₁ (equation 6.10).
    TwoStep,
}

/// What the prediction, and the derivative part, take for the change of the error per sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PredictionBasis {
    /// eₙ - eₙ₋₁ (equation 6.7): a jump of the reference is taken for a motion of the pressure in that sample.
    Error,
    /// pₙ₋₁ - pₙ: the same while the reference rests, and blind to its jumps. The derivative part still answers to a jump away from
    /// the pressure, which helps to get there, and no longer to one towards it, which would open the other valve far from the reference.
    Pressure,
}

/// Which predicted errors switch the valves off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SwitchOff {
    /// Those inside the tolerance (figure 6.9). A fast pressure can be predicted to be past it, and is then not switched off.
    InsideTolerance,
    /// Those inside the tolerance or on the other side of it.
    InsideOrBeyond,
}

/// The extra integrator that runs only while the pressure does not respond and |e| is outside the tolerance (section 6.5.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Boost {
    /// Rate [% of u per second and bar of error], 0.1 ..= 30 000.
    pub rate_pct_per_bar_s: I16F16,
    /// Bound of the boost [% of u], 0 ..= 1000.
    pub max_pct: I16F16,
    /// The pressure responds when it moves towards the reference by at least this much in one sample \[bar\], 0 ..= 10.
    pub response_bar: I16F16,
}

/// How the control signal becomes two duty cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Distributor {
    /// |u| to the fill valve for u > 0, to the vent valve for u < 0 (equations 6.3 to 6.5).
    Traditional,
    /// |u| from 0 to 100 % onto DC_min to DC_max of the same valve (figure 6.4, right).
    Scheme1,
    /// Both valves around a middle duty cycle each (section 6.3.2): at u = 0 both get the middle, at u = 100 % the fill valve
    /// DC_max and the vent valve DC_min, at u = -100 % the reverse, linear between.
    Scheme2 {
        /// Middle of the fill valve [%], largest DC_min ..= DC_max.
        middle_fill_pct: I16F16,
        /// Middle of the vent valve [%], largest DC_min ..= DC_max.
        middle_vent_pct: I16F16,
    },
}

/// Lower limit of the duty cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LowerLimit {
    /// The same at every pressure (section 6.3.1).
    Constant {
        /// Fill valve [%], 0 ..= 100.
        fill_pct: I16F16,
        /// Vent valve [%], 0 ..= 100.
        vent_pct: I16F16,
    },
    /// The duty cycle that just opens the valve at this chamber pressure (section 7.2). The fill valve sees p_sup - p_ch,
    /// the vent valve p_ch.
    PressureDependent {
        /// Fill valve.
        fill: OpeningDuty,
        /// Vent valve.
        vent: OpeningDuty,
    },
}

/// The duty cycle that just opens one valve, over the pressure difference that helps to open it.
///
/// Three points and the parabola through them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct OpeningDuty {
    /// Without pressure difference [%], 0 ..= 100 (table 4.2).
    pub without_pressure_pct: I16F16,
    /// At half the supply pressure [%], in the middle half between the other two, so that the parabola falls all the way.
    pub at_half_pct: I16F16,
    /// At the supply pressure [%], 0 ..= `without_pressure_pct` (table 4.1).
    pub with_supply_pressure_pct: I16F16,
}

impl OpeningDuty {
    /// The straight line of section 7.2.
    ///
    /// Between its ends it lies below what opens the valve (2.0 % below at half the supply pressure with the fill valve's
    /// figures): a dead band remains there, but no valve opens early.
    pub const fn linear(without_pressure_pct: I16F16, with_supply_pressure_pct: I16F16) -> Self {
        let sum = (without_pressure_pct.to_bits() as i64)
            .wrapping_add(with_supply_pressure_pct.to_bits() as i64);
        Self {
            without_pressure_pct,
            // The mean of two values of a type is one of that type.
            at_half_pct: I16F16::from_bits((sum >> 1) as i32),
            with_supply_pressure_pct,
        }
    }

    /// The force balance: the magnetic force goes with i², i with the duty cycle, and the pressure takes its share of the
    /// preload, so duty² falls linearly with the pressure difference (section 5.1.3). The parabola meets this curve at both
    /// ends and in the middle.
    pub const fn force_balance(
        without_pressure_pct: I16F16,
        with_supply_pressure_pct: I16F16,
    ) -> Self {
        let a = without_pressure_pct.to_bits().unsigned_abs() as u64;
        let b = with_supply_pressure_pct.to_bits().unsigned_abs() as u64;
        // Each square is at most 2⁶²; the root of their mean is at most 2³¹, which alone is one too many for the type.
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
    /// The controller of the thesis: PID, anti-windup, Scheme 1 with 25.5 % as lower limit in all conditions, tolerance,
    /// prediction two samples ahead, boost. The thesis does not print its gains; these are of the size its figures show.
    pub const fn thesis() -> Self {
        // Constants, so that the compiler reads the decimal text and not the target.
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
        };
        THESIS
    }

    /// What we would put on a truck: the thesis' controller with pressure-dependent lower limits (section 7.2), a prediction
    /// that a jump of the reference does not fool, and an integral part that does not outlive the reference it was built for.
    /// The numbers were tuned on simulated rigs; `hil-harness/controllers/recommended.toml` has the reason for each.
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
            ..Settings::thesis()
        };
        RECOMMENDED
    }
}
