//! `verify`: the comparison of cameras with the strict reference solver.

use std::fs;
use std::io;
use std::path::Path;

use fmc_camera_file::published::CAMERA_FILES;
use fmc_camera_file::{CameraFile, GridFiles};
use fmc_reference::verification::result::Verification;
use fmc_reference::verification::{cameras as check, grid};
use fmc_report::figure::FigureError;
use fmc_report::images::kernel_result::{self, KernelResult};
use fmc_report::verification::summary::Summary;
use fmc_report::verification::{distortion_field, error_plot, frames_csv, html, table};
use indicatif::{ProgressBar, ProgressStyle};

use super::device::Devices;
use super::images::verification;
use crate::cli::VerifyArgs;
use crate::device::DeviceError;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
    if args.images {
        return verify_images(args);
    }
    let cameras = cameras(args.camera.as_deref())?;
    let folder = args.out.as_deref().map(OutputFolder::create).transpose()?;
    let (devices, not_in_qemu) = match &args.not_in_qemu {
        Some(reason) => (vec![args.device.stand_in()?], Some(reason.clone())),
        None => args.device.open_or_fall_back(cameras.len())?,
    };
    let mut verification = verify(devices, &cameras, args.device.log)?;
    verification.not_in_qemu = not_in_qemu;
    if let Some(folder) = folder {
        write_report(&folder, &verification)?;
        note(format_args!(
            "report: {}",
            folder.path().join("report.html").display()
        ));
    }
    // The table is printed last, because its last line names the device.
    output::write(None, |sink| {
        sink.write_all(table::text(&verification).as_bytes())
    })?;
    if verification.passed() {
        Ok(())
    } else if verification.difference.is_some() {
        Err(Failure::check(
            "the camera does not compute what its own code computes on this PC",
        ))
    } else {
        Err(Failure::check(
            "the camera differs from the strict solver by more than the limit",
        ))
    }
}

/// Checks what kernels of resampling make of frames whose answer is known.
fn verify_images(args: &VerifyArgs) -> Result<(), Failure> {
    let texts: Vec<(String, String, GridFiles)> = match &args.camera {
        Some(path) => {
            let (_, grids) = super::read_camera_with_grids(path)?;
            let text = fs::read_to_string(path).map_err(|error| Failure::reading(path, &error))?;
            vec![(path.display().to_string(), text, grids)]
        }
        None => CAMERA_FILES
            .iter()
            .map(|(file, text)| ((*file).to_owned(), (*text).to_owned(), GridFiles::default()))
            .collect(),
    };
    let folder = args.out.as_deref().map(OutputFolder::create).transpose()?;
    let bar = ProgressBar::new(texts.len() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:10} {pos}/{len} cameras, {eta} {wide_msg}")
    {
        bar.set_style(style);
    }
    let mut results = verification::Results::default();
    for (name, text, grids) in &texts {
        bar.set_message(name.clone());
        results.add_camera(name, text, grids)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    let results = results.rows();
    if let Some(folder) = folder {
        folder.write_json("images.json", &results)?;
    }
    output::write(None, |sink| {
        writeln!(sink, "Shift of the content of blocks of 64 px, px")?;
        writeln!(sink, "{}", kernel_result::table(&results))
    })?;
    if results.is_empty() || !results.iter().all(KernelResult::passed) {
        return Err(Failure::check(
            "rectified images differ from the exact ones by more than the limit",
        ));
    }
    Ok(())
}

fn cameras(given: Option<&Path>) -> Result<Vec<(CameraFile, GridFiles)>, Failure> {
    if let Some(path) = given {
        return Ok(vec![super::read_camera_with_grids(path)?]);
    }
    CAMERA_FILES
        .iter()
        .map(|(file, text)| Ok((CameraFile::parse(file, text)?.0, GridFiles::default())))
        .collect()
}

fn verify(
    mut devices: Devices,
    cameras: &[(CameraFile, GridFiles)],
    prints_log: bool,
) -> Result<Verification, Failure> {
    let frames: usize = cameras
        .iter()
        .map(|(camera, _)| grid::exposures(camera).len())
        .sum();
    let bar = if prints_log {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(frames as u64)
    };
    if let Ok(style) =
        ProgressStyle::with_template("{bar:10} {pos}/{len} exposures, {eta} {wide_msg}")
    {
        bar.set_style(style);
    }
    let name = |camera: &str| bar.set_message(camera.to_owned());
    let verification = check::cameras(&mut devices, cameras, name, || bar.inc(1));
    bar.finish_and_clear();
    verification.map_err(|failed| match failed.error {
        DeviceError::Calibration(_)
        | DeviceError::Frame(_)
        | DeviceError::Grids(_)
        | DeviceError::NoGrids => Failure::bad_input(failed.to_string()),
        error => error.into(),
    })
}

/// Writes report.html, summary.json, frames.csv, and each camera's figures.
fn write_report(folder: &OutputFolder, verification: &Verification) -> Result<(), Failure> {
    let drawing = |error: FigureError| Failure::device_or_io(format!("figure: {error}"));
    folder.write_json("summary.json", &Summary::of(verification))?;
    folder.write("frames.csv", |sink| {
        frames_csv::write(verification, sink).map_err(io::Error::other)
    })?;
    let page = html::page(verification)
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    folder.write("report.html", |sink| sink.write_all(page.as_bytes()))?;
    for camera in &verification.cameras {
        let name = file_name(&camera.name);
        for (figure, svg) in [
            ("distortion", distortion_field::distortion(camera)),
            ("dynamic-change", distortion_field::dynamic(camera)),
            ("error", error_plot::error_against_travel(camera)),
        ] {
            let svg = svg.map_err(drawing)?;
            folder.write(&format!("{name}-{figure}.svg"), |sink| {
                sink.write_all(svg.as_bytes())
            })?;
        }
    }
    Ok(())
}

/// Turns a camera's name into a part of a file name.
fn file_name(name: &str) -> String {
    name.chars()
        .map(|c| {
            if c.is_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '-'
            }
        })
        .collect()
}
