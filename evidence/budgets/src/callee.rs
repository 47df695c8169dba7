//! Candidate as it is called: a function with its configuration and its state, passed by reference.

use core::cell::Cell;
use core::marker::PhantomData;

use budgets::plant::Sample;
use ecu::{Ecu, Inputs};

/// Full step in integers: reference and pressure (2⁻¹⁶ bar) to fill and vent (2⁻¹⁶ %), in the lower and upper word.
pub(crate) type IntegerStep<C, S> = extern "C" fn(&C, &mut S, i32, i32) -> u64;
/// Full step in floats: reference and pressure (bar) to fill and vent (%).
pub(crate) type FloatStep<C, S> = extern "C" fn(&C, &mut S, f32, f32) -> FloatDuties;
/// PID controller only, in integers.
pub(crate) type IntegerKernel<C, S> = extern "C" fn(&C, &mut S, i32, i32) -> i32;
/// PID controller only, in floats.
pub(crate) type FloatKernel<C, S> = extern "C" fn(&C, &mut S, f32, f32) -> f32;

/// Two duty cycles as the calling convention returns them, in the first two registers of the floating-point unit.
#[repr(C)]
pub(crate) struct FloatDuties {
    fill: f32,
    vent: f32,
}

/// Inputs and results of a call, as far as the calling convention keeps them in registers.
#[repr(C)]
pub(crate) struct Registers {
    pub(crate) r0: u32,
    pub(crate) r1: u32,
    pub(crate) r2: i32,
    pub(crate) r3: i32,
    pub(crate) s0: f32,
    pub(crate) s1: f32,
}

impl Registers {
    /// Creates the registers for reference and pressure (2⁻¹⁶ bar), for integers and for floats (bar).
    pub(crate) fn pressures(sample: Sample) -> Self {
        Self {
            s0: sample.reference as f32 / 65_536.0,
            s1: sample.pressure as f32 / 65_536.0,
            ..Self::integers(sample.reference, sample.pressure)
        }
    }

    /// Creates the registers for the reference (2⁻¹⁶ bar) and the code of the sensor.
    pub(crate) fn code(sample: Sample) -> Self {
        Self::integers(sample.reference, i32::from(sample.code.bits()))
    }

    /// Registers of a candidate without inputs in registers.
    pub(crate) const NONE: Self = Self::integers(0, 0);

    const fn integers(r2: i32, r3: i32) -> Self {
        Self {
            r0: 0,
            r1: 0,
            r2,
            r3,
            s0: 0.0,
            s1: 0.0,
        }
    }
}

/// Place of a candidate's answer.
#[derive(Clone, Copy)]
enum Answer {
    Integers,
    Floats,
    /// Control signal of a kernel, which no other candidate shares: only its cost is compared.
    Kernel,
}

/// Candidate, ready to be called.
pub(crate) struct Callee<'a> {
    pub(crate) entry: usize,
    pub(crate) config: *const (),
    pub(crate) state: *mut (),
    pub(crate) config_bytes: usize,
    pub(crate) state_bytes: usize,
    answer: Answer,
    borrowed: PhantomData<&'a mut ()>,
}

impl<'a> Callee<'a> {
    pub(crate) fn integer_step<C, S>(
        step: IntegerStep<C, S>,
        config: &'a C,
        state: &'a mut S,
    ) -> Self {
        Self::new(step as usize, config, state, Answer::Integers)
    }

    #[cfg(feature = "c-baselines")]
    pub(crate) fn float_step<C, S>(step: FloatStep<C, S>, config: &'a C, state: &'a mut S) -> Self {
        Self::new(step as usize, config, state, Answer::Floats)
    }

    pub(crate) fn integer_kernel<C, S>(
        kernel: IntegerKernel<C, S>,
        config: &'a C,
        state: &'a mut S,
    ) -> Self {
        Self::new(kernel as usize, config, state, Answer::Kernel)
    }

    pub(crate) fn float_kernel<C, S>(
        kernel: FloatKernel<C, S>,
        config: &'a C,
        state: &'a mut S,
    ) -> Self {
        Self::new(kernel as usize, config, state, Answer::Kernel)
    }

    /// Creates the callee of the whole ECU, which has its configuration in its state.
    pub(crate) fn ecu(
        sample: IntegerStep<Cell<Inputs>, Ecu>,
        inputs: &'a Cell<Inputs>,
        ecu: &'a mut Ecu,
    ) -> Self {
        Self {
            config_bytes: 0,
            ..Self::integer_step(sample, inputs, ecu)
        }
    }

    fn new<C, S>(entry: usize, config: &'a C, state: &'a mut S, answer: Answer) -> Self {
        Self {
            entry,
            config: (&raw const *config).cast(),
            state: (&raw mut *state).cast(),
            config_bytes: size_of::<C>(),
            state_bytes: size_of::<S>(),
            answer,
            borrowed: PhantomData,
        }
    }

    /// Returns the duty cycles after a call, fill and vent (2⁻¹⁶ %); `None` for a kernel.
    pub(crate) fn duties(&self, left: &Registers) -> Option<[i32; 2]> {
        let bits = |percent: f32| (percent * 65_536.0) as i32;
        match self.answer {
            Answer::Integers => Some([left.r0 as i32, left.r1 as i32]),
            Answer::Floats => Some([bits(left.s0), bits(left.s1)]),
            Answer::Kernel => None,
        }
    }
}
