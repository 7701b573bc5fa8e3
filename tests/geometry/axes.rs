//! Symmetry of the four FMC axes: turning or mirroring the camera turns or mirrors the result.

use crate::geometry::cameras;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use proptest::prelude::*;

/// Eight units in the last place of 6 mm of distortion with its terms added in another order, mm;
/// the smallest term of the motion is four times as large.
const ROUNDING_MM: f32 = 4e-6;

fn corrections(
    record: CalibrationParameters,
    motion: &PrincipalPointMotion,
) -> [FrameCorrection; 2] {
    let calibration = Calibration::new(CalibrationParameters {
        fitted: Some(cameras::fitted(&record.distortion)),
        ..record
    })
    .unwrap();
    let focus = cameras::focus(&calibration, 0.02);
    [
        FrameCorrection::exact(&calibration, motion, &focus),
        FrameCorrection::five_coefficient(&calibration, motion).unwrap(),
    ]
}

/// Compares a camera with its image under `map`, which takes points and displacements alike.
fn assert_same_under(
    map: impl Fn([f32; 2]) -> [f32; 2],
    camera: [FrameCorrection; 2],
    mapped_camera: [FrameCorrection; 2],
    [x, y]: [f32; 2],
) {
    for (one, other) in camera.iter().zip(&mapped_camera) {
        let d = one.distortion(SensorPoint::new(x, y));
        let expected = map([d.dx_mm, d.dy_mm]);
        let [mx, my] = map([x, y]);
        let found = other.distortion(SensorPoint::new(mx, my));
        assert!(
            (found.dx_mm - expected[0]).abs() < ROUNDING_MM
                && (found.dy_mm - expected[1]).abs() < ROUNDING_MM,
            "{found:?} is not {expected:?}"
        );
    }
}

proptest! {
    #[test]
    fn mirror_in_x_exchanges_plus_y_and_minus_y(
        lens in cameras::lenses(),
        motion in cameras::motions(),
        x in -40.0_f32..40.0,
        y in -40.0_f32..40.0,
    ) {
        let record = cameras::square(lens, FmcAxis::PlusY);
        let pp = record.principal_point;
        let mirrored = CalibrationParameters {
            distortion: Brown { p2: -lens.p2, b2: -lens.b2, ..lens },
            principal_point: SensorPoint::new(pp.x_mm, -pp.y_mm),
            axis: FmcAxis::MinusY,
            ..record
        };
        let mirror = |[x, y]: [f32; 2]| [x, -y];
        assert_same_under(mirror, corrections(record, &motion), corrections(mirrored, &motion), [x, y]);
    }

    #[test]
    fn mirror_in_y_exchanges_plus_x_and_minus_x(
        lens in cameras::lenses(),
        motion in cameras::motions(),
        x in -40.0_f32..40.0,
        y in -40.0_f32..40.0,
    ) {
        let record = cameras::square(lens, FmcAxis::PlusX);
        let pp = record.principal_point;
        let mirrored = CalibrationParameters {
            distortion: Brown { p1: -lens.p1, b2: -lens.b2, ..lens },
            principal_point: SensorPoint::new(-pp.x_mm, pp.y_mm),
            axis: FmcAxis::MinusX,
            ..record
        };
        let mirror = |[x, y]: [f32; 2]| [-x, y];
        assert_same_under(mirror, corrections(record, &motion), corrections(mirrored, &motion), [x, y]);
    }

    #[test]
    fn diagonal_mirror_exchanges_x_and_y(
        lens in cameras::lenses(),
        motion in cameras::motions(),
        x in -40.0_f32..40.0,
        y in -40.0_f32..40.0,
    ) {
        // Affinity is defined for x alone, so that these coefficients have no mirror image with it.
        let lens = Brown { b1: 0.0, b2: 0.0, ..lens };
        let record = cameras::square(lens, FmcAxis::PlusY);
        let pp = record.principal_point;
        let mirrored = CalibrationParameters {
            distortion: Brown { p1: lens.p2, p2: lens.p1, ..lens },
            principal_point: SensorPoint::new(pp.y_mm, pp.x_mm),
            axis: FmcAxis::PlusX,
            ..record
        };
        let mirror = |[x, y]: [f32; 2]| [y, x];
        assert_same_under(mirror, corrections(record, &motion), corrections(mirrored, &motion), [x, y]);
    }
}
