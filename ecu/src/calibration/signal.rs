//! Table of signals.

use hil_protocol::crc32::Digest;
use hil_protocol::{Actuators, Telemetry};

use crate::input_output::Inputs;
use crate::sensor::PressureSensor;

/// Description of one signal: the meaning of its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Name of the signal.
    pub name: &'static str,
    /// Unit of the signal; empty if it has none.
    pub unit: &'static str,
    /// Number of fraction bits: the number counts 2 to the minus this of the unit.
    pub fraction_bits: u8,
    /// Whether the number is an `i32`; otherwise its bits are a `u32`.
    pub signed: bool,
}

/// Number of a signal that was missing in the last sample.
pub const MISSING: i32 = i32::MIN;

macro_rules! signals {
    ($($id:ident: $name:literal, $unit:literal, $fraction_bits:literal, $signed:literal;)*) => {
        /// Number of a signal: its row in [`SIGNALS`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u16)]
        pub enum SignalId {
            $(#[doc = concat!("`", $name, "`")] $id,)*
        }

        /// Number of signals.
        pub const SIGNAL_COUNT: usize = [$(SignalId::$id),*].len();

        impl SignalId {
            /// All signals, in the order of the table.
            pub const ALL: [Self; SIGNAL_COUNT] = [$(Self::$id),*];
        }

        /// All signals, in the order of their numbers.
        pub static SIGNALS: [Signal; SIGNAL_COUNT] = TABLE;

        const TABLE: [Signal; SIGNAL_COUNT] = [
            $(Signal {
                name: $name,
                unit: $unit,
                fraction_bits: $fraction_bits,
                signed: $signed,
            },)*
        ];
    };
}

signals! {
    Sample: "sample", "", 0, false;
    Elapsed: "elapsed", "us", 0, false;
    Reference: "p_ref", "bar gauge", 16, true;
    PressureCode: "pressure_code", "", 0, true;
    Pressure: "p_ch_measured", "bar gauge", 16, true;
    CurrentFill: "i_fill", "mA", 0, true;
    CurrentVent: "i_vent", "mA", 0, true;
    Battery: "u_bat", "mV", 0, true;
    DutyFill: "duty_fill", "%", 16, true;
    DutyVent: "duty_vent", "%", 16, true;
    ControlSignal: "u", "%", 12, true;
    PreviousPressure: "controller_pressure", "bar gauge", 16, true;
    PreviousError: "controller_error", "bar", 16, true;
    IntegralLow: "integral_low_word", "%", 44, false;
    Integral: "integral", "%", 12, true;
    BoostLow: "boost_low_word", "%", 44, false;
    Boost: "boost", "%", 12, true;
    Mode: "mode", "", 0, false;
    Faults: "faults", "", 0, false;
    EcuDigest: "ecu_digest", "", 0, false;
}

impl SignalId {
    /// Returns the signal's row in the table.
    pub const fn signal(self) -> &'static Signal {
        &TABLE[self as usize]
    }

    /// Returns the signal with this number.
    pub fn numbered(number: u16) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Returns the signal with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|id| id.signal().name == name)
    }
}

/// CRC-32 of the table: names and units, each terminated by a zero, fraction bits and sign.
pub const SIGNALS_DIGEST: u32 = digest();

const fn digest() -> u32 {
    let mut digest = Digest::new();
    let mut row = 0;
    while row < SIGNAL_COUNT {
        let Signal {
            name,
            unit,
            fraction_bits,
            signed,
        } = TABLE[row];
        digest.update_text(name);
        digest.update_text(unit);
        digest.update(fraction_bits);
        digest.update(signed as u8);
        row += 1;
    }
    digest.value()
}

/// Inputs and results of one sample, from which signals are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Snapshot {
    /// Number of the sample.
    pub sample: u32,
    /// Measured inputs and reference.
    pub inputs: Inputs,
    /// Outputs to the coils.
    pub actuators: Actuators,
    /// Internal values after the sample.
    pub telemetry: Telemetry,
}

impl Snapshot {
    /// Returns the number of one signal.
    pub fn signal(&self, id: SignalId) -> i32 {
        let Self {
            sample,
            inputs,
            actuators,
            telemetry,
        } = self;
        let [pressure, error, integral_low, integral, boost_low, boost] =
            telemetry.controller_state;
        match id {
            SignalId::Sample => sample.cast_signed(),
            SignalId::Elapsed => inputs.elapsed_us.cast_signed(),
            SignalId::Reference => inputs
                .reference
                .map_or(MISSING, |reference| reference.to_bits()),
            SignalId::PressureCode => inputs
                .pressure
                .map_or(MISSING, |code| i32::from(code.bits())),
            SignalId::Pressure => inputs
                .pressure
                .map_or(MISSING, |code| PressureSensor::pressure(code).to_bits()),
            SignalId::CurrentFill => inputs.current_fill_ma.map_or(MISSING, i32::from),
            SignalId::CurrentVent => inputs.current_vent_ma.map_or(MISSING, i32::from),
            SignalId::Battery => inputs.battery_mv.map_or(MISSING, i32::from),
            SignalId::DutyFill => actuators.duty_fill.cast_signed(),
            SignalId::DutyVent => actuators.duty_vent.cast_signed(),
            SignalId::ControlSignal => telemetry.control_signal,
            SignalId::PreviousPressure => pressure,
            SignalId::PreviousError => error,
            SignalId::IntegralLow => integral_low,
            SignalId::Integral => integral,
            SignalId::BoostLow => boost_low,
            SignalId::Boost => boost,
            SignalId::Mode => i32::from(telemetry.mode),
            SignalId::Faults => telemetry.faults.cast_signed(),
            SignalId::EcuDigest => telemetry.ecu_digest.cast_signed(),
        }
    }
}
