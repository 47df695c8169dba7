#![doc = include_str!("../README.md")]

mod align;
mod assets;
mod closed_loop;
mod effects;
mod examples;
mod guard;
mod history;
mod job;
mod log_reader;
mod mapping;
mod pages;
mod plant_file;
mod project;
mod pyramid;
mod refusal;
mod server;
mod session;
mod shelf;
mod store;
mod token;

pub use server::{Options, ServeError, Server, Stopper};
