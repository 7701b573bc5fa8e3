//! Sizes and stack of the flight image.

use std::{ffi::OsStr, fs, path::Path};

use anyhow::{Context as _, Result};
use object::{File, Object as _, ObjectSegment as _};
use serde::Deserialize;

use super::cost::Footprint;
use crate::{
    emulator::Emulator,
    firmware::{self, Image},
    stack::StackBound,
    target::Target,
    verify,
    workspace::Workspace,
};

/// Start address of the memory of variables on every Cortex-M.
const RAM: u64 = 0x2000_0000;

/// Part of the reports of `host-sim verify`, `mission` and `camera store` about the camera's end of
/// the link.
#[derive(Debug, Deserialize)]
struct Summary {
    link: LinkSummary,
}

#[derive(Debug, Deserialize)]
struct LinkSummary {
    stack_used_bytes: u64,
}

/// Returns the bytes of flash and of static RAM that an image takes.
fn sizes(image: &Path) -> Result<(u64, u64)> {
    let bytes = fs::read(image)?;
    let file = File::parse(&*bytes).with_context(|| format!("{}", image.display()))?;
    // Initialised variables that are not zero take both: they are copied from flash to RAM.
    let flash = file.segments().map(|segment| segment.file_range().1).sum();
    let in_ram = file.segments().filter(|segment| segment.address() >= RAM);
    let ram = in_ram.map(|segment| segment.size()).sum();
    Ok((flash, ram))
}

/// Exposures of the mission.
const EXPOSURES: &str = "20";

/// Private half of the key that a firmware trusts unless it is built with another.
const TEST_KEY: &str = "host-sim/keys/test-private-key.pem";

/// Measures the sizes of the flight image, and its stack during a mission, during the verification
/// of one camera, and while a calibration is stored: the largest of the three, which is compared
/// with the bound.
pub(super) fn footprint(
    workspace: &Workspace,
    target: &Target<'_>,
    emulator: &Emulator,
) -> Result<Footprint> {
    let image = firmware::build(workspace, target, Image::Mps2)?;
    let (flash_bytes, static_ram_bytes) = sizes(&image)?;
    let host_sim = verify::tested_host_sim(workspace)?;
    let camera = workspace.root.join("host-sim/cameras/rc30-5324.toml");
    let camera = camera.as_os_str();
    let arguments: [&[&OsStr]; 2] = [
        &["verify".as_ref(), "--camera".as_ref(), camera],
        &[
            "mission".as_ref(),
            "--exposures".as_ref(),
            EXPOSURES.as_ref(),
        ],
    ];
    let mut stack_used_bytes = 0;
    for arguments in arguments {
        let out = workspace.target_dir.join("bench-verify");
        let host_sim = workspace.shell.cmd(&host_sim).quiet().args(arguments);
        host_sim
            .args(["--device", "qemu", "--out"])
            .arg(&out)
            .env("PATH", emulator.search_path()?)
            .ignore_stdout()
            .run()?;
        let summary = fs::read_to_string(out.join("summary.json"))?;
        let Summary { link } = serde_json::from_str(&summary)
            .with_context(|| format!("summary.json of {arguments:?}"))?;
        stack_used_bytes = link.stack_used_bytes.max(stack_used_bytes);
    }
    let of_store = stack_of_store(workspace, &host_sim, emulator)?;
    stack_used_bytes = stack_used_bytes.max(of_store);
    let bound = StackBound::of(&workspace.root, &image)?;
    bound.check_used(stack_used_bytes)?;
    Ok(Footprint {
        image: Image::Mps2.to_string(),
        flash_bytes,
        static_ram_bytes,
        stack_used_bytes,
        stack_bound_bytes: Some(bound.bytes().into()),
        compiler: target.compiler()?,
    })
}

/// Returns the bytes of stack that were used while a signed calibration was stored in a new flash,
/// and one that follows it, before which the first is read again.
fn stack_of_store(workspace: &Workspace, host_sim: &Path, emulator: &Emulator) -> Result<u64> {
    let folder = workspace.target_dir.join("bench-store");
    fs::create_dir_all(&folder)?;
    let [camera, signature, flash] =
        ["camera.toml", "signature.json", "flash.bin"].map(|name| folder.join(name));
    if flash.exists() {
        fs::remove_file(&flash)?;
    }
    let text = fs::read_to_string(workspace.root.join("host-sim/cameras/rc30-5324.toml"))?;
    let host_sim = || workspace.shell.cmd(host_sim).quiet();
    let mut stack_used_bytes = 0;
    for version in [1, 2] {
        // Without both no calibration is stored.
        let identity = format!("serial = \"5324\"\nversion = {version}\n");
        fs::write(&camera, identity + &text)?;
        let sign = host_sim().arg("sign").arg("--camera").arg(&camera);
        let sign = sign.arg("--key").arg(workspace.root.join(TEST_KEY));
        sign.arg("--out").arg(&signature).ignore_stdout().run()?;
        let store = host_sim().args(["camera", "--device", "qemu", "--flash"]);
        let store = store.arg(&flash).args(["store", "--json", "--camera"]);
        let store = store.arg(&camera).arg("--signature").arg(&signature);
        let stored = store.env("PATH", emulator.search_path()?).read()?;
        let Summary { link } = serde_json::from_str(&stored).context("JSON of camera store")?;
        stack_used_bytes = link.stack_used_bytes.max(stack_used_bytes);
    }
    Ok(stack_used_bytes)
}
