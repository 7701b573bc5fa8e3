//! Linker arguments of the check, set here and not in RUSTFLAGS, so that a user's flags cannot
//! displace them.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // The flag adds a call that can panic. The link must then fail, or the check proves nothing.
    println!("cargo::rustc-check-cfg=cfg(negative_control)");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo::rustc-link-arg-bins=--entry=entry");
        println!("cargo::rustc-link-arg-bins=--gc-sections");
    }
}
