//! Tests of the wire format and of its robustness.

mod flips;
mod frames;
mod garbage;
mod link;
mod mailbox;
mod messages;
#[path = "../promise/mod.rs"]
mod promise;
mod sessions;
mod stepper;
mod worked_example;
