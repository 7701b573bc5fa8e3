//! The camera of the tests: 100 mm, 9216 x 9216 pixels of 8.75 µm, ± 2 mm of stroke along +y.

use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::exposure::Limits;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::focus_table::FocusTable;
use fmc_camera::geometry::grid::GridChecksums;
use fmc_camera::geometry::principal_distance::Flatness;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::geometry::shutter::ShutterProfile;

pub(crate) fn record() -> CameraParameters {
    CameraParameters {
        calibration: CalibrationParameters {
            principal_distance_mm: 100.0,
            exit_pupil_mm: 100.0,
            principal_point: SensorPoint::default(),
            width_px: 9216,
            height_px: 9216,
            pixel_um: 8.75,
            distortion: Brown::default(),
            fitted: None,
            axis: FmcAxis::PlusY,
            stroke_mm: 4.0,
            flatness: Flatness::default(),
        },
        mechanism: Mechanism::Stage {
            acceleration_mm_s2: 1000.0,
            settling_ms: 5.0,
            run_up: RunUp::Centred,
            jerk_mm_s3: None,
            max_speed_mm_s: None,
        },
        shutter: ShutterProfile::Uniform,
        limits: Limits {
            vh_per_s: [0.0, 1.0],
            exposure_s: [1e-4, 0.1],
        },
        grids: GridChecksums::NONE,
        focus: FocusTable::NONE,
        serial: SerialNumber::EMPTY,
        version: 0,
    }
}
