//! Memory layout of the emulated board, put where the root's `memory.x` includes it, for this
//! comparison and for `benches/instructions`, which is at the same depth of the tree.

use std::{env, error::Error, fs, path::Path};

/// Cortex-M4F and M7: mps2-an386, mps2-an500.
const MPS2: &str = "../../tests/kernel/mps2.x";
/// Cortex-M55: mps3-an547.
const MPS3: &str = "../../tests/kernel/mps3.x";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=../../tests/kernel/build.rs");
    println!("cargo::rerun-if-changed={MPS2}");
    println!("cargo::rerun-if-changed={MPS3}");
    println!("cargo::rustc-check-cfg=cfg(mps2)");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let is_mps2 = env::var("TARGET")?.starts_with("thumbv7em");
        if is_mps2 {
            println!("cargo::rustc-cfg=mps2");
        }
        let memory = if is_mps2 { MPS2 } else { MPS3 };
        let out = env::var("OUT_DIR")?;
        fs::copy(memory, Path::new(&out).join("board-memory.x"))?;
        println!("cargo::rustc-link-search={out}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
