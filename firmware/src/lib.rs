//! How does the controller live on an ECU?
//!
//! ```text
//!            converter, currents,                      valves
//!            battery, reference                     (drivers::Valve)
//!                   │ Inputs                              ▲ Outputs
//!                   ▼                                     │
//!  sample ──► ┌─────────────────────── Image ─────────────────────────┐ ◄──► link: hil-protocol
//!  timer      │ settings, Ecu, black box, timing: ecu::device         │      (UART, mailbox)
//!             └───────────────────────────────────────────────────────┘ ──► log
//! ```
//! A board ([`Board`]) holds facts; [`Image`] decides what to do with them and runs in the host's tests as well as on the
//! target; [`drivers`] are written over `embedded-hal` alone. The binary beside this library is one board and its [`Image`].
//!
//! One loop, one thread of control: the sample has precedence at the top of the loop, and whatever else the loop does
//! between two samples is short. Interrupts only count ticks and move bytes. So nothing is shared but counters and queues,
//! nothing can be locked, and the stack has one bound.

#![cfg_attr(not(test), no_std)]

mod board;
mod byte_ring;
mod control_task;
pub mod drivers;
mod event;
mod image;
mod log_ring;
mod measurement;
mod punctuality;
mod retained;
mod rzcobs;
pub mod self_test;

pub use board::{Board, Pace, Received};
pub use byte_ring::ByteRing;
pub use event::Event;
pub use image::{BLACK_BOX_WORDS, Image, Life};
pub use log_ring::LogRing;
pub use punctuality::{FIRST_SIGNAL, SIGNALS};
pub use retained::{Farewell, Retained, Start, WORDS as RETAINED_WORDS};
pub use rzcobs::Rzcobs;
