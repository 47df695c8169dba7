//! Interface between the image and the machine it runs on.

use ecu::{Inputs, Outputs};
use hil_protocol::{FRAME_MAX, LogBytes, ResetCause, Sensors};

use crate::event::Event;
use crate::pace::Pace;
use crate::retained::Retained;

/// Machine-dependent services of the image.
///
/// A board's folder contains facts only: addresses, pins, clocks, the wiring of the [drivers](crate::drivers). All
/// decisions are made above this trait, where tests on the host cover them. No method waits longer than its
/// documentation says.
pub trait Board {
    /// Name of the board, at most 32 bytes.
    const NAME: &'static str;

    /// Returns a number that differs from build to build; 0: not known.
    fn build(&self) -> u32;

    /// Establishes the safe state: no current in either coil, in any situation.
    ///
    /// It must work at any moment, does not wait and cannot fail. Calling it again changes nothing. The same state is
    /// present at reset. The handlers of panics, faults and the watchdog reach the same outputs without this value.
    fn coils_off(&mut self);

    /// Returns the cause of the last reset, as far as the hardware reports it.
    fn reset_cause(&mut self) -> ResetCause;

    /// Returns the words that a warm reset does not change.
    fn retained(&self) -> Retained<'_>;

    /// Returns the time since a fixed moment (µs), from a hardware counter. It wraps to 0 after 2³² - 1 and never goes
    /// back.
    fn now_us(&self) -> u32;

    /// Returns the number of ticks of the sample timer, 10 ms, since the last call.
    fn take_ticks(&mut self) -> u32;

    /// Returns the time since the last tick of the sample timer (µs), measured by that timer.
    fn since_tick_us(&self) -> u32;

    /// Feeds the watchdog, which resets the machine if it is not fed again in time.
    fn feed_watchdog(&mut self, pace: Pace);

    /// Serves peripherals without interrupt and buffer in each turn of the main loop; does not wait.
    fn background(&mut self) {}

    /// Returns whether the inputs of this machine may come from the link now: always in an emulator, on a real board
    /// only while its bench jumper is fitted.
    fn may_simulate(&mut self) -> bool;

    /// Replaces the sensors' values by these, for the next [`Board::measure`].
    fn simulate(&mut self, sensors: &Sensors);

    /// Returns to the real sensors.
    fn end_simulation(&mut self);

    /// Samples all inputs through their drivers. An input that could not be measured is `None`.
    fn measure(&mut self, elapsed_us: u32) -> Inputs;

    /// Sets the duty cycles of the coils, from the next PWM period on.
    fn drive(&mut self, outputs: Outputs);

    /// Returns received data of a link, if there is any. Does not wait.
    fn receive<'a>(&mut self, buffer: &'a mut [u8; FRAME_MAX]) -> Option<Received<'a>>;

    /// Sends a frame over the link that received the last byte or frame. Does not wait: a frame without room in the
    /// queue is lost, as on any wire.
    fn send(&mut self, frame: &[u8]);

    /// Returns whether data is still being sent.
    fn is_sending(&self) -> bool;

    /// Writes an event to the log.
    fn log(&mut self, event: Event);

    /// Takes the oldest bytes of the log and returns the number of bytes lost since the start.
    fn take_log(&mut self, bytes: &mut LogBytes) -> u32;
}

/// Received data of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// One byte of a stream.
    Byte(u8),
    /// A whole frame.
    Frame(&'a [u8]),
}
