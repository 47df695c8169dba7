//! Gives the linker the memory map of the board, for the ECU only: compiled for the host the image is an ordinary program.

use std::path::Path;
use std::{env, fs};

/// Features that choose a board, and where its memory map lies.
const BOARDS: [(&str, &str); 1] = [("CARGO_FEATURE_BOARD_MPS2_AN386", "../memory.x")];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = env::var("CARGO_MANIFEST_DIR")?;
    for (_, memory_map) in BOARDS {
        let path = Path::new(&folder).join(memory_map);
        println!("cargo::rerun-if-changed={}", path.display());
    }
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let chosen: Vec<&str> = BOARDS
        .iter()
        .filter(|(feature, _)| env::var_os(feature).is_some())
        .map(|&(_, memory_map)| memory_map)
        .collect();
    let [memory_map] = chosen[..] else {
        return Err("an image is for one board: choose one feature `board-...`".into());
    };
    // `link.x` of cortex-m-rt includes a file `memory.x`, which the linker looks for on its search path.
    let out = env::var("OUT_DIR")?;
    fs::copy(
        Path::new(&folder).join(memory_map),
        Path::new(&out).join("memory.x"),
    )?;
    println!("cargo::rustc-link-search={out}");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // The strings of the log stay in the ELF, for whoever decodes it, and out of the flash.
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    // Without a word about it only errors would be logged.
    println!("cargo::rustc-env=DEFMT_LOG=info");
    // Page alignment would waste up to 64 KiB between the sections of a machine that has no pages.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    Ok(())
}
