//! Exact count of the instructions of one call, and of the stack used by the calls.
//!
//! QEMU with `-icount shift=10` makes each instruction take 1024 ns. SysTick of the machine `mps2-an386` counts at 25
//! MHz, a tick every 40 ns: 25.6 ticks per instruction, so the difference of two readings gives the number without
//! ambiguity. Only the callee runs between the two readings, on a separate stack that was painted before.

use core::arch::naked_asm;
use core::mem::offset_of;

use crate::callee::{Callee, Registers};

/// Control and status, reload and current value of SysTick (Armv7-M architecture, B3.3).
const SYST_CSR: *mut u32 = 0xe000_e010 as *mut u32;
const SYST_RVR: *mut u32 = 0xe000_e014 as *mut u32;
const SYST_CVR_ADDRESS: usize = 0xe000_e018;
const SYST_CVR: *mut u32 = SYST_CVR_ADDRESS as *mut u32;
/// Control value: enabled, from the processor's clock, without interrupt.
const RUNNING: u32 = 0b101;
/// Range of the down-counter, 24 bits.
const MASK: u32 = 0x00ff_ffff;

/// Duration of an instruction, as set for QEMU, and of a tick.
const INSTRUCTION_NS: u32 = 1024;
const TICK_NS: u32 = 40;
/// Number of instructions between the two readings in addition to the callee: the call, and the second reading.
const AROUND: u32 = 2;

/// Value of an unwritten word of the stack.
const PAINT: u32 = 0xcccc_cccc;
const STACK_WORDS: usize = 1024;

/// Instruction counter for one callee.
#[repr(align(8))]
pub(crate) struct Counter {
    stack: [u32; STACK_WORDS],
}

impl Counter {
    /// Starts SysTick and paints the stack.
    pub(crate) fn new() -> Self {
        // SAFETY: three registers that every Cortex-M has; no other code in this image uses SysTick, and no interrupt
        // is enabled.
        unsafe {
            SYST_RVR.write_volatile(MASK);
            SYST_CVR.write_volatile(0);
            SYST_CSR.write_volatile(RUNNING);
        }
        Self {
            stack: [PAINT; STACK_WORDS],
        }
    }

    /// Calls once, and returns the number of instructions of the callee, including its return.
    pub(crate) fn call(&mut self, callee: &Callee<'_>, registers: &mut Registers) -> u32 {
        registers.r0 = callee.config as u32;
        registers.r1 = callee.state as u32;
        let mut call = Call {
            entry: callee.entry,
            stack: self.stack.as_mut_ptr_range().end,
            registers,
            before: 0,
            after: 0,
        };
        timed(&mut call);
        let ticks = call.before.wrapping_sub(call.after) & MASK;
        (ticks * TICK_NS + INSTRUCTION_NS / 2) / INSTRUCTION_NS - AROUND
    }

    /// Returns the stack depth of the calls (bytes): down to the last word whose paint was changed.
    pub(crate) fn stack_touched(&self) -> usize {
        let untouched = self.stack.iter().take_while(|&&word| word == PAINT);
        size_of::<u32>() * (STACK_WORDS - untouched.count())
    }
}

/// One call, in the layout used by the assembly below.
#[repr(C)]
struct Call<'a> {
    entry: usize,
    stack: *mut u32,
    registers: &'a mut Registers,
    before: u32,
    after: u32,
}

/// Loads the registers, changes to the other stack, reads SysTick, calls, reads SysTick, and restores everything.
///
/// A `Callee` is a function of the calling convention of C whose arguments are alive for as long as it is borrowed; the
/// convention keeps r4 to r11 and the stack pointer. The other stack has room for any candidate, as `stack_touched` shows.
#[unsafe(naked)]
extern "C" fn timed(call: &mut Call<'_>) {
    naked_asm!(
        "push {{r4, r5, r6, r7, r8, lr}}",
        "mov r4, r0",
        "mov r5, sp",
        "ldr r6, ={syst_cvr}",
        "ldr r7, [r4, #{entry}]",
        "ldr r8, [r4, #{stack}]",
        "mov sp, r8",
        "ldr r8, [r4, #{registers}]",
        "vldr s0, [r8, #{s0}]",
        "vldr s1, [r8, #{s0} + 4]",
        "ldm r8, {{r0, r1, r2, r3}}",
        "ldr r8, [r6]",
        "blx r7",
        "ldr r6, [r6]",
        "mov sp, r5",
        "str r8, [r4, #{before}]",
        "str r6, [r4, #{after}]",
        "ldr r8, [r4, #{registers}]",
        "stm r8, {{r0, r1}}",
        "vstr s0, [r8, #{s0}]",
        "vstr s1, [r8, #{s0} + 4]",
        "pop {{r4, r5, r6, r7, r8, pc}}",
        syst_cvr = const SYST_CVR_ADDRESS,
        entry = const offset_of!(Call, entry),
        stack = const offset_of!(Call, stack),
        registers = const offset_of!(Call, registers),
        before = const offset_of!(Call, before),
        after = const offset_of!(Call, after),
        s0 = const offset_of!(Registers, s0),
    )
}
