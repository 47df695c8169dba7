//! Inputs of every candidate: one closed loop of the thesis' controller on a simple [`Plant`].
//!
//! All candidates get the same pressures, independent of their answers, so different rounding gives no advantage. Only
//! the whole ECU drives a separate plant: its detectors would report another controller's valves as broken.

use controller::{FixedConfig, State};

use crate::ours::{Thesis, fixed, full_step, in_words};
use crate::plant::{Plant, Sample};

/// Number of samples of the trace.
pub const SAMPLES: usize = 102_400;

const CONTROLLER: FixedConfig<Thesis> = fixed();

/// Closed loop: an endless sequence of inputs and of its controller's answers.
pub struct ClosedLoop {
    plant: Plant,
    state: State,
}

impl ClosedLoop {
    /// Creates the loop before the first sample.
    pub const fn new() -> Self {
        Self {
            plant: Plant::new(),
            state: State::at_rest(),
        }
    }

    /// Returns the inputs of the next sample, and the controller's duty cycles of fill and vent valve (2⁻¹⁶ %).
    pub fn sample(&mut self) -> (Sample, [i32; 2]) {
        let sample = self.plant.sample();
        // This calls the measured function, not a second copy of the step: if it were inlined here, it would not be
        // inlined there.
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

    /// Goal: the mean over the trace is that of a working loop, not of one at rest, and every branch occurs. Method:
    /// the trace of the controller in each sample.
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
