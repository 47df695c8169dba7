//! Claims about the whole image, on a board that a test makes up: what it does with ticks, hosts and resets.

mod bench;
mod life;
mod link;
mod pace;
