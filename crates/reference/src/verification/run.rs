//! Verification of one camera.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, GridFiles};

use super::device::{CorrectingDevice, CorrectionFailure};
use super::grid::{self, GridExposure};
use super::result::{
    CameraResult, ErrorStatistics, Field, FieldPoint, FrameResult, WorstPoint, infinite_if_nan,
};
use crate::exposure::ExposureRequest;
use crate::fitted::FittedModel;
use crate::lens::Lens;
use crate::residual_splines::ResidualSplines;
use crate::strict::{StrictSolver, Weight};

/// Checks one camera without residual grids on a device; `after_frame` is called once per exposure.
///
/// # Errors
/// The error of a device that refuses the camera or an exposure, or does not answer every point.
pub fn camera<D: CorrectingDevice + ?Sized>(
    device: &mut D,
    camera: &CameraFile,
    after_frame: impl FnMut(),
) -> Result<CameraResult, D::Error> {
    let grids = GridFiles::default();
    exposures(
        device,
        (camera, &grids),
        &grid::exposures(camera),
        after_frame,
    )
}

/// Checks one camera with its residual grids on a device in some exposures; `after_frame` is called
/// once per exposure. Grids that do not fit the camera are refused by the device.
///
/// # Errors
/// As [`camera`].
pub fn exposures<D: CorrectingDevice + ?Sized>(
    device: &mut D,
    (camera, grids): (&CameraFile, &GridFiles),
    exposures: &[GridExposure],
    mut after_frame: impl FnMut(),
) -> Result<CameraResult, D::Error> {
    // The camera receives points rounded to single precision; the reference is computed at the
    // rounded points.
    let grid = grid::points(camera.half_format_mm());
    let measured: Vec<SensorPoint> = grid.points().collect();
    let mut summary = Summary {
        splines: splines(camera, grids),
        ..Summary::default()
    };
    let mut loaded = None;
    for exposure in exposures {
        let mut strategy = camera.clone();
        strategy.fmc.strategy = exposure.strategy;
        if loaded != Some(exposure.strategy) {
            device.load_grids(grids)?;
            device.load(&strategy.parameters())?;
            loaded = Some(exposure.strategy);
        }
        device.expose(&Exposure::new(
            single(exposure.vh_per_s),
            single(exposure.exposure_s),
        ))?;
        let corrected = device.correct_grid(&grid)?;
        if corrected.len() != measured.len() {
            return Err(D::Error::of_count(measured.len(), corrected.len()));
        }
        summary.add_frame(&strategy, exposure, &measured, &corrected);
        after_frame();
    }
    Ok(summary.finish(camera))
}

/// Returns the splines of a camera's grids; none for grids that do not fit it.
fn splines(camera: &CameraFile, grids: &GridFiles) -> ResidualSplines {
    Calibration::new(camera.parameters().calibration)
        .ok()
        .and_then(|calibration| Some(ResidualSplines::of(&grids.grids(&calibration).ok()?)))
        .unwrap_or_default()
}

/// Results of a camera so far.
#[derive(Default)]
struct Summary {
    splines: ResidualSplines,
    frames: Vec<FrameResult>,
    distortion_mm: Option<[f64; 2]>,
    field: Option<(f64, Field)>,
    worst: Option<WorstPoint>,
}

impl Summary {
    fn add_frame(
        &mut self,
        camera: &CameraFile,
        exposure: &GridExposure,
        measured: &[SensorPoint],
        corrected: &[Corrected],
    ) {
        let request = ExposureRequest::planned(exposure.vh_per_s, exposure.exposure_s);
        let solver = StrictSolver::new(camera, &request, Weight::Exposure)
            .with_splines(self.splines.clone());
        let path = solver.path();
        let printed = FittedModel::printed(camera, path.travel_mm);
        let lens = Lens::of(camera);
        let [x0, y0] = camera.principal_point_mm;
        let mut frame = FrameResult {
            strategy: exposure.strategy_name(),
            vh_per_s: exposure.vh_per_s,
            exposure_s: exposure.exposure_s,
            travel_mm: path.travel_mm,
            centroid_mm: path.centroid_mm(),
            errors: [ErrorStatistics::default(); 4],
            coordinate_error: ErrorStatistics::default(),
            solver_error_mm: 0.0,
        };
        let mut field = Vec::with_capacity(measured.len());
        let mut most_change_mm = 0.0_f64;
        for (point, answer) in measured.iter().zip(corrected) {
            let point_mm = [point.x_mm, point.y_mm].map(f64::from);
            let [x, y] = point_mm;
            let strict = solver.mean(point_mm);
            let truth = strict.distortion_mm;
            frame.solver_error_mm = frame.solver_error_mm.max(infinite_if_nan(strict.error_mm));
            let residual_mm = self.splines.calibrated(point_mm);
            let static_mm = sum(lens.displacement([x - x0, y - y0]), residual_mm);
            let camera_mm = [answer.distortion.dx_mm, answer.distortion.dy_mm].map(f64::from);
            let treatments = [
                [0.0, 0.0],
                static_mm,
                sum(printed.distortion(point_mm), residual_mm),
                camera_mm,
            ];
            for (errors, treatment) in frame.errors.iter_mut().zip(treatments) {
                errors.add(difference(treatment, truth));
            }
            let ideal = difference(point_mm, truth);
            let answered = [answer.point.x_mm, answer.point.y_mm].map(f64::from);
            frame.coordinate_error.add(difference(answered, ideal));
            self.note_point(exposure, point_mm, difference(camera_mm, truth), truth);
            let dynamic_mm = difference(truth, static_mm);
            most_change_mm = most_change_mm.max(length(dynamic_mm));
            field.push(FieldPoint {
                point_mm,
                static_mm,
                dynamic_mm,
            });
        }
        if self
            .field
            .as_ref()
            .is_none_or(|(most, _)| most_change_mm > *most)
        {
            let field = Field {
                frame: self.frames.len(),
                points: field,
            };
            self.field = Some((most_change_mm, field));
        }
        self.frames.push(frame);
    }

    fn note_point(
        &mut self,
        exposure: &GridExposure,
        [x_mm, y_mm]: [f64; 2],
        [error_x, error_y]: [f64; 2],
        distortion: [f64; 2],
    ) {
        let size = length(distortion);
        let [least, most] = self.distortion_mm.unwrap_or([size, size]);
        self.distortion_mm = Some([least.min(size), most.max(size)]);
        let error_nm = 1e6
            * infinite_if_nan(error_x)
                .abs()
                .max(infinite_if_nan(error_y).abs());
        if self
            .worst
            .as_ref()
            .is_none_or(|worst| error_nm > worst.error_nm)
        {
            self.worst = Some(WorstPoint {
                error_nm,
                x_mm,
                y_mm,
                vh_per_s: exposure.vh_per_s,
                exposure_s: exposure.exposure_s,
                strategy: exposure.strategy_name(),
            });
        }
    }

    fn finish(self, camera: &CameraFile) -> CameraResult {
        let points = self
            .frames
            .iter()
            .map(|frame| frame.coordinate_error.points())
            .sum();
        CameraResult {
            name: camera.name.clone(),
            format_mm: camera.half_format_mm().map(|half| 2.0 * half),
            principal_distance_mm: camera.principal_distance_mm,
            pixel_um: camera.sensor.pixel_um,
            axis: camera.fmc.axis.name(),
            points,
            frames: self.frames,
            distortion_mm: self.distortion_mm.unwrap_or_default(),
            field: self.field.map(|(_, field)| field).unwrap_or_default(),
            worst: self.worst.unwrap_or_default(),
        }
    }
}

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}

fn difference([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax - bx, ay - by]
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
