//! Distortion at points over the sensor: what calibrations miss of the exposure mean.

use fmc::SensorPoint;
use fmc::flight::camera::Camera;
use fmc::geometry::evaluation_form::Displacement;
use fmc::geometry::frame_correction::FrameCorrection;

/// Points along each side of the sensor, edges included.
pub(crate) const SIDE_POINTS: u8 = 21;

/// Largest lengths over the sensor, mm, by which calibrations miss the exposure mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Missed {
    /// The static calibration.
    pub(crate) by_static: f32,
    /// The calibration about the centroid's principal point, without the moments of the motion.
    pub(crate) by_moved: f32,
}

/// Returns what calibrations miss in a frame with this exposure mean of the distortion.
///
/// # Model
/// Differences of the distortion, measured - ideal, at 21 x 21 points with the corners.
pub(crate) fn missed(camera: &Camera, mean: &FrameCorrection) -> Missed {
    let parameters = camera.calibration().parameters();
    let still = FrameCorrection::without_motion(camera.calibration());
    let centre = mean.centre();
    let mut largest = Missed::default();
    for point in points(camera) {
        let of_mean = mean.distortion(point);
        let moved = parameters
            .distortion
            .displacement(point.x_mm - centre.x_mm, point.y_mm - centre.y_mm);
        largest.by_static = largest
            .by_static
            .max(length(of_mean, still.distortion(point)));
        largest.by_moved = largest.by_moved.max(length(of_mean, moved));
    }
    largest
}

fn length(one: Displacement, other: Displacement) -> f32 {
    let [dx_mm, dy_mm] = difference(one, other);
    libm::hypotf(dx_mm, dy_mm)
}

/// Returns what a displacement has more than another one, mm.
pub(crate) fn difference(one: Displacement, other: Displacement) -> [f32; 2] {
    [one.dx_mm - other.dx_mm, one.dy_mm - other.dy_mm]
}

/// Returns the points, row after row from the lower left corner.
pub(crate) fn points(camera: &Camera) -> impl Iterator<Item = SensorPoint> {
    let sensor = camera.calibration().sensor();
    let (half_width, half_height) = (sensor.half_width_mm(), sensor.half_height_mm());
    places()
        .flat_map(move |y| places().map(move |x| SensorPoint::new(x * half_width, y * half_height)))
}

/// Returns places from -1 to 1.
fn places() -> impl Iterator<Item = f32> {
    (0..SIDE_POINTS).map(|index| 2.0 * f32::from(index) / f32::from(SIDE_POINTS - 1) - 1.0)
}
