//! Black-box tests of the binary: commands, exit status, messages, files.

mod compare;
mod control;
#[cfg(unix)]
mod damage;
mod demo;
mod device;
mod diagnose;
mod files;
#[cfg(feature = "image-in-the-loop")]
mod image;
mod inspect;
mod listings;
mod mf4;
mod mistakes;
mod monte_carlo;
mod next_experiment;
mod own_effects;
mod report;
mod rigs;
mod runner;
mod schemas;
mod serve;
mod simulate;
mod simulation_start;
mod thesis;
mod tune;
