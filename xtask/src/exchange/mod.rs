//! Files for other programs and poses, read by the programs themselves, and blocks of frames on
//! several workers: `OpenCV`, COLMAP and Dask, from the Python package index.

use std::{fs, path::PathBuf};

use anyhow::{Context as _, Result, ensure};

use crate::{python::Python, tools::Toolbox, verify, workspace::Workspace};

/// Script that reads the files and projects points.
const SCRIPT: &str = "xtask/src/exchange/readers.py";

/// Script that reads poses of a flight.
const POSES: &str = "xtask/src/exchange/poses.py";

/// Script that rectifies a block of frames with Dask.
const BLOCKS: &str = "xtask/src/exchange/blocks.py";

/// Directory of the packages.
pub(crate) const READERS: &str = "readers";

/// Packages with their versions, so that a new one cannot change what is tested.
pub(crate) const PACKAGES: [&str; 5] = [
    "dask[distributed]==2026.8.0",
    "numpy==2.4.6",
    "opencv-python-headless==5.0.0.93",
    "psutil==7.2.2",
    "pycolmap==4.2.1",
];

/// Camera with every term of the camera file, and nothing symmetric.
const ALL_TERMS: &str = "name = \"all terms\"\nprincipal_distance_mm = 100\n\
                         principal_point_mm = [0.35, -0.21]\n\
                         [sensor]\nwidth_px = 9216\nheight_px = 6144\npixel_um = 8.75\n\
                         [distortion]\nk0 = 2e-4\nk1 = -8e-6\nk2 = 3e-9\nk3 = -4e-13\n\
                         p1 = 3e-6\np2 = -5e-6\nb1 = 1e-4\nb2 = -6e-5\n";

/// Lets the programs read exports of every camera and project points, and poses of a flight.
///
/// # Errors
/// An error if the programs are not available, or if a projected point is not where the export
/// states.
pub(crate) fn check(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<()> {
    let host_sim = verify::tested_host_sim(workspace)?;
    let python = Python::with(workspace, toolbox, READERS, &PACKAGES).context(
        "exports cannot be read by OpenCV and COLMAP, nor blocks be rectified with Dask",
    )?;
    let shell = &workspace.shell;
    let folder = shell.create_temp_dir()?;
    let all_terms = [folder.path().join("all-terms.toml")];
    for file in &all_terms {
        shell.write_file(file, ALL_TERMS)?;
    }
    let mut cameras = cameras(workspace)?;
    cameras.extend(all_terms.clone());
    let command = python
        .run(shell)
        .quiet()
        .arg(workspace.root.join(SCRIPT))
        .arg(&host_sim)
        .args(cameras);
    eprintln!("$ {command}");
    command.run()?;
    for (script, files) in [(POSES, &all_terms[..]), (BLOCKS, &[])] {
        let command = python
            .run(shell)
            .quiet()
            .arg(workspace.root.join(script))
            .arg(&host_sim)
            .args(files);
        eprintln!("$ {command}");
        command.run()?;
    }
    Ok(())
}

/// Returns the camera files of the program.
fn cameras(workspace: &Workspace) -> Result<Vec<PathBuf>> {
    let folder = workspace.root.join("host-sim/cameras");
    let entries = fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    files.sort();
    ensure!(!files.is_empty(), "no camera files in {}", folder.display());
    Ok(files)
}
