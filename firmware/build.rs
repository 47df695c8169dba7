//! Passes the memory map of the board to the linker, for the ECU only: compiled for the host the image is an ordinary
//! program.

use std::path::Path;
use std::{env, fs};

/// Features that choose a board, with their folders.
const BOARDS: [(&str, &str); 2] = [
    ("CARGO_FEATURE_BOARD_MPS2_AN386", "mps2_an386"),
    ("CARGO_FEATURE_BOARD_NUCLEO_G474RE", "nucleo_g474re"),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let folder = env::var("CARGO_MANIFEST_DIR")?;
    let folder = Path::new(&folder);
    let map = folder.join("../memory.x");
    println!("cargo::rerun-if-changed={}", map.display());
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let chosen: Vec<&str> = BOARDS
        .iter()
        .filter(|(feature, _)| env::var_os(feature).is_some())
        .map(|&(_, board)| board)
        .collect();
    let [board] = chosen[..] else {
        return Err("an image is for one board: choose one feature `board-...`".into());
    };
    let addresses = folder.join("src/boards").join(board).join("board.x");
    println!("cargo::rerun-if-changed={}", addresses.display());
    // Read before `link.x` of cortex-m-rt, which includes `memory.x`.
    println!("cargo::rustc-link-arg-bins=-T{}", addresses.display());
    // If cargo runs the linker in the workspace, the workspace's `memory.x` is found; elsewhere the linker looks for it
    // here.
    let out = env::var("OUT_DIR")?;
    fs::copy(&map, Path::new(&out).join("memory.x"))?;
    println!("cargo::rustc-link-search={out}");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // The strings of the log stay in the ELF, where the host decodes them, and out of the flash.
    println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    // Without this setting only errors would be logged.
    println!("cargo::rustc-env=DEFMT_LOG=info");
    // Page alignment would waste up to 64 KiB between the sections, and this machine has no pages.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    Ok(())
}
