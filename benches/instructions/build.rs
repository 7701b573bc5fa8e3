//! The memory of the emulated board, where the root's `memory.x` includes it.

use std::{env, error::Error, fs, path::Path};

/// Cortex-M4F and M7: mps2-an386, mps2-an500.
const MPS2: &str = "../../src/bin/firmware/board/mps2/memory.x";
/// Cortex-M55: mps3-an547.
const MPS3: &str = "../../tests/kernel/mps3.x";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={MPS2}");
    println!("cargo::rerun-if-changed={MPS3}");
    println!("cargo::rustc-check-cfg=cfg(mps3)");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let is_mps3 = env::var("TARGET")?.starts_with("thumbv8m.main-");
        if is_mps3 {
            println!("cargo::rustc-cfg=mps3");
        }
        let memory = if is_mps3 { MPS3 } else { MPS2 };
        let out = env::var("OUT_DIR")?;
        fs::copy(memory, Path::new(&out).join("board-memory.x"))?;
        println!("cargo::rustc-link-search={out}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
