//! The binary as a person meets it: commands, exit status, messages, files.

mod compare;
mod control;
mod device;
mod listings;
mod mistakes;
mod runner;
mod schemas;
mod simulate;
mod thesis;
mod tour;
