//! The memory of the emulated board, where the root's `memory.x` includes it.

use std::{env, error::Error, fs, path::Path};

const MEMORY: &str = "../../src/bin/firmware/board/mps2/memory.x";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={MEMORY}");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let out = env::var("OUT_DIR")?;
        fs::copy(MEMORY, Path::new(&out).join("board-memory.x"))?;
        println!("cargo::rustc-link-search={out}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
