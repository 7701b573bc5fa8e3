//! Residual grids that do not fit their camera.

use crate::geometry::spline::{file, noise, wave};
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters, Polynomial};
use fmc_camera::geometry::camera_grids::{CameraGrids, CameraGridsError, MAX_GRID_SLOPE};
use fmc_camera::geometry::grid::{GridCarrier, GridError, GridHeader, ResidualGrid};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};

/// Returns a header of cells up to 22 mm along x and 17 mm along y.
fn header(carrier: GridCarrier) -> GridHeader {
    GridHeader {
        carrier,
        columns: 25,
        rows: 20,
        first_node: SensorPoint::new(-24.0, -19.0),
        pitch_mm: 2.0,
        scale_mm: 1e-7,
    }
}

/// Returns a camera of 40 mm by 30 mm with a stroke of 4 mm.
fn camera(axis: FmcAxis) -> CalibrationParameters {
    let mut parameters = CalibrationParameters::new(100.0, [4000, 3000], 10.0);
    parameters.axis = axis;
    parameters
}

/// Returns the grids of a camera with one grid in the place of a part.
fn grids(
    parameters: CalibrationParameters,
    place: GridCarrier,
    bytes: &[u8],
) -> Result<CameraGrids<'_>, CameraGridsError> {
    let calibration = Calibration::new(parameters).unwrap();
    let grid = ResidualGrid::parse(bytes).unwrap();
    match place {
        GridCarrier::Lens => CameraGrids::new(&calibration, Some(grid), None),
        GridCarrier::Sensor => CameraGrids::new(&calibration, None, Some(grid)),
    }
}

#[test]
fn grid_of_the_other_part_is_refused() {
    for (place, other, words) in [
        (
            GridCarrier::Lens,
            GridCarrier::Sensor,
            "that of the lens, and its file says sensor",
        ),
        (
            GridCarrier::Sensor,
            GridCarrier::Lens,
            "that of the sensor, and its file says lens",
        ),
    ] {
        let bytes = file(&header(other), wave);
        let error = grids(camera(FmcAxis::PlusY), place, &bytes).unwrap_err();
        assert_eq!(error, CameraGridsError::Carrier { given_as: place });
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// The cells are as large as the sensor enlarged by half the stroke along either axis; a pixel more
/// is refused.
#[test]
fn grid_of_the_lens_covers_half_the_stroke_and_that_of_the_sensor_need_not() {
    let along_both = |parameters: CalibrationParameters, place| {
        let bytes = file(&header(place), wave);
        grids(parameters, place, &bytes).map(|_| ())
    };
    for axis in FmcAxis::ALL {
        assert_eq!(
            along_both(camera(axis), GridCarrier::Lens),
            Ok(()),
            "{axis:?}"
        );
        let mut longer = camera(axis);
        longer.stroke_mm = 4.02;
        let error = along_both(longer, GridCarrier::Lens).unwrap_err();
        let CameraGridsError::Grid {
            carrier: GridCarrier::Lens,
            error:
                GridError::Uncovered {
                    to_mm,
                    region_to_mm,
                    ..
                },
        } = error
        else {
            panic!("{error}");
        };
        let bits = |pair: [f32; 2]| pair.map(f32::to_bits);
        assert_eq!(bits(to_mm), bits([22.0, 17.0]));
        let [x, y] = if axis.is_x() {
            [22.01, 15.0]
        } else {
            [20.0, 17.01]
        };
        assert!((region_to_mm[0] - x).abs() < 1e-5 && (region_to_mm[1] - y).abs() < 1e-5);
        assert!(
            error.to_string().contains("enlarged by half the stroke"),
            "{error}"
        );
        assert_eq!(along_both(longer, GridCarrier::Sensor), Ok(()));
        let mut wider = camera(axis);
        wider.width_px = 4402;
        assert!(matches!(
            along_both(wider, GridCarrier::Sensor),
            Err(CameraGridsError::Grid {
                carrier: GridCarrier::Sensor,
                ..
            })
        ));
    }
}

#[test]
fn grids_that_are_steeper_than_a_residual_are_refused() {
    let steep = GridHeader {
        scale_mm: 2e-6,
        ..header(GridCarrier::Sensor)
    };
    let bytes = file(&steep, noise);
    let error = grids(camera(FmcAxis::PlusY), GridCarrier::Sensor, &bytes).unwrap_err();
    let CameraGridsError::Steep { slope } = error else {
        panic!("{error}");
    };
    assert!((MAX_GRID_SLOPE..0.2).contains(&slope), "{slope}");
    assert!(error.to_string().ends_with("allowed: 0.05"), "{error}");
}

/// 3·K1·r² with the focus shift leaves a scale of 0.1 to 0.13 at the corner; a grid of a slope of
/// 0.04 is too much, one of 0.0001 is not.
#[test]
fn slope_of_the_grids_is_part_of_the_proof_that_the_image_does_not_fold() {
    let mut parameters = camera(FmcAxis::PlusY);
    parameters.stroke_mm = 0.001;
    parameters.distortion.k1 = 4.5e-4;
    let calibration = Calibration::new(parameters).unwrap();
    let alone = calibration.least_scale();
    assert!((0.1..0.13).contains(&alone), "{alone}");
    let ramp = |slope: f32| {
        let header = GridHeader {
            // A hundred units from node to node.
            scale_mm: slope * 2.0 / 100.0,
            ..header(GridCarrier::Sensor)
        };
        file(&header, |column, _| {
            [100 * (i16::try_from(column).unwrap() - 12), 0]
        })
    };
    let gentle = ramp(1e-4);
    let accepted = grids(parameters, GridCarrier::Sensor, &gentle).unwrap();
    assert!(accepted.least_scale() < alone);
    // Over the disc of a mild lens the slope is subtracted as it is.
    let mild = camera(FmcAxis::PlusY);
    let accepted = grids(mild, GridCarrier::Sensor, &gentle).unwrap();
    let alone = Calibration::new(mild).unwrap().least_scale();
    let difference = alone - accepted.slope() - accepted.least_scale();
    assert!(
        accepted.slope() > 9e-5 && difference.abs() < 1e-6,
        "{difference}"
    );
    let steep = ramp(0.04);
    let error = grids(parameters, GridCarrier::Sensor, &steep).unwrap_err();
    let CameraGridsError::Folds {
        slope,
        polynomial: Polynomial::Static,
        scale,
        at,
    } = error
    else {
        panic!("{error}");
    };
    assert!((slope - 0.04).abs() < 1e-3, "{slope}");
    assert!(scale < 0.1 && at.x_mm.abs() > 15.0, "{scale} at {at:?}");
    assert!(
        error.to_string().contains("at least 0.1 is required"),
        "{error}"
    );
}
