//! A small verification for the tests.

use fmc_reference::verification::device::Evidence;
use fmc_reference::verification::result::{
    CameraResult, ErrorStatistics, Field, FieldPoint, FrameResult, Verification, WorstPoint,
};

/// Returns two cameras within the limits.
pub(super) fn passing() -> Verification {
    of(vec![camera("Alpha", 0.1), camera("Beta", 0.2)])
}

/// Returns two cameras, of which the second exceeds the limit.
pub(super) fn failing() -> Verification {
    of(vec![camera("Alpha", 0.1), camera("Beta", 2.0)])
}

pub(super) fn of(cameras: Vec<CameraResult>) -> Verification {
    Verification {
        device: "mock camera".to_owned(),
        not_in_qemu: None,
        evidence: Evidence {
            by_digest: 36,
            by_value: 5,
        },
        link: None,
        difference: None,
        cameras,
    }
}

/// Returns a camera of 20 mm x 10 mm with two exposures of nine points.
pub(super) fn camera(name: &str, error_nm: f64) -> CameraResult {
    let errors = |size_mm: f64| {
        let mut errors = ErrorStatistics::default();
        errors.add([size_mm, 0.0]);
        errors
    };
    let frame = |strategy, travel_mm, centroid_mm| FrameResult {
        strategy,
        vh_per_s: 0.17,
        exposure_s: 0.01,
        travel_mm,
        centroid_mm,
        errors: [0.5, 5e-4, 1.5e-3, 1e-6 * error_nm].map(errors),
        coordinate_error: errors(2e-6),
        solver_error_mm: 1e-10,
    };
    let places = [-1.0, 0.0, 1.0];
    let points = places.iter().flat_map(|x| {
        places.iter().map(move |y| FieldPoint {
            point_mm: [10.0 * x, 5.0 * y],
            static_mm: [0.3 * x + 0.1, 0.2 * y],
            dynamic_mm: [1e-4 * x * y, 1e-4 * (x * x + y * y) + 3e-5],
        })
    });
    CameraResult {
        name: name.to_owned(),
        format_mm: [20.0, 10.0],
        principal_distance_mm: 50.0,
        pixel_um: 4.0,
        axis: "+y",
        points: 18,
        frames: vec![frame("centred", 0.02, 0.0), frame("from-rest", 0.08, 0.12)],
        distortion_mm: [0.1, 0.45],
        field: Field {
            frame: 1,
            points: points.collect(),
        },
        worst: WorstPoint {
            error_nm,
            x_mm: 10.0,
            y_mm: -5.0,
            vh_per_s: 0.17,
            exposure_s: 0.01,
            strategy: "from-rest",
        },
    }
}
