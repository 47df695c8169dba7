//! Code that a function reaches, and the constructs in it.

use std::collections::{BTreeMap, BTreeSet};

use super::code::{Code, Function};
use super::instruction::Flow;

/// All code that a call of one function can execute, up to the panic handler, which is not part of the function.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Reach {
    /// Code with the constants between it (bytes).
    pub(crate) bytes: u32,
    /// Functions other than the first, by name.
    pub(crate) others: BTreeSet<String>,
    /// Paths into the panic handler, by name.
    pub(crate) panics: BTreeSet<String>,
    /// Places of floating-point instructions.
    pub(crate) floats: Vec<String>,
    /// Places of divisions.
    pub(crate) divisions: Vec<String>,
}

/// Follows every branch and call from a function's entry.
pub(crate) fn reach(code: &Code, entry: u32) -> Reach {
    let mut seen = BTreeSet::new();
    let mut functions: BTreeMap<u32, &Function> = BTreeMap::new();
    let mut reach = Reach::default();
    let mut open = vec![entry & !1];
    while let Some(address) = open.pop() {
        if !seen.insert(address) {
            continue;
        }
        if let Some(function) = code.function(address) {
            functions.insert(function.start, function);
        }
        let Some(instruction) = code.at(address) else {
            continue;
        };
        if instruction.is_float() {
            reach.floats.push(code.place(address));
        }
        if instruction.divides() {
            reach.divisions.push(code.place(address));
        }
        if let Some(function) = code.panic_from(address) {
            reach.panics.insert(function.name.clone());
            continue;
        }
        if let Flow::Call(target) = instruction.flow {
            open.push(target);
        }
        open.extend(code.successors(address));
    }
    reach.bytes = functions.values().map(|function| function.bytes()).sum();
    let first = code.function(entry & !1).map(|function| function.start);
    let others = functions
        .values()
        .filter(|function| Some(function.start) != first);
    reach.others = others.map(|function| function.name.clone()).collect();
    reach
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::code::fixture;

    #[test]
    fn a_function_reaches_its_callees_and_their_bytes_and_what_stands_in_them() {
        let code = fixture(
            "0 f:\n 0: push {r7, lr}\n 2: bl 20 <g>\n 6: cbz r0, c <f+0xc>\n 8: sdiv r0, r0, r1\n c: pop {r7, pc}\n\
             20 g:\n 20: b.w 30 <h>\n\
             30 h:\n 30: vadd.f32 s0, s0, s0\n 34: bl 40 <panic>\n 38: nop\n\
             40 core::panicking::panic:\n 40: b.n 40 <panic>\n\
             50 never_called:\n 50: vdiv.f32 s0, s0, s1\n 54: bx lr\n",
        );
        let set = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let expected = Reach {
            bytes: 0x40,
            others: set(&["g", "h"]),
            panics: set(&["core::panicking::panic"]),
            floats: vec!["h+0x0".to_owned()],
            divisions: vec!["f+0x8".to_owned()],
        };
        assert_eq!(reach(&code, 1), expected);
    }
}
