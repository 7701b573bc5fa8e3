//! Strips flown to and fro with the same camera.

use fmc_camera::flight::camera::{Camera, CameraParameters, Mechanism};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure, FlightDirection};
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::five_coefficient::{FiveCoefficients, Regressor};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::geometry::shutter::ShutterProfile;

fn camera(axis: FmcAxis, mechanism: Mechanism, regressor: Regressor) -> Camera {
    let mut record = CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
    record.calibration.principal_point = SensorPoint::new(0.02, -0.01);
    record.calibration.distortion = Brown {
        k1: -1e-6,
        k2: 2e-10,
        k3: -1e-14,
        p1: 1e-6,
        p2: -2e-6,
        b1: 1e-5,
        b2: 2e-5,
        ..Brown::default()
    };
    record.calibration.fitted = Some(FiveCoefficients {
        km0: 1e-4,
        km1: -1e-6,
        km2: 2e-10,
        kd1: 1e-6,
        pm1: 5e-7,
        regressor,
    });
    // The run-out is even in s, so that a reversed stage has the same.
    record.calibration.flatness.coefficients_um = [1.0, 0.0, 3.0, 0.0, 0.0];
    record.calibration.axis = axis;
    record.mechanism = mechanism;
    record.shutter = ShutterProfile::Trapezoid {
        opening_fraction: 0.3,
        closing_fraction: 0.1,
    };
    Camera::new(record).unwrap()
}

fn mechanisms() -> Vec<Mechanism> {
    let stage = |run_up, jerk_mm_s3| Mechanism::Stage {
        acceleration_mm_s2: 1000.0,
        settling_ms: 5.0,
        run_up,
        jerk_mm_s3,
        max_speed_mm_s: Some(30.0),
    };
    vec![
        stage(RunUp::Centred, None),
        stage(RunUp::FromRest, None),
        stage(RunUp::FromRest, Some(1e5)),
        Mechanism::Tdi {
            first_transfer: 0.7,
        },
    ]
}

#[test]
fn flight_against_an_axis_is_flight_along_the_opposite_one_bit_by_bit() {
    let opposite = [
        (FmcAxis::PlusY, FmcAxis::MinusY),
        (FmcAxis::MinusY, FmcAxis::PlusY),
        (FmcAxis::PlusX, FmcAxis::MinusX),
        (FmcAxis::MinusX, FmcAxis::PlusX),
    ];
    let models = [
        CorrectionModel::Exact,
        CorrectionModel::Fitted,
        CorrectionModel::Static,
    ];
    for mechanism in mechanisms() {
        for regressor in [Regressor::Travel, Regressor::Centroid] {
            for (axis, against) in opposite {
                for model in models {
                    let along = Exposure {
                        model,
                        ..Exposure::new(0.17, 0.01)
                    };
                    let reverse = Exposure {
                        direction: FlightDirection::Reverse,
                        ..along
                    };
                    let forward = camera(against, mechanism, regressor).frame(&along).unwrap();
                    let back = camera(axis, mechanism, regressor).frame(&reverse).unwrap();
                    let (there, here) = (forward.interior.motion, back.interior.motion);
                    assert!(here.travel_mm < 0.0);
                    assert!((here.travel_mm + there.travel_mm).abs() <= 0.0);
                    assert!((here.centroid_mm + there.centroid_mm).abs() <= 0.0);
                    assert_eq!(
                        back.interior.principal_point,
                        forward.interior.principal_point
                    );
                    assert_eq!(
                        back.correction, forward.correction,
                        "{mechanism:?} {model:?}"
                    );
                    let point = SensorPoint::new(31.0, -23.0);
                    assert_eq!(
                        back.correction.correct(point),
                        forward.correction.correct(point)
                    );
                }
            }
        }
    }
}

#[test]
fn direction_moves_the_principal_point_the_other_way() {
    let camera = camera(FmcAxis::PlusY, mechanisms()[1], Regressor::Travel);
    let reverse = Exposure {
        direction: FlightDirection::Reverse,
        ..Exposure::new(0.17, 0.01)
    };
    // From rest to 17 mm/s: 0.1445 mm of ramp, 0.085 mm of settling, downwards.
    let plan = camera.plan(&reverse).unwrap();
    assert!((plan.opening_mm + 0.2295).abs() < 1e-6);
    assert!((plan.closing_mm + 0.3995).abs() < 1e-6);
    let frame = camera.frame(&reverse).unwrap();
    assert!(frame.interior.principal_point.y_mm < -0.01 - 0.3);
}

#[test]
fn given_opening_offset_is_along_the_axis_in_both_directions() {
    let camera = camera(FmcAxis::PlusY, mechanisms()[0], Regressor::Travel);
    let given = |direction| Exposure {
        opening_offset_mm: Some(0.25),
        direction,
        ..Exposure::new(0.17, 0.01)
    };
    for (direction, closing_mm) in [
        (FlightDirection::Forward, 0.42),
        (FlightDirection::Reverse, 0.08),
    ] {
        let plan = camera.plan(&given(direction)).unwrap();
        assert!((plan.opening_mm - 0.25).abs() < 1e-7);
        assert!((plan.closing_mm - closing_mm).abs() < 1e-6);
    }
}
