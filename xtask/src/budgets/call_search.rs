//! Search over a function and its callees: each is visited once, and none may call itself.

use std::collections::HashMap;

use super::code::Code;
use super::instruction::{Flow, Instruction};
use super::unbounded::Unbounded;

/// Property that a function is searched for.
pub(crate) trait Found: Copy {
    /// Follows the function's own code; [`CallSearch::function`] gives the property of a callee.
    fn in_body(search: &mut CallSearch<'_, Self>, entry: u32) -> Result<Self, Unbounded>;
}

/// Search with a memory of its results, for an image with several entries.
pub(crate) struct CallSearch<'a, F> {
    pub(crate) code: &'a Code,
    /// Functions whose calls lead to the current one.
    callers: Vec<u32>,
    functions: HashMap<u32, F>,
}

impl<'a, F: Found> CallSearch<'a, F> {
    pub(crate) fn new(code: &'a Code) -> Self {
        Self {
            code,
            callers: Vec::new(),
            functions: HashMap::new(),
        }
    }

    /// Returns the property of the function at this address, callees included.
    pub(crate) fn function(&mut self, entry: u32) -> Result<F, Unbounded> {
        if let Some(&found) = self.functions.get(&entry) {
            return Ok(found);
        }
        if self.callers.contains(&entry) {
            let at = self.code.place(entry);
            return Err(Unbounded::Recursion { at });
        }
        self.callers.push(entry);
        let found = F::in_body(self, entry)?;
        self.callers.pop();
        self.functions.insert(entry, found);
        Ok(found)
    }

    /// Returns the property of a function if it is already known.
    pub(crate) fn known(&self, entry: u32) -> Option<F> {
        self.functions.get(&entry).copied()
    }

    /// Returns the instruction at this address if it can be followed: it exists, does not lead to a panic, and its
    /// targets are known.
    pub(crate) fn instruction(&self, address: u32) -> Result<&'a Instruction, Unbounded> {
        let Some(instruction) = self.code.at(address) else {
            let at = self.code.place(address);
            return Err(Unbounded::NoCode { at });
        };
        if let Some(function) = self.code.panic_from(address) {
            return Err(self.code.panics_at(address, function));
        }
        let is_unknown = match instruction.flow {
            Flow::IndirectCall | Flow::IndirectJump => true,
            Flow::Table(_) => self.code.successors(address).is_empty(),
            _ => false,
        };
        if is_unknown {
            return Err(self.code.indirect_at(address));
        }
        Ok(instruction)
    }
}
