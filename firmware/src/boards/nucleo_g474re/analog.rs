//! The processor's converter: it measures lever, supply voltage and the two coil currents, continuously.
//!
//! The hardware converts each of the four channels 16 times and sums the results up, in 98 µs. All four take 0.4 ms, so
//! that a mean over a PWM period has about 25 of each. The converter waits until its last result was read. Therefore no
//! result is lost or assigned to another channel, at any delay of the loop.

use controller::Pressure;
use firmware::drivers::analog::{Mean, lever_reference, scaled};
use stm32g4xx_hal::adc::config::{
    ClockMode, Continuous, OverSampling, OverSamplingShift, SampleTime, Sequence,
};
use stm32g4xx_hal::adc::{AdcClaim, AdcCommonExt};
use stm32g4xx_hal::delay::SystDelay;
use stm32g4xx_hal::gpio::{Analog as AnalogPin, PA0, PA1, PC0, PC1};
use stm32g4xx_hal::rcc::Rcc;
use stm32g4xx_hal::stm32::{ADC1, ADC12_COMMON};

/// Full scale of the supply voltage (mV): divider 10 : 1 before 3.3 V.
const BATTERY_FULL_SCALE_MV: u16 = 36_300;
/// Full scale of a coil current (mA): shunt and amplifier give 3.3 V per ampere.
const CURRENT_FULL_SCALE_MA: u16 = 1000;

const CHANNELS: usize = 4;

/// Pins of the four inputs.
pub(super) struct Pins {
    pub(super) lever: PA0<AnalogPin>,
    pub(super) battery: PA1<AnalogPin>,
    pub(super) current_fill: PC0<AnalogPin>,
    pub(super) current_vent: PC1<AnalogPin>,
}

/// Means since the last sample; `None`: nothing was converted.
pub(super) struct Means {
    pub(super) reference: Option<Pressure>,
    pub(super) battery_mv: Option<u16>,
    pub(super) current_fill_ma: Option<u16>,
    pub(super) current_vent_ma: Option<u16>,
}

pub(super) struct Analog {
    means: [Mean; CHANNELS],
    /// Channel of the next result.
    channel: usize,
}

impl Analog {
    pub(super) fn start(
        converter: ADC1,
        common: ADC12_COMMON,
        pins: &Pins,
        delay: &mut SystDelay,
        rcc: &mut Rcc,
    ) -> Self {
        let common = common.claim(ClockMode::AdcHclkDiv4, rcc);
        let mut adc = common.claim(converter, delay);
        adc.set_continuous(Continuous::Continuous);
        adc.set_auto_delay(true);
        adc.set_oversampling(OverSampling::Ratio_16, OverSamplingShift::Shift_4);
        let time = SampleTime::Cycles_247_5;
        adc.reset_sequence();
        adc.configure_channel(&pins.lever, Sequence::One, time);
        adc.configure_channel(&pins.battery, Sequence::Two, time);
        adc.configure_channel(&pins.current_fill, Sequence::Three, time);
        adc.configure_channel(&pins.current_vent, Sequence::Four, time);
        adc.enable().start_conversion();
        Self {
            means: [Mean::new(); CHANNELS],
            channel: 0,
        }
    }

    /// Reads a result, if there is one.
    pub(super) fn poll(&mut self) {
        // SAFETY: after the start no other code uses the converter.
        let converter = unsafe { &*ADC1::ptr() };
        if !converter.isr().read().eoc().bit_is_set() {
            return;
        }
        let code = converter.dr().read().rdata().bits();
        if let Some(mean) = self.means.get_mut(self.channel) {
            mean.add(code);
        }
        self.channel = self.channel.wrapping_add(1) % CHANNELS;
    }

    pub(super) fn take(&mut self) -> Means {
        let [lever, battery, fill, vent] = self.means.each_mut().map(Mean::take);
        let current = |code| scaled(code, CURRENT_FULL_SCALE_MA);
        Means {
            reference: lever.and_then(lever_reference),
            battery_mv: battery.map(|code| scaled(code, BATTERY_FULL_SCALE_MV)),
            current_fill_ma: fill.map(current),
            current_vent_ma: vent.map(current),
        }
    }
}
