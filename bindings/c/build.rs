//! The condition `control` adds a function that can panic, by an argument behind
//! `cargo rustc --`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(control)");
}
