//! Simple plant of first order in the pressure, with few parameters; the detailed plant is `plant-sim`.

use ecu::{PressureSensor, SensorCode};

/// Number of samples between two references: half of T_req, so that the loop is in motion most of the time.
const STRETCH: usize = 25;
/// Supply pressure, 8.4 bar gauge (2⁻¹⁶ bar).
const SUPPLY: i32 = 550_502;
/// Share of the pressure difference that a fully open valve closes in a sample, as a power of two: a time constant of
/// 160 ms.
const TIME_CONSTANT_LOG2: u32 = 4;
/// Noise in either direction, one step of the sensor: 5 mbar (2⁻¹⁶ bar).
const NOISE: i32 = 328;
/// Duty cycles at which the thesis' valves begin to open and are fully open (2⁻¹⁶ %).
const OPENS: i32 = 1_671_168;
const OPEN: i32 = 5_242_880;

/// Inputs of the ECU in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Reference (2⁻¹⁶ bar gauge).
    pub reference: i32,
    /// Chamber pressure as the sensor's curve converts the code (2⁻¹⁶ bar gauge).
    pub pressure: i32,
    /// Code of the sensor.
    pub code: SensorCode,
}

/// Two valves, a chamber, a sensor, and a source of references: identical on every machine.
pub struct Plant {
    random: u32,
    reference: i32,
    pressure: i32,
    sample: usize,
}

impl Plant {
    /// Creates the plant: the chamber at ambient pressure, and reference 0 in the first interval, which an ECU requires
    /// after its reset.
    pub const fn new() -> Self {
        Self {
            random: 0x6c07_8965,
            reference: 0,
            pressure: 0,
            sample: 0,
        }
    }

    /// Returns the inputs of the next sample.
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

    /// Drives the valves with these duty cycles, fill and vent (2⁻¹⁶ %), until the next sample.
    pub fn drive(&mut self, duties: [i32; 2]) {
        self.pressure += flow(duties[0], SUPPLY - self.pressure);
        self.pressure -= flow(duties[1], self.pressure);
    }

    /// Returns a random number in `0..bound`, from Marsaglia's xorshift of 32 bits.
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

/// Returns the sensor's code below a pressure.
fn code(pressure: i32) -> SensorCode {
    let gauge_pa = (i64::from(pressure) * 100_000) >> 16;
    let above_lowest = gauge_pa + PressureSensor::AMBIENT_PA - PressureSensor::LOWEST_PA;
    let bits = PressureSensor::CODE_AT_LOWEST + above_lowest / PressureSensor::STEP_PA;
    let bits = bits.clamp(0, i64::from(SensorCode::MAX.bits()));
    SensorCode::from_bits(bits as u16).unwrap_or(SensorCode::MAX)
}

/// Returns the pressure change through a valve with this duty cycle in a sample, for this pressure difference (2⁻¹⁶
/// bar).
fn flow(duty: i32, difference: i32) -> i32 {
    let lift = (duty.min(OPEN) - OPENS).max(0);
    let share = i64::from(lift) * i64::from(difference) / i64::from(OPEN - OPENS);
    (share >> TIME_CONSTANT_LOG2) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One step of the sensor (2⁻¹⁶ bar).
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
