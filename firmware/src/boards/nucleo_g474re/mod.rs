//! ST NUCLEO-G474RE: an STM32G474RE (Cortex-M4F, 170 MHz) with debugger and serial port on the board. `docs/board.md`
//! has the wiring and the points that may be wrong. This board support was never run on hardware; the CI builds it.
//!
//! Section numbers refer to ST's reference manual RM0440.

mod analog;
mod clock;
mod converter;
mod flash;
mod start;
mod timer;
mod uart;
mod watchdog;

use cortex_m_rt::{entry, exception};
use ecu::{Inputs, Outputs, ResetCause};
use firmware::drivers::{Mcp3201, Valve};
use firmware::{Board, Event, Image, NextAction, Pace, Received, ResetReason, Retained};
use hil_protocol::{FRAME_MAX, LogBytes, Sensors};

use crate::build_number::build_number;
use crate::handlers;
use crate::log;
use crate::retained_ram;

pub(crate) use start::coils_off;
pub(crate) use timer::now_us;

/// Size of the black box in `board.x` (bytes).
pub(crate) const BLACK_BOX_ROOM: usize = 23 * 1024;

defmt::timestamp!("{=u32:us}", now_us());

struct NucleoG474Re {
    fill: Valve<start::FillPwm>,
    vent: Valve<start::VentPwm>,
    converter: Mcp3201<converter::Bus>,
    analog: analog::Analog,
    bench_jumper: start::BenchJumper,
    reset_cause: ResetCause,
    /// Values from the link that replace the sensors'.
    simulated: Option<Inputs>,
}

impl Board for NucleoG474Re {
    const NAME: &'static str = "nucleo-g474re";

    fn build(&self) -> u32 {
        build_number()
    }

    fn coils_off(&mut self) {
        coils_off();
    }

    fn reset_cause(&mut self) -> ResetCause {
        self.reset_cause
    }

    fn retained(&self) -> Retained<'_> {
        retained_ram::retained()
    }

    fn now_us(&self) -> u32 {
        now_us()
    }

    fn take_ticks(&mut self) -> u32 {
        timer::take_ticks()
    }

    fn since_tick_us(&self) -> u32 {
        timer::since_tick_us()
    }

    fn feed_watchdog(&mut self, pace: Pace) {
        watchdog::feed(pace);
    }

    fn background(&mut self) {
        self.analog.poll();
    }

    fn may_simulate(&mut self) -> bool {
        self.bench_jumper.is_high()
    }

    fn simulate(&mut self, sensors: &Sensors) {
        self.simulated = Some(Inputs::from(*sensors));
    }

    fn end_simulation(&mut self) {
        self.simulated = None;
    }

    fn measure(&mut self, elapsed_us: u32) -> Inputs {
        let means = self.analog.take();
        if let Some(inputs) = self.simulated {
            return Inputs {
                elapsed_us,
                ..inputs
            };
        }
        Inputs {
            elapsed_us,
            reference: means.reference,
            pressure: self.converter.read().ok(),
            current_fill_ma: means.current_fill_ma,
            current_vent_ma: means.current_vent_ma,
            battery_mv: means.battery_mv,
        }
    }

    fn drive(&mut self, outputs: Outputs) {
        let Ok(()) = self.fill.drive(outputs.duty_fill);
        let Ok(()) = self.vent.drive(outputs.duty_vent);
        start::connect_coils();
    }

    fn receive<'a>(&mut self, _: &'a mut [u8; FRAME_MAX]) -> Option<Received<'a>> {
        uart::receive().map(Received::Byte)
    }

    fn send(&mut self, frame: &[u8]) {
        uart::send(frame);
    }

    fn is_sending(&self) -> bool {
        uart::is_sending()
    }

    fn log(&mut self, event: Event) {
        log::log(event);
    }

    fn take_log(&mut self, bytes: &mut LogBytes) -> u32 {
        log::take(bytes)
    }
}

#[entry]
fn main() -> ! {
    // Neither can be taken twice before the next reset.
    if let (Some((board, flash)), Some(black_box)) = (start::start(), retained_ram::black_box()) {
        let mut image = Image::start(board, flash, black_box);
        while image.turn() == NextAction::Continue {}
    }
    #[cfg(feature = "panic-canary")]
    handlers::sing();
    handlers::end(ResetReason::Requested)
}

/// Ends the run: no other interrupt is enabled.
// SAFETY: cortex-m-rt demands the signature. The handler touches only what `handlers::end` touches.
#[exception]
unsafe fn DefaultHandler(_: i16) {
    handlers::end(ResetReason::Exception { pc: 0 })
}

/// Handles two wrong bits in a word, found by the flash's error correction (section 3.3.4). In the settings' pages the
/// cause is a loss of supply during a write: the copy fails its checksum, and the other copy is whole. Anywhere else
/// the run ends.
// SAFETY: cortex-m-rt demands the signature. The handler touches only the error flag, and what `handlers::end` touches.
#[exception]
unsafe fn NonMaskableInt() {
    if !flash::forgive_torn_settings() {
        handlers::end(ResetReason::Exception { pc: 0 })
    }
}
