#![doc = include_str!("../README.md")]

mod align;
mod assets;
mod calculated;
mod closed_loop;
mod connections;
mod effects;
mod examples;
mod formula;
mod guard;
mod histogram;
mod history;
mod job;
mod lock;
mod log_reader;
mod loopback;
mod mapping;
mod named_plant;
mod names;
mod pages;
mod plant_file;
mod project;
mod pyramid;
mod refusal;
mod resample;
mod results;
mod server;
mod session;
mod shelf;
mod shown_unit;
mod spectrum;
mod store;
mod token;
mod tolerance;

pub use server::{Options, ServeError, Server, Stopper};
pub use store::FolderError;
