//! Gives the linker the memory map, for the ECU only: compiled for the host the image is an ordinary program.

use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let memory_map = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../memory.x");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={}", memory_map.display());
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    // `link.x` of cortex-m-rt includes a file `memory.x`, which the linker looks for on its search path.
    let out = env::var("OUT_DIR")?;
    fs::copy(&memory_map, Path::new(&out).join("memory.x"))?;
    println!("cargo::rustc-link-search={out}");
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // Page alignment would waste up to 64 KiB between the sections of a machine that has no pages.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    Ok(())
}
