//! `import`: a camera file from another program's.

mod residual_grid;

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use fmc_camera_file::grid_block::without_grids;
use fmc_camera_file::interior_text::{self, Interior};
use fmc_camera_file::{CameraFile, DistortionTable, Sign};
use fmc_exchange::export::GOOD_ENOUGH_PX;
use fmc_exchange::found::Stated;
use fmc_exchange::import::{self, Imported};
use fmc_exchange::source::{MAX_BYTES, Source};
use fmc_report::exchange::{self, Assumed, ImportSummary};
use serde::Serialize;

use self::residual_grid::GridOfImport;
use crate::cli::{ImportArgs, SignName};
use crate::failure::{Failure, note};
use crate::formats::output;

/// Difference of two pixel pitches that are the same, relative.
const SAME_PITCH: f64 = 1e-6;

pub(super) fn run(args: &ImportArgs) -> Result<(), Failure> {
    check_outputs(args)?;
    let bytes = read(&args.file)?;
    let base = match &args.base {
        Some(path) => Some(base(path)?),
        None => None,
    };
    let base_file = base.as_ref().map(|(file, _)| file);
    if let Some(file) = base_file {
        check_same_array(args, file)?;
    }
    let from_base = args
        .base
        .as_deref()
        .map(|path| format!("--base {}", path.display()));
    let stated = stated(args, base_file, from_base.as_deref());
    let program = args.format;
    let file = args.file.display().to_string();
    let source = Source {
        file: &file,
        bytes: &bytes,
    };
    let imported = import::import(program, &source, &stated)?;
    let assumed = Assumed {
        pixel_um: 1e3 * imported.camera.pixel_mm,
        size_px: imported.camera.size_px,
        id: args.id.clone(),
        sign: args.sign.map(|sign| match sign {
            SignName::Correction => "correction",
            SignName::Distortion => "distortion",
        }),
    };
    let residual_px = imported.residual.largest_um / (1e3 * imported.camera.pixel_mm);
    if residual_px >= GOOD_ENOUGH_PX && !args.grid {
        note(format_args!(
            "warning: {file}: the camera file's polynomial leaves up to {residual_px:.3} px of its \
             model, not below {GOOD_ENOUGH_PX} px; --grid takes it"
        ));
    }
    let out = args.out.display().to_string();
    let base_text = base.as_ref().map(|(_, text)| text.as_str());
    let written = |grid: Option<&GridOfImport>| {
        let statement = grid.map(|grid| &grid.statement);
        let comments = exchange::comments(program, &file, &bytes, &imported, statement);
        interior_text::write(&out, &comments, &interior(&imported, base_file), base_text)
    };
    let mut text = written(None)?;
    let (mut camera, _) = CameraFile::parse(&out, &text)?;
    super::warn_of_distortion(&args.out, &camera);
    let grid = if args.grid {
        GridOfImport::of(&file, &imported, &camera, &args.out)?
    } else {
        None
    };
    if let Some(grid) = &grid {
        text = grid.named_by(&out, &written(Some(grid))?)?;
        let beside = args.out.with_file_name(&grid.statement.file);
        let others = [Some(&args.file), args.base.as_ref(), args.report.as_ref()];
        for other in others.into_iter().flatten() {
            output::check_not_an_input(&beside, other)?;
        }
        output::write(Some(&beside), |sink| sink.write_all(&grid.bytes))?;
    }
    output::write(Some(&args.out), |sink| sink.write_all(text.as_bytes()))?;
    if grid.is_some() {
        // The identity of the calibration includes that of the grid.
        (camera, ..) = CameraFile::read_with_grids(&args.out)?;
    }
    let summary = ImportSummary::of(
        &camera,
        text.as_bytes(),
        program,
        &bytes,
        &imported,
        assumed,
        grid.map(|grid| grid.statement),
    );
    if let Some(uncertainty) = &imported.found.uncertainty {
        write_json(&args.out.with_extension("uncertainty.json"), uncertainty)?;
    }
    if let Some(report) = &args.report {
        write_json(report, &summary)?;
    }
    output::write(None, |sink: &mut dyn Write| {
        writeln!(sink, "{}", summary.text())
    })
}

/// Statements of the options, each with its option; where there is none, those of the file of
/// `--base`, `from_base` being its name.
fn stated<'a>(
    args: &'a ImportArgs,
    base: Option<&CameraFile>,
    from_base: Option<&'a str>,
) -> Stated<'a> {
    let from =
        |option: &'static str, is_given: bool| if is_given { Some(option) } else { from_base };
    Stated {
        pixel_from: from("--pixel-um", args.pixel_um.is_some()),
        size_from: from("--size", args.size.is_some()),
        pixel_mm: args
            .pixel_um
            .or(base.map(|file| file.sensor.pixel_um))
            .map(|um| um / 1000.0),
        size_px: args.size.or_else(|| base.and_then(size)),
        id: args.id.as_deref(),
        is_correction: args.sign.map(|sign| sign == SignName::Correction),
    }
}

/// Refuses to write over a file that is read.
fn check_outputs(args: &ImportArgs) -> Result<(), Failure> {
    for input in [Some(&args.file), args.base.as_ref()].into_iter().flatten() {
        output::check_not_an_input(&args.out, input)?;
        if let Some(report) = &args.report {
            output::check_not_an_input(report, input)?;
        }
    }
    Ok(())
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    output::write(Some(path), |sink| {
        serde_json::to_writer_pretty(&mut *sink, value)?;
        writeln!(sink)
    })
}

/// Reads a file that is not larger than a camera's can be.
fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let file = File::open(path).map_err(|error| Failure::reading(path, &error))?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| Failure::reading(path, &error))?;
    if u64::try_from(bytes.len()).unwrap_or(u64::MAX) > MAX_BYTES {
        return Err(Failure::bad_input(format!(
            "{}: larger than {} MiB, which no camera file is",
            path.display(),
            MAX_BYTES >> 20
        )));
    }
    Ok(bytes)
}

/// Refuses a pitch or a size that contradicts the camera whose mechanism is taken.
fn check_same_array(args: &ImportArgs, base: &CameraFile) -> Result<(), Failure> {
    let file = args
        .base
        .as_deref()
        .unwrap_or(Path::new("--base"))
        .display();
    let pitch = base.sensor.pixel_um;
    if let Some(stated) = args.pixel_um
        && (stated - pitch).abs() > SAME_PITCH * pitch
    {
        return Err(Failure::bad_input(format!(
            "--pixel-um {stated}: {file} has a pixel pitch of {pitch} µm"
        )));
    }
    if let (Some([width, height]), Some(of_base)) = (args.size, size(base))
        && [width, height] != of_base
    {
        let [columns, rows] = of_base;
        return Err(Failure::bad_input(format!(
            "--size {width}x{height}: {file} has {columns} x {rows} px"
        )));
    }
    Ok(())
}

/// Reads a camera file and its text, without residual grids, which belong to its lens.
fn base(path: &Path) -> Result<(CameraFile, String), Failure> {
    let (file, _, _) = CameraFile::read_with_grids(path)?;
    let text = std::fs::read_to_string(path).map_err(|error| Failure::reading(path, &error))?;
    let text = without_grids(&path.display().to_string(), &text)?;
    Ok((file, text))
}

fn size(file: &CameraFile) -> Option<[u32; 2]> {
    let [width, height] = [file.sensor.width_px, file.sensor.height_px];
    Some([width.try_into().ok()?, height.try_into().ok()?])
}

/// Returns the numbers of the camera file.
fn interior(imported: &Imported, base: Option<&CameraFile>) -> Interior {
    let camera = &imported.camera;
    let [k0, k1, k2, k3] = camera.lens.k;
    let [p1, p2] = camera.lens.p;
    let [b1, b2] = camera.lens.b;
    Interior {
        name: base.map_or_else(|| name(&camera.name), |file| file.name.clone()),
        principal_distance_mm: camera.principal_distance_mm,
        principal_point_mm: camera.principal_point_mm,
        size_px: camera.size_px,
        pixel_um: 1e3 * camera.pixel_mm,
        distortion: DistortionTable {
            sign: Sign::Distortion,
            k0,
            k1,
            k2,
            k3,
            p1,
            p2,
            b1,
            b2,
        },
    }
}

/// Returns a name that a camera file may have.
fn name(found: &str) -> String {
    let name = found.replace(char::is_control, " ");
    if name.trim().is_empty() {
        "camera".to_owned()
    } else {
        name
    }
}
