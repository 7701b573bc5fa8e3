//! The memory of the emulated board, where the root's `memory.x` includes it.

use std::{env, error::Error, fs, path::Path};

const MPS2: &str = "../../src/bin/firmware/board/mps2/memory.x";
const MPS3: &str = "../../tests/kernel/mps3.x";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={MPS2}");
    println!("cargo::rerun-if-changed={MPS3}");
    println!("cargo::rustc-check-cfg=cfg(mps3)");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let mps3 = env::var("TARGET")?.starts_with("thumbv8m");
        if mps3 {
            println!("cargo::rustc-cfg=mps3");
        }
        let out = env::var("OUT_DIR")?;
        let memory = if mps3 { MPS3 } else { MPS2 };
        fs::copy(memory, Path::new(&out).join("board-memory.x"))?;
        println!("cargo::rustc-link-search={out}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
