//! Largest number of instructions of a call for any input: the longest path through the linked code.
//!
//! Every path counts as possible, so the bound is never too low; code with a loop has no bound. An instruction that its
//! IT block skips counts, since the processor has to fetch it.

use std::collections::{HashMap, HashSet};

use super::call_search::{CallSearch, Found};
use super::code::Code;
use super::instruction::Flow;
use super::unbounded::Unbounded;

/// Returns the longest path from a function's entry to its return, callees included.
pub(crate) fn longest_path(code: &Code, entry: u32) -> Result<u32, Unbounded> {
    let Instructions(longest) = CallSearch::new(code).function(entry & !1)?;
    Ok(longest)
}

/// Length of a function's longest path.
#[derive(Clone, Copy)]
struct Instructions(u32);

impl Found for Instructions {
    /// Searches depth first without recursion: an address stays on the path until the longest path after it is known.
    fn in_body(search: &mut CallSearch<'_, Self>, entry: u32) -> Result<Self, Unbounded> {
        let code = search.code;
        let mut longest: HashMap<u32, u32> = HashMap::new();
        let mut on_way = HashSet::new();
        let mut way = vec![entry];
        while let Some(&address) = way.last() {
            let flow = &search.instruction(address)?.flow;
            if let Flow::Trap = flow {
                let at = code.place(address);
                return Err(Unbounded::Trap { at });
            }
            on_way.insert(address);
            let successors = code.successors(address);
            let unknown = successors.iter().find(|next| !longest.contains_key(next));
            if let Some(&next) = unknown {
                if on_way.contains(&next) {
                    let at = code.place(next);
                    return Err(Unbounded::Loop { at });
                }
                way.push(next);
                continue;
            }
            let behind = successors.iter().map(|next| longest[next]).max();
            let Self(callee) = match *flow {
                Flow::Call(target) => search.function(target)?,
                _ => Self(0),
            };
            longest.insert(address, 1 + callee + behind.unwrap_or(0));
            way.pop();
            on_way.remove(&address);
        }
        Ok(Self(longest[&entry]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::code::fixture;

    fn bound(text: &str) -> Result<u32, Unbounded> {
        longest_path(&fixture(text), 0)
    }

    #[test]
    fn a_straight_line_costs_its_instructions_with_the_return() {
        assert_eq!(
            bound("0 f:\n 0: movs r0, #1\n 2: adds r0, #1\n 4: bx lr\n"),
            Ok(3)
        );
    }

    #[test]
    fn of_two_branches_the_longer_one_counts() {
        // 0, 2, 4, 6, 8 is longer than 0, 8.
        let code = "0 f:\n 0: cbz r0, 8 <f+0x8>\n 2: nop\n 4: nop\n 6: nop\n 8: bx lr\n";
        assert_eq!(bound(code), Ok(5));
    }

    #[test]
    fn a_callee_counts_each_time_it_is_called() {
        let code = "0 f:\n 0: push {r4, lr}\n 2: bl 20 <g>\n 6: bl 20 <g>\n a: pop {r4, pc}\n\
                    20 g:\n 20: nop\n 22: bx lr\n";
        assert_eq!(bound(code), Ok(4 + 2 * 2));
    }

    #[test]
    fn a_tail_call_goes_on_in_the_other_function_and_returns_from_there() {
        let code = "0 f:\n 0: nop\n 2: b.w 20 <g>\n20 g:\n 20: nop\n 22: bx lr\n";
        assert_eq!(bound(code), Ok(4));
    }

    #[test]
    fn an_it_block_counts_whole_and_a_return_in_it_may_be_taken_or_not() {
        let code = "0 f:\n 0: cmp r0, #0\n 2: itt eq\n 4: moveq r0, #1\n 6: bxeq lr\n 8: bx lr\n";
        assert_eq!(bound(code), Ok(5));
    }

    #[test]
    fn a_table_branch_counts_its_longest_arm() {
        // Entries 2, 3 and a byte of padding: to 8 and to a.
        let code = "0 f:\n 0: tbb [pc, r0]\n 4: .byte 0x02\n 5: .byte 0x03\n 6: .short 0x0000\n\
                    8: nop\n a: nop\n c: bx lr\n";
        assert_eq!(bound(code), Ok(4));
    }

    #[test]
    fn what_has_no_bound_is_reported_with_its_place() {
        let at = |text: &str| text.to_owned();
        for (code, reason) in [
            (
                "0 f:\n 0: nop\n 2: subs r0, #1\n 4: bne.n 2 <f+0x2>\n 6: bx lr\n",
                Unbounded::Loop { at: at("f+0x2") },
            ),
            (
                "0 f:\n 0: push {r4, lr}\n 2: bl 0 <f>\n 6: pop {r4, pc}\n",
                Unbounded::Recursion { at: at("f+0x0") },
            ),
            (
                "0 f:\n 0: blx r3\n 2: bx lr\n",
                Unbounded::Indirect {
                    at: at("f+0x0"),
                    text: at("blx r3"),
                },
            ),
            (
                "0 f:\n 0: nop\n 2: bl 20 <x>\n20 core::panicking::panic:\n 20: b.n 20 <x>\n",
                Unbounded::Panic {
                    at: at("f+0x2"),
                    function: at("core::panicking::panic"),
                },
            ),
            ("0 f:\n 0: udf #254\n", Unbounded::Trap { at: at("f+0x0") }),
            (
                "0 f:\n 0: nop\n 2: .word 0x12345678\n",
                Unbounded::NoCode { at: at("f+0x2") },
            ),
        ] {
            assert_eq!(bound(code), Err(reason), "{code}");
        }
    }

    /// A diamond is not a loop: both arms meet again.
    #[test]
    fn arms_that_meet_again_are_no_loop() {
        let code = "0 f:\n 0: cbz r0, 6 <f+0x6>\n 2: nop\n 4: b.n 8 <f+0x8>\n 6: nop\n 8: bx lr\n";
        assert_eq!(bound(code), Ok(4));
    }
}
