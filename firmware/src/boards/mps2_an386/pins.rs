//! The pins of the emulated board: words that stand for what sensors show and coils get.
//!
//! ```text
//! word  0  reference [2⁻¹⁶ bar gauge]          word 32  compare value of the fill valve's PWM, of 65 535
//!       1  code of the pressure sensor              33  compare value of the vent valve's PWM, of 65 535
//!       2  current of the fill valve's coil [mA]
//!       3  current of the vent valve's coil [mA]
//!       4  supply voltage [mV]
//!       5  which of these are there, a bit each
//!      16  what to do after a reset: "test", else serve
//!      17  an accident to happen now, once: "hang" or "trap"; the handlers of watchdog and faults must do the rest
//! ```
//! In lock step the link's samples are put here; when the timer sets the pace, whoever maps the memory may do it.

use core::sync::atomic::Ordering;

use controller::Pressure;
use ecu::SensorCode;
use hil_protocol::Sensors;

use super::memory::PIN_WORDS;

const REFERENCE: usize = 0;
const PRESSURE: usize = 1;
const CURRENT_FILL: usize = 2;
const CURRENT_VENT: usize = 3;
const BATTERY: usize = 4;
const PRESENT: usize = 5;
const WISH: usize = 16;
/// Where the compare values begin.
pub(super) const COMPARE: usize = 32;

/// The wish for a self-test, "test" in ASCII.
const SELF_TEST: u32 = 0x7465_7374;

const ACCIDENT: usize = 17;
/// In ASCII, as all of these.
const HANG: u32 = 0x6861_6e67;
const TRAP: u32 = 0x7472_6170;

/// What a sound image never does.
pub(super) enum Accident {
    /// The main loop stands still.
    Hang,
    /// An instruction that there is not.
    Trap,
}

/// Puts a sample's values to the pins.
pub(super) fn simulate(sensors: &Sensors) {
    let present = put(REFERENCE, sensors.reference.map(i32::cast_unsigned))
        | put(PRESSURE, sensors.pressure.map(u32::from))
        | put(CURRENT_FILL, sensors.current_fill_ma.map(u32::from))
        | put(CURRENT_VENT, sensors.current_vent_ma.map(u32::from))
        | put(BATTERY, sensors.battery_mv.map(u32::from));
    PIN_WORDS[PRESENT].store(present, Ordering::Relaxed);
}

/// Puts a value to a pin, if there is one; its bit in the word that says so.
fn put(pin: usize, value: Option<u32>) -> u32 {
    let Some(value) = value else { return 0 };
    PIN_WORDS[pin].store(value, Ordering::Relaxed);
    1 << pin
}

/// What is asked for; none: no valid message.
pub(super) fn reference() -> Option<Pressure> {
    word(REFERENCE).map(|bits| Pressure::from_bits(bits as i32))
}

/// What the pressure sensor's converter would answer; none: it does not.
pub(super) fn pressure() -> Option<SensorCode> {
    SensorCode::from_bits(half_word(PRESSURE)?)
}

pub(super) fn current_fill_ma() -> Option<u16> {
    half_word(CURRENT_FILL)
}

pub(super) fn current_vent_ma() -> Option<u16> {
    half_word(CURRENT_VENT)
}

pub(super) fn battery_mv() -> Option<u16> {
    half_word(BATTERY)
}

/// Whether whoever started the machine wants the self-test and nothing else.
pub(super) fn self_test_is_wanted() -> bool {
    PIN_WORDS[WISH].load(Ordering::Relaxed) == SELF_TEST
}

/// The accident that whoever maps the memory wants to see, once.
pub(super) fn take_accident() -> Option<Accident> {
    let accident = match PIN_WORDS[ACCIDENT].load(Ordering::Relaxed) {
        HANG => Accident::Hang,
        TRAP => Accident::Trap,
        _ => return None,
    };
    PIN_WORDS[ACCIDENT].store(0, Ordering::Relaxed);
    Some(accident)
}

fn word(index: usize) -> Option<u32> {
    let present = PIN_WORDS[PRESENT].load(Ordering::Relaxed);
    let value = PIN_WORDS[index].load(Ordering::Relaxed);
    (present >> index & 1 == 1).then_some(value)
}

fn half_word(index: usize) -> Option<u16> {
    u16::try_from(word(index)?).ok()
}
