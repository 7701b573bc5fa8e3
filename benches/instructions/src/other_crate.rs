//! Alternative for users: the crate `opencv-ros-camera`, in single precision, with coordinates in
//! pixels.

use core::hint::black_box;

use cam_geom::{IntrinsicParameters as _, Pixels, Points, coordinate_system::CameraFrame};
use nalgebra::{SMatrix, Vector5};
use opencv_ros_camera::{Distortion, RosOpenCvIntrinsics, UndistortedPixels};

use crate::counter::Counter;
use crate::specimen::points;

/// Points per call; their matrices are on the stack.
const BATCH: usize = 256;
const PIXEL_MM: f32 = 0.00376;
const PRINCIPAL_DISTANCE_PX: f32 = 51.3712 / PIXEL_MM;
const CENTRE_PX: [f32; 2] = [7101.5, 5325.5];

/// Counts the crate's functions. It converts ideal into measured points by a polynomial and back by
/// five iterations; photogrammetry has the polynomial the other way round.
pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    // K1 to K3 of the short specimen, and no tangential terms, in units of the principal distance.
    let distortion = Distortion::from_opencv_vec(Vector5::new(0.0424, -0.0431, 0.0, 0.0, 0.0241));
    let [centre_col, centre_row] = CENTRE_PX;
    let camera = RosOpenCvIntrinsics::from_params_with_distortion(
        PRINCIPAL_DISTANCE_PX,
        0.0,
        PRINCIPAL_DISTANCE_PX,
        centre_col,
        centre_row,
        distortion,
    );
    let points = points();
    let places = SMatrix::<f32, BATCH, 2>::from_fn(|row, column| {
        // Every fourth point is taken.
        let point = points.get(4 * row).copied().unwrap_or_default();
        match column {
            0 => centre_col + point.x_mm / PIXEL_MM,
            _ => centre_row - point.y_mm / PIXEL_MM,
        }
    });
    #[expect(clippy::cast_possible_truncation, reason = "256 points")]
    let per_point = (BATCH as u32, "point");
    let ideal = UndistortedPixels { data: places };
    counter.count("opencv_ros_camera_distort", per_point, || {
        Some(black_box(&camera).distort(black_box(&ideal)).data[(0, 0)])
    })?;
    let measured = Pixels::new(places);
    counter.count("opencv_ros_camera_undistort", per_point, || {
        Some(black_box(&camera).undistort(black_box(&measured)).data[(0, 0)])
    })?;
    // The conversion from directions in the camera to pixels has one division more than the
    // polynomial.
    let rays =
        Points::<CameraFrame, f32, _, _>::new(SMatrix::<f32, BATCH, 3>::from_fn(|row, column| {
            match column {
                0 => (places[(row, 0)] - centre_col) / PRINCIPAL_DISTANCE_PX,
                1 => (places[(row, 1)] - centre_row) / PRINCIPAL_DISTANCE_PX,
                _ => 1.0,
            }
        }));
    counter.count("opencv_ros_camera_project", per_point, || {
        Some(black_box(&camera).camera_to_pixel(black_box(&rays)).data[(0, 0)])
    })
}
