//! `correct` and `distort`: points through the camera.

use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::sensor::SensorPoint;

use crate::cli::PointsArgs;
use crate::device::DeviceError;
use crate::failure::Failure;
use crate::formats::camera_file::CameraFile;
use crate::formats::number::single;
use crate::formats::output;
use crate::formats::points::{Answer, PointTable};

/// Which way the points go.
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
    let request = &args.exposure;
    let camera = request.read_camera()?;
    output::check_not_the_input(args.files.out.as_deref(), &request.camera)?;
    let points = PointTable::read(&args.files.points, &camera)?;
    if direction == Direction::Correct {
        points.check_on_sensor(&camera)?;
    }
    let mut device = args.device.open()?;
    device
        .load(&camera.record())
        .and_then(|()| device.expose(&request.exposure()))
        .map_err(|error| request.refused(&error))?;
    let mut answers = Vec::with_capacity(points.rows.len());
    for rows in points.rows.chunks(BATCH) {
        let batch: Vec<SensorPoint> = rows.iter().map(|row| sensor_point(row.point_mm)).collect();
        let corrected = match direction {
            Direction::Correct => device.correct(&batch),
            Direction::Distort => device.distort(&batch),
        }
        .and_then(|corrected| {
            DeviceError::check_count(batch.len(), corrected.len())?;
            Ok(corrected)
        })
        .map_err(|error| point_failure(&error, &points, answers.len(), &camera, args))?;
        answers.extend(
            corrected
                .iter()
                .map(|corrected| answer(corrected, direction, &camera)),
        );
    }
    output::write(args.files.out.as_deref(), |sink| {
        points.write_answers(&answers, &camera, sink)
    })
}

fn sensor_point([x, y]: [f64; 2]) -> SensorPoint {
    SensorPoint::new(single(x), single(y))
}

fn answer(corrected: &Corrected, direction: Direction, camera: &CameraFile) -> Answer {
    let [x, y] = [corrected.point.x_mm, corrected.point.y_mm].map(f64::from);
    let point_mm = match direction {
        Direction::Correct => [x, y],
        // An edge in single precision may lie beyond the edge by rounding.
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

/// A point without a measured place is the input's fault; anything else the device's.
fn point_failure(
    error: &DeviceError,
    points: &PointTable,
    done: usize,
    camera: &CameraFile,
    args: &PointsArgs,
) -> Failure {
    let (DeviceError::Distort { index, .. } | DeviceError::OffSensor { index }) = error else {
        return args.exposure.refused(error);
    };
    let Some(row) = points.rows.get(done + index) else {
        return Failure::device_or_io(error.to_string());
    };
    let DeviceError::Distort { error, .. } = error else {
        return points.off_sensor(row, "the point", row.point_mm, camera);
    };
    match error {
        DistortError::OffSensor(measured) => points.off_sensor(
            row,
            "its measured point",
            [measured.x_mm, measured.y_mm].map(f64::from),
            camera,
        ),
        DistortError::NotConverged { .. } => Failure::bad_input(format!(
            "{}, line {}: point {}: {error}",
            points.file, row.line, row.id
        )),
    }
}
