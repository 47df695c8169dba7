//! Arm MPS2 with the AN386 image: the Cortex-M4F machine that QEMU emulates (`-machine mps2-an386`).
//!
//! The machine has no coil drivers, no converter and no flash. They are simulated in memory that the host can map as
//! well ([`pins`], `memory.x`), behind the same drivers as on a real board. Its two user LEDs show the coils: LED 0 is
//! lit for a duty cycle above zero of the fill valve's coil, LED 1 for the vent valve's.
//!
//! The clock is 25 MHz for all parts (application note AN386, "Clocks").

mod converter;
mod flash;
mod memory;
mod pins;
mod pwm;
mod register;
mod self_test;
mod timer;
mod uart;
mod watchdog;

use core::sync::atomic::AtomicU32;

use cortex_m_rt::{entry, exception};
use ecu::{Inputs, Outputs, ResetCause};
use firmware::drivers::{Mcp3201, Valve};
use firmware::{Board, Event, Image, NextAction, Pace, Received, Retained};
use hil_protocol::mailbox::{self, Mailbox};
use hil_protocol::{FRAME_MAX, LogBytes, Sensors};

use crate::build_number::build_number;
use crate::handlers;
use crate::log;
use crate::retained_ram;
use converter::Converter;
use firmware::ResetReason;
use flash::Flash;
use pins::Accident;
use pwm::Pwm;

pub(crate) use timer::now_us;

/// Size of the black box in `board.x` (bytes).
pub(crate) const BLACK_BOX_ROOM: usize = 28 * 1024;

defmt::timestamp!("{=u32:us}", now_us());

/// Link that received the last data.
enum Link {
    Mailbox,
    Uart,
}

struct Mps2An386 {
    converter: Mcp3201<Converter>,
    fill: Valve<Pwm>,
    vent: Valve<Pwm>,
    mailbox: Mailbox<&'static [AtomicU32; mailbox::WORDS]>,
    link: Link,
}

impl Mps2An386 {
    fn new() -> Self {
        timer::start();
        uart::start();
        let Ok(fill) = Valve::new(Pwm::FILL);
        let Ok(vent) = Valve::new(Pwm::VENT);
        Self {
            converter: Mcp3201::new(Converter),
            fill,
            vent,
            mailbox: Mailbox::device(&memory::MAILBOX),
            link: Link::Mailbox,
        }
    }
}

impl Board for Mps2An386 {
    const NAME: &'static str = "mps2-an386";

    fn build(&self) -> u32 {
        build_number()
    }

    fn coils_off(&mut self) {
        coils_off();
    }

    fn reset_cause(&mut self) -> ResetCause {
        // No register reports it. Only the reason that the image stores before it resets the machine is known.
        ResetCause::Unknown
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
        uart::poll();
        match pins::take_accident() {
            Some(Accident::Hang) => loop {
                core::hint::spin_loop();
            },
            Some(Accident::Trap) => cortex_m::asm::udf(),
            None => {}
        }
    }

    fn may_simulate(&mut self) -> bool {
        true
    }

    fn simulate(&mut self, sensors: &Sensors) {
        pins::simulate(sensors);
    }

    fn end_simulation(&mut self) {
        // The simulated sensors are the only ones.
    }

    fn measure(&mut self, elapsed_us: u32) -> Inputs {
        Inputs {
            elapsed_us,
            reference: pins::reference(),
            pressure: self.converter.read().ok(),
            current_fill_ma: pins::current_fill_ma(),
            current_vent_ma: pins::current_vent_ma(),
            battery_mv: pins::battery_mv(),
        }
    }

    fn drive(&mut self, outputs: Outputs) {
        let Ok(()) = self.fill.drive(outputs.duty_fill);
        let Ok(()) = self.vent.drive(outputs.duty_vent);
    }

    fn receive<'a>(&mut self, buffer: &'a mut [u8; FRAME_MAX]) -> Option<Received<'a>> {
        if let Some(frame) = self.mailbox.receive(buffer) {
            self.link = Link::Mailbox;
            return Some(Received::Frame(frame));
        }
        let byte = uart::receive()?;
        self.link = Link::Uart;
        Some(Received::Byte(byte))
    }

    fn send(&mut self, frame: &[u8]) {
        match self.link {
            // The host repeats a request whose answer it did not get.
            Link::Mailbox => drop(self.mailbox.send(frame)),
            Link::Uart => uart::send(frame),
        }
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

/// Establishes the safe state from anywhere: see [`Board::coils_off`].
pub(crate) fn coils_off() {
    Pwm::all_off();
}

#[entry]
fn main() -> ! {
    coils_off();
    if self_test::is_wanted() {
        self_test::run();
    }
    if let Some(black_box) = retained_ram::black_box() {
        let flash = Flash::start(!retained_ram::retained().is_warm());
        let mut image = Image::start(Mps2An386::new(), flash, black_box);
        while image.turn() == NextAction::Continue {}
    }
    #[cfg(feature = "panic-canary")]
    handlers::sing();
    handlers::end(ResetReason::Requested)
}

/// Handles the timer's tick and the serial port's bytes.
// SAFETY: cortex-m-rt demands the signature. The handler touches only counters and queues that are made for it.
#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    match interrupt {
        uart::RECEIVED => uart::on_received(),
        timer::TICK => timer::on_tick(),
        // No other interrupt is enabled.
        _ => handlers::end(ResetReason::Exception { pc: 0 }),
    }
}

/// Handles the watchdog's warning. It ends the run at the first warning: the coils are not left to a partly working
/// image.
// SAFETY: cortex-m-rt demands the signature. The handler never returns, and touches only the outputs, the retained words
// and the reset.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    handlers::end(ResetReason::Watchdog)
}
