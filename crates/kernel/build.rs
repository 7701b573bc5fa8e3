//! Decides which kernel a target gets: its features cannot be asked for in the sources of a stable compiler.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(hand_scheduled)");
    let target = env::var("TARGET").unwrap_or_default();
    if target.starts_with("thumbv7em-") && target.ends_with("eabihf") {
        println!("cargo::rustc-cfg=hand_scheduled");
    }
}
