//! Largest stack of a call for any input: its deepest point, callees included.
//!
//! The stack pointer is followed along every path; a loop is allowed if it leaves the stack pointer unchanged.

use std::collections::HashMap;

use super::call_search::{CallSearch, Found};
use super::code::Code;
use super::instruction::{Flow, StackChange};
use super::unbounded::Unbounded;

/// Limit of a frame: a loop that pushes in each round soon exceeds it.
const DEEPEST: u32 = 1 << 20;

/// Returns the maximum number of bytes below the stack pointer of the caller.
pub(crate) fn stack_bound(code: &Code, entry: u32) -> Result<u32, Unbounded> {
    StackSearch::new(code).bytes(entry & !1)
}

/// Search for the stack that each function needs.
pub(crate) type StackSearch<'a> = CallSearch<'a, Need>;

/// Stack effect of a call for its caller.
#[derive(Clone, Copy)]
pub(crate) struct Need {
    bytes: u32,
    returns: bool,
    /// The callee with the deepest stack, if any.
    deepest: Option<u32>,
}

impl StackSearch<'_> {
    /// Returns the maximum number of bytes that a call of this function needs.
    pub(crate) fn bytes(&mut self, entry: u32) -> Result<u32, Unbounded> {
        self.function(entry).map(|need| need.bytes)
    }

    /// Returns the calls by which a bounded function reaches its deepest point, each with its own part.
    pub(crate) fn deepest_calls(&self, entry: u32) -> Vec<(String, u32)> {
        let mut calls = Vec::new();
        let mut next = Some(entry);
        while let Some((at, need)) = next.and_then(|at| Some((at, self.known(at)?))) {
            next = need.deepest;
            let below = next.and_then(|callee| self.known(callee));
            let own = need.bytes - below.map_or(0, |callee| callee.bytes);
            let function = self.code.function(at);
            let name = function.map_or_else(|| self.code.place(at), |found| found.name.clone());
            calls.push((name, own));
        }
        calls
    }

    fn depth_after(&self, address: u32, before: u32) -> Result<u32, Unbounded> {
        match self.instruction(address)?.stack {
            StackChange::None => Ok(before),
            StackChange::Down(bytes) if before + bytes > DEEPEST => {
                let at = self.code.place(address);
                Err(Unbounded::StackGrows { at })
            }
            StackChange::Down(bytes) => Ok(before + bytes),
            StackChange::Up(bytes) => Ok(before.saturating_sub(bytes)),
            StackChange::Unknown => Err(self.code.stack_pointer_at(address)),
        }
    }
}

impl Found for Need {
    /// Visits an address again when a path reaches it with a deeper stack than before.
    fn in_body(search: &mut StackSearch<'_>, entry: u32) -> Result<Self, Unbounded> {
        let mut need = Self {
            bytes: 0,
            returns: false,
            deepest: None,
        };
        let mut depths = HashMap::from([(entry, 0)]);
        let mut open = vec![entry];
        while let Some(address) = open.pop() {
            let before = depths[&address];
            let after = search.depth_after(address, before)?;
            let mut depth = after;
            let mut callee = None;
            let mut goes_on = true;
            let flow = search.code.at(address).map(|here| &here.flow);
            match flow {
                Some(&Flow::Call(target)) => {
                    let called = search.function(target)?;
                    depth += called.bytes;
                    callee = Some(target);
                    goes_on = called.returns;
                }
                Some(Flow::Return | Flow::ReturnOrNext) => need.returns = true,
                _ => {}
            }
            if depth > need.bytes {
                need.bytes = depth;
                need.deepest = callee;
            }
            if !goes_on {
                continue;
            }
            for next in search.code.successors(address) {
                if depths.get(&next).is_none_or(|&known| known < after) {
                    depths.insert(next, after);
                    open.push(next);
                }
            }
        }
        Ok(need)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::code::fixture;

    fn bound(text: &str) -> Result<u32, Unbounded> {
        stack_bound(&fixture(text), 0)
    }

    #[test]
    fn a_leaf_without_frame_needs_nothing() {
        assert_eq!(bound("0 f:\n 0: adds r0, #1\n 2: bx lr\n"), Ok(0));
    }

    #[test]
    fn a_frame_and_the_deepest_of_its_callees_add_up() {
        let code = "0 f:\n 0: push {r4, lr}\n 2: sub sp, #16\n 4: bl 20 <g>\n 8: bl 30 <h>\n c: add sp, #16\n e: pop {r4, pc}\n\
                    20 g:\n 20: push {r7, lr}\n 22: pop {r7, pc}\n\
                    30 h:\n 30: push {r4, r5, r7, lr}\n 32: pop {r4, r5, r7, pc}\n";
        assert_eq!(bound(code), Ok(8 + 16 + 16));
    }

    #[test]
    fn the_calls_to_the_deepest_point_are_listed_with_what_each_adds() {
        let code = fixture(
            "0 f:\n 0: push {r4, lr}\n 2: bl 20 <g>\n 6: bl 30 <h>\n a: pop {r4, pc}\n\
             20 g:\n 20: sub sp, #16\n 22: add sp, #16\n 24: bx lr\n\
             30 h:\n 30: push {r7, lr}\n 32: bl 20 <g>\n 36: pop {r7, pc}\n",
        );
        let mut search = StackSearch::new(&code);
        assert_eq!(search.bytes(0), Ok(8 + 8 + 16));
        let expected = [("f", 8), ("h", 8), ("g", 16)].map(|(name, own)| (name.to_owned(), own));
        assert_eq!(search.deepest_calls(0), expected);
    }

    #[test]
    fn a_frame_that_is_gone_before_the_next_call_does_not_count_for_it() {
        let code = "0 f:\n 0: push {r4, lr}\n 2: sub sp, #64\n 4: add sp, #64\n 6: bl 20 <g>\n a: pop {r4, pc}\n\
                    20 g:\n 20: push {r7, lr}\n 22: pop {r7, pc}\n";
        assert_eq!(bound(code), Ok(8 + 64));
    }

    #[test]
    fn a_tail_call_needs_its_stack_below_what_is_left_of_the_caller() {
        let code = "0 f:\n 0: push {r4, lr}\n 2: ldmia.w sp!, {r4, lr}\n 6: b.w 20 <g>\n\
                    20 g:\n 20: push {r4, r5, r6, lr}\n 22: pop {r4, r5, r6, pc}\n";
        assert_eq!(bound(code), Ok(16));
    }

    #[test]
    fn the_path_that_pushes_more_counts() {
        let code = "0 f:\n 0: cbz r0, 8 <f+0x8>\n 2: push {r4, r5, r6, lr}\n 4: pop {r4, r5, r6, pc}\n\
                    8: push {r4, lr}\n a: pop {r4, pc}\n";
        assert_eq!(bound(code), Ok(16));
    }

    #[test]
    fn a_loop_that_leaves_the_stack_as_it_was_is_bounded_and_one_that_does_not_is_named() {
        let balanced = "0 f:\n 0: push {r4}\n 2: pop {r4}\n 4: bne.n 0 <f>\n 6: bx lr\n";
        assert_eq!(bound(balanced), Ok(4));
        let grows = "0 f:\n 0: push {r4}\n 2: bne.n 0 <f>\n 4: bx lr\n";
        let at = "f+0x0".to_owned();
        assert_eq!(bound(grows), Err(Unbounded::StackGrows { at }));
    }

    /// A call that never returns is followed by a constant pool or the next function, which are not part of the path.
    #[test]
    fn nothing_follows_a_call_that_never_returns() {
        let code = "0 f:\n 0: push {r7, lr}\n 2: bl 20 <g>\n 6: .word 0x00000000\n20 g:\n 20: b.n 20 <g>\n";
        assert_eq!(bound(code), Ok(8));
    }

    #[test]
    fn what_has_no_bound_is_reported_with_its_place() {
        let at = |text: &str| text.to_owned();
        for (code, reason) in [
            (
                "0 f:\n 0: push {r7, lr}\n 2: bl 20 <g>\n 6: pop {r7, pc}\n20 g:\n 20: b.w 30 <h>\n\
                 30 h:\n 30: bl 0 <f>\n 34: bx lr\n",
                Unbounded::Recursion { at: at("f+0x0") },
            ),
            (
                "0 f:\n 0: sub.w sp, sp, r0\n 4: bx lr\n",
                Unbounded::StackPointer {
                    at: at("f+0x0"),
                    text: at("sub.w sp, sp, r0"),
                },
            ),
            (
                "0 f:\n 0: bl 20 <x>\n20 core::panicking::panic:\n 20: b.n 20 <x>\n",
                Unbounded::Panic {
                    at: at("f+0x0"),
                    function: at("core::panicking::panic"),
                },
            ),
            (
                "0 f:\n 0: bx r3\n",
                Unbounded::Indirect {
                    at: at("f+0x0"),
                    text: at("bx r3"),
                },
            ),
        ] {
            assert_eq!(bound(code), Err(reason), "{code}");
        }
    }
}
