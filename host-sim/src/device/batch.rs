//! Batches of points of a frame, corrected with the vectors of this PC.

use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::{Corrected, FrameCorrection};
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_kernel::host::Batch;

/// Points that go through the kernel together: their numbers fit the first-level cache.
const POINTS: usize = 512;

/// The correction of a frame, evaluated for many points with the bits of
/// [`FrameCorrection::correct`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointBatch(Batch);

impl PointBatch {
    pub(crate) fn new(correction: &FrameCorrection) -> Self {
        Self(Batch::new(correction.coefficients(), correction.terms()))
    }

    /// Returns true if every point is on the sensor. Only the farthest is tested, as the sensor is
    /// centred on the origin.
    pub(crate) fn all_on_sensor(correction: &FrameCorrection, points: &[SensorPoint]) -> bool {
        let (mut farthest, mut numbers) = (SensorPoint::default(), true);
        for point in points {
            farthest.x_mm = farthest.x_mm.max(point.x_mm.abs());
            farthest.y_mm = farthest.y_mm.max(point.y_mm.abs());
            // `max` ignores NaN.
            numbers &= !(point.x_mm.is_nan() | point.y_mm.is_nan());
        }
        numbers && correction.contains(farthest)
    }

    /// Returns the measured points with their corrections, in order.
    pub(crate) fn corrected(&self, measured: &[SensorPoint]) -> Vec<Corrected> {
        let mut corrected = Vec::with_capacity(measured.len());
        let [mut x, mut y, mut ideal_x, mut ideal_y, mut dx, mut dy] = [[0.0; POINTS]; 6];
        for measured in measured.chunks(POINTS) {
            for ((point, x), y) in measured.iter().zip(&mut x).zip(&mut y) {
                (*x, *y) = (point.x_mm, point.y_mm);
            }
            self.0
                .xy_with_distortion([&x, &y], [&mut ideal_x, &mut ideal_y], [&mut dx, &mut dy]);
            let ideal = ideal_x.iter().zip(&ideal_y);
            let distortion = dx.iter().zip(&dy);
            let both = ideal.zip(distortion).take(measured.len());
            corrected.extend(both.map(|((x, y), (dx, dy))| Corrected {
                point: SensorPoint::new(*x, *y),
                distortion: Displacement {
                    dx_mm: *dx,
                    dy_mm: *dy,
                },
            }));
        }
        corrected
    }
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::camera::Camera;
    use fmc_camera::flight::exposure::Exposure;
    use fmc_camera_file::CameraFile;
    use fmc_camera_file::number::single;
    use fmc_camera_file::published::CAMERA_FILES;

    use fmc_camera_kernel::Terms;

    use super::*;

    #[test]
    fn one_point_off_the_sensor_or_no_number_is_seen_wherever_it_stands() {
        let (name, text) = CAMERA_FILES[0];
        let (file, _) = CameraFile::parse(name, text).unwrap();
        let [half_width, half_height] = file.half_format_mm().map(single);
        let camera = Camera::new(file.parameters()).unwrap();
        let exposure = Exposure::new(0.17, 0.001);
        let correction = camera.frame(&exposure).unwrap().correction;
        let corner = SensorPoint::new(half_width, -half_height);
        let all = |points: &[SensorPoint]| PointBatch::all_on_sensor(&correction, points);
        assert!(all(&[]) && all(&[corner; 40]));
        for index in 0..40 {
            for (x_mm, y_mm) in [
                (f32::NAN, 0.0),
                (0.0, f32::NAN),
                (f32::NEG_INFINITY, 0.0),
                (-half_width * 1.001, 0.0),
                (0.0, half_height * 1.001),
            ] {
                let mut points = [corner; 40];
                points[index] = SensorPoint::new(x_mm, y_mm);
                assert!(!all(&points), "{index}: {x_mm}, {y_mm}");
            }
        }
    }

    #[test]
    fn batch_has_the_bits_of_one_point_at_a_time() {
        let bits = |corrected: Corrected| {
            let (point, distortion) = (corrected.point, corrected.distortion);
            [point.x_mm, point.y_mm, distortion.dx_mm, distortion.dy_mm].map(f32::to_bits)
        };
        let mut random = fastrand::Rng::with_seed(8);
        let mut terms = Vec::new();
        for (name, text) in CAMERA_FILES {
            let (file, _) = CameraFile::parse(name, text).unwrap();
            let camera = Camera::new(file.parameters()).unwrap();
            let [half_width, half_height] = file.half_format_mm().map(single);
            let points: Vec<SensorPoint> = (0..20_000)
                .map(|_| {
                    SensorPoint::new(
                        half_width * (2.0 * random.f32() - 1.0),
                        half_height * (2.0 * random.f32() - 1.0),
                    )
                })
                .collect();
            for focus_shift_um in [0.0, 5.0] {
                let exposure = Exposure {
                    focus_shift_um,
                    ..Exposure::new(0.17, 0.02)
                };
                let correction = camera.frame(&exposure).unwrap().correction;
                terms.push(correction.terms());
                let batch = PointBatch::new(&correction).corrected(&points);
                assert_eq!(batch.len(), points.len());
                for (point, batch) in points.iter().zip(batch) {
                    assert_eq!(
                        bits(batch),
                        bits(correction.correct(*point)),
                        "{name}: {point:?}"
                    );
                }
            }
        }
        assert!(terms.contains(&Terms::Short) && terms.contains(&Terms::Full));
    }
}
