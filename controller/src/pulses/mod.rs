//! Model-based pulses: in each sample the one pulse that lands on the reference (docs/equations.md).
//!
//! One file for each mechanism: `flow` (pressure in units of open time), `pulse_table` (open time of a pulse), `run`
//! (pulses under way), `adaptation` (gain and opening delay of each valve, lag of the pressure), `leak` (drift while both
//! valves are shut), `valve` (one valve with all of these), `choice` (pulse of a sample).

mod adaptation;
mod choice;
mod config;
mod flow;
mod leak;
mod pulse_table;
mod run;
mod state;
mod tables;
mod valve;

pub use choice::pulse_step;
pub use config::PulseConfig;
pub use pulse_table::{CoilSlowness, Slowness};
pub use state::PulseState;
