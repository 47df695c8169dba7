//! Effect of a Thumb-2 instruction on the flow of control and on the stack, read from the disassembler's text.
//!
//! The text of GNU objdump is used because it covers every encoding; the Rust disassembler that was tried
//! (`yaxpeax-arm` 0.5) stops at the instructions of the floating-point unit. An instruction that could write the
//! program counter or the stack pointer in an unknown way becomes an [`Flow::IndirectJump`] or a
//! [`StackChange::Unknown`].

/// Flow of control after an instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    Next,
    Jump(u32),
    /// To this address, or to the next instruction.
    Branch(u32),
    /// To this address, and then to the next instruction.
    Call(u32),
    Return,
    /// Under a condition: back to the caller; otherwise to the next instruction.
    ReturnOrNext,
    /// To one of the targets in the table after it, with entries of this many bytes.
    Table(u32),
    /// To an address in a register, and then to the next instruction.
    IndirectCall,
    /// To an address in a register.
    IndirectJump,
    /// Undefined instruction, placed where control must never come.
    Trap,
}

/// Change of the stack pointer by an instruction (bytes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StackChange {
    None,
    Down(u32),
    Up(u32),
    /// By an amount that the instruction does not state.
    Unknown,
}

/// One instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Instruction {
    /// Text of the disassembler.
    pub(crate) text: String,
    pub(crate) flow: Flow,
    pub(crate) stack: StackChange,
}

impl Instruction {
    /// Reads the disassembler's mnemonic and operands, without the comment.
    pub(crate) fn read(mnemonic: &str, operands: &str) -> Self {
        let name = mnemonic.split('.').next().unwrap_or(mnemonic);
        let (name, conditional) = without_condition(name);
        let flow = flow(name, conditional, operands);
        let stack = match stack_change(name, operands) {
            // A taken return leaves the function, so only the other case counts; other conditional changes are not
            // followed.
            _ if flow == Flow::ReturnOrNext => StackChange::None,
            StackChange::Down(_) | StackChange::Up(_) if conditional => StackChange::Unknown,
            change => change,
        };
        Self {
            text: format!("{mnemonic} {operands}").trim_end().to_owned(),
            flow,
            stack,
        }
    }

    /// Returns whether the floating-point unit executes it: all of its mnemonics begin in this way, and no others.
    pub(crate) fn is_float(&self) -> bool {
        self.text.starts_with('v')
    }

    /// Returns whether it divides, or takes a root.
    pub(crate) fn divides(&self) -> bool {
        ["sdiv", "udiv", "vdiv", "vsqrt"]
            .iter()
            .any(|name| self.text.starts_with(name))
    }
}

/// Names that affect flow and stack. All others are opaque, so that `lsls` is not read as `ls` under a condition.
const NAMES: [&str; 26] = [
    "add", "addw", "b", "bl", "blx", "bx", "ldm", "ldmdb", "ldmia", "ldr", "ldrd", "mov", "pop",
    "push", "stm", "stmdb", "stmia", "str", "strd", "sub", "subw", "vldmia", "vpop", "vpush",
    "vstmdb", "vstmia",
];

const CONDITIONS: [&str; 16] = [
    "eq", "ne", "cs", "hs", "cc", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le",
];

/// Returns the name without its condition, and whether there was one.
fn without_condition(name: &str) -> (&str, bool) {
    if NAMES.contains(&name) {
        return (name, false);
    }
    let base = CONDITIONS
        .iter()
        .find_map(|condition| name.strip_suffix(condition))
        .filter(|base| NAMES.contains(base));
    base.map_or((name, false), |base| (base, true))
}

fn flow(name: &str, conditional: bool, operands: &str) -> Flow {
    let returned = if conditional {
        Flow::ReturnOrNext
    } else {
        Flow::Return
    };
    match (name, target(operands)) {
        ("b", Some(target)) if conditional => Flow::Branch(target),
        ("b", Some(target)) => Flow::Jump(target),
        ("cbz" | "cbnz", Some(target)) => Flow::Branch(target),
        ("bl" | "blx", Some(target)) => Flow::Call(target),
        ("bl" | "blx", None) => Flow::IndirectCall,
        ("bx", _) if operands == "lr" => returned,
        ("mov", _) if operands == "pc, lr" => returned,
        ("pop", _) if operands.contains("pc}") => returned,
        ("ldm" | "ldmia", _) if operands.starts_with("sp!") && operands.contains("pc}") => returned,
        ("ldr", _) if operands.starts_with("pc, [sp], ") => returned,
        ("tbb", _) => Flow::Table(1),
        ("tbh", _) => Flow::Table(2),
        ("udf", _) => Flow::Trap,
        ("b" | "bx", _) => Flow::IndirectJump,
        _ if destination(name, operands) == Some("pc") || operands.ends_with("pc}") => {
            Flow::IndirectJump
        }
        _ => Flow::Next,
    }
}

/// Returns the address before its `<symbol>`, which the disassembler gives to branches and calls only.
fn target(operands: &str) -> Option<u32> {
    let (before, _) = operands.split_once(" <")?;
    let address = before.rsplit(' ').next()?;
    u32::from_str_radix(address, 16).ok()
}

/// Returns the register that an instruction writes first, if any.
fn destination<'a>(name: &str, operands: &'a str) -> Option<&'a str> {
    let reads = [
        "cmp", "cmn", "tst", "teq", "str", "stm", "push", "vstr", "vstm", "pld",
    ];
    if reads.iter().any(|reading| name.starts_with(reading)) {
        return None;
    }
    operands.split([',', ' ']).next()
}

fn stack_change(name: &str, operands: &str) -> StackChange {
    let down = |bytes: Option<u32>| bytes.map_or(StackChange::Unknown, StackChange::Down);
    let up = |bytes: Option<u32>| bytes.map_or(StackChange::Unknown, StackChange::Up);
    let moves_stack = operands.starts_with("sp!");
    match name {
        "push" | "vpush" => down(list_bytes(operands)),
        "pop" | "vpop" => up(list_bytes(operands)),
        "stmdb" | "vstmdb" if moves_stack => down(list_bytes(operands)),
        "ldm" | "ldmia" | "vldmia" if moves_stack => up(list_bytes(operands)),
        "sub" | "subw" if operands.starts_with("sp, ") => down(constant(operands)),
        "add" | "addw" if operands.starts_with("sp, ") => up(constant(operands)),
        "str" | "strd" if operands.contains("[sp, #-") && operands.ends_with("]!") => {
            let bytes = operands.rsplit("#-").next();
            down(bytes.and_then(|text| text.trim_end_matches("]!").parse().ok()))
        }
        "ldr" | "ldrd" if operands.contains("[sp], #") => {
            let bytes = operands.rsplit('#').next();
            up(bytes.and_then(|text| text.parse().ok()))
        }
        _ if destination(name, operands) == Some("sp")
            || operands.contains("sp!")
            || operands.contains("[sp], ")
            || (operands.contains("[sp") && operands.ends_with("]!"))
            || (name == "msr"
                && ["MSP", "PSP", "CONTROL"]
                    .iter()
                    .any(|s| operands.starts_with(s))) =>
        {
            StackChange::Unknown
        }
        _ => StackChange::None,
    }
}

/// Returns the constant of `sp, #8` or `sp, sp, #8`.
fn constant(operands: &str) -> Option<u32> {
    let rest = operands.strip_prefix("sp, ")?;
    let rest = rest.strip_prefix("sp, ").unwrap_or(rest);
    rest.strip_prefix('#')?.parse().ok()
}

/// Returns the bytes of the registers in a list such as `{r4-r6, lr}` or `{d8}`.
fn list_bytes(operands: &str) -> Option<u32> {
    let (_, list) = operands.split_once('{')?;
    let list = list.trim_end_matches('}');
    let each = if list.starts_with('d') { 8 } else { 4 };
    let number = |register: &str| register.trim().get(1..)?.parse::<u32>().ok();
    let mut registers = 0;
    for part in list.split(',') {
        registers += match part.split_once('-') {
            Some((first, last)) => number(last)?.checked_sub(number(first)?)? + 1,
            None => 1,
        };
    }
    Some(registers * each)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Instruction {
        let (mnemonic, operands) = line.split_once(' ').unwrap_or((line, ""));
        Instruction::read(mnemonic, operands)
    }

    #[test]
    fn every_way_in_which_a_compiler_moves_control_is_known() {
        for (line, flow) in [
            ("adds r0, r0, r1", Flow::Next),
            ("lsls r0, r0, #16", Flow::Next),
            ("itte lt", Flow::Next),
            ("bkpt 0x00ab", Flow::Next),
            ("add r7, sp, #8", Flow::Next),
            ("b.n 24 <f+0x24>", Flow::Jump(0x24)),
            ("b.w 1f0 <other>", Flow::Jump(0x1f0)),
            ("ble.n 2a <f+0x2a>", Flow::Branch(0x2a)),
            ("bls.n 2a <f+0x2a>", Flow::Branch(0x2a)),
            ("bvs.w 2a <f+0x2a>", Flow::Branch(0x2a)),
            ("cbnz r1, 46 <f+0x16>", Flow::Branch(0x46)),
            ("bl 80 <g>", Flow::Call(0x80)),
            ("blne 80 <g>", Flow::Call(0x80)),
            ("blx r3", Flow::IndirectCall),
            ("bx lr", Flow::Return),
            ("bxeq lr", Flow::ReturnOrNext),
            ("bx r3", Flow::IndirectJump),
            ("pop {r4, pc}", Flow::Return),
            ("popne {r4, pc}", Flow::ReturnOrNext),
            ("ldmia.w sp!, {r4, r5, pc}", Flow::Return),
            ("ldmia.w r0, {r4, r5, pc}", Flow::IndirectJump),
            ("ldr.w pc, [sp], #8", Flow::Return),
            ("ldr.w pc, [r1, r0, lsl #2]", Flow::IndirectJump),
            ("mov pc, r0", Flow::IndirectJump),
            ("add pc, r0", Flow::IndirectJump),
            ("tbb [pc, r0]", Flow::Table(1)),
            ("tbh [pc, r0, lsl #1]", Flow::Table(2)),
            ("udf #254", Flow::Trap),
        ] {
            assert_eq!(read(line).flow, flow, "{line}");
        }
    }

    #[test]
    fn every_way_in_which_a_compiler_moves_the_stack_is_known_and_any_other_is_unknown() {
        for (line, change) in [
            ("push {r4, r5, r7, lr}", StackChange::Down(16)),
            ("vpush {d8-d9}", StackChange::Down(16)),
            ("vpush {s16}", StackChange::Down(4)),
            ("stmdb sp!, {r4, r5, r6, r7, r8, lr}", StackChange::Down(24)),
            ("sub sp, #8", StackChange::Down(8)),
            ("sub.w sp, sp, #1024", StackChange::Down(1024)),
            ("subw sp, sp, #1028", StackChange::Down(1028)),
            ("str.w r8, [sp, #-4]!", StackChange::Down(4)),
            ("strd r0, r1, [sp, #-16]!", StackChange::Down(16)),
            ("pop {r4, r5}", StackChange::Up(8)),
            ("add sp, #16", StackChange::Up(16)),
            ("ldr.w r8, [sp], #4", StackChange::Up(4)),
            ("vpop {d8}", StackChange::Up(8)),
            ("popne {r4, pc}", StackChange::None),
            ("str r0, [sp, #4]", StackChange::None),
            ("add r7, sp, #8", StackChange::None),
            ("mov r4, sp", StackChange::None),
            ("cmp sp, r0", StackChange::None),
            ("mov sp, r4", StackChange::Unknown),
            ("sub.w sp, sp, r0", StackChange::Unknown),
            ("addne sp, #8", StackChange::Unknown),
            ("pushne {r4}", StackChange::Unknown),
            ("msr MSP, r0", StackChange::Unknown),
            ("bic.w sp, sp, #7", StackChange::Unknown),
        ] {
            assert_eq!(read(line).stack, change, "{line}");
        }
    }

    #[test]
    fn floats_and_divisions_are_distinguished_from_integers() {
        assert!(read("vmul.f32 s0, s0, s1").is_float() && !read("mul r0, r1, r2").is_float());
        assert!(read("sdiv r0, r1, r2").divides() && read("vdiv.f32 s0, s0, s1").divides());
        assert!(!read("smull r0, r1, r2, r3").divides());
    }
}
