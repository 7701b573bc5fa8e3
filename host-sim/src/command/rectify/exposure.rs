//! Exposures of the frames, from the records of a flight or from the options.

use fmc_camera::Camera;
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_frames::{FrameCamera, FrameRow, FrameTable, records, row};
use serde::{Deserialize, Serialize};

use super::task::FrameTask;
use crate::cli::{FocusSignName, RectifyArgs};
use crate::command::frames::frame_file;
use crate::device::DeviceError;
use crate::failure::{Failure, note};

/// The exposure of a frame.
#[derive(Debug, Clone)]
pub(super) struct FrameExposure<'a> {
    pub(super) correction: GriddedCorrection<'a>,
    /// Centroid principal point, sensor frame, mm: (x0, y0) + c̄·e.
    pub(super) principal_point_mm: [f64; 2],
    pub(super) record: RecordedExposure,
}

/// The numbers of a record on which the image depends, and its times, as the description of a
/// rectified frame repeats them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RecordedExposure {
    sequence: Option<u32>,
    model: String,
    opening_offset_mm: f32,
    travel_mm: f32,
    centroid_offset_mm: f32,
    centroid_after_opening_s: f32,
    variance_mm2: f32,
    third_moment_mm3: f32,
    fourth_moment_mm4: f32,
    focus_shift_mm: f32,
    enlargement: f32,
    focus_sign: String,
    principal_point_frame_sigma_mm: Option<f32>,
    principal_point_common_sigma_mm: Option<f32>,
    centroid_us: Option<u64>,
    centroid_unix_us: Option<u64>,
}

/// Exposures by their sequence numbers.
#[derive(Debug)]
pub(super) enum Exposures<'a> {
    /// The records of a flight.
    Records {
        table: FrameTable,
        camera: &'a FrameCamera,
        grids: Box<CameraGrids<'a>>,
        /// Name of their file in messages.
        name: String,
    },
    /// The exposure of the options.
    Options(Box<FrameExposure<'a>>),
}

impl<'a> Exposures<'a> {
    /// Reads the records, or computes the exposure of the options.
    ///
    /// # Errors
    /// [`Failure`] of the records or of an exposure that the camera refuses.
    pub(super) fn read(
        args: &RectifyArgs,
        file: &CameraFile,
        camera: &'a FrameCamera,
    ) -> Result<Self, Failure> {
        let grids = camera.grids()?;
        match &args.records {
            None => Ok(Self::Options(Box::new(of_options(
                args, file, camera, &grids,
            )?))),
            Some(path) => {
                let mut without_crc = 0_u32;
                let table = FrameTable::collect(|each| {
                    frame_file::with_bar(path, true, |name, source| {
                        records::read_from(name, source, camera, |frame| {
                            let names_none = frame.calibration_crc.is_none();
                            without_crc += u32::from(names_none && frame.exposed().is_some());
                            each(frame)
                        })
                    })
                })?;
                if without_crc > 0 {
                    note(format_args!(
                        "warning: {}: {without_crc} records name no calibration; they are taken for those of {}",
                        path.display(),
                        args.exposure.camera.display()
                    ));
                }
                Ok(Self::Records {
                    table,
                    camera,
                    grids: Box::new(grids),
                    name: path.display().to_string(),
                })
            }
        }
    }

    /// Returns the exposure of a frame.
    ///
    /// # Errors
    /// [`Failure`] naming the frame, for a record that is missing or that of a refused trigger, and
    /// for a principal point off the sensor.
    pub(super) fn of(
        &self,
        task: &FrameTask,
        file: &CameraFile,
    ) -> Result<FrameExposure<'a>, Failure> {
        let exposure = self.find(task, file)?;
        let ([x, y], [half_x, half_y]) = (exposure.principal_point_mm, file.half_format_mm());
        if x.abs() > half_x || y.abs() > half_y {
            return Err(Failure::bad_input(format!(
                "{}: the principal point ({x:.6}, {y:.6}) mm is off the sensor; allowed: ±{half_x}, ±{half_y} mm",
                task.name
            )));
        }
        Ok(exposure)
    }

    fn find(&self, task: &FrameTask, file: &CameraFile) -> Result<FrameExposure<'a>, Failure> {
        let (table, camera, grids, name) = match self {
            Self::Options(exposure) => return Ok((**exposure).clone()),
            Self::Records {
                table,
                camera,
                grids,
                name,
            } => (table, camera, grids, name),
        };
        let sequence = task.sequence.unwrap_or_default();
        let refused = |fault: String| Failure::bad_input(format!("{}: {fault}", task.name));
        let row = table
            .find(sequence)
            .and_then(|place| table.rows().get(place));
        let row = row.ok_or_else(|| refused(format!("{name} has no record {sequence}")))?;
        if let Some(reason) = table.reason_of(row) {
            return Err(refused(format!(
                "its record {sequence} is that of a refused trigger ({reason}): there is no exposure ({name})"
            )));
        }
        let correction = row
            .gridded(camera.calibration(), grids)
            .ok_or_else(|| refused(format!("record {sequence}: the camera has no [fitted]")))?;
        Ok(FrameExposure {
            correction,
            principal_point_mm: principal_point_mm(file, camera.camera(), &row.motion),
            record: RecordedExposure::of_row(row),
        })
    }
}

/// Returns the exposure of the options.
fn of_options<'a>(
    args: &RectifyArgs,
    file: &CameraFile,
    camera: &FrameCamera,
    grids: &CameraGrids<'a>,
) -> Result<FrameExposure<'a>, Failure> {
    let request = &args.exposure;
    let exposure = request.exposure();
    let frame = camera
        .camera()
        .frame(&exposure)
        .map_err(|error| request.refused(file, &DeviceError::Frame(error)))?;
    let interior = &frame.interior;
    let sign = match request.focus_sign {
        FocusSignName::Physical => FocusSign::Physical,
        FocusSignName::Printed => FocusSign::Printed,
    };
    Ok(FrameExposure {
        correction: GriddedFrame::new(&frame, grids).correction,
        principal_point_mm: principal_point_mm(file, camera.camera(), &interior.motion),
        record: RecordedExposure::of_interior(interior, sign),
    })
}

/// Returns (x0, y0) + c̄·e, mm, with the digits of the camera file.
fn principal_point_mm(
    file: &CameraFile,
    camera: &Camera,
    motion: &PrincipalPointMotion,
) -> [f64; 2] {
    let axis = camera.calibration().parameters().axis;
    let shift = axis.sensor_from_offset(SensorPoint::default(), motion.centroid_mm);
    let [x0, y0] = file.principal_point_mm;
    [x0 + f64::from(shift.x_mm), y0 + f64::from(shift.y_mm)]
}

impl RecordedExposure {
    fn of_row(row: &FrameRow) -> Self {
        let sigma = row.sigma();
        Self {
            sequence: Some(row.sequence),
            model: row.model().map_or("", row::model).to_owned(),
            focus_shift_mm: row.focus_shift_mm,
            enlargement: row.enlargement,
            focus_sign: name(row.focus_sign()).to_owned(),
            centroid_us: row.centroid().map(Time::us),
            centroid_unix_us: row.centroid_utc().map(|utc| utc.unix_us),
            ..Self::of_motion(&row.motion, sigma)
        }
    }

    fn of_interior(interior: &InteriorOrientation, sign: FocusSign) -> Self {
        Self {
            model: row::model(interior.model).to_owned(),
            focus_shift_mm: interior.focus_shift_mm,
            enlargement: interior.enlargement,
            focus_sign: name(sign).to_owned(),
            ..Self::of_motion(&interior.motion, None)
        }
    }

    fn of_motion(motion: &PrincipalPointMotion, sigma: Option<PrincipalPointSigma>) -> Self {
        Self {
            sequence: None,
            model: String::new(),
            opening_offset_mm: motion.opening_offset_mm,
            travel_mm: motion.travel_mm,
            centroid_offset_mm: motion.centroid_mm,
            centroid_after_opening_s: motion.centroid_time_s,
            variance_mm2: motion.moments.second,
            third_moment_mm3: motion.moments.third,
            fourth_moment_mm4: motion.moments.fourth,
            focus_shift_mm: 0.0,
            enlargement: 0.0,
            focus_sign: String::new(),
            principal_point_frame_sigma_mm: sigma.map(|sigma| sigma.frame_mm),
            principal_point_common_sigma_mm: sigma.map(|sigma| sigma.common_mm),
            centroid_us: None,
            centroid_unix_us: None,
        }
    }
}

const fn name(sign: FocusSign) -> &'static str {
    match sign {
        FocusSign::Physical => "physical",
        FocusSign::Printed => "printed",
    }
}
