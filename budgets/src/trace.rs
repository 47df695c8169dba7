//! What every candidate is fed: the inputs of one closed loop, the thesis' controller on a simple plant.
//!
//! All candidates see the same pressures, whatever they answer: one that rounds differently does not get an easier way. The
//! plant is of first order in the pressure, so that its numbers can be said in a line; the true one is `plant-sim`.

use controller::{FixedConfig, State};

use crate::ours::{Thesis, fixed, full_step, in_words};

/// Samples of the trace.
pub const SAMPLES: usize = 102_400;

/// Samples between two references: half of T_req, so that most of the time the loop is on its way.
const STRETCH: usize = 25;
/// 8.4 bar gauge [2⁻¹⁶ bar].
const SUPPLY: i32 = 550_502;
/// A fully open valve closes this part of the pressure difference in a sample, as a power of two: a time constant of 160 ms.
const TIME_CONSTANT_LOG2: u32 = 4;
/// One step of a 12-bit sensor over 20.4 bar, 5 mbar [2⁻¹⁶ bar]: the noise on either side.
const NOISE: i32 = 328;
/// Where the thesis' valves begin to open and are fully open [2⁻¹⁶ %].
const OPENS: i32 = 1_671_168;
const OPEN: i32 = 5_242_880;

const CONTROLLER: FixedConfig<Thesis> = fixed();

/// The loop: an endless sequence of inputs and of what its controller answers, the same on every machine.
pub struct ClosedLoop {
    random: u32,
    state: State,
    reference: i32,
    pressure: i32,
    sample: usize,
}

impl ClosedLoop {
    /// The chamber at ambient pressure.
    pub const fn new() -> Self {
        Self {
            random: 0x6c07_8965,
            state: State::at_rest(),
            reference: 0,
            pressure: 0,
            sample: 0,
        }
    }

    /// Marsaglia's xorshift of 32 bits, as a value in `0..bound`.
    fn below(&mut self, bound: i32) -> i32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 17;
        self.random ^= self.random << 5;
        ((u64::from(self.random) * bound as u64) >> 32) as i32
    }
}

impl Default for ClosedLoop {
    fn default() -> Self {
        Self::new()
    }
}

/// One sample of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Reference of the controller [2⁻¹⁶ bar].
    pub reference: i32,
    /// Pressure as the controller reads it [2⁻¹⁶ bar].
    pub pressure: i32,
    /// What the controller answered, fill and vent [2⁻¹⁶ %].
    pub duties: [i32; 2],
}

impl Iterator for ClosedLoop {
    type Item = Sample;

    fn next(&mut self) -> Option<Self::Item> {
        if self.sample.is_multiple_of(STRETCH) {
            self.reference = self.below(SUPPLY);
        }
        self.sample += 1;
        let noise = self.below(2 * NOISE + 1) - NOISE;
        let (reference, pressure) = (self.reference, self.pressure + noise);
        // The function that is measured, not a second copy of the step: inlined here it would not be inlined there.
        let duties = in_words(full_step(&CONTROLLER, &mut self.state, reference, pressure));
        self.pressure += flow(duties[0], SUPPLY - self.pressure);
        self.pressure -= flow(duties[1], self.pressure);
        Some(Sample {
            reference,
            pressure,
            duties,
        })
    }
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
    use controller::{Activity, Duty, Input, Pressure, Saturation};

    /// Goal: the mean over the trace is that of a loop at work, not of one at rest, and its largest path can occur.
    /// Method: what a traced controller says of each sample.
    #[test]
    fn the_loop_is_mostly_on_its_way_and_visits_every_branch() {
        let mut state = State::at_rest();
        let mut activities = [0; 3];
        let (mut high, mut low, mut boosting, mut fill, mut vent) = (0, 0, 0, 0, 0);
        for sample in ClosedLoop::new().take(SAMPLES) {
            let input = Input {
                reference: Pressure::from_bits(sample.reference),
                pressure: Pressure::from_bits(sample.pressure),
            };
            let (output, trace) = CONTROLLER.step_traced(&mut state, input);
            let duties = [output.duty_fill, output.duty_vent].map(Duty::to_bits);
            assert_eq!(duties, sample.duties);
            activities[match trace.activity {
                Activity::Controlling => 0,
                Activity::InsideTolerance => 1,
                Activity::SwitchedOffAhead => 2,
            }] += 1;
            high += usize::from(trace.saturation == Saturation::High);
            low += usize::from(trace.saturation == Saturation::Low);
            boosting += usize::from(trace.boosting);
            fill += usize::from(!output.duty_fill.is_off());
            vent += usize::from(!output.duty_vent.is_off());
        }
        let counts = [
            activities[0],
            activities[1],
            activities[2],
            high,
            low,
            boosting,
            fill,
            vent,
        ];
        assert!(activities[0] > SAMPLES * 2 / 3, "{counts:?}");
        assert!(counts.iter().all(|&count| count > 500), "{counts:?}");
    }

    #[test]
    fn the_pressure_stays_between_ambient_and_supply() {
        for Sample { pressure, .. } in ClosedLoop::new().take(SAMPLES) {
            assert!((-NOISE..=SUPPLY + NOISE).contains(&pressure), "{pressure}");
        }
    }
}
