//! The calibration as another program's files.

use std::fs;
use std::io::Write;
use std::path::Path;

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{self, Choices, Exported};
use fmc_exchange::program::Program;
use fmc_reference::residual_splines::ResidualSplines;
use pyo3::prelude::*;
use serde_json::{Value, json};
use tempfile::NamedTempFile;

use crate::camera::CameraParts;
use crate::error;

/// Writes the files of a program into a folder, each only when it is complete, and returns what
/// they hold as text in JSON, with the keys of host-sim's `export.json`.
///
/// # Errors
/// `fmc_camera.Error` for a program or a model that is not known, and those of the file system.
pub(crate) fn export(
    camera: &CameraParts,
    program: &str,
    folder: &Path,
    model: Option<&str>,
) -> PyResult<String> {
    let found = Program::WRITTEN
        .into_iter()
        .find(|one| one.name() == program);
    let program = found.ok_or_else(|| {
        let names = Program::WRITTEN.map(Program::name).join(", ");
        error::of_text(format!("program = '{program}': must be one of {names}"))
    })?;
    let choices = Choices {
        model,
        ..Choices::default()
    };
    let splines = ResidualSplines::of(camera.grids());
    let calibrated = Calibrated::of(&camera.file).with_residual(splines);
    let exported =
        export::export(&calibrated, program, &choices).map_err(|error| error::of_input(&error))?;
    fs::create_dir_all(folder)?;
    for (name, bytes) in &exported.files {
        write(&folder.join(name), bytes)?;
    }
    Ok(statement(camera, program, &exported).to_string())
}

/// Returns the statement of what was written.
fn statement(camera: &CameraParts, program: Program, exported: &Exported) -> Value {
    let conventions = program.conventions();
    let pixel_um = camera.file.sensor.pixel_um;
    let residual = &exported.residual;
    let files: Vec<&String> = exported.files.iter().map(|(name, _)| name).collect();
    let not_held = exported.not_held.iter();
    let not_held: Vec<Value> = not_held
        .map(|one| json!({"term": one.term, "size_um": one.size_um}))
        .collect();
    json!({
        "format": program.name(),
        "model": exported.model,
        "camera": camera.file.name,
        "files": files,
        "direction": exported.formula.direction(),
        "sign": conventions.sign,
        "unit": conventions.unit,
        "origin": conventions.origin,
        "residual_max_um": residual.largest_um,
        "residual_rms_um": residual.rms_um,
        "residual_max_px": residual.largest_um / pixel_um,
        "residual_rms_px": residual.rms_um / pixel_um,
        "not_held": not_held,
        "advice": conventions.advice,
        "calibration_crc32": format!("{:08x}", camera.camera.crc()),
    })
}

/// Writes a file that appears only when it is complete.
fn write(path: &Path, bytes: &[u8]) -> PyResult<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The mask of the user takes from them.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file: NamedTempFile = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}
