//! Measurement of every candidate over the whole trace, one printed line each:
//! ```text
//! candidate=full_step entry=0x00000a1c calls=102400 sum=6400000 min=20 max=80 stack=24 state=24 config=44 deviation=0 decisions=0
//! ```
//! The instructions are those of the callee with its return; `stack`, `state` and `config` are in bytes. `deviation` is
//! the largest difference of a duty cycle from the project's own controller (2⁻¹⁶ %) while both drive the same valve,
//! `decisions` the number of samples in which they do not. Only the full steps have both.

use core::cell::Cell;
use core::fmt::{self, Write};

use budgets::ecu_samples::{self, Checked, Rig};
use budgets::ours::{self, Recommended, Thesis, Traced};
use budgets::trace::{ClosedLoop, SAMPLES};
use controller::{FixedConfig, PulseState, State};
use cortex_m_semihosting::hio::{self, HostStream};
use idsp::iir::{DirectForm1, DirectForm1Wide};

use crate::callee::{Callee, IntegerStep, Registers};
use crate::counter::Counter;
use crate::peers;

/// Measures all candidates.
pub(crate) fn run() -> fmt::Result {
    let mut bench = Bench {
        out: hio::hstdout().map_err(|()| fmt::Error)?,
    };
    bench.ours()?;
    #[cfg(feature = "c-baselines")]
    bench.baselines()?;
    bench.ecus()?;
    bench.kernels()
}

struct Bench {
    out: HostStream,
}

impl Bench {
    fn ours(&mut self) -> fmt::Result {
        let thesis: FixedConfig<Thesis> = ours::fixed();
        let recommended: FixedConfig<Recommended> = ours::fixed();
        let rest = State::at_rest();
        self.step("full_step", ours::full_step, &thesis, rest)?;
        self.step("full_step_any", ours::full_step_any, thesis.config(), rest)?;
        let (step, traced) = (ours::traced_step, Traced::at_rest());
        self.step("traced_step", step, &recommended, traced)?;
        self.step("pid_alone", ours::pid_alone, &ours::fixed(), rest)?;
        let at_rest = PulseState::at_rest();
        self.step("pulses", ours::pulses, &ours::PULSES, at_rest)
    }

    #[cfg(feature = "c-baselines")]
    fn baselines(&mut self) -> fmt::Result {
        use crate::baselines::{self as c, FLOAT, INTEGER};
        for (name, step) in [
            ("saturating_o2", c::saturating_step_o2 as c::IntegerStep),
            ("saturating_os", c::saturating_step_os),
            ("tuned_o2", c::tuned_step_o2),
            ("tuned_os", c::tuned_step_os),
        ] {
            self.step(name, step, &INTEGER, c::State::default())?;
        }
        for (name, step) in [
            ("float_o2", c::float_step_o2 as c::FloatStep),
            ("float_os", c::float_step_os),
        ] {
            let mut state = c::State::default();
            self.on_trace(name, Callee::float_step(step, &FLOAT, &mut state))?;
        }
        Ok(())
    }

    fn kernels(&mut self) -> fmt::Result {
        let fixed = peers::fixed_biquad();
        let mut state = DirectForm1::default();
        let callee = Callee::integer_kernel(peers::idsp_fixed, &fixed, &mut state);
        self.on_trace("idsp_fixed", callee)?;
        let mut state = DirectForm1Wide::default();
        let callee = Callee::integer_kernel(peers::idsp_fixed_wide, &fixed, &mut state);
        self.on_trace("idsp_fixed_wide", callee)?;
        let float = peers::float_biquad();
        let mut state = DirectForm1::default();
        let callee = Callee::float_kernel(peers::idsp_float, &float, &mut state);
        self.on_trace("idsp_float", callee)?;
        let mut pid = peers::pid();
        self.on_trace("pid", Callee::float_kernel(peers::pid_step, &(), &mut pid))?;
        let mut pid = peers::advanced_pid();
        let callee = Callee::float_kernel(peers::advanced_pid_step, &0.01, &mut pid);
        self.on_trace("advanced_pid", callee)
    }

    /// Measures the loop with the plausibility check of its pressure, and the whole ECU on a separate plant.
    fn ecus(&mut self) -> fmt::Result {
        let (config, mut checked) = (ecu_samples::CHECKED, Checked::NEW);
        let callee = Callee::integer_step(ecu_samples::checked_loop, &config, &mut checked);
        let mut closed_loop = ClosedLoop::new();
        self.measure("checked_loop", callee, |_| Fed {
            registers: Registers::code(closed_loop.sample().0),
            expected: None,
        })?;

        let (mut rig, mut ecu) = (Rig::new(), ecu_samples::bench_ecu());
        let inputs = Cell::new(rig.sample());
        let callee = Callee::ecu(ecu_samples::ecu_sample, &inputs, &mut ecu);
        self.measure("ecu_sample", callee, |answered| {
            if let Some(duties) = answered {
                rig.drive(duties);
                inputs.set(rig.sample());
            }
            Fed {
                registers: Registers::NONE,
                expected: None,
            }
        })
    }

    fn step<C, S>(
        &mut self,
        name: &str,
        step: IntegerStep<C, S>,
        config: &C,
        mut state: S,
    ) -> fmt::Result {
        self.on_trace(name, Callee::integer_step(step, config, &mut state))
    }

    fn on_trace(&mut self, name: &str, callee: Callee<'_>) -> fmt::Result {
        let mut closed_loop = ClosedLoop::new();
        self.measure(name, callee, |_| {
            let (sample, duties) = closed_loop.sample();
            Fed {
                registers: Registers::pressures(sample),
                expected: Some(duties),
            }
        })
    }

    /// Calls the candidate repeatedly with the inputs that `feed` computes from the previous answer.
    fn measure(
        &mut self,
        name: &str,
        callee: Callee<'_>,
        mut feed: impl FnMut(Option<[i32; 2]>) -> Fed,
    ) -> fmt::Result {
        let mut counter = Counter::new();
        let mut cost = Cost::NONE;
        let mut difference = Difference::NONE;
        let mut answered = None;
        for _ in 0..SAMPLES {
            let Fed {
                mut registers,
                expected,
            } = feed(answered);
            cost.add(counter.call(&callee, &mut registers));
            answered = callee.duties(&registers);
            if let (Some(expected), Some(answered)) = (expected, answered) {
                difference.add(expected, answered);
            }
        }
        writeln!(
            self.out,
            "candidate={name} entry={:#010x} calls={SAMPLES} {cost} stack={} state={} config={} {difference}",
            callee.entry,
            counter.stack_touched(),
            callee.state_bytes,
            callee.config_bytes,
        )
    }
}

/// Input of a call, and the duty cycles (2⁻¹⁶ %) with which the project's own controller answers.
struct Fed {
    registers: Registers,
    expected: Option<[i32; 2]>,
}

/// Instruction counts over all calls.
struct Cost {
    sum: u32,
    min: u32,
    max: u32,
}

impl Cost {
    const NONE: Self = Self {
        sum: 0,
        min: u32::MAX,
        max: 0,
    };

    fn add(&mut self, instructions: u32) {
        self.sum += instructions;
        self.min = self.min.min(instructions);
        self.max = self.max.max(instructions);
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sum, min, max } = self;
        write!(f, "sum={sum} min={min} max={max}")
    }
}

/// Difference between a candidate's duty cycles and those of the project's own controller.
struct Difference {
    deviation: u32,
    decisions: u32,
}

impl Difference {
    const NONE: Self = Self {
        deviation: 0,
        decisions: 0,
    };

    fn add(&mut self, expected: [i32; 2], answered: [i32; 2]) {
        let driven = |duties: [i32; 2]| duties.map(|duty| duty != 0);
        if driven(expected) != driven(answered) {
            self.decisions += 1;
            return;
        }
        for (expected, answered) in expected.into_iter().zip(answered) {
            self.deviation = self.deviation.max(expected.abs_diff(answered));
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            deviation,
            decisions,
        } = self;
        write!(f, "deviation={deviation} decisions={decisions}")
    }
}
