//! Tests of the wire format and of its robustness.

mod flips;
mod frames;
mod garbage;
mod link;
mod mailbox;
mod messages;
#[path = "../properties/mod.rs"]
mod properties;
mod sessions;
mod stepper;
mod worked_example;
