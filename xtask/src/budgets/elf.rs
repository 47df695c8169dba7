//! Image as the linker wrote it: symbols, sections, vector table.

use std::fs;
use std::path::{Path, PathBuf};

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use super::unproved::Unproved;
use crate::failure::Failure;

/// Bytes of an ELF file.
pub(crate) struct Elf {
    path: PathBuf,
    bytes: Vec<u8>,
}

/// Function or variable, with its size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Symbol {
    /// Name in Rust's notation.
    pub(crate) name: String,
    pub(crate) address: u32,
    pub(crate) bytes: u32,
    pub(crate) memory: Memory,
}

/// Memory of a section while the image runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Memory {
    /// Instructions.
    Code,
    /// Constants.
    Constants,
    /// Variables with a value at reset, which also take flash.
    Data,
    /// Variables that are zero at reset, or not initialised.
    Zeroed,
}

impl Memory {
    fn of(kind: SectionKind) -> Option<Self> {
        match kind {
            SectionKind::Text => Some(Self::Code),
            SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => Some(Self::Constants),
            SectionKind::Data => Some(Self::Data),
            SectionKind::UninitializedData => Some(Self::Zeroed),
            // Sections for the host only: the log's texts, debug information.
            _ => None,
        }
    }

    pub(crate) fn is_flash(self) -> bool {
        self != Self::Zeroed
    }

    pub(crate) fn is_ram(self) -> bool {
        matches!(self, Self::Data | Self::Zeroed)
    }
}

impl Elf {
    /// Reads an image.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let path = path.to_owned();
        let bytes = fs::read(&path).map_err(|source| Failure::File {
            path: path.clone(),
            source,
        })?;
        Ok(Self { path, bytes })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns all functions and variables, each once.
    pub(crate) fn symbols(&self) -> Result<Vec<Symbol>, Failure> {
        let file = self.file()?;
        let mut symbols: Vec<Symbol> = Vec::new();
        for symbol in file.symbols().filter(|symbol| symbol.size() > 0) {
            let section = symbol
                .section_index()
                .and_then(|index| file.section_by_index(index).ok());
            let Some(memory) = section.and_then(|section| Memory::of(section.kind())) else {
                continue;
            };
            // Bit 0 of a function's address marks Thumb code.
            let thumb = u64::from(symbol.kind() == SymbolKind::Text);
            let name = symbol.name().unwrap_or("without name");
            symbols.push(Symbol {
                name: format!("{:#}", rustc_demangle::demangle(name)),
                address: (symbol.address() & !thumb) as u32,
                bytes: symbol.size() as u32,
                memory,
            });
        }
        symbols.sort_by_key(|symbol| symbol.address);
        // The compiler merges identical functions into one body with several names.
        symbols.dedup_by_key(|symbol| symbol.address);
        Ok(symbols)
    }

    /// Returns the bytes of all sections of a kind.
    pub(crate) fn bytes_in(&self, wanted: fn(Memory) -> bool) -> Result<u32, Failure> {
        let file = self.file()?;
        let sections = file.sections();
        let sections = sections.filter(|section| Memory::of(section.kind()).is_some_and(wanted));
        Ok(sections.map(|section| section.size() as u32).sum())
    }

    /// Returns the value of a symbol that the linker script defines.
    pub(crate) fn address_of(&self, name: &'static str) -> Result<u32, Failure> {
        let file = self.file()?;
        let symbol = file.symbol_by_name(name);
        let missing = || Unproved::NoSymbol {
            path: self.path.clone(),
            name,
        };
        Ok(symbol.ok_or_else(missing)?.address() as u32)
    }

    /// Returns the words of the vector table.
    pub(crate) fn vectors(&self) -> Result<Vec<u32>, Failure> {
        const SECTION: &str = ".vector_table";
        let file = self.file()?;
        let missing = || Unproved::NoSymbol {
            path: self.path.clone(),
            name: SECTION,
        };
        let section = file.section_by_name(SECTION).ok_or_else(missing)?;
        let bytes = section.data().map_err(|source| self.broken(source))?;
        let words = bytes.chunks_exact(4);
        Ok(words
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect())
    }

    fn file(&self) -> Result<object::File<'_>, Failure> {
        object::File::parse(&*self.bytes).map_err(|source| self.broken(source).into())
    }

    fn broken(&self, source: object::Error) -> Unproved {
        Unproved::Elf {
            path: self.path.clone(),
            source,
        }
    }
}
