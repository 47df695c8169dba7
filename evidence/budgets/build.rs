//! Passes the linker script and the baselines in C to the linker, for the ECU only: compiled for the host there is
//! nothing to link.

use std::env;

fn main() -> Result<(), env::VarError> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=c");
    // `link.x` of cortex-m-rt includes a file `memory.x`, which the linker finds in the folder where cargo starts it,
    // the workspace's.
    println!("cargo::rerun-if-changed=../../memory.x");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // Page alignment would waste up to 64 KiB between the sections, and this machine has no pages.
    println!("cargo::rustc-link-arg-bins=--nmagic");
    #[cfg(feature = "c-baselines")]
    compile_baselines();
    Ok(())
}

/// Compiles each baseline twice, for speed and for size; its name ends in `_o2` or `_os`. All flags are explicit: none
/// is cargo's or cc's.
#[cfg(feature = "c-baselines")]
fn compile_baselines() {
    for optimisation in ["O2", "Os"] {
        let mut build = cc::Build::new();
        build
            .compiler("arm-none-eabi-gcc")
            .archiver("arm-none-eabi-ar")
            .no_default_flags(true);
        // Freestanding: no header and no function of a C library, which the compiler's package does not contain.
        build.flags(["-std=c11", "-ffreestanding", "-Wall", "-Wextra", "-Werror"]);
        build.flags(["-mcpu=cortex-m4", "-mthumb"]);
        build.flags(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
        build.flags(["-ffunction-sections", "-fdata-sections"]);
        build.flag(format!("-{optimisation}"));
        build.define(
            "OPTIMISATION",
            Some(format!("_{}", optimisation.to_lowercase()).as_str()),
        );
        build.files(["c/saturating.c", "c/tuned.c", "c/float.c"]);
        build.compile(&format!("baselines_{optimisation}"));
    }
}
