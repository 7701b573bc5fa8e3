//! Batches of points of a frame, corrected and distorted with the vectors of this PC.

use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::{Corrected, FrameCorrection};
use fmc_camera::geometry::inverse::DistortSliceError;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_camera_kernel::host::Batch;
use fmc_camera_kernel::inverse::LastStep;

use crate::formats::points::farthest;

/// Points that go through the kernel together: their numbers fit the first-level cache.
const POINTS: usize = 512;

/// The correction of a frame, evaluated for many points with the bits of
/// [`FrameCorrection::correct`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointBatch {
    batch: Batch,
    last_step: LastStep,
}

impl PointBatch {
    pub(crate) fn new(correction: &FrameCorrection) -> Self {
        Self {
            batch: Batch::new(correction.coefficients(), correction.terms()),
            last_step: correction.last_step(),
        }
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
        let mut numbers = Numbers::new();
        for measured in measured.chunks(POINTS) {
            numbers.take(measured);
            let [given, found, distortion] = numbers.slices();
            let given = given.map(|numbers| &*numbers);
            self.batch.xy_with_distortion(given, found, distortion);
            corrected.extend(numbers.corrected(measured.len()));
        }
        corrected
    }

    /// Returns the ideal points with their measured ones, in order: [`FrameCorrection::distort`],
    /// bit for bit.
    ///
    /// # Errors
    /// That of the first point without a measured one, with its index.
    pub(crate) fn distorted(
        &self,
        correction: &FrameCorrection,
        ideal: &[SensorPoint],
    ) -> Result<Vec<Corrected>, DistortSliceError> {
        let mut distorted = self.stepped(ideal);
        for (index, (found, ideal)) in distorted.iter_mut().zip(ideal).enumerate() {
            if found.point.x_mm.is_nan() {
                *found = correction
                    .distort(*ideal)
                    .map_err(|error| DistortSliceError { index, error })?;
            }
        }
        Ok(distorted)
    }

    /// Returns the measured points of ideal ones as far as the first step leads, in order: x is NaN
    /// where it is not the last.
    pub(crate) fn stepped(&self, ideal: &[SensorPoint]) -> Vec<Corrected> {
        let mut stepped = Vec::with_capacity(ideal.len());
        let mut numbers = Numbers::new();
        for ideal in ideal.chunks(POINTS) {
            numbers.take(ideal);
            let [given, found, distortion] = numbers.slices();
            let given = given.map(|numbers| &*numbers);
            // Points that need more are marked.
            let _ = self
                .batch
                .xy_distorted(&self.last_step, given, found, distortion);
            stepped.extend(numbers.corrected(ideal.len()));
        }
        stepped
    }
}

/// Rows of an array: x and y of a point in mm, and of its answer, dx and dy in µm besides.
impl PointBatch {
    /// Appends the answers to measured points; returns `false` if one is off the sensor.
    pub(crate) fn correct_rows(
        &self,
        correction: &FrameCorrection,
        measured: &[[[u8; 4]; 2]],
        answers: &mut Vec<[[u8; 4]; 4]>,
    ) -> bool {
        let [x_mm, y_mm] = farthest(measured);
        if !correction.contains(SensorPoint::new(x_mm, y_mm)) {
            return false;
        }
        let mut numbers = Numbers::new();
        for measured in measured.chunks(POINTS) {
            numbers.take_rows(measured);
            let [given, found, distortion] = numbers.slices();
            let given = given.map(|numbers| &*numbers);
            self.batch.xy_with_distortion(given, found, distortion);
            answers.extend(numbers.rows(measured.len()));
        }
        true
    }

    /// Appends the answers to ideal points, no farther than `half_format_mm`; returns `false` if
    /// the first step does not end one of them.
    pub(crate) fn distort_rows(
        &self,
        half_format_mm: [f64; 2],
        ideal: &[[[u8; 4]; 2]],
        answers: &mut Vec<[[u8; 4]; 4]>,
    ) -> bool {
        let mut numbers = Numbers::new();
        for ideal in ideal.chunks(POINTS) {
            numbers.take_rows(ideal);
            let [given, found, distortion] = numbers.slices();
            let given = given.map(|numbers| &*numbers);
            if !self
                .batch
                .xy_distorted(&self.last_step, given, found, distortion)
            {
                return false;
            }
            numbers.keep_within(half_format_mm);
            answers.extend(numbers.rows(ideal.len()));
        }
        true
    }
}

/// Points of a call of the kernel, their answers, and the distortion, x and y apart.
struct Numbers([[[f32; POINTS]; 2]; 3]);

impl Numbers {
    const fn new() -> Self {
        Self([[[0.0; POINTS]; 2]; 3])
    }

    /// Takes points; numbers behind them stay, and their answers do not matter.
    fn take(&mut self, points: &[SensorPoint]) {
        let Self([[x, y], ..]) = self;
        for ((point, x), y) in points.iter().zip(x).zip(y) {
            (*x, *y) = (point.x_mm, point.y_mm);
        }
    }

    /// Takes points as an array holds them.
    fn take_rows(&mut self, points: &[[[u8; 4]; 2]]) {
        let Self([[x, y], ..]) = self;
        for ((point, x), y) in points.iter().zip(x).zip(y) {
            [*x, *y] = point.map(f32::from_le_bytes);
        }
    }

    /// Moves answers beyond an edge to it, as [`f64::clamp`] does before it is rounded.
    fn keep_within(&mut self, half_format_mm: [f64; 2]) {
        let Self([_, found, _]) = self;
        for (numbers, half) in found.iter_mut().zip(half_format_mm) {
            let edge = single(half);
            // Numbers up to this one are not moved.
            let within = if f64::from(edge) > half {
                edge.next_down()
            } else {
                edge
            };
            for number in numbers {
                if number.abs() > within {
                    *number = edge.copysign(*number);
                }
            }
        }
    }

    /// Returns the first `count` answers as rows of an array.
    fn rows(&self, count: usize) -> impl Iterator<Item = [[u8; 4]; 4]> {
        self.corrected(count)
            .map(|Corrected { point, distortion }| {
                let [dx_um, dy_um] = [distortion.dx_mm, distortion.dy_mm].map(|d_mm| 1000.0 * d_mm);
                [point.x_mm, point.y_mm, dx_um, dy_um].map(f32::to_le_bytes)
            })
    }

    fn slices(&mut self) -> [[&mut [f32]; 2]; 3] {
        let Self(numbers) = self;
        numbers
            .each_mut()
            .map(|xy| xy.each_mut().map(<[f32; POINTS]>::as_mut_slice))
    }

    /// Returns the first `count` answers.
    fn corrected(&self, count: usize) -> impl Iterator<Item = Corrected> {
        let Self([_, [x, y], [dx, dy]]) = self;
        let point = x.iter().zip(y);
        let distortion = dx.iter().zip(dy);
        let both = point.zip(distortion).take(count);
        both.map(|((x_mm, y_mm), (dx_mm, dy_mm))| Corrected {
            point: SensorPoint::new(*x_mm, *y_mm),
            distortion: Displacement {
                dx_mm: *dx_mm,
                dy_mm: *dy_mm,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::camera::{Camera, CameraParameters};
    use fmc_camera::flight::exposure::Exposure;
    use fmc_camera::geometry::calibration::CalibrationParameters;
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

    #[test]
    fn distorted_batch_has_the_bits_and_the_error_of_one_point_at_a_time() {
        let bits = |of: &Corrected| {
            let (point, distortion) = (of.point, of.distortion);
            [point.x_mm, point.y_mm, distortion.dx_mm, distortion.dy_mm].map(f32::to_bits)
        };
        let mut random = fastrand::Rng::with_seed(9);
        let mut refused = 0;
        // A lens of 20 % of distortion at the corner, whose first step is not the last.
        let mut strong = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
        strong.distortion.k1 = 9e-5;
        let files = CAMERA_FILES.map(|(name, text)| {
            let (file, _) = CameraFile::parse(name, text).unwrap();
            file.parameters()
        });
        for parameters in files.into_iter().chain([CameraParameters::new(strong)]) {
            let camera = Camera::new(parameters).unwrap();
            let correction = camera
                .frame(&Exposure::new(0.17, 0.001))
                .unwrap()
                .correction;
            let sensor = *correction.sensor();
            let [width, height] = [sensor.half_width_mm(), sensor.half_height_mm()];
            for (count, beyond) in [(1, 0.9), (511, 0.9), (20_000, 0.8), (700, 1.01)] {
                let mut about = |half: f32| beyond * half * (2.0 * random.f32() - 1.0);
                let ideal: Vec<_> = (0..count)
                    .map(|_| SensorPoint::new(about(width), about(height)))
                    .collect();
                let expected: Result<Vec<_>, _> = (0..)
                    .zip(&ideal)
                    .map(|(index, point)| {
                        let found = correction.distort(*point);
                        found.map_err(|error| DistortSliceError { index, error })
                    })
                    .collect();
                match (
                    PointBatch::new(&correction).distorted(&correction, &ideal),
                    expected,
                ) {
                    (Ok(found), Ok(expected)) => {
                        assert!(found.iter().map(bits).eq(expected.iter().map(bits)));
                    }
                    (found, expected) => {
                        refused += 1;
                        assert_eq!(found, expected);
                    }
                }
            }
        }
        assert!(refused > 1);
    }

    #[test]
    fn a_point_that_is_no_number_among_good_ones_is_refused_by_its_index() {
        let (name, text) = CAMERA_FILES[0];
        let (file, _) = CameraFile::parse(name, text).unwrap();
        let camera = Camera::new(file.parameters()).unwrap();
        let correction = camera
            .frame(&Exposure::new(0.17, 0.001))
            .unwrap()
            .correction;
        let batch = PointBatch::new(&correction);
        for index in [0, 3, 15, 16, 511, 512, 1300] {
            let mut ideal = vec![SensorPoint::new(1.0, -2.0); 1301];
            for bad in [
                [f32::NAN, 0.0],
                [0.0, f32::NAN],
                [f32::INFINITY, 0.0],
                [1e9, 0.0],
            ] {
                ideal[index] = SensorPoint::new(bad[0], bad[1]);
                let refused = batch.distorted(&correction, &ideal).unwrap_err();
                let error = correction.distort(ideal[index]).unwrap_err();
                assert_eq!(refused.index, index);
                // A NaN in an error equals none.
                assert_eq!(format!("{:?}", refused.error), format!("{error:?}"));
            }
        }
    }
}
