//! Complete ECU on a simple rig: faults, fault reactions, recovery, resets.

// The bench is shared with the tests inside the crate, which use this name.
use ecu as api;

mod bench;
mod checked_loop;
mod compensation;
mod detection;
mod document;
mod invariants;
mod one_place;
mod page;
mod pulses;
mod reactions;
mod recovery;
mod reset;
mod settings_page;
mod valves;
mod words;
