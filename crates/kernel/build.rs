//! Selection of the kernel for a target, in the build script because the sources of a stable
//! compiler cannot query the target's features.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(hand_scheduled)");
    let target = env::var("TARGET").unwrap_or_default();
    if target.starts_with("thumbv7em-") && target.ends_with("eabihf") {
        println!("cargo::rustc-cfg=hand_scheduled");
    }
}
