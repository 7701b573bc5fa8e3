//! Rows by differences against the distortion, within the bound that they state.

use crate::geometry::cameras;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::displacement_rows::{
    DisplacementRows, RESTART_INTERVAL, ROW_ROUNDING_NM,
};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use proptest::prelude::*;

/// Largest error measured on the cameras below, nm: the largest roundings do not all coincide.
const MEASURED_NM: f64 = 0.6;

/// Returns the evaluation form in double precision.
pub(crate) fn form_f64(correction: &FrameCorrection, x_mm: f64, y_mm: f64) -> [f64; 2] {
    let form = correction.form();
    let [k0, k1, k2, k3] = [form.k0, form.k1, form.k2, form.k3].map(f64::from);
    let [hx, hy, gx, gy] = [form.hx, form.hy, form.gx, form.gy].map(f64::from);
    let [b1, b2, tx, ty] = [form.b1, form.b2, form.tx, form.ty].map(f64::from);
    let x = x_mm - f64::from(correction.centre().x_mm);
    let y = y_mm - f64::from(correction.centre().y_mm);
    let r2 = x * x + y * y;
    let gain = k0 + r2 * (k1 + r2 * (k2 + r2 * k3)) + hx * x + hy * y;
    [
        x * gain + gx * r2 + b1 * x + b2 * y + tx,
        y * gain + gy * r2 + ty,
    ]
}

/// Returns a sensor 104 mm wide and high with 0.5 mm of distortion per axis at the corner.
pub(crate) fn wide(distortion: Brown) -> CalibrationParameters {
    CalibrationParameters {
        width_px: 10_400,
        height_px: 10_400,
        pixel_um: 10.0,
        ..cameras::square(distortion, FmcAxis::PlusY)
    }
}

/// Returns distortions of [`wide`]: K1 alone, K1 to K3 that compete, and these with all other
/// terms.
pub(crate) fn half_a_millimetre() -> [Brown; 3] {
    let third_order = Brown {
        k1: 1.78e-6,
        ..Brown::default()
    };
    let competing = Brown {
        k1: 2.5e-6,
        k2: -1.6e-10,
        k3: 5.0e-15,
        ..Brown::default()
    };
    let all = Brown {
        k0: 1e-4,
        p1: 1e-6,
        p2: -2e-6,
        b1: 1e-4,
        b2: -2e-4,
        ..competing
    };
    [third_order, competing, all]
}

/// Returns the largest error over the rows of a sensor, nm; every row goes from edge to edge.
fn largest_error_nm(correction: &FrameCorrection, rows: &DisplacementRows, step_mm: f32) -> f64 {
    let sensor = correction.sensor();
    let top = sensor.half_height_mm();
    let heights = (-8_i8..=8).map(|index| f32::from(index) / 8.0 * top);
    let first = heights.map(|y_mm| SensorPoint::new(-sensor.half_width_mm(), y_mm));
    first
        .map(|first| row_error_nm(correction, rows, first, step_mm))
        .fold(0.0, f64::max)
}

/// Returns the largest error of one row, nm, from `first` to the edge.
fn row_error_nm(
    correction: &FrameCorrection,
    rows: &DisplacementRows,
    first: SensorPoint,
    step_mm: f32,
) -> f64 {
    let right = correction.sensor().half_width_mm();
    let inside = |index: &u16| (first.x_mm + f32::from(*index) * step_mm).abs() <= right;
    let count = (1..u16::MAX).take_while(inside).count() + 1;
    let mut row = vec![Displacement::default(); count];
    rows.row(first).write(&mut row);
    let mut largest = 0.0_f64;
    for (index, found) in (0_u32..).zip(&row) {
        let x_mm = f64::from(first.x_mm) + f64::from(index) * f64::from(step_mm);
        let [dx, dy] = form_f64(correction, x_mm, f64::from(first.y_mm));
        largest = largest
            .max((f64::from(found.dx_mm) - dx).abs())
            .max((f64::from(found.dy_mm) - dy).abs());
    }
    1e6 * largest
}

/// Returns corrections of a calibration: still, and at either end of a motion in both directions of
/// flight.
pub(crate) fn corrections(calibration: &Calibration) -> Vec<FrameCorrection> {
    use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
    use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let moved = [(0.1, 17.0), (-0.1, -17.0)].map(|(opening_offset_mm, speed_mm_s)| {
        let travel = UniformTravel {
            opening_offset_mm,
            speed_mm_s,
            exposure_s: 0.01,
        };
        let motion = PrincipalPointMotion::from_plan(travel, &shutter);
        FrameCorrection::exact(calibration, &motion, &cameras::focus(calibration, 0.005))
    });
    let still = FrameCorrection::without_motion(calibration);
    moved.into_iter().chain([still]).collect()
}

/// Returns frames of the published cameras, of that of the paper, and of [`wide`], with their
/// names.
pub(crate) fn frames() -> Vec<(&'static str, FrameCorrection)> {
    // This is the camera of the paper, in host-sim/cameras.
    let paper = Brown {
        k1: 9.226_781e-8,
        ..Brown::default()
    };
    let paper = cameras::square(paper, FmcAxis::PlusY);
    let wide = half_a_millimetre().map(wide);
    let records = ["published"; 5]
        .into_iter()
        .zip(cameras::published())
        .chain(["wide"; 3].into_iter().zip(wide))
        .chain([("paper", paper)]);
    let named = |(name, record)| {
        let corrections = corrections(&Calibration::new(record).unwrap());
        corrections.into_iter().map(move |frame| (name, frame))
    };
    records.flat_map(named).collect()
}

/// Distances from vertex to vertex, as warp engines use them.
pub(crate) const SPACINGS_PX: [f32; 5] = [8.0, 16.0, 32.0, 64.0, 128.0];

#[test]
fn rows_of_every_camera_are_within_their_stated_bound_and_four_nanometres() {
    for (name, correction) in frames() {
        for spacing_px in SPACINGS_PX {
            let step_mm = spacing_px * correction.sensor().pixel_mm();
            let rows = DisplacementRows::new(&correction, step_mm);
            let error_nm = largest_error_nm(&correction, &rows, step_mm);
            let bound_nm = rows.rounding_bound_nm();
            assert!(error_nm <= MEASURED_NM, "{name}: {error_nm} nm");
            assert!(
                error_nm <= f64::from(bound_nm),
                "{error_nm} > {bound_nm} nm"
            );
            assert!(bound_nm <= ROW_ROUNDING_NM, "{bound_nm} nm");
        }
    }
}

#[test]
fn rows_of_a_step_that_is_no_length_have_no_bound() {
    for (name, correction) in frames() {
        for step_mm in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let rows = DisplacementRows::new(&correction, step_mm);
            assert!(rows.rounding_bound_nm().is_nan(), "{name}, {step_mm} mm");
        }
    }
}

/// Number of points between starts at half a millimetre of distortion over 104 mm. It keeps a point
/// within 20 instructions at 64 pixels from point to point and within 21 at 128.
const WIDE_INTERVAL: u16 = 48;

#[test]
fn starts_are_rare_enough_at_every_spacing() {
    for (name, correction) in frames() {
        for spacing_px in SPACINGS_PX {
            let step_mm = spacing_px * correction.sensor().pixel_mm();
            let interval = DisplacementRows::new(&correction, step_mm).restart_interval();
            let least = match name {
                "wide" => WIDE_INTERVAL,
                _ => RESTART_INTERVAL.get(),
            };
            assert!(interval >= least, "{name}, {spacing_px} px: {interval}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn rows_of_any_lens_are_within_their_stated_bound(
        lens in cameras::lenses(),
        axis in cameras::axes(),
        motion in cameras::motions(),
        step_mm in 0.02_f32..2.0,
    ) {
        let calibration = Calibration::new(cameras::square(lens, axis)).unwrap();
        let focus = cameras::focus(&calibration, 0.01);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let rows = DisplacementRows::new(&correction, step_mm);
        let error_nm = largest_error_nm(&correction, &rows, step_mm);
        prop_assert!(error_nm <= f64::from(rows.rounding_bound_nm()), "{error_nm} nm");
    }

    #[test]
    fn rows_from_any_point_in_either_direction_are_within_their_stated_bound(
        lens in cameras::lenses(),
        motion in cameras::motions(),
        [across, up] in [-1.0_f32..1.0, -1.0_f32..1.0],
        step_mm in 0.02_f32..4.0,
    ) {
        let calibration = Calibration::new(cameras::square(lens, FmcAxis::PlusX)).unwrap();
        let focus = cameras::focus(&calibration, 0.01);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let sensor = correction.sensor();
        let first = SensorPoint::new(across * sensor.half_width_mm(), up * sensor.half_height_mm());
        for step_mm in [step_mm, -step_mm] {
            let rows = DisplacementRows::new(&correction, step_mm);
            let error_nm = row_error_nm(&correction, &rows, first, step_mm);
            prop_assert!(error_nm <= f64::from(rows.rounding_bound_nm()), "{error_nm} nm");
        }
    }
}

#[test]
fn interval_is_the_longest_where_the_lens_allows_it_and_shorter_where_not() {
    let [third_order, ..] = half_a_millimetre();
    let interval = |share: f32| {
        let lens = Brown {
            k1: share * third_order.k1,
            ..third_order
        };
        let calibration = Calibration::new(wide(lens)).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        DisplacementRows::new(&correction, 0.64).restart_interval()
    };
    assert_eq!(interval(1.0), RESTART_INTERVAL.get());
    assert!(interval(2.0) < RESTART_INTERVAL.get());
    assert!(interval(4.0) < interval(2.0));
}
