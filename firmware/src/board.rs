//! The contract between the image and the machine it runs on.

use ecu::{Inputs, Outputs};
use hil_protocol::{FRAME_MAX, LogBytes, ResetCause, Sensors};

use crate::event::Event;
use crate::pace::Pace;
use crate::retained::Retained;

/// What the image asks of a machine.
///
/// A board's folder holds facts only: addresses, pins, clocks, the wiring of the [drivers](crate::drivers). What to do with
/// them is decided above this trait, where the host's tests see it. No method waits longer than it says.
pub trait Board {
    /// The board's name, at most 32 bytes.
    const NAME: &'static str;

    /// A number that differs from build to build; 0: not known.
    fn build(&self) -> u32;

    /// The safe state: no current in either coil, whatever ran before.
    ///
    /// Must work at any moment, does not wait and cannot fail. Calling it again changes nothing. It is the state at reset.
    /// The handlers of panics, faults and the watchdog reach the same outputs without this value.
    fn coils_off(&mut self);

    /// Why the machine started, as far as the hardware tells.
    fn reset_cause(&mut self) -> ResetCause;

    /// The words that a warm reset leaves alone.
    fn retained(&self) -> Retained<'_>;

    /// Time since some moment \[µs\], from a hardware counter; goes on at 0 after 2³² - 1. Never goes back.
    fn now_us(&self) -> u32;

    /// How often the sample timer, 10 ms, has come since the last call.
    fn take_ticks(&mut self) -> u32;

    /// Time since the sample timer came last \[µs\], by that timer itself.
    fn since_tick_us(&self) -> u32;

    /// Tells the watchdog that all is well; it resets the machine if this is not said again in time.
    fn feed_watchdog(&mut self, pace: Pace);

    /// A little work with each turn of the main loop, for what neither interrupts nor buffers; does not wait.
    fn background(&mut self) {}

    /// Whether the inputs of this machine may come from the link at this moment: always in an emulator, on a real board
    /// only while its bench jumper is fitted.
    fn may_simulate(&mut self) -> bool;

    /// Puts these values where the sensors' values come from, for the next [`Board::measure`].
    fn simulate(&mut self, sensors: &Sensors);

    /// Back to the real sensors.
    fn end_simulation(&mut self);

    /// One sample of all inputs, through their drivers. What could not be measured is none.
    fn measure(&mut self, elapsed_us: u32) -> Inputs;

    /// Gives the coils their duty cycles, from the next PWM period on.
    fn drive(&mut self, outputs: Outputs);

    /// What came over a link, if anything did. Does not wait.
    fn receive<'a>(&mut self, buffer: &'a mut [u8; FRAME_MAX]) -> Option<Received<'a>>;

    /// Sends a frame over the link from which the last byte or frame came. Does not wait: a frame for which there is no
    /// room is lost, as on any wire.
    fn send(&mut self, frame: &[u8]);

    /// Whether something of what was sent has not left yet.
    fn is_sending(&self) -> bool;

    /// Writes an event to the log.
    fn log(&mut self, event: Event);

    /// Takes the oldest bytes of the log; says how many were lost since the start.
    fn take_log(&mut self, bytes: &mut LogBytes) -> u32;
}

/// What came over a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// One byte of a stream.
    Byte(u8),
    /// A whole frame.
    Frame(&'a [u8]),
}
