//! Gives the linker the memory map and the baselines in C, for the ECU only: compiled for the host there is nothing to link.

use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let here = env::var("CARGO_MANIFEST_DIR")?;
    let memory_map = Path::new(&here).join("memory.x");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=c");
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
    #[cfg(feature = "c-baselines")]
    compile_baselines();
    Ok(())
}

/// Each baseline twice, for speed and for size; `_O2` and `_Os` end its name. All flags are stated: none is cargo's or cc's.
#[cfg(feature = "c-baselines")]
fn compile_baselines() {
    for optimisation in ["O2", "Os"] {
        let mut build = cc::Build::new();
        build
            .compiler("arm-none-eabi-gcc")
            .archiver("arm-none-eabi-ar")
            .no_default_flags(true);
        build.flags(["-std=c11", "-Wall", "-Wextra", "-Werror"]);
        build.flags(["-mcpu=cortex-m4", "-mthumb"]);
        build.flags(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
        build.flags(["-ffunction-sections", "-fdata-sections"]);
        build.flag(format!("-{optimisation}"));
        build.define("OPTIMISATION", Some(format!("_{optimisation}").as_str()));
        build.files(["c/saturating.c", "c/tuned.c", "c/float.c"]);
        build.compile(&format!("baselines_{optimisation}"));
    }
}
