//! Flash and RAM of an image by crate, each within its budget.
//!
//! A function counts for the crate that its symbol names; code that the compiler inlined counts where it was inlined.

use std::collections::BTreeMap;

use super::elf::{Elf, Symbol};
use super::gate::Gate;
use super::table::Table;
use crate::failure::Failure;

/// Budget of one crate, or of all crates without a line of their own.
struct Room {
    of: &'static str,
    flash_bytes: u32,
    ram_bytes: u32,
}

const fn room(of: &'static str, flash_bytes: u32, ram_bytes: u32) -> Room {
    Room {
        of,
        flash_bytes,
        ram_bytes,
    }
}

/// Functions of the compiler: copying, 64-bit division.
const BUILTINS: &str = "compiler_builtins";
/// Texts and tables that the compiler moved out of functions.
const CONSTANTS: &str = "constants without name";
/// Everything without a line of its own in [`ROOMS`], including the vector table.
const OTHERS: &str = "others";
/// Constants that the linker keeps without a symbol, and the gaps between sections.
const UNNAMED: &str = "without symbol";

/// Budget of each crate (bytes): its size when the budget was set, and about a third more.
const ROOMS: [Room; 10] = [
    room("firmware", 18_432, 8_192),
    room("ecu", 32_768, 0),
    room("hil_protocol", 3_072, 0),
    room("controller", 14_336, 0),
    room("postcard", 8_192, 0),
    room("core", 1_024, 0),
    room(BUILTINS, 4_096, 0),
    room(CONSTANTS, 6_144, 0),
    room(OTHERS, 4_096, 256),
    room(UNNAMED, 1_024, 256),
];

/// Flash and RAM (bytes).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) flash: u32,
    pub(crate) ram: u32,
}

/// Returns the sizes of an image by the lines of the budget; their sum is the image.
pub(crate) fn sizes(elf: &Elf) -> Result<BTreeMap<&'static str, Size>, Failure> {
    let total = Size {
        flash: elf.bytes_in(super::elf::Memory::is_flash)?,
        ram: elf.bytes_in(super::elf::Memory::is_ram)?,
    };
    Ok(by_crate(&elf.symbols()?, total))
}

fn by_crate(symbols: &[Symbol], total: Size) -> BTreeMap<&'static str, Size> {
    let mut sizes: BTreeMap<&'static str, Size> = ROOMS
        .iter()
        .map(|room| (room.of, Size::default()))
        .collect();
    let mut named = Size::default();
    for symbol in symbols {
        let size = sizes.entry(line_of(&symbol.name)).or_default();
        let flash = if symbol.memory.is_flash() {
            symbol.bytes
        } else {
            0
        };
        let ram = if symbol.memory.is_ram() {
            symbol.bytes
        } else {
            0
        };
        size.flash += flash;
        size.ram += ram;
        named.flash += flash;
        named.ram += ram;
    }
    let unnamed = sizes.entry(UNNAMED).or_default();
    unnamed.flash += total.flash.saturating_sub(named.flash);
    unnamed.ram += total.ram.saturating_sub(named.ram);
    sizes
}

/// Returns the line of the budget that a symbol counts for.
fn line_of(name: &str) -> &'static str {
    let own = crate_of(name);
    let own = match own {
        "" if name.starts_with(".L") => CONSTANTS,
        "" if name.starts_with("mem") => BUILTINS,
        "" if name.starts_with("__") && !name.contains(char::is_uppercase) => BUILTINS,
        _ => own,
    };
    let room = ROOMS.iter().find(|room| room.of == own);
    room.map_or(OTHERS, |room| room.of)
}

/// Returns the crate in the name of a function or variable. For `for` and `as` the type in front of them counts; for a
/// type of the language itself, the trait.
fn crate_of(name: &str) -> &str {
    let name = name.trim_start_matches(['<', '&', '*', '[', '(']);
    let name = ["mut ", "const ", "dyn ", "impl "]
        .iter()
        .fold(name, |name, word| name.strip_prefix(word).unwrap_or(name));
    let end = name
        .find(|c: char| !c.is_alphanumeric() && c != '_')
        .unwrap_or(name.len());
    let (first, rest) = name.split_at(end);
    if rest.starts_with("::") {
        return first;
    }
    match rest.split_once(" as ") {
        Some((_, of_trait)) => crate_of(of_trait),
        None => "",
    }
}

/// Returns the sizes as a table.
pub(crate) fn table(sizes: &BTreeMap<&'static str, Size>) -> Table {
    let mut table = Table::new(&["image, bytes", "flash", "allowed", "RAM", "allowed"]);
    let line = |name: &str, size: Size, room: [u32; 2]| {
        let figures = [size.flash, room[0], size.ram, room[1]];
        let mut row = vec![format!("  {name}")];
        row.extend(figures.map(|figure| figure.to_string()));
        row
    };
    let mut sum = Size::default();
    for room in &ROOMS {
        let size = sizes.get(room.of).copied().unwrap_or_default();
        sum.flash += size.flash;
        sum.ram += size.ram;
        table.row(line(room.of, size, [room.flash_bytes, room.ram_bytes]));
    }
    let allowed = [
        ROOMS.iter().map(|room| room.flash_bytes).sum(),
        ROOMS.iter().map(|room| room.ram_bytes).sum(),
    ];
    table.row(line("all", sum, allowed));
    table
}

/// Compares each crate's flash and RAM with its budget.
pub(crate) fn gates(sizes: &BTreeMap<&'static str, Size>) -> Vec<Gate> {
    let gates = ROOMS.iter().flat_map(|room| {
        let size = sizes.get(room.of).copied().unwrap_or_default();
        [
            Gate::at_most(
                &format!("flash of {} [bytes]", room.of),
                size.flash,
                room.flash_bytes,
            ),
            Gate::at_most(
                &format!("RAM of {} [bytes]", room.of),
                size.ram,
                room.ram_bytes,
            ),
        ]
    });
    gates.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budgets::elf::Memory;
    use crate::budgets::gate::exceeded;

    #[test]
    fn a_symbol_belongs_to_the_crate_of_its_type_or_else_of_its_trait() {
        for (name, of) in [
            ("ecu::ecu::Ecu::sample", "ecu"),
            (
                "<firmware::boards::Board as firmware::board::Board>::measure",
                "firmware",
            ),
            (
                "<&mut hil_protocol::frame::Encoder as core::fmt::Write>::write_str",
                "hil_protocol",
            ),
            ("<usize as core::fmt::Display>::fmt", "core"),
            (
                "<[T] as serde_core::ser::Serialize>::serialize",
                "serde_core",
            ),
            (
                "serde_core::de::impls::<impl serde_core::de::Deserialize for Option<T>>::deserialize",
                "serde_core",
            ),
            ("__aeabi_memcpy4", ""),
            (".Lanon.88b9.146", ""),
        ] {
            assert_eq!(crate_of(name), of, "{name}");
        }
    }

    #[test]
    fn what_names_no_crate_counts_for_the_compiler_for_constants_or_for_others() {
        for (name, of) in [
            ("controller::step::step", "controller"),
            ("__aeabi_memcpy4", BUILTINS),
            ("memcmp", BUILTINS),
            ("__divmoddi4", BUILTINS),
            (".Lanon.88b9.146", CONSTANTS),
            ("__INTERRUPTS", OTHERS),
            ("Reset", OTHERS),
            ("defmt::export::fmt", OTHERS),
        ] {
            assert_eq!(line_of(name), of, "{name}");
        }
    }

    fn symbol(name: &str, bytes: u32, memory: Memory) -> Symbol {
        Symbol {
            name: name.to_owned(),
            address: 0,
            bytes,
            memory,
        }
    }

    #[test]
    fn the_lines_add_up_to_the_image() {
        let symbols = [
            symbol("controller::step", 100, Memory::Code),
            symbol("ecu::STATE", 8, Memory::Data),
            symbol("heapless::BUFFER", 32, Memory::Zeroed),
        ];
        let total = Size {
            flash: 120,
            ram: 40,
        };
        let sizes = by_crate(&symbols, total);
        assert_eq!(sizes["controller"], Size { flash: 100, ram: 0 });
        assert_eq!(sizes["ecu"], Size { flash: 8, ram: 8 });
        assert_eq!(sizes[OTHERS], Size { flash: 0, ram: 32 });
        assert_eq!(sizes[UNNAMED], Size { flash: 12, ram: 0 });
    }

    #[test]
    fn one_byte_beyond_a_crates_room_is_reported_and_no_other() {
        let full: BTreeMap<_, _> = ROOMS
            .iter()
            .map(|room| {
                let size = Size {
                    flash: room.flash_bytes,
                    ram: room.ram_bytes,
                };
                (room.of, size)
            })
            .collect();
        assert_eq!(exceeded(&gates(&full)), Vec::<String>::new());
        for room in &ROOMS {
            let mut more = full.clone();
            more.get_mut(room.of).unwrap().ram += 1;
            let exceeded = exceeded(&gates(&more));
            assert_eq!(exceeded.len(), 1, "{exceeded:?}");
            assert!(exceeded[0].starts_with(&format!("RAM of {} ", room.of)));
        }
    }
}
