//! Rounding of the single-precision evaluation, as maximum, root mean square and bias.

use crate::geometry::cameras;
use crate::geometry::jacobian::brown;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::FrameCorrection;

/// Largest rounding error of a distortion of a published camera, nm.
const MAX_NM: f64 = 0.11;
/// Root mean square, nm.
const RMS_NM: f64 = 0.02;
/// Largest mean error, nm: rounding must not be biased.
const BIAS_NM: f64 = 0.001;
/// Largest error of a coordinate: half a unit in the last place at 114 mm, nm.
const COORDINATE_NM: f64 = 3.83;

#[test]
fn rounding_stays_within_its_budget_on_the_published_cameras() {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for record in cameras::published() {
        let calibration = Calibration::new(record).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let pp = record.principal_point;
        for point in cameras::grid(&calibration, 101) {
            let [x, y] = [point.x_mm, point.y_mm].map(f64::from);
            let [x0, y0] = [pp.x_mm, pp.y_mm].map(f64::from);
            let expected = brown(&record.distortion, x - x0, y - y0);
            let answer = correction.correct(point);
            let found = [answer.distortion.dx_mm, answer.distortion.dy_mm].map(f64::from);
            let ideal = [answer.point.x_mm, answer.point.y_mm].map(f64::from);
            for axis in 0..2 {
                let error_nm = 1e6 * (found[axis] - expected[axis]);
                assert!(error_nm.abs() <= MAX_NM, "{error_nm} nm at {point:?}");
                sum += error_nm;
                squares += error_nm * error_nm;
                count += 1.0;
                let coordinate_nm = 1e6 * (ideal[axis] - ([x, y][axis] - expected[axis]));
                assert!(coordinate_nm.abs() <= COORDINATE_NM, "{coordinate_nm} nm");
            }
        }
    }
    let (rms, bias): (f64, f64) = ((squares / count).sqrt(), sum / count);
    assert!(rms <= RMS_NM, "rms {rms} nm");
    assert!(bias.abs() <= BIAS_NM, "bias {bias} nm");
}

#[test]
fn kernel_is_short_only_where_the_dropped_terms_are_below_half_a_nanometre() {
    use fmc_camera::geometry::frame_correction::{SHORT_KERNEL_NM, Terms};
    use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
    use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let mut seen = [false, false];
    for record in cameras::published() {
        let calibration = Calibration::new(record).unwrap();
        for speed_mm_s in [1.0, 4.0, 8.0, 16.0, 34.0] {
            let travel = UniformTravel {
                opening_offset_mm: 0.0,
                speed_mm_s,
                exposure_s: 0.01,
            };
            let motion = PrincipalPointMotion::from_plan(travel, &shutter);
            let focus = cameras::focus(&calibration, 0.0);
            let correction = FrameCorrection::exact(&calibration, &motion, &focus);
            let (form, centre) = (correction.form(), correction.centre());
            let dropped_nm = cameras::grid(&calibration, 21)
                .into_iter()
                .map(|p| {
                    let (x, y) = (p.x_mm - centre.x_mm, p.y_mm - centre.y_mm);
                    let full = form.displacement(x, y);
                    let short = form.short_displacement(x, y);
                    1e6 * (full.dx_mm - short.dx_mm)
                        .abs()
                        .max((full.dy_mm - short.dy_mm).abs())
                })
                .fold(0.0, f32::max);
            match correction.terms() {
                // 0.06 nm are the rounding of the two sums.
                Terms::Short => assert!(dropped_nm < SHORT_KERNEL_NM + 0.06),
                Terms::Full => assert!(dropped_nm > SHORT_KERNEL_NM - 0.06),
            }
            seen[usize::from(correction.terms() == Terms::Full)] = true;
        }
    }
    assert_eq!(seen, [true, true], "both kernels must have been used");
}
