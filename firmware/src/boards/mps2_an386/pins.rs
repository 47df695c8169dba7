//! Pins of the emulated board: words for the values of the sensors and the duty cycles of the coils.
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
//! In lock step the link's samples are stored here; if the timer sets the pace, any program that maps the memory may
//! write them.

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
const SELF_TEST_REQUEST: usize = 16;
/// First compare value.
pub(super) const COMPARE: usize = 32;

/// Request for a self-test, "test" in ASCII.
const SELF_TEST: u32 = 0x7465_7374;

const ACCIDENT: usize = 17;
/// ASCII, like the other requests.
const HANG: u32 = 0x6861_6e67;
const TRAP: u32 = 0x7472_6170;

/// Deliberate failure that a healthy image never has.
pub(super) enum Accident {
    /// The main loop stops.
    Hang,
    /// The processor executes an undefined instruction.
    Trap,
}

/// Stores a sample's values in the pins.
pub(super) fn simulate(sensors: &Sensors) {
    let present = put(REFERENCE, sensors.reference.map(i32::cast_unsigned))
        | put(PRESSURE, sensors.pressure.map(u32::from))
        | put(CURRENT_FILL, sensors.current_fill_ma.map(u32::from))
        | put(CURRENT_VENT, sensors.current_vent_ma.map(u32::from))
        | put(BATTERY, sensors.battery_mv.map(u32::from));
    PIN_WORDS[PRESENT].store(present, Ordering::Relaxed);
}

/// Stores a value in a pin, if there is one, and returns its presence bit.
fn put(pin: usize, value: Option<u32>) -> u32 {
    let Some(value) = value else { return 0 };
    PIN_WORDS[pin].store(value, Ordering::Relaxed);
    1 << pin
}

/// Returns the reference; `None`: no valid message.
pub(super) fn reference() -> Option<Pressure> {
    word(REFERENCE).map(|bits| Pressure::from_bits(bits as i32))
}

/// Returns the code that the pressure sensor's converter would give; `None`: it does not answer.
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

/// Returns whether the program that started the machine requests the self-test only.
pub(super) fn self_test_is_wanted() -> bool {
    PIN_WORDS[SELF_TEST_REQUEST].load(Ordering::Relaxed) == SELF_TEST
}

/// Takes the deliberate failure that the host requests, once.
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
