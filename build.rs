//! Linker arguments of the firmware, and the memory of its board. They stand here and not in
//! RUSTFLAGS, so that a user's flags cannot displace them. A build of the library alone gets none
//! of them. A firmware with a store trusts the public key in the file that `FMC_PUBLIC_KEY` names,
//! else a test key that everybody can sign by. `FMC_LINK_BAUD` is the speed of the link. The condition `host_kernel` is set where the feature
//! `host` has a kernel.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
    process::Command,
};

/// Features that choose a board, each with the file that describes its memory.
const BOARDS: [(&str, &str); 2] = [
    (
        "CARGO_FEATURE_BOARD_MPS2",
        "src/bin/firmware/board/mps2/memory.x",
    ),
    (
        "CARGO_FEATURE_BOARD_NUCLEO_H743ZI",
        "src/bin/firmware/board/nucleo_h743zi/memory.x",
    ),
];

/// Architectures of PCs for whose vectors there are kernels.
const HOST_ARCHITECTURES: [&str; 2] = ["x86_64", "aarch64"];

/// Conditions that are set for the firmware alone, by arguments behind `cargo rustc --`; features
/// would make cargo compile the library anew for each. `drills` compiles in accidents on request,
/// for tests; `link_check` links only if nothing can panic, and `negative_control` adds a panic to
/// that.
const CFGS: [&str; 3] = ["drills", "link_check", "negative_control"];

/// Variable that names the file of the public key (PEM).
const PUBLIC_KEY: &str = "FMC_PUBLIC_KEY";

/// Public key whose private half is in the repository.
const TEST_KEY: &str = "src/bin/firmware/test-public-key.pem";

/// Variable that sets the speed of the link, bits per second.
const LINK_BAUD: &str = "FMC_LINK_BAUD";

/// Speed of the link without the variable, that of `host-sim`.
const USUAL_BAUD: u32 = 921_600;

/// Speeds that `host-sim` takes.
const BAUDS: [u32; 2] = [57_600, 3_000_000];

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(board)");
    for cfg in CFGS {
        println!("cargo::rustc-check-cfg=cfg({cfg})");
    }
    println!("cargo::rustc-check-cfg=cfg(host_kernel)");
    println!("cargo::rustc-check-cfg=cfg(test_key)");
    let architecture = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    if env::var_os("CARGO_FEATURE_HOST").is_some()
        && HOST_ARCHITECTURES.contains(&architecture.as_str())
    {
        println!("cargo::rustc-cfg=host_kernel");
    }
    let chosen = |(feature, _): &&(&str, &str)| env::var_os(feature).is_some();
    let mut boards = BOARDS.iter().filter(chosen);
    let for_target = env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none");
    match (for_target, boards.next(), boards.next()) {
        (true, Some(_), Some(_)) => println!("cargo::error=the firmware is for one board"),
        (true, Some((_, memory)), None) => firmware(memory)?,
        _ => {}
    }
    Ok(())
}

/// Tells cargo the linker arguments for the board whose memory that file describes.
fn firmware(memory: &str) -> io::Result<()> {
    println!("cargo::rustc-cfg=board");
    if let Some(out) = env::var_os("OUT_DIR").map(PathBuf::from) {
        // The linker finds the root's memory.x, which includes this one.
        fs::copy(memory, out.join("board-memory.x"))?;
        println!("cargo::rustc-link-search={}", out.display());
    }
    println!("cargo::rerun-if-changed={memory}");
    println!("cargo::rerun-if-changed=memory.x");
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    log_level();
    name_sources();
    link_baud();
    if env::var_os("CARGO_FEATURE_STORE").is_some() {
        public_key();
    }
    Ok(())
}

/// Tells the firmware the speed of its link.
fn link_baud() {
    println!("cargo::rerun-if-env-changed={LINK_BAUD}");
    let [least, most] = BAUDS;
    let given = env::var(LINK_BAUD);
    let baud = match &given {
        Ok(text) => text.parse().ok(),
        Err(_) => Some(USUAL_BAUD),
    };
    match baud.filter(|baud| (least..=most).contains(baud)) {
        Some(baud) => println!("cargo::rustc-env={LINK_BAUD}={baud}"),
        None => println!(
            "cargo::error={LINK_BAUD}={}: not a whole number of {least} to {most}, bits per second",
            given.unwrap_or_default()
        ),
    }
}

/// Tells the firmware in which file its public key is.
fn public_key() {
    println!("cargo::rerun-if-env-changed={PUBLIC_KEY}");
    let given = env::var_os(PUBLIC_KEY);
    if given.is_none() {
        println!("cargo::rustc-cfg=test_key");
    }
    let file = PathBuf::from(given.unwrap_or_else(|| TEST_KEY.into()));
    match file.canonicalize() {
        Ok(path) => {
            println!("cargo::rerun-if-changed={}", path.display());
            println!("cargo::rustc-env=FMC_PUBLIC_KEY_FILE={}", path.display());
        }
        Err(error) => println!("cargo::error={PUBLIC_KEY}={}: {error}", file.display()),
    }
}

/// Names the state of the sources for the firmware, which tells it to the PC: what `FMC_BUILD`
/// says, else what git says, else the package's version.
fn name_sources() {
    println!("cargo::rerun-if-env-changed=FMC_BUILD");
    if env::var_os("FMC_BUILD").is_some() {
        return;
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        let text = text.trim().to_owned();
        (output.status.success() && !text.is_empty()).then_some(text)
    };
    // The package may lie unpacked below a repository of somebody else.
    let is_tracked = git(&["ls-files", "--error-unmatch", "build.rs"]).is_some();
    let described = git(&["describe", "--always", "--dirty"]).filter(|_| is_tracked);
    let name = described.unwrap_or_else(|| env::var("CARGO_PKG_VERSION").unwrap_or_default());
    println!("cargo::rustc-env=FMC_BUILD={name}");
    // Commits, and changes without one.
    let places = git(&["rev-parse", "--git-path", "logs/HEAD"]);
    let sources = ["src", "crates/kernel", "Cargo.toml", "Cargo.lock"].map(str::to_owned);
    for place in places.into_iter().chain(sources) {
        if Path::new(&place).exists() {
            println!("cargo::rerun-if-changed={place}");
        }
    }
}

/// Sets the level of the log, because without the variable only errors would be compiled in.
fn log_level() {
    println!("cargo::rerun-if-env-changed=DEFMT_LOG");
    if env::var_os("DEFMT_LOG").is_none() {
        println!("cargo::rustc-env=DEFMT_LOG=info");
    }
}
