//! Flashed image: no panic left in it, its stack bounded, its parts within their budgets.

use std::collections::BTreeSet;

use super::code::Code;
use super::elf::Elf;
use super::gate::Gate;
use super::stack_bound::StackSearch;
use super::table::Table;
use super::unbounded::Unbounded;
use super::unproved::Unproved;
use crate::failure::Failure;

/// Maximum number of bytes that the processor pushes at an exception: 26 words including those of the floating-point
/// unit, and one word to align the stack (Armv7-M architecture, B1.5.7).
const EXCEPTION_FRAME_BYTES: u32 = 27 * 4;

/// Index of the reset vector; the word before it is the initial stack pointer.
const RESET_VECTOR: usize = 1;

/// Smallest frame that the list of calls to the deepest point shows (bytes).
const SHOWN_BYTES: u32 = 256;

/// Stack that an image can need.
#[derive(Debug)]
pub(crate) struct Stack {
    /// Reset, and each handler once with its exception frame, as if each interrupted the previous one.
    parts: Vec<Part>,
    /// Reserved space, from the end of the variables to the top of RAM (bytes).
    reserved: u32,
}

/// Stack that one entry of the vector table can need.
#[derive(Debug, PartialEq, Eq)]
struct Part {
    name: String,
    bytes: u32,
    /// Calls to its deepest point, each with its own part.
    calls: Vec<(String, u32)>,
}

impl Stack {
    /// Reads the vector table and follows each entry.
    pub(crate) fn of(elf: &Elf, code: &Code) -> Result<Self, Failure> {
        let reserved = elf.address_of("_stack_start")? - elf.address_of("_stack_end")?;
        let parts = parts(code, &elf.vectors()?).map_err(Unproved::Stack)?;
        Ok(Self { parts, reserved })
    }

    fn bound(&self) -> u32 {
        self.parts.iter().map(|part| part.bytes).sum()
    }

    pub(crate) fn gate(&self, image: &str) -> Gate {
        let what = format!("{image}: stack proved [bytes]");
        Gate::at_most(&what, self.bound(), self.reserved)
    }

    /// Compares the painted stack of a run with the proved bound.
    pub(crate) fn painted(&self, used: u32) -> Gate {
        Gate::at_most(
            "image: stack touched within proved [bytes]",
            used,
            self.bound(),
        )
    }

    /// Returns the stack of each entry, and the remaining space.
    pub(crate) fn table(&self) -> Table {
        let mut table = Table::new(&[
            "stack of the image, each handler with its exception frame",
            "bytes",
        ]);
        for part in &self.parts {
            table.row(vec![format!("  {}", part.name), part.bytes.to_string()]);
            let large = part.calls.iter().filter(|(_, own)| *own >= SHOWN_BYTES);
            for (name, own) in large {
                table.row(vec![format!("    of which {name}"), own.to_string()]);
            }
        }
        table.row(vec![
            "  all, each handler once upon the other".to_owned(),
            self.bound().to_string(),
        ]);
        table.row(vec!["  reserved".to_owned(), self.reserved.to_string()]);
        let margin = i64::from(self.reserved) - i64::from(self.bound());
        table.row(vec!["  margin".to_owned(), margin.to_string()]);
        table
    }
}

fn parts(code: &Code, vectors: &[u32]) -> Result<Vec<Part>, Unbounded> {
    let mut search = StackSearch::new(code);
    let mut parts = Vec::new();
    let mut seen = BTreeSet::new();
    for (number, &entry) in vectors.iter().enumerate().skip(RESET_VECTOR) {
        let entry = entry & !1;
        if entry == 0 || !seen.insert(entry) {
            continue;
        }
        let frame = if number == RESET_VECTOR {
            0
        } else {
            EXCEPTION_FRAME_BYTES
        };
        let function = code.function(entry);
        let name = function.map_or_else(|| code.place(entry), |function| function.name.clone());
        let bytes = frame + search.bytes(entry)?;
        let calls = search.deepest_calls(entry);
        parts.push(Part { name, bytes, calls });
    }
    Ok(parts)
}

/// Fails if a flashed image has a path to its panic handler.
pub(crate) fn has_no_panic(code: &Code) -> Result<(), Unproved> {
    let panics = code.panics();
    if panics.is_empty() {
        return Ok(());
    }
    let listed = panics.iter().map(|(panic, callers)| {
        if callers.is_empty() {
            return panic.clone();
        }
        let callers: Vec<&str> = callers.iter().map(String::as_str).collect();
        format!("{panic}, called by {}", callers.join(", "))
    });
    Err(Unproved::PanicsLeft(listed.collect()))
}

/// Reads the painted stack from the self-test's output: `stack used=312 of=65536`, in bytes.
pub(crate) fn painted(said: &str) -> Result<u32, Unproved> {
    let line = said
        .lines()
        .find_map(|line| line.strip_prefix("stack used="));
    let used = line.and_then(|rest| rest.split(' ').next()?.parse().ok());
    used.ok_or(Unproved::NotPainted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::code::fixture;

    const IMAGE: &str = "40 Reset:\n 40: push {r7, lr}\n 42: bl 60 <main>\n60 main:\n 60: sub sp, #32\n 62: b.n 62 <main+0x2>\n\
                         80 SysTick:\n 80: push {r4, lr}\n 82: pop {r4, pc}\n90 DefaultHandler:\n 90: b.n 90 <x>\n";

    /// Unused vectors share one handler, which counts once; the first word is the stack pointer, and 0 is not a
    /// handler.
    #[test]
    fn each_handler_counts_once_with_its_exception_frame() {
        let vectors = [0x2002_0000, 0x41, 0x91, 0x91, 0, 0x81, 0x91];
        let parts = parts(&fixture(IMAGE), &vectors).unwrap();
        let parts: Vec<(&str, u32)> = parts
            .iter()
            .map(|part| (part.name.as_str(), part.bytes))
            .collect();
        assert_eq!(
            parts,
            [("Reset", 40), ("DefaultHandler", 108), ("SysTick", 116)]
        );
    }

    fn part(bytes: u32) -> Part {
        Part {
            name: "Handler".to_owned(),
            bytes,
            calls: Vec::new(),
        }
    }

    #[test]
    fn a_stack_one_byte_short_of_its_bound_exceeds_the_budget() {
        let stack = |reserved| Stack {
            parts: [40, 116].map(part).into(),
            reserved,
        };
        let exceeded = |gate| crate::budgets::gate::exceeded(&[gate]).len();
        assert_eq!(exceeded(stack(156).gate("image")), 0);
        assert_eq!(exceeded(stack(155).gate("image")), 1);
        assert_eq!(exceeded(stack(156).painted(156)), 0);
        assert_eq!(exceeded(stack(156).painted(157)), 1);
    }

    #[test]
    fn the_painted_stack_is_read_from_the_self_test_and_missed_if_it_is_silent() {
        assert_eq!(painted("config=p\nstack used=312 of=65536\n").unwrap(), 312);
        for silent in ["", "stack used= of=1", "config=p steps=65536"] {
            assert!(painted(silent).is_err(), "{silent}");
        }
    }

    #[test]
    fn a_panic_that_is_left_is_reported_with_its_caller() {
        assert!(has_no_panic(&fixture(IMAGE)).is_ok());
        let panics =
            format!("{IMAGE}a0 core::panicking::panic:\n a0: b.n a0 <x>\nb0 f:\n b0: bl a0 <x>\n");
        let message = has_no_panic(&fixture(&panics)).unwrap_err().to_string();
        assert!(
            message.contains("core::panicking::panic, called by f"),
            "{message}"
        );
    }
}
