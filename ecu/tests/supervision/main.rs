//! The whole ECU on a simple rig: faults, ways into the safe state, recovery, resets.

// As the bench is shared with the tests inside.
use ecu as api;

mod bench;
mod checked_loop;
mod detection;
mod document;
mod invariants;
mod recovery;
mod reset;
mod valves;
mod ways;
mod words;
