//! Rows of sources: the inverse of the correction, continued beyond the sensor.

use crate::geometry::cameras;
use crate::geometry::mesh::{corrections, form_f64, half_a_millimetre, wide};
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::mesh::source_row::SourceRow;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use proptest::prelude::*;

/// Largest error against the exact inverse, nm: the effect of rounding the measured coordinate, 3.8
/// nm, on a distortion of a few per cent, and the rounding of the displacement itself.
const SOURCE_NM: f64 = 0.3;

/// Returns the exact way from an ideal point to its measured one; beyond the sensor the distortion
/// is that of its nearest point.
pub(crate) fn source_f64(correction: &FrameCorrection, [x, y]: [f64; 2]) -> [f64; 2] {
    let half_width = f64::from(correction.sensor().half_width_mm());
    let half_height = f64::from(correction.sensor().half_height_mm());
    // The fixed-point iteration gains a factor of at least two a step.
    (0..80).fold([0.0, 0.0], |[dx, dy], _| {
        form_f64(
            correction,
            (x + dx).clamp(-half_width, half_width),
            (y + dy).clamp(-half_height, half_height),
        )
    })
}

#[test]
fn sources_of_every_camera_are_the_inverse_within_a_third_of_a_nanometre() {
    let mut largest = 0.0_f64;
    for record in cameras::published()
        .into_iter()
        .chain(half_a_millimetre().map(wide))
    {
        let calibration = Calibration::new(record).unwrap();
        let sensor = *calibration.sensor();
        for correction in corrections(&calibration) {
            for spacing_px in [8_u16, 64] {
                let step_mm = f32::from(spacing_px) * sensor.pixel_mm();
                for y_mm in [-1.0, -0.4, 0.0, 0.7, 1.0].map(|y| y * sensor.half_height_mm()) {
                    let mut row = SourceRow::new(&correction);
                    let mut x_mm = -sensor.half_width_mm();
                    while x_mm < sensor.half_width_mm() + step_mm {
                        let found = row.next(SensorPoint::new(x_mm, y_mm)).unwrap();
                        let [dx, dy] = source_f64(&correction, [f64::from(x_mm), f64::from(y_mm)]);
                        let error_nm = 1e6
                            * (f64::from(found.dx_mm) - dx)
                                .abs()
                                .max((f64::from(found.dy_mm) - dy).abs());
                        assert!(error_nm <= SOURCE_NM, "{error_nm} nm at {x_mm}, {y_mm}");
                        largest = largest.max(error_nm);
                        x_mm += step_mm;
                    }
                }
            }
        }
    }
    println!("{largest}");
}

#[test]
fn a_source_found_across_the_edge_of_the_sensor_is_as_exact_as_any() {
    // The scale is 0.8 in the corners; off the sensor, where the distortion does not change, it is
    // 1.
    let lens = Brown {
        k1: -3.44e-6,
        k2: 2.21e-9,
        k3: 5.76e-13,
        ..Brown::default()
    };
    let calibration = Calibration::new(cameras::square(lens, FmcAxis::default())).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let half = calibration.sensor().half_width_mm();
    let mut both_sides = [0; 2];
    for along in [-0.97_f32, -0.5, 0.93, 1.0] {
        // The ideal place of a point of the edge is tested, and places up to 10 µm off it.
        let edge = correction
            .correct(SensorPoint::new(along * half, half))
            .point;
        for step in -500_i16..=500 {
            let ideal = SensorPoint::new(edge.x_mm, edge.y_mm + 2e-5 * f32::from(step));
            let found = SourceRow::new(&correction).next(ideal).unwrap();
            let [dx, dy] = source_f64(&correction, [ideal.x_mm, ideal.y_mm].map(f64::from));
            let off_nm = [f64::from(found.dx_mm) - dx, f64::from(found.dy_mm) - dy]
                .map(|off_mm| 1e6 * off_mm.abs());
            // The bound is a fifth of the rounding of the measured coordinate, 3.8 nm, and of the
            // last residual, 2 nm.
            assert!(
                off_nm[0].max(off_nm[1]) <= 1.5,
                "{off_nm:?} nm at {ideal:?}"
            );
            both_sides[usize::from(ideal.y_mm + found.dy_mm > half)] += 1;
        }
    }
    assert!(
        both_sides.iter().all(|count| *count > 1000),
        "{both_sides:?}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_source_on_the_sensor_is_what_distort_finds(
        lens in cameras::lenses(),
        axis in cameras::axes(),
        motion in cameras::motions(),
        y in -1.0_f32..1.0,
        step_mm in 0.05_f32..5.0,
    ) {
        let calibration = Calibration::new(cameras::square(lens, axis)).unwrap();
        let focus = cameras::focus(&calibration, 0.01);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let half = calibration.sensor().half_width_mm();
        let mut row = SourceRow::new(&correction);
        let mut x_mm = -half;
        while x_mm < half {
            let ideal = SensorPoint::new(x_mm, y * half);
            let found = row.next(ideal).unwrap();
            let source = SensorPoint::new(ideal.x_mm + found.dx_mm, ideal.y_mm + found.dy_mm);
            match correction.distort(ideal) {
                Ok(corrected) => {
                    let off = [
                        source.x_mm - corrected.point.x_mm,
                        source.y_mm - corrected.point.y_mm,
                    ];
                    // The bound is two units in the last place at 40 mm.
                    prop_assert!(off[0].abs().max(off[1].abs()) <= 7.7e-6, "{off:?}");
                }
                // The point is off the sensor, or on its edge within rounding; on a strong lens
                // Newton's method may stop there.
                Err(error) => {
                    let is_off = source.x_mm.abs().max(source.y_mm.abs()) > half - 1e-5;
                    prop_assert!(is_off, "{source:?}: {error}");
                }
            }
            x_mm += step_mm;
        }
    }
}

#[test]
fn a_point_that_is_no_number_is_refused_and_so_is_a_vertex_off_the_image() {
    let calibration = Calibration::new(cameras::published()[0]).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let refused = SourceRow::new(&correction).next(SensorPoint::new(f32::NAN, 0.0));
    assert!(matches!(refused, Err(DistortError::NotConverged { .. })));
    let sensor = calibration.sensor();
    // The last vertex may lie one spacing beyond the last pixel, and no further.
    let row = VertexRow {
        first_col_px: sensor.width_px() - 1,
        row_px: sensor.height_px() + 15,
        spacing_px: 16,
        count: 3,
        origin_px: [0, 0],
    };
    let vertices: Vec<_> = row.vertices(&correction).collect();
    assert!(vertices[0].is_ok() && vertices[1].is_ok());
    let col_px = sensor.width_px() + 31;
    let row_px = row.row_px;
    assert_eq!(vertices[2], Err(MeshError::OffImage { col_px, row_px }));
}
