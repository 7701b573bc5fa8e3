//! `verify --images`: frames of the published cameras, rendered, rectified and compared.

use fmc_camera::Camera;
use fmc_camera::flight::exposure::{Exposure, FlightDirection};
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, GridFiles, grid_block};
use fmc_rectification::comparison::ShiftSummary;
use fmc_rectification::{Rectification, Request, Resampling, SourceBand, Window};
use fmc_reference::exposure::{ExposureRequest, FocusFormula};
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::verification::grid::{self, GridExposure};
use fmc_report::images::kernel_result::{ALL_CAMERAS, KernelResult};
use rayon::prelude::*;

use super::image_difference;
use super::scaled_camera;
use super::scene::{Pattern, Scene};
use super::written::sixteen_bits;
use crate::failure::Failure;

/// Width of the rendered frames, pixels: the cameras' pixels are made wider until they have it.
const WIDTH_PX: i64 = 1800;
/// Periods of the waves, pixels.
const PERIODS_PX: [f64; 8] = [12.0, 18.0, 27.0, 40.0, 60.0, 90.0, 135.0, 200.0];
/// Pixels along all edges at which kernels reach beyond the sensor.
const EDGE_PX: usize = 4;
/// Number of kernels that are judged.
const KERNELS: usize = 4;
/// Kernels with the longest shift of a block that passes, and the RMS of those of all cameras,
/// pixels.
const LIMITS_PX: [(Resampling, f64, f64); KERNELS] = [
    (Resampling::Bilinear, 0.035, 0.035),
    (Resampling::Bicubic, 0.004, 0.0025),
    (Resampling::Keys6, 0.0015, 0.0008),
    (Resampling::Lanczos3, 0.038, 0.038),
];

/// Differences of the frames of a kernel.
#[derive(Debug, Clone, Default)]
struct Found {
    shifts: ShiftSummary,
    mesh_bound_px: f64,
    grey_largest: f64,
}

impl Found {
    fn merge(&mut self, other: &Self) {
        self.shifts.merge(&other.shifts);
        self.mesh_bound_px = self.mesh_bound_px.max(other.mesh_bound_px);
        self.grey_largest = self.grey_largest.max(other.grey_largest);
    }
}

/// Results of cameras, by kernels.
#[derive(Debug, Default)]
pub(in crate::command) struct Results {
    cameras: Vec<(String, [Found; KERNELS])>,
}

impl Results {
    /// Renders, rectifies and compares frames of a camera with all kernels.
    ///
    /// # Errors
    /// [`Failure`] of a camera that refuses the exposures.
    pub(in crate::command) fn add_camera(
        &mut self,
        name: &str,
        text: &str,
        grids: &GridFiles,
    ) -> Result<(), Failure> {
        let failed = |fault: &dyn std::fmt::Display| Failure::bad_input(format!("{name}: {fault}"));
        let text = grid_block::without_grids(name, text)?;
        let (camera, _) = CameraFile::parse(name, &text)?;
        let text = scaled_camera::scaled(&text, &camera, scale(&camera))
            .map_err(|fault| failed(&fault))?;
        let (camera, _) = CameraFile::parse(name, &text)?;
        let mut kernels: [Found; KERNELS] = Default::default();
        for (seed, exposure) in (1..).zip(longest_travels(&camera)) {
            let rendered =
                Rendered::of(&camera, grids, &exposure, seed).map_err(|fault| failed(&fault))?;
            for (found, (kernel, _, _)) in kernels.iter_mut().zip(LIMITS_PX) {
                let frame = rendered.rectified(kernel).map_err(|fault| failed(&fault))?;
                found.merge(&frame);
            }
        }
        self.cameras.push((camera.name, kernels));
        Ok(())
    }

    /// Returns the results of each camera, and of several those of all together.
    pub(in crate::command) fn rows(&self) -> Vec<KernelResult> {
        let mut all: [Found; KERNELS] = Default::default();
        let mut rows = Vec::new();
        for (camera, kernels) in &self.cameras {
            for (all, found) in all.iter_mut().zip(kernels) {
                all.merge(found);
            }
            rows.extend(results(camera, kernels, false));
        }
        if self.cameras.len() > 1 {
            rows.extend(results(ALL_CAMERAS, &all, true));
        }
        rows
    }
}

fn results(
    camera: &str,
    kernels: &[Found; KERNELS],
    are_all: bool,
) -> impl Iterator<Item = KernelResult> {
    let pairs = kernels.iter().zip(LIMITS_PX);
    pairs.map(move |(found, (kernel, largest_px, rms_px))| KernelResult {
        camera: camera.to_owned(),
        kernel: kernel.name(),
        blocks: found.shifts.found,
        shift_rms_px: found.shifts.rms_px().unwrap_or_default(),
        shift_largest_px: found.shifts.largest_px,
        limit_rms_px: are_all.then_some(rms_px),
        limit_largest_px: largest_px,
        mesh_bound_px: found.mesh_bound_px,
        grey_largest: found.grey_largest,
    })
}

/// Returns how many times as wide the pixels are made: as many as the width and the range of a
/// camera's pixels allow.
fn scale(camera: &CameraFile) -> u16 {
    let by_width = camera.sensor.width_px / WIDTH_PX;
    let (_, widest_um) = Quantity::PixelUm.range();
    let scales = (1..).take_while(|scale| {
        i64::from(*scale) <= by_width
            && f64::from(*scale) * camera.sensor.pixel_um <= f64::from(widest_um)
    });
    scales.last().unwrap_or(1)
}

/// Returns the exposure with the longest travel of each run-up strategy.
fn longest_travels(camera: &CameraFile) -> Vec<GridExposure> {
    let mut longest: Vec<GridExposure> = Vec::new();
    for exposure in grid::exposures(camera) {
        let travel = |exposure: &GridExposure| exposure.vh_per_s * exposure.exposure_s;
        match longest
            .iter_mut()
            .find(|other| other.strategy == exposure.strategy)
        {
            None => longest.push(exposure),
            Some(other) if travel(&exposure) > travel(other) => *other = exposure,
            Some(_) => {}
        }
    }
    longest
}

/// A frame and its exactly rectified answer.
struct Rendered<'a> {
    correction: GriddedCorrection<'a>,
    principal_point: SensorPoint,
    size_px: [u32; 2],
    frame: Vec<u16>,
    answer: Vec<u16>,
}

impl<'a> Rendered<'a> {
    fn of(
        camera: &CameraFile,
        grids: &'a GridFiles,
        exposure: &GridExposure,
        seed: u64,
    ) -> Result<Self, String> {
        let mut file = camera.clone();
        file.fmc.strategy = exposure.strategy.or(file.fmc.strategy);
        let camera = Camera::new(file.parameters()).map_err(|error| error.to_string())?;
        let grids = grids
            .grids(camera.calibration())
            .map_err(|error| error.to_string())?;
        let (vh_per_s, exposure_s) = (exposure.vh_per_s, exposure.exposure_s);
        let frame = camera
            .frame(&Exposure::new(single(vh_per_s), single(exposure_s)))
            .map_err(|error| error.to_string())?;
        let request = ExposureRequest {
            vh_per_s,
            exposure_s,
            opening_offset_mm: None,
            focus_shift_mm: 0.0,
            focus_formula: FocusFormula::Physical,
            direction: FlightDirection::Forward,
        };
        let pattern = Pattern::waves(&PERIODS_PX, seed, 16);
        let scene = Scene::new(
            &file,
            ResidualSplines::of(&grids),
            &request,
            pattern,
            [1, 16],
        );
        let [_, height] = scene.size_px;
        let image = |row: &(dyn Fn(u32) -> Vec<f64> + Sync)| -> Vec<u16> {
            let rows = (0..height).into_par_iter();
            rows.flat_map_iter(|number| row(number).into_iter().map(sixteen_bits))
                .collect()
        };
        Ok(Self {
            correction: GriddedFrame::new(&frame, &grids).correction,
            principal_point: frame.interior.principal_point,
            size_px: scene.size_px,
            frame: image(&|row| scene.recorded_row(row)),
            answer: image(&|row| scene.rectified_row(row)),
        })
    }

    /// Rectifies the frame, and compares it with the answer.
    fn rectified(&self, resampling: Resampling) -> Result<Found, String> {
        let request = Request {
            window: Window::Same,
            resampling,
            ..Request::default()
        };
        let rectification = Rectification::new(self.correction, self.principal_point, &request)
            .map_err(|error| error.to_string())?;
        let [width, _] = self.size_px.map(|side| side as usize);
        let rows: Vec<&[u16]> = self.frame.chunks_exact(width).collect();
        let band = SourceBand::new(self.size_px, 1, 0, &rows).ok_or("no image")?;
        let mut rectified = vec![0; self.frame.len()];
        let done = rectified.par_chunks_exact_mut(width).enumerate();
        done.try_for_each(|(row, out)| {
            let row = u32::try_from(row).unwrap_or(u32::MAX);
            let mut mask = vec![0; width];
            rectification.row(row, &band, out, &mut mask).map(|_| ())
        })
        .map_err(|error| error.to_string())?;
        let mut pairs = self
            .answer
            .chunks_exact(width)
            .zip(rectified.chunks_exact(width));
        let difference = image_difference::of_rows(self.size_px, 1, EDGE_PX, |[a, b]| {
            if let Some((answer, rectified)) = pairs.next() {
                a.copy_from_slice(answer);
                b.copy_from_slice(rectified);
            }
            Ok(())
        });
        let difference = difference.map_err(|failure: Failure| failure.text())?;
        let pixels = self.frame.len() as u64;
        if difference.one_sided > pixels / 100 {
            return Err(format!(
                "{}: {} of {pixels} pixels have content in the rectified frame or in the exact answer alone",
                resampling.name(),
                difference.one_sided
            ));
        }
        Ok(Found {
            shifts: difference.shifts,
            mesh_bound_px: rectification.mesh_bound_px(),
            grey_largest: difference.grey.largest,
        })
    }
}
