//! Linker arguments of the firmware and the memory of its board. They stand here, and not in RUSTFLAGS, so that a user's
//! flags cannot displace them. A build of the library alone gets none.

use std::{env, fs, io, path::PathBuf};

/// Features that choose a board, and where its memory is described.
const BOARDS: [(&str, &str); 1] = [(
    "CARGO_FEATURE_BOARD_MPS2",
    "src/bin/firmware/board/mps2/memory.x",
)];

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    let board = BOARDS
        .iter()
        .find(|(feature, _)| env::var_os(feature).is_some());
    let for_target = env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none");
    if let (true, Some((_, memory)), Some(out)) = (for_target, board, env::var_os("OUT_DIR")) {
        // The linker finds the root's memory.x, which includes this one.
        fs::copy(memory, PathBuf::from(&out).join("board-memory.x"))?;
        println!("cargo::rerun-if-changed={memory}");
        println!("cargo::rerun-if-changed=memory.x");
        println!("cargo::rustc-link-search={}", out.display());
        for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
            println!("cargo::rustc-link-arg-bins={argument}");
        }
        log_level();
    }
    Ok(())
}

/// Without the variable only errors would be compiled in.
fn log_level() {
    println!("cargo::rerun-if-env-changed=DEFMT_LOG");
    if env::var_os("DEFMT_LOG").is_none() {
        println!("cargo::rustc-env=DEFMT_LOG=info");
    }
}
