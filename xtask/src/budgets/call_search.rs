//! What is found out about a function needs the same of its callees: each is looked at once, and none may call itself.

use std::collections::HashMap;

use super::code::Code;
use super::instruction::{Flow, Instruction};
use super::unbounded::Unbounded;

/// What a function is searched for.
pub(crate) trait Found: Copy {
    /// Follows the function's own code; of a callee it asks [`CallSearch::function`].
    fn in_body(search: &mut CallSearch<'_, Self>, entry: u32) -> Result<Self, Unbounded>;
}

/// A search that remembers what it found, for an image with several entries.
pub(crate) struct CallSearch<'a, F> {
    pub(crate) code: &'a Code,
    /// The functions whose calls lead here.
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

    /// What the function at this address has, callees included.
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

    /// What is known of a function so far.
    pub(crate) fn known(&self, entry: u32) -> Option<F> {
        self.functions.get(&entry).copied()
    }

    /// The instruction at this address, if it can be followed: it is one, leads into no panic, and says where it goes.
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
