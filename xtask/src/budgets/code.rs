//! Linked code of an image: its instructions by address, and their functions.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use std::time::Duration;

use super::elf::{Elf, Memory};
use super::instruction::{Flow, Instruction};
use super::unbounded::Unbounded;
use crate::failure::Failure;
use crate::packages;
use crate::process;
use crate::workspace::find_program;

const DISASSEMBLER: &str = "arm-none-eabi-objdump";
const DEADLINE: Duration = Duration::from_secs(120);

/// Function of the image, from its symbol.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) start: u32,
    pub(crate) end: u32,
}

impl Function {
    pub(crate) fn bytes(&self) -> u32 {
        self.end - self.start
    }

    /// Returns whether the function only panics: the core library's paths to the panic handler, and the handler.
    pub(crate) fn panics(&self) -> bool {
        let name = self.name.as_str();
        let in_core = name.starts_with("core::")
            && (name.contains("::panic") || name.ends_with("_fail") || name.ends_with("_failed"));
        in_core || name.ends_with("rust_begin_unwind")
    }
}

/// All code of an image.
#[derive(Default)]
pub(crate) struct Code {
    instructions: BTreeMap<u32, Instruction>,
    /// Constants between the instructions, by byte.
    data: BTreeMap<u32, u8>,
    /// Functions by start; no two begin at the same address.
    functions: BTreeMap<u32, Function>,
}

/// Installs the disassembler if it is missing.
pub(crate) fn ready() -> Result<(), Failure> {
    match find_program(DISASSEMBLER) {
        Some(_) => Ok(()),
        None => packages::install("a disassembler for ARM", &["binutils-arm-none-eabi"]),
    }
}

impl Code {
    /// Disassembles an image.
    pub(crate) fn of(elf: &Elf) -> Result<Self, Failure> {
        let mut disassembler = Command::new(DISASSEMBLER);
        disassembler
            .args(["--disassemble", "--no-show-raw-insn"])
            .arg(elf.path());
        let text = process::capture(&mut disassembler, DEADLINE)?;
        let symbols = elf.symbols()?.into_iter();
        let functions = symbols.filter(|symbol| symbol.memory == Memory::Code);
        Ok(Self::read(
            &text,
            functions.map(|symbol| Function {
                name: symbol.name,
                start: symbol.address,
                end: symbol.address + symbol.bytes,
            }),
        ))
    }

    /// Reads the disassembler's text.
    pub(crate) fn read(text: &str, functions: impl IntoIterator<Item = Function>) -> Self {
        let mut code = Self::default();
        for line in text.lines() {
            code.add(line);
        }
        for function in functions {
            code.functions.entry(function.start).or_insert(function);
        }
        code
    }

    /// Adds a line with address, mnemonic and operands separated by tabs: `2e: bl 5c <name+0x4> @ comment`. Other lines
    /// are headings.
    fn add(&mut self, line: &str) -> Option<()> {
        let (address, rest) = line.split_once(":\t")?;
        let address = u32::from_str_radix(address.trim(), 16).ok()?;
        let rest = rest.split(['@', ';']).next().unwrap_or(rest);
        let (mnemonic, operands) = rest
            .trim_end()
            .split_once('\t')
            .unwrap_or((rest.trim_end(), ""));
        match mnemonic {
            ".word" => self.add_data(address, operands, 4),
            ".short" => self.add_data(address, operands, 2),
            ".byte" => self.add_data(address, operands, 1),
            // An instruction that the disassembler cannot read is left out: a path that reaches it ends with an error.
            _ if !mnemonic.starts_with(|c: char| c.is_ascii_lowercase()) => None,
            _ => {
                let instruction = Instruction::read(mnemonic, operands.trim_end());
                self.instructions.insert(address, instruction);
                Some(())
            }
        }
    }

    fn add_data(&mut self, address: u32, value: &str, bytes: usize) -> Option<()> {
        let value = u32::from_str_radix(value.trim().strip_prefix("0x")?, 16).ok()?;
        let bytes = value.to_le_bytes().into_iter().take(bytes);
        self.data.extend((address..).zip(bytes));
        Some(())
    }

    pub(crate) fn at(&self, address: u32) -> Option<&Instruction> {
        self.instructions.get(&address)
    }

    /// Returns the address after an instruction: another one, a constant or the end of the code.
    fn after(&self, address: u32) -> u32 {
        let behind = address + 1..;
        let instruction = self.instructions.range(behind.clone()).next();
        let constant = self.data.range(behind).next();
        let instruction = instruction.map(|(&at, _)| at);
        let constant = constant.map(|(&at, _)| at);
        let next = instruction.into_iter().chain(constant).min();
        next.unwrap_or(u32::MAX)
    }

    /// Returns the function that contains an address.
    pub(crate) fn function(&self, address: u32) -> Option<&Function> {
        let (_, function) = self.functions.range(..=address).next_back()?;
        (address < function.end).then_some(function)
    }

    /// Returns the functions that only panic, each with its callers.
    pub(crate) fn panics(&self) -> BTreeMap<String, BTreeSet<String>> {
        let functions = self.functions.values().filter(|function| function.panics());
        let mut panics: BTreeMap<String, BTreeSet<String>> = functions
            .map(|function| (function.name.clone(), BTreeSet::new()))
            .collect();
        for &address in self.instructions.keys() {
            let caller = self.function(address).filter(|caller| !caller.panics());
            if let (Some(panic), Some(caller)) = (self.panic_from(address), caller) {
                let callers = panics.entry(panic.name.clone()).or_default();
                callers.insert(caller.name.clone());
            }
        }
        panics
    }

    /// Returns the function through which the instruction at this address panics, if it calls or jumps to one.
    pub(crate) fn panic_from(&self, address: u32) -> Option<&Function> {
        match self.at(address)?.flow {
            Flow::Call(target) | Flow::Jump(target) => {
                self.function(target).filter(|function| function.panics())
            }
            _ => None,
        }
    }

    /// Returns the reason why there is no bound: the instruction at this address panics through `function`.
    pub(crate) fn panics_at(&self, address: u32, function: &Function) -> Unbounded {
        Unbounded::Panic {
            at: self.place(address),
            function: function.name.clone(),
        }
    }

    /// Returns the reason why there is no bound: the target of the instruction at this address is in a register.
    pub(crate) fn indirect_at(&self, address: u32) -> Unbounded {
        Unbounded::Indirect {
            at: self.place(address),
            text: self.text(address),
        }
    }

    /// Returns the reason why there is no bound: the instruction at this address moves the stack pointer by an unknown
    /// amount.
    pub(crate) fn stack_pointer_at(&self, address: u32) -> Unbounded {
        Unbounded::StackPointer {
            at: self.place(address),
            text: self.text(address),
        }
    }

    fn text(&self, address: u32) -> String {
        let instruction = self.at(address);
        instruction.map_or_else(String::new, |instruction| instruction.text.clone())
    }

    /// Formats an address as `name+0x12`.
    pub(crate) fn place(&self, address: u32) -> String {
        match self.function(address) {
            Some(function) => format!("{}+{:#x}", function.name, address - function.start),
            None => format!("{address:#010x}"),
        }
    }

    /// Returns the possible next addresses within the same call, without entering called functions.
    pub(crate) fn successors(&self, address: u32) -> Vec<u32> {
        let Some(instruction) = self.at(address) else {
            return Vec::new();
        };
        match instruction.flow {
            Flow::Next | Flow::Call(_) | Flow::IndirectCall | Flow::ReturnOrNext => {
                vec![self.after(address)]
            }
            Flow::Jump(target) => vec![target],
            Flow::Branch(target) => vec![target, self.after(address)],
            Flow::Table(entry_bytes) => self.table(address, entry_bytes),
            Flow::Return | Flow::IndirectJump | Flow::Trap => Vec::new(),
        }
    }

    /// Returns the targets of a TBB or TBH: its table lies after it, each entry half the distance from there.
    ///
    /// The table ends with the constants after the instruction. A table of odd length ends with a byte of padding,
    /// which leads into the table itself and not to an instruction.
    fn table(&self, address: u32, entry_bytes: u32) -> Vec<u32> {
        let base = address + 4;
        let byte = |at: u32| self.data.get(&at).map(|&byte| u32::from(byte));
        let entry = |at: u32| match entry_bytes {
            1 => byte(at),
            _ => Some(byte(at)? | byte(at + 1)? << 8),
        };
        let entries = (base..).step_by(entry_bytes as usize).map_while(entry);
        let mut targets: Vec<u32> = entries
            .map(|entry| base + 2 * entry)
            .filter(|target| self.instructions.contains_key(target))
            .collect();
        targets.sort_unstable();
        targets.dedup();
        targets
    }
}

/// Creates code for a test: `0 name:` begins a function, ` 2: adds r0, #1` is an instruction.
#[cfg(test)]
pub(crate) fn fixture(text: &str) -> Code {
    let mut functions: Vec<Function> = Vec::new();
    let mut disassembly = String::new();
    for line in text.lines() {
        match line.trim_end_matches(':').split_once(' ') {
            Some((start, name))
                if !line.starts_with(' ') && line.ends_with(':') && !start.ends_with(':') =>
            {
                let start = u32::from_str_radix(start, 16).unwrap();
                if let Some(last) = functions.last_mut() {
                    last.end = start;
                }
                functions.push(Function {
                    name: name.to_owned(),
                    start,
                    end: u32::MAX,
                });
            }
            _ => {
                let (address, rest) = line.trim().split_once(": ").unwrap();
                let rest = rest.replacen(' ', "\t", 1);
                disassembly.push_str(&format!("{address}:\t{rest}\n"));
            }
        }
    }
    Code::read(&disassembly, functions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(name: &str) -> Function {
        Function {
            name: name.to_owned(),
            start: 0,
            end: 4,
        }
    }

    #[test]
    fn the_ways_to_the_panic_handler_are_distinguished_from_functions_that_only_sound_so() {
        for name in [
            "__rustc::rust_begin_unwind",
            "rust_begin_unwind",
            "core::panicking::panic_bounds_check",
            "core::panicking::panic_const::panic_const_add_overflow",
            "core::option::unwrap_failed",
            "core::slice::index::slice_start_index_len_fail",
            "core::cell::panic_already_borrowed",
        ] {
            assert!(function(name).panics(), "{name}");
        }
        for name in [
            "ecu::fault::on_fail",
            "firmware::panic_count",
            "core::fmt::write",
            "Reset",
        ] {
            assert!(!function(name).panics(), "{name}");
        }
    }

    #[test]
    fn each_panic_is_listed_with_those_who_call_it() {
        let code = fixture(
            "0 f:\n 0: bl 20 <x>\n 4: bl 20 <x>\n10 g:\n 10: b.w 20 <x>\n\
             20 core::panicking::panic:\n 20: b.w 30 <y>\n30 rust_begin_unwind:\n 30: b.n 30 <y>\n",
        );
        let panics = code.panics();
        let callers: Vec<&str> = panics["core::panicking::panic"]
            .iter()
            .map(String::as_str)
            .collect();
        assert_eq!(callers, ["f", "g"]);
        assert_eq!(panics.len(), 2);
    }

    #[test]
    fn what_the_disassembler_cannot_read_is_no_instruction() {
        let code = fixture("0 f:\n 0: nop\n 2: <UNDEFINED> instruction: 0xffff\n");
        assert!(code.at(0).is_some() && code.at(2).is_none());
    }

    #[test]
    fn comments_of_either_style_are_no_operands() {
        let code = Code::read("   0:\tsub\tsp, #8\t@ 0x8\n   2:\tadd\tsp, #8\t; 0x8\n", []);
        let texts: Vec<&str> = [0, 2].map(|at| code.at(at).unwrap().text.as_str()).into();
        assert_eq!(texts, ["sub sp, #8", "add sp, #8"]);
    }
}
