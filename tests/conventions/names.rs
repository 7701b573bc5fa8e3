//! The symbols of section 9: their names in the code and in the camera file.

use crate::conventions::document::{names, rows};
use std::collections::BTreeSet;

use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::flight::stage::{MechanismLimits, RunUp, StrokeTooShort, Tracking, Travel};
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::five_coefficient::FiveCoefficients;
use fmc_camera::geometry::focus_table::FocusTable;
use fmc_camera::geometry::image_motion::{
    Attitude, FlightState, GroundMotion, ImageVelocity, Smear,
};
use fmc_camera::geometry::moments::CentralMoments;
use fmc_camera::geometry::principal_distance::{Flatness, FocusShift};
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, StageSample, UniformTravel};
use fmc_camera::geometry::sensor::{FmcAxis, PixelPoint, SensorPoint};
use fmc_camera::geometry::shutter::ShutterProfile;

const CAMERA_FILE: [&str; 3] = [
    include_str!("../../crates/camera-file/src/camera.rs"),
    include_str!("../../crates/camera-file/src/limits_table.rs"),
    include_str!("../../crates/camera-file/src/tables.rs"),
];

/// Returns `Type.field`, as documented; does not compile for a field that does not exist.
macro_rules! field {
    ($type:ident . $field:ident) => {{
        let _ = |value: $type| {
            let _ = value.$field;
        };
        concat!(stringify!($type), ".", stringify!($field))
    }};
}

/// Returns `Type::name`, as documented, of a method or a variant, with `{}` after a variant with
/// fields.
macro_rules! path {
    ($type:ident :: $name:ident) => {{
        let _ = $type::$name;
        concat!(stringify!($type), "::", stringify!($name))
    }};
    ($type:ident :: $name:ident {}) => {{
        let _ = |value: $type| matches!(value, $type::$name { .. });
        concat!(stringify!($type), "::", stringify!($name))
    }};
}

#[test]
fn documented_names_are_those_of_the_code() {
    let code = BTreeSet::from([
        field!(SensorPoint.x_mm),
        field!(SensorPoint.y_mm),
        field!(PixelPoint.col_px),
        field!(PixelPoint.row_px),
        field!(CalibrationParameters.width_px),
        field!(CalibrationParameters.height_px),
        field!(CalibrationParameters.pixel_um),
        field!(CalibrationParameters.principal_point),
        field!(CalibrationParameters.principal_distance_mm),
        field!(CalibrationParameters.exit_pupil_mm),
        field!(CalibrationParameters.axis),
        field!(CalibrationParameters.stroke_mm),
        field!(StrokeTooShort.from_mm),
        field!(StrokeTooShort.to_mm),
        field!(MechanismLimits.jerk_mm_s3),
        field!(MechanismLimits.max_speed_mm_s),
        field!(Tracking.margin_s),
        field!(Travel.off_centre_mm),
        field!(Exposure.direction),
        field!(Displacement.dx_mm),
        field!(Displacement.dy_mm),
        field!(Brown.k0),
        field!(Brown.k1),
        field!(Brown.k2),
        field!(Brown.k3),
        field!(Brown.p1),
        field!(Brown.p2),
        field!(Brown.b1),
        field!(Brown.b2),
        field!(FiveCoefficients.km0),
        field!(FiveCoefficients.km1),
        field!(FiveCoefficients.km2),
        field!(FiveCoefficients.kd1),
        field!(FiveCoefficients.pm1),
        field!(FiveCoefficients.regressor),
        path!(CameraGrids::lens),
        path!(CameraGrids::sensor),
        path!(FmcAxis::sign),
        field!(StageSample.offset_mm),
        field!(StageSample.time_s),
        field!(Exposure.vh_per_s),
        field!(Exposure.exposure_s),
        field!(Exposure.opening_offset_mm),
        field!(UniformTravel.speed_mm_s),
        field!(PrincipalPointMotion.opening_offset_mm),
        field!(PrincipalPointMotion.travel_mm),
        field!(PrincipalPointMotion.centroid_time_s),
        field!(PrincipalPointMotion.centroid_mm),
        field!(CentralMoments.second),
        field!(CentralMoments.third),
        field!(CentralMoments.fourth),
        field!(InteriorOrientation.principal_point),
        field!(InteriorOrientation.focus_shift_mm),
        field!(InteriorOrientation.enlargement),
        path!(ShutterProfile::Trapezoid {}),
        field!(CameraParameters.mechanism),
        field!(CameraParameters.serial),
        field!(CameraParameters.version),
        path!(RunUp::Centred),
        path!(RunUp::FromRest),
        path!(Mechanism::Stage {}),
        path!(Mechanism::Tdi {}),
        field!(Flatness.coefficients_um),
        field!(FocusShift.shift_mm),
        path!(FocusShift::enlargement),
        path!(FocusTable::at),
        field!(Attitude.pitch_deg),
        field!(Attitude.roll_deg),
        field!(GroundMotion.drift_deg),
        field!(GroundMotion.relief_percent),
        field!(Attitude.pitch_rate_deg_s),
        field!(Attitude.roll_rate_deg_s),
        field!(Attitude.yaw_rate_deg_s),
        field!(FlightState.compensated_vh_per_s),
        field!(ImageVelocity.x_mm_s),
        field!(ImageVelocity.y_mm_s),
        field!(Smear.x_um),
        field!(Smear.y_um),
    ]);
    let symbols = rows("symbol");
    let documented: BTreeSet<_> = symbols.iter().flat_map(|row| names(row[3])).collect();
    assert_eq!(documented, code);
}

/// Returns the keys of the camera file, with their table, from the fields that are read.
fn camera_file_keys() -> BTreeSet<String> {
    let mut table = None;
    let mut keys = BTreeSet::new();
    for line in CAMERA_FILE.iter().flat_map(|file| file.lines()) {
        if let Some(name) = line.strip_prefix("pub struct ") {
            table = Some(match name.trim_end_matches(" {") {
                "CameraFile" => String::new(),
                name => name.strip_suffix("Table").expect(name).to_lowercase() + ".",
            });
        } else if line == "}" {
            table = None;
        } else if let (Some(table), Some(field)) = (&table, line.strip_prefix("    pub ")) {
            let (key, kind) = field.split_once(':').unwrap();
            if !kind.contains("Table") && key != "name" {
                keys.insert(format!("{table}{key}"));
            }
        }
    }
    keys
}

#[test]
fn documented_keys_are_those_of_the_camera_file() {
    let symbols = rows("symbol");
    let documented: BTreeSet<_> = symbols
        .iter()
        .flat_map(|row| names(row[4]))
        .map(str::to_owned)
        .collect();
    assert_eq!(documented, camera_file_keys());
}
