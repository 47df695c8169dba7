//! Tests of the whole image on a simulated board: ticks, hosts and resets.

mod bench;
mod life;
mod link;
mod pace;
