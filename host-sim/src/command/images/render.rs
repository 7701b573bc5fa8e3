//! `render`: a pattern as a camera records it, and its exactly rectified answer.

use std::path::Path;

use fmc_camera_file::{CameraFile, grid_block};
use fmc_raster::{FrameReader, Sample};
use fmc_reference::residual_splines::ResidualSplines;
use serde::Serialize;

use super::scaled_camera;
use super::scene::{Pattern, Scene};
use super::written::{self, Format};
use crate::cli::RenderArgs;
use crate::command::rectify::frame_flow::read_failure;
use crate::device::DeviceError;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(in crate::command) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let request = &args.exposure;
    let name = request.camera.display().to_string();
    let (given, grids) = request.read_camera_with_grids()?;
    let text = scaled_camera::text(&request.camera, &given, args.scale)?;
    let (text, copies) = grid_block::with_copies(&name, &text, &grids)?;
    let without = grid_block::without_grids(&name, &text)?;
    let (camera, checked) = CameraFile::parse(&name, &without)?;
    let refused = |error: DeviceError| request.refused(&camera, &error);
    // The camera itself refuses an exposure outside its limits.
    checked
        .frame(&request.exposure())
        .map_err(|error| refused(DeviceError::Frame(error)))?;
    let fitting = grids
        .grids(checked.calibration())
        .map_err(|error| refused(DeviceError::Grids(error)))?;
    let splines = ResidualSplines::of(&fitting);
    let (pattern, [bands, bits]) = match &args.image {
        None => (
            Pattern::waves(&args.periods, args.seed, args.bits),
            [args.bands, args.bits],
        ),
        Some(path) => seen(path, &camera)?,
    };
    let scene = Scene::new(&camera, splines, &request.request(), pattern, [bands, bits]);
    let folder = OutputFolder::create(&args.out)?;
    let [frame, rectified] = ["frame.tif", "rectified.tif"].map(|name| folder.path().join(name));
    for path in [&frame, &rectified] {
        for input in args.image.iter().chain([&request.camera]) {
            output::check_not_an_input(path, input)?;
        }
    }
    for copy in ["camera.toml"]
        .into_iter()
        .chain(copies.iter().map(|(name, _)| name.as_str()))
    {
        output::check_not_an_input(&folder.path().join(copy), &request.camera)?;
    }
    let format = Format {
        size_px: scene.size_px,
        bands,
        bits,
    };
    written::write(&frame, format, |row| scene.recorded_row(row))?;
    written::write(&rectified, format, |row| scene.rectified_row(row))?;
    for (name, bytes) in &copies {
        folder.write(name, |sink| sink.write_all(bytes))?;
    }
    folder.write("camera.toml", |sink| sink.write_all(text.as_bytes()))?;
    folder.write_json("render.json", &Description::of(args, &camera, &scene))?;
    let names: Vec<&str> = ["frame.tif", "rectified.tif", "camera.toml", "render.json"]
        .into_iter()
        .chain(copies.iter().map(|(name, _)| name.as_str()))
        .collect();
    note(format_args!(
        "{}: {}",
        folder.path().display(),
        names.join(", ")
    ));
    Ok(())
}

/// Content of render.json.
#[derive(Debug, Serialize)]
struct Description {
    camera: String,
    width_px: u32,
    height_px: u32,
    bands: u8,
    bits: u8,
    image: Option<String>,
    periods_px: Vec<f64>,
    seed: u64,
    vh_per_s: f64,
    exposure_s: Option<f64>,
    principal_point_mm: [f64; 2],
    meaning: &'static str,
}

impl Description {
    fn of(args: &RenderArgs, camera: &CameraFile, scene: &Scene) -> Self {
        let [width_px, height_px] = scene.size_px;
        let image = args.image.as_ref().map(|path| path.display().to_string());
        Self {
            camera: camera.name.clone(),
            width_px,
            height_px,
            bands: scene.bands,
            bits: scene.bits,
            periods_px: match image {
                None => args.periods.clone(),
                Some(_) => Vec::new(),
            },
            image,
            seed: args.seed,
            vh_per_s: args.exposure.vh.per_s(),
            exposure_s: args.exposure.exposure,
            principal_point_mm: scene.principal_point_mm(),
            meaning: "frame.tif is what the camera records of the pattern, by the strict solver; rectified.tif is the pattern about the principal point of the exposure, 0 where the camera sees nothing",
        }
    }
}

/// Reads an image that the camera sees.
fn seen(path: &Path, camera: &CameraFile) -> Result<(Pattern, [u8; 2]), Failure> {
    let refused =
        |fault: &dyn std::fmt::Display| Failure::bad_input(format!("{}: {fault}", path.display()));
    let mut reader = FrameReader::open(path).map_err(|error| read_failure(path, error))?;
    let header = reader.header().clone();
    let calibration = camera.parameters().calibration;
    let size = [calibration.width_px, calibration.height_px];
    if [header.width_px, header.height_px] != size {
        return Err(refused(&format_args!(
            "{} x {} px; allowed: {} x {} px, the sensor of {}",
            header.width_px, header.height_px, size[0], size[1], camera.name
        )));
    }
    let values = match header.bits {
        8 => values::<u8>(&mut reader),
        _ => values::<u16>(&mut reader),
    }
    .map_err(|error| read_failure(path, error))?;
    let samples = [header.samples, header.bits].map(|number| u8::try_from(number).unwrap_or(0));
    let pattern = Pattern::Image {
        width: header.width_px as usize,
        bands: usize::from(header.samples),
        values,
    };
    Ok((pattern, samples))
}

fn values<S: Sample + Into<f32>>(
    reader: &mut FrameReader,
) -> Result<Vec<f32>, fmc_raster::ReadError> {
    let header = reader.header();
    let (rows, row_samples) = (header.height_px, header.row_samples());
    let mut values = Vec::with_capacity(rows as usize * row_samples);
    let mut row = vec![S::zeroed(); row_samples];
    for _ in 0..rows {
        reader.read_rows(&mut row)?;
        values.extend(row.iter().map(|sample| (*sample).into()));
    }
    Ok(values)
}
