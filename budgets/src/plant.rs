//! A simple plant: first order in the pressure, so that its numbers can be said in a line; the true one is `plant-sim`.

use ecu::{PressureSensor, SensorCode};

/// Samples between two references: half of T_req, so that most of the time the loop is on its way.
const STRETCH: usize = 25;
/// 8.4 bar gauge [2⁻¹⁶ bar].
const SUPPLY: i32 = 550_502;
/// A fully open valve closes this part of the pressure difference in a sample, as a power of two: a time constant of 160 ms.
const TIME_CONSTANT_LOG2: u32 = 4;
/// One step of the sensor, 5 mbar [2⁻¹⁶ bar]: the noise on either side.
const NOISE: i32 = 328;
/// Where the thesis' valves begin to open and are fully open [2⁻¹⁶ %].
const OPENS: i32 = 1_671_168;
const OPEN: i32 = 5_242_880;

/// What the ECU gets in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Reference [2⁻¹⁶ bar gauge].
    pub reference: i32,
    /// Chamber pressure as the sensor's curve reads the code [2⁻¹⁶ bar gauge].
    pub pressure: i32,
    /// Code of the sensor.
    pub code: SensorCode,
}

/// Two valves, a chamber and a sensor, and whoever asks for pressures: the same on every machine.
pub struct Plant {
    random: u32,
    reference: i32,
    pressure: i32,
    sample: usize,
}

impl Plant {
    /// The chamber at ambient pressure, and nothing asked for in the first stretch: an ECU waits for that after its reset.
    pub const fn new() -> Self {
        Self {
            random: 0x6c07_8965,
            reference: 0,
            pressure: 0,
            sample: 0,
        }
    }

    /// The inputs of the next sample.
    pub fn sample(&mut self) -> Sample {
        if self.sample > 0 && self.sample.is_multiple_of(STRETCH) {
            self.reference = self.below(SUPPLY);
        }
        self.sample += 1;
        let noise = self.below(2 * NOISE + 1) - NOISE;
        let code = code(self.pressure + noise);
        Sample {
            reference: self.reference,
            pressure: PressureSensor::pressure(code).to_bits(),
            code,
        }
    }

    /// The valves with these duty cycles, fill and vent [2⁻¹⁶ %], until the next sample.
    pub fn drive(&mut self, duties: [i32; 2]) {
        self.pressure += flow(duties[0], SUPPLY - self.pressure);
        self.pressure -= flow(duties[1], self.pressure);
    }

    /// Marsaglia's xorshift of 32 bits, as a value in `0..bound`.
    fn below(&mut self, bound: i32) -> i32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 17;
        self.random ^= self.random << 5;
        ((u64::from(self.random) * bound as u64) >> 32) as i32
    }
}

impl Default for Plant {
    fn default() -> Self {
        Self::new()
    }
}

/// The sensor's curve, from the pressure to the code below it.
fn code(pressure: i32) -> SensorCode {
    let gauge_pa = (i64::from(pressure) * 100_000) >> 16;
    let above_lowest = gauge_pa + PressureSensor::AMBIENT_PA - PressureSensor::LOWEST_PA;
    let bits = PressureSensor::CODE_AT_LOWEST + above_lowest / PressureSensor::STEP_PA;
    let bits = bits.clamp(0, i64::from(SensorCode::MAX.bits()));
    SensorCode::from_bits(bits as u16).unwrap_or(SensorCode::MAX)
}

/// What a valve with this duty cycle lets pass in a sample, driven by this pressure difference [2⁻¹⁶ bar].
fn flow(duty: i32, difference: i32) -> i32 {
    let lift = (duty.min(OPEN) - OPENS).max(0);
    let share = i64::from(lift) * i64::from(difference) / i64::from(OPEN - OPENS);
    (share >> TIME_CONSTANT_LOG2) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One step of the sensor [2⁻¹⁶ bar].
    const STEP: i32 = 335;

    #[test]
    fn the_pressure_is_read_within_a_step_of_the_sensor() {
        for pressure in (0..SUPPLY).step_by(1009) {
            let read = PressureSensor::pressure(code(pressure)).to_bits();
            assert!(
                (pressure - STEP..=pressure).contains(&read),
                "{pressure}: {read}"
            );
        }
    }

    #[test]
    fn the_pressure_stays_between_ambient_and_supply_however_the_valves_are_driven() {
        let mut plant = Plant::new();
        for index in 0..10_000 {
            let pressure = plant.sample().pressure;
            let (low, high) = (-NOISE - STEP, SUPPLY + NOISE);
            assert!((low..=high).contains(&pressure), "{pressure}");
            let full = [[100 << 16, 0], [0, 100 << 16], [100 << 16; 2]];
            plant.drive(full[index / 100 % 3]);
        }
    }
}
