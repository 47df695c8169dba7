//! Start of the board: clocks, pins, and the assignment of the peripherals.

use cortex_m::peripheral::{NVIC, Peripherals as Core};
use ecu::ResetCause;
use firmware::drivers::{Mcp3201, Valve};
use stm32g4xx_hal::gpio::{AF6, Input, PA8, PA9, PC8};
use stm32g4xx_hal::prelude::*;
use stm32g4xx_hal::pwm::{ActiveHigh, C1, C2, ComplementaryDisabled, Pwm};
use stm32g4xx_hal::spi::MODE_0;
use stm32g4xx_hal::stm32::{Interrupt, Peripherals, RCC, TIM1};
use stm32g4xx_hal::time::RateExtU32;

use super::flash::Flash;
use super::{NucleoG474Re, analog, clock, converter, timer, uart};

pub(super) type FillPwm = Pwm<TIM1, C1, ComplementaryDisabled, ActiveHigh, ActiveHigh>;
pub(super) type VentPwm = Pwm<TIM1, C2, ComplementaryDisabled, ActiveHigh, ActiveHigh>;
pub(super) type BenchJumper = PC8<Input>;

/// PWM frequency f_PWM (Hz).
const PWM_HZ: u32 = 100;

/// SPI clock of the converter (Hz): below its limit of 1.6 MHz at 5 V, the next frequency that the bus can divide to.
const SPI_HZ: u32 = 1_400_000;

/// Takes the peripherals and wires them; returns `None` if they were taken before. Both coils stay off.
pub(super) fn start() -> Option<(NucleoG474Re, Flash)> {
    let core = Core::take()?;
    let device = Peripherals::take()?;
    let reset_cause = reset_cause(&device.RCC);

    let mut rcc = clock::start(device.RCC, &device.PWR, &device.FLASH);
    timer::start_clock(device.TIM2, &mut rcc);

    let port_a = device.GPIOA.split(&mut rcc);
    let port_b = device.GPIOB.split(&mut rcc);
    let port_c = device.GPIOC.split(&mut rcc);

    // Converter of the pressure sensor.
    let bus = device.SPI2.spi(
        (
            port_b.pb13.into_alternate(),
            port_b.pb14.into_alternate(),
            port_b.pb15.into_alternate(),
        ),
        MODE_0,
        SPI_HZ.Hz(),
        &mut rcc,
    );
    let converter = Mcp3201::new(converter::Bus::new(
        bus,
        port_b.pb12.into_push_pull_output(),
    ));

    // Converter of the processor.
    let inputs = analog::Pins {
        lever: port_a.pa0.into_analog(),
        battery: port_a.pa1.into_analog(),
        current_fill: port_c.pc0.into_analog(),
        current_vent: port_c.pc1.into_analog(),
    };
    let mut delay = core.SYST.delay(&rcc.clocks);
    let analog = analog::Analog::start(
        device.ADC1,
        device.ADC12_COMMON,
        &inputs,
        &mut delay,
        &mut rcc,
    );

    // Link through the debugger's serial port.
    uart::start(
        device.USART2,
        port_a.pa2.into_alternate(),
        port_a.pa3.into_alternate(),
        &mut rcc,
    );

    // Coils, last.
    let pins: (PA8<AF6>, PA9<AF6>) = (port_a.pa8.into_alternate(), port_a.pa9.into_alternate());
    let (mut fill, mut vent) = device.TIM1.pwm(pins, PWM_HZ.Hz(), &mut rcc);
    coils_off();
    let _ = (
        fill.set_duty_cycle_fully_off(),
        vent.set_duty_cycle_fully_off(),
    );
    fill.enable();
    vent.enable();
    timer::start_ticks();
    for interrupt in [Interrupt::TIM1_UP_TIM16, Interrupt::USART2] {
        // SAFETY: no critical section relies on these interrupts being masked.
        unsafe { NVIC::unmask(interrupt) }
    }
    let Ok(fill) = Valve::new(fill);
    let Ok(vent) = Valve::new(vent);
    let board = NucleoG474Re {
        fill,
        vent,
        converter,
        analog,
        bench_jumper: port_c.pc8.into_pull_down_input(),
        reset_cause,
        simulated: None,
    };
    Some((board, Flash::new(device.FLASH)))
}

/// Returns the cause given by the reset flags (section 7.4.30), the most specific first, and clears the flags.
fn reset_cause(rcc: &RCC) -> ResetCause {
    let flags = rcc.csr().read();
    let cause = if flags.iwdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() {
        ResetCause::Watchdog
    } else if flags.sftrstf().bit_is_set() {
        ResetCause::Software
    } else if flags.borrstf().bit_is_set() {
        // This flag is also set at power-on: the part does not distinguish brownout and power-on.
        ResetCause::PowerOn
    } else if flags.pinrstf().bit_is_set() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    };
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    cause
}

/// Establishes the safe state from anywhere. Both outputs are disconnected from the timer at once, and the pull-downs
/// at the gates keep them low. The compare values are zero for the time when the outputs are connected again.
pub(crate) fn coils_off() {
    // SAFETY: plain stores to a timer whose registers are not read back; code that is interrupted while it changes a
    // duty cycle does not continue, or finds the coils off.
    let timer = unsafe { &*TIM1::ptr() };
    timer.bdtr().modify(|_, w| w.moe().clear_bit());
    timer.ccr1().reset();
    timer.ccr2().reset();
}

/// Connects the outputs to the timer again.
pub(super) fn connect_coils() {
    // SAFETY: one bit of a register that is otherwise written at the start and in `coils_off` only, which ends the run.
    let timer = unsafe { &*TIM1::ptr() };
    timer.bdtr().modify(|_, w| w.moe().set_bit());
}
