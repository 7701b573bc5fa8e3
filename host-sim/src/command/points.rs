//! `correct` and `distort`: points through the camera.

use fmc_camera::geometry::frame_correction::{Corrected, FrameCorrection};
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;

use super::frames;
use super::point_stream::PointStream;
use crate::cli::PointsArgs;
use crate::device::{DeviceError, PointBatch};
use crate::failure::Failure;
use crate::formats::output;
use crate::formats::points::{Answer, Block, BlockAnswers, Checked, Source};

/// Direction of the transformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Direction {
    /// Measured -> ideal.
    Correct,
    /// Ideal -> measured.
    Distort,
}

/// Points given to the device at once.
const BATCH: usize = 4096;

pub(super) fn run(args: &PointsArgs, direction: Direction) -> Result<(), Failure> {
    if args.frames.are_given() {
        return frames::points::run(args, direction);
    }
    let request = &args.exposure;
    let (camera, grids) = request.read_camera_with_grids()?;
    output::check_not_the_input(args.files.out.as_deref(), &request.camera)?;
    let checked = match direction {
        Direction::Correct => Checked::OnSensor,
        Direction::Distort => Checked::Finite,
    };
    let points = PointStream::open(&args.files, &camera, checked)?;
    let mut device = args.device.open()?;
    device
        .load_grids(&grids)
        .and_then(|()| device.load(&camera.parameters()))
        .and_then(|()| device.expose(&request.exposure()))
        .map_err(|error| request.refused(&camera, &error))?;
    let mut batch = Vec::with_capacity(BATCH);
    points.answer(|source, block, answers| {
        if let Some(correction) = device.correction_here()
            && answered_by_rows(correction, direction, &camera, block, answers)
        {
            return Ok(());
        }
        block.widen();
        for points_mm in block.points_mm.chunks(BATCH) {
            batch.clear();
            batch.extend(points_mm.iter().map(|point_mm| sensor_point(*point_mm)));
            let corrected = match direction {
                Direction::Correct => device.correct(&batch),
                Direction::Distort => device.distort(&batch),
            }
            .and_then(|corrected| {
                DeviceError::check_count(batch.len(), corrected.len())?;
                Ok(corrected)
            })
            .map_err(|error| {
                point_failure(&error, source, block, answers.numbers.len(), &camera, args)
            })?;
            answers.numbers.extend(
                corrected
                    .iter()
                    .map(|corrected| answer(corrected, direction, &camera)),
            );
        }
        Ok(())
    })
}

/// Answers the rows of an array in single precision, from the bytes that were read to those that
/// are written; `false`, and no answer, if a point has none, or needs more than one step.
fn answered_by_rows(
    correction: &FrameCorrection,
    direction: Direction,
    camera: &CameraFile,
    block: &Block,
    answers: &mut BlockAnswers,
) -> bool {
    if block.rows.is_empty() {
        return false;
    }
    let batch = PointBatch::new(correction);
    let (rows, found) = (block.rows.as_slice(), &mut answers.rows);
    let are_all = match direction {
        Direction::Correct => batch.correct_rows(correction, rows, found),
        Direction::Distort => batch.distort_rows(camera.half_format_mm(), rows, found),
    };
    if !are_all {
        found.clear();
    }
    are_all
}

fn sensor_point([x, y]: [f64; 2]) -> SensorPoint {
    SensorPoint::new(single(x), single(y))
}

fn answer(corrected: &Corrected, direction: Direction, camera: &CameraFile) -> Answer {
    let [x, y] = [corrected.point.x_mm, corrected.point.y_mm].map(f64::from);
    let point_mm = match direction {
        Direction::Correct => [x, y],
        // Rounding to single precision can put a point of the edge beyond the edge.
        Direction::Distort => {
            let [half_width, half_height] = camera.half_format_mm();
            [
                x.clamp(-half_width, half_width),
                y.clamp(-half_height, half_height),
            ]
        }
    };
    Answer {
        point_mm,
        distortion_mm: [corrected.distortion.dx_mm, corrected.distortion.dy_mm].map(f64::from),
    }
}

/// Returns the failure of a point: the input is at fault where the point has no measured place,
/// otherwise the device.
fn point_failure(
    error: &DeviceError,
    source: &Source,
    block: &Block,
    done: usize,
    camera: &CameraFile,
    args: &PointsArgs,
) -> Failure {
    let (DeviceError::Distort { index, .. } | DeviceError::OffSensor { index }) = error else {
        return args.exposure.refused(camera, error);
    };
    let index = done + index;
    let Some(point_mm) = block.points_mm.get(index) else {
        return Failure::device_or_io(error.to_string());
    };
    let DeviceError::Distort { error, .. } = error else {
        return block.off_sensor(source, index, "the point", *point_mm, camera);
    };
    match error {
        DistortError::OffSensor(measured) => block.off_sensor(
            source,
            index,
            "its measured point",
            [measured.x_mm, measured.y_mm].map(f64::from),
            camera,
        ),
        DistortError::NotConverged { .. } => {
            Failure::bad_input(format!("{}: {error}", block.place(source, index)))
        }
    }
}
