#![doc = include_str!("../README.md")]
#![no_std]

mod anti_windup;
mod arithmetic;
mod boost;
mod compensation;
mod config;
mod control_signal;
mod direction;
mod distributor;
mod duty;
mod error;
mod fixed_config;
mod input_output;
mod integrator;
mod lower_limit;
mod pid;
mod prediction;
mod pressure;
mod pulses;
mod range;
mod setting;
mod settings;
mod state;
mod step;
mod structure;
mod table;
mod tolerance;
mod trace;

pub use compensation::{
    CoilMeasurement, DutyScale, ReleaseShift, ResistanceRatio, SupplyCompensation,
};
pub use config::Config;
pub use control_signal::ControlSignal;
pub use duty::Duty;
pub use error::{Coefficient, ConfigError, OtherMechanism, StateError};
pub use fixed;
pub use fixed_config::{FixedConfig, Mechanisms};
pub use input_output::{Input, Output};
pub use pressure::Pressure;
pub use pulses::{CoilSlowness, PulseConfig, PulseState, Slowness, pulse_step};
pub use setting::{Form, SettingSpec};
pub use settings::{
    AntiWindup, Boost, Compensation, Distributor, IntegralAtReference, LowerLimit, OpeningDuty,
    Prediction, PredictionBasis, Pulses, Settings, SwitchOff,
};
pub use state::State;
pub use step::{step, step_traced};
pub use table::Field;
pub use trace::{Activity, Saturation, Trace};
