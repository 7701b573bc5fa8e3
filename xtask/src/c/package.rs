//! Inputs of build systems: files for pkg-config and `CMake`, and a module of Zephyr.

use std::{fs, path::Path};

use anyhow::{Context as _, Result};

use super::library::{Library, directory};
use crate::workspace::Workspace;

/// Files of the crate that go along as they are, with their places.
const FILES: [(&str, &str); 6] = [
    ("include/fmc_camera.h", "include/fmc_camera.h"),
    (
        "cmake/fmc_camera-config.cmake",
        "cmake/fmc_camera-config.cmake",
    ),
    ("zephyr/module.yml", "zephyr/module.yml"),
    ("zephyr/CMakeLists.txt", "zephyr/CMakeLists.txt"),
    ("zephyr/Kconfig", "zephyr/Kconfig"),
    ("examples/main.c", "examples/main.c"),
];

/// Writes the package around its libraries.
///
/// # Errors
/// An error if a file cannot be written.
pub(super) fn write(workspace: &Workspace, out: &Path, libraries: &[Library]) -> Result<()> {
    for (from, to) in FILES {
        let to = out.join(to);
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent).with_context(|| parent.display().to_string())?;
        }
        let from = directory(workspace, from);
        fs::copy(&from, &to).with_context(|| from.display().to_string())?;
    }
    let version = env!("CARGO_PKG_VERSION");
    let path = out.join("cmake/fmc_camera-config-version.cmake");
    fs::write(&path, cmake_version(version)).with_context(|| path.display().to_string())?;
    let pkgconfig = out.join("pkgconfig");
    fs::create_dir_all(&pkgconfig).with_context(|| pkgconfig.display().to_string())?;
    for target in libraries
        .iter()
        .map(|library| library.architecture.target())
        .chain(["host"])
    {
        let private = if target == "host" {
            "Libs.private: -lpthread -ldl -lm\n"
        } else {
            ""
        };
        let text = format!(
            "prefix=${{pcfiledir}}/..\n\n\
             Name: fmc_camera\n\
             Description: Geometry of an airborne mapping camera with forward motion compensation\n\
             Version: {version}\n\
             Cflags: -I${{prefix}}/include\n\
             Libs: -L${{prefix}}/lib/{target} -lfmc_camera\n{private}"
        );
        let path = pkgconfig.join(format!("fmc_camera-{target}.pc"));
        fs::write(&path, text).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// Returns the file by which `CMake` judges the version that a project asks for: one with another
/// number in the first two places has another header.
fn cmake_version(version: &str) -> String {
    let (compatible, _) = version.rsplit_once('.').unwrap_or((version, ""));
    format!(
        "set(PACKAGE_VERSION {version})\n\
         set(fmc_camera_asked ${{PACKAGE_FIND_VERSION_MAJOR}}.${{PACKAGE_FIND_VERSION_MINOR}})\n\
         if(fmc_camera_asked VERSION_EQUAL {compatible} AND\n   \
         NOT PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION)\n  \
         set(PACKAGE_VERSION_COMPATIBLE TRUE)\n\
         else()\n  \
         set(PACKAGE_VERSION_COMPATIBLE FALSE)\n\
         endif()\n\
         if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)\n  \
         set(PACKAGE_VERSION_EXACT TRUE)\n\
         endif()\n"
    )
}
