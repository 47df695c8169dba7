//! What every candidate is fed: the inputs of one closed loop, the thesis' controller on a simple [`Plant`].
//!
//! All see the same pressures, whatever they answer: one that rounds differently does not get an easier way. The whole ECU
//! alone drives a plant of its own: its detectors would take another's valves for broken ones.

use controller::{FixedConfig, State};

use crate::ours::{Thesis, fixed, full_step, in_words};
use crate::plant::{Plant, Sample};

/// Samples of the trace.
pub const SAMPLES: usize = 102_400;

const CONTROLLER: FixedConfig<Thesis> = fixed();

/// The loop: an endless sequence of inputs and of what its controller answers.
pub struct ClosedLoop {
    plant: Plant,
    state: State,
}

impl ClosedLoop {
    /// Before the first sample.
    pub const fn new() -> Self {
        Self {
            plant: Plant::new(),
            state: State::at_rest(),
        }
    }

    /// The inputs of the next sample, and the duty cycles of fill and vent valve [2⁻¹⁶ %] that the controller answers.
    pub fn sample(&mut self) -> (Sample, [i32; 2]) {
        let sample = self.plant.sample();
        // The function that is measured, not a second copy of the step: inlined here it would not be inlined there.
        let answer = full_step(
            &CONTROLLER,
            &mut self.state,
            sample.reference,
            sample.pressure,
        );
        let duties = in_words(answer);
        self.plant.drive(duties);
        (sample, duties)
    }
}

impl Default for ClosedLoop {
    fn default() -> Self {
        Self::new()
    }
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
        let mut closed_loop = ClosedLoop::new();
        for _ in 0..SAMPLES {
            let (sample, duties) = closed_loop.sample();
            let input = Input {
                reference: Pressure::from_bits(sample.reference),
                pressure: Pressure::from_bits(sample.pressure),
            };
            let (output, trace) = CONTROLLER.step_traced(&mut state, input);
            assert_eq!(
                [output.duty_fill, output.duty_vent].map(Duty::to_bits),
                duties
            );
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
}
