//! Clock of the processor: 170 MHz from the internal oscillator; after a reset it is 16 MHz.
//!
//! f_VCO = f_HSI · N / M and f_SYS = f_VCO / R (register PLLCFGR, section 7.4.4). The frequency is within 1 % over
//! temperature (data sheet DS12288, HSI16). The sample time may have the same deviation, and the start does not wait
//! for a crystal. The HAL can set clocks up in any order and panics for invalid ones; here the order is that of the
//! manual, and nothing can panic.

use stm32g4xx_hal::rcc::{Clocks, PLLClocks, Rcc, RccExt};
use stm32g4xx_hal::stm32::{FLASH, PWR, RCC};
use stm32g4xx_hal::time::{Hertz, RateExtU32};

/// Frequency of the internal oscillator (Hz).
const HSI_HZ: u32 = 16_000_000;
/// f_SYS (Hz): divided by M = 4, times N = 85, divided by R = 2.
pub(super) const HZ: u32 = HSI_HZ / 4 * 85 / 2;

/// Sets the clock up. The returned value contains the frequencies.
pub(super) fn start(registers: RCC, power: &PWR, flash: &FLASH) -> Rcc {
    let mut rcc = registers.constrain();
    rcc.pllcfgr().write(|w| {
        w.pllsrc().hsi16().pllm().div4().plln().div85();
        w.pllr().div2().pllren().set_bit()
    });
    rcc.cr().modify(|_, w| w.pllon().on());
    while rcc.cr().read().pllrdy().bit_is_clear() {}
    to_full_speed(&rcc, power, flash);
    rcc.clocks = clocks();
    rcc
}

/// Changes from range 1 to its boost mode, which is required from 150 MHz on: the sequence of section 6.1.5.
fn to_full_speed(rcc: &RCC, power: &PWR, flash: &FLASH) {
    rcc.apb1enr1().modify(|_, w| w.pwren().set_bit());
    // The bit takes effect two clocks later (section 7.2.17).
    let _ = rcc.apb1enr1().read();
    rcc.cfgr().modify(|_, w| w.hpre().div2());
    power.cr5().modify(|_, w| w.r1mode().clear_bit());
    // Up to 170 MHz in boost mode: four wait states (section 3.3.3). They are in effect once they are read back.
    flash.acr().modify(|_, w| w.latency().wait4());
    while !flash.acr().read().latency().is_wait4() {}
    rcc.cfgr().modify(|_, w| w.sw().pll());
    while !rcc.cfgr().read().sws().is_pll() {}
    // At least a microsecond at half the speed.
    cortex_m::asm::delay(HZ / 1_000_000);
    rcc.cfgr().modify(|_, w| w.hpre().div1());
}

/// Returns the frequencies of the buses: none is divided, all run at one frequency.
fn clocks() -> Clocks {
    let system: Hertz = HZ.Hz();
    Clocks {
        sys_clk: system,
        core_clk: system,
        ahb_clk: system,
        apb1_clk: system,
        apb1_tim_clk: system,
        apb2_clk: system,
        apb2_tim_clk: system,
        pll_clk: PLLClocks {
            r: Some(system),
            q: None,
            p: None,
        },
    }
}
