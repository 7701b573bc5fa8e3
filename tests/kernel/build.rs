//! The memory of the emulated board, where the root's `memory.x` includes it, and whether the kernel is the one scheduled
//! by hand.

use std::{env, error::Error, fs, path::Path};

const MPS2: &str = "../../src/bin/firmware/board/mps2/memory.x";
const MPS3: &str = "mps3.x";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={MPS2}");
    println!("cargo::rerun-if-changed={MPS3}");
    println!("cargo::rustc-check-cfg=cfg(hand_scheduled)");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let hand_scheduled = env::var("TARGET")?.starts_with("thumbv7em");
        if hand_scheduled {
            println!("cargo::rustc-cfg=hand_scheduled");
        }
        let memory = if hand_scheduled { MPS2 } else { MPS3 };
        let out = env::var("OUT_DIR")?;
        fs::copy(memory, Path::new(&out).join("board-memory.x"))?;
        println!("cargo::rustc-link-search={out}");
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
        println!("cargo::rustc-link-arg-bins=--nmagic");
    }
    Ok(())
}
