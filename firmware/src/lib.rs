#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), no_std)]

mod board;
mod byte_ring;
mod control_task;
pub mod drivers;
mod event;
mod image;
mod log_ring;
mod measurement;
mod pace;
mod punctuality;
mod retained;
mod rzcobs;
pub mod self_test;

pub use board::{Board, Received};
pub use byte_ring::ByteRing;
pub use event::Event;
pub use image::{BLACK_BOX_WORDS, Image, NextAction};
pub use log_ring::LogRing;
pub use pace::Pace;
pub use punctuality::{FIRST_SIGNAL, SIGNALS};
pub use retained::{ResetReason, Retained, Start, WORDS as RETAINED_WORDS};
pub use rzcobs::Rzcobs;
