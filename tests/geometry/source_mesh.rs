//! Sources by differences against the exact inverse and `distort`, within their stated bound.

use crate::geometry::cameras;
use crate::geometry::mesh::frames;
use crate::geometry::source_row::source_f64;
use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::source_mesh::{SOURCE_BLOCK_NM, SourceMesh};
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::{FmcAxis, PixelPoint};
use fmc_camera::{Camera, CameraParameters, Exposure};
use proptest::prelude::*;

/// Largest error measured on the cameras below, nm.
const MEASURED_NM: f64 = 0.7;
/// Largest difference from `distort` on them, nm.
const FROM_DISTORT_NM: f64 = 1.2;

/// Distances from vertex to vertex, as warp engines and `cv::remap` use them.
const SPACINGS_PX: [u16; 7] = [1, 2, 8, 16, 32, 64, 128];

/// Returns the row of vertices of the whole image at a row of it.
pub(crate) fn whole_row(correction: &FrameCorrection, row_px: u32, spacing_px: u16) -> VertexRow {
    let width_px = correction.sensor().width_px();
    VertexRow {
        first_col_px: 0,
        row_px,
        spacing_px,
        count: u16::try_from(width_px.div_ceil(u32::from(spacing_px)) + 1).unwrap(),
        origin_px: [0, 0],
    }
}

/// Returns the sources of a row.
pub(crate) fn sources(row: &VertexRow, mesh: &SourceMesh<'_>) -> Vec<Displacement> {
    let mut sources = vec![Displacement::default(); usize::from(row.count)];
    assert_eq!(
        row.sources(mesh, &mut sources).unwrap().len(),
        usize::from(row.count)
    );
    sources
}

/// Largest errors of one row, nm: against the exact inverse, and against `distort`.
fn row_error_nm(correction: &FrameCorrection, row: &VertexRow, mesh: &SourceMesh<'_>) -> [f64; 2] {
    let sensor = correction.sensor();
    let pixel_mm = (f64::from(sensor.pixel_mm()) * 1e7).round() / 1e7;
    let middle = [sensor.width_px(), sensor.height_px()].map(|side| f64::from(side - 1) / 2.0);
    let off = |found: Displacement, [dx, dy]: [f64; 2]| {
        let off_x = (f64::from(found.dx_mm) - dx).abs();
        1e6 * off_x.max((f64::from(found.dy_mm) - dy).abs())
    };
    let mut largest = [0.0_f64; 2];
    // A prime number of vertices apart: all places within blocks are met.
    for (index, found) in sources(row, mesh).iter().enumerate().step_by(7) {
        let col_px = row.first_col_px + u32::from(row.spacing_px) * u32::try_from(index).unwrap();
        let exact = [
            (f64::from(col_px) - middle[0]) * pixel_mm,
            (middle[1] - f64::from(row.row_px)) * pixel_mm,
        ];
        largest[0] = largest[0].max(off(*found, source_f64(correction, exact)));
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2²⁴")]
        let pixel = PixelPoint {
            col_px: col_px as f32,
            row_px: row.row_px as f32,
        };
        if let Ok(distorted) = correction.distort(sensor.sensor_from_pixel(pixel)) {
            let Displacement { dx_mm, dy_mm } = distorted.distortion;
            largest[1] = largest[1].max(off(*found, [dx_mm, dy_mm].map(f64::from)));
        }
    }
    largest
}

/// Returns the largest errors over rows of the whole image.
fn largest_error_nm(
    correction: &FrameCorrection,
    mesh: &SourceMesh<'_>,
    spacing_px: u16,
) -> [f64; 2] {
    let last = correction.sensor().height_px() - 1;
    (0..=6)
        .map(|index| {
            row_error_nm(
                correction,
                &whole_row(correction, index * last / 6, spacing_px),
                mesh,
            )
        })
        .fold([0.0, 0.0], |[a, b], [c, d]| [a.max(c), b.max(d)])
}

/// Checks a frame at one spacing.
fn check(name: &str, correction: &FrameCorrection, spacing_px: u16) {
    let mesh = SourceMesh::new(correction, spacing_px);
    let [error_nm, from_distort_nm] = largest_error_nm(correction, &mesh, spacing_px);
    assert!(
        error_nm <= MEASURED_NM,
        "{name}, {spacing_px} px: {error_nm} nm"
    );
    assert!(
        from_distort_nm <= FROM_DISTORT_NM,
        "{name}, {spacing_px} px: {from_distort_nm} nm"
    );
    if let Some(bound_nm) = mesh.bound_nm() {
        assert!(
            error_nm <= f64::from(bound_nm),
            "{error_nm} > {bound_nm} nm"
        );
        assert!(bound_nm <= SOURCE_BLOCK_NM, "{bound_nm} nm");
    }
}

#[test]
fn sources_of_every_camera_are_within_their_bound_and_as_near_to_distort_as_required() {
    for (name, correction) in frames() {
        for spacing_px in SPACINGS_PX {
            check(name, &correction, spacing_px);
        }
    }
}

#[test]
fn sources_of_either_run_up_are_as_near_at_the_ends_of_the_flight_envelope() {
    for (calibration, run_up, vh_per_s, exposure_s) in published_exposures() {
        let mut parameters = CameraParameters::new(calibration);
        parameters.mechanism = Mechanism::Stage {
            acceleration_mm_s2: 1000.0,
            settling_ms: 5.0,
            run_up,
            jerk_mm_s3: None,
            max_speed_mm_s: None,
        };
        // The stroke holds a run-up from rest at the largest speed, 26 mm/s.
        parameters.calibration.stroke_mm = 8.0;
        let camera = Camera::new(parameters).unwrap();
        let frame = camera.frame(&Exposure::new(vh_per_s, exposure_s)).unwrap();
        check("run-up", &frame.correction, 8);
    }
}

/// Returns published cameras, either run-up, and the ends of V/H and exposure.
fn published_exposures() -> Vec<(CalibrationParameters, RunUp, f32, f32)> {
    let mut all = Vec::new();
    for calibration in cameras::published() {
        for run_up in [RunUp::Centred, RunUp::FromRest] {
            for (vh_per_s, exposure_s) in [(0.05, 1.0 / 700.0), (0.17, 1.0 / 100.0)] {
                all.push((calibration, run_up, vh_per_s, exposure_s));
            }
        }
    }
    all
}

#[test]
fn blocks_are_as_long_as_the_bound_allows() {
    let least = |name: &str, spacing_px: u16| match (name, spacing_px) {
        (_, 1..=8) => Some(40),
        ("wide", 16) => Some(32),
        (_, 16) => Some(64),
        (_, 32) => Some(24),
        (_, 64) => Some(16),
        _ => None,
    };
    for (name, correction) in frames() {
        for spacing_px in SPACINGS_PX {
            let length = SourceMesh::new(&correction, spacing_px).block_length();
            assert!(
                length >= least(name, spacing_px),
                "{name}, {spacing_px}: {length:?}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn sources_of_any_lens_are_within_their_stated_bound(
        lens in cameras::lenses(),
        strength in 0.01_f32..1.0,
        axis in cameras::axes(),
        motion in cameras::motions(),
        spacing_px in 1_u16..80,
        [up, phase] in [0.0_f32..1.0, 0.0_f32..1.0],
    ) {
        let weaker = Brown {
            k0: strength * lens.k0,
            k1: strength * lens.k1,
            k2: strength * lens.k2,
            k3: strength * lens.k3,
            ..lens
        };
        let calibration = Calibration::new(cameras::square(weaker, axis)).unwrap();
        let focus = cameras::focus(&calibration, 0.01);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let mesh = SourceMesh::new(&correction, spacing_px);
        let row = VertexRow {
            first_col_px: share(phase, u32::from(spacing_px)),
            count: 9216 / spacing_px,
            ..whole_row(&correction, share(up, 9216), spacing_px)
        };
        // Off the sensor, where every vertex is solved by itself, a step over the edge counts.
        let bound_nm = mesh.bound_nm().map_or(SINGLE_NM, |bound_nm| f64::from(bound_nm).max(SINGLE_NM));
        let [error_nm, _] = row_error_nm(&correction, &row, &mesh);
        prop_assert!(error_nm <= bound_nm, "{error_nm} > {bound_nm} nm, {:?}", mesh.block_length());
    }

    #[test]
    fn a_vertex_has_the_same_bits_however_its_row_is_cut(
        lens in cameras::lenses(),
        strength in 0.01_f32..0.2,
        spacing_px in 1_u16..60,
        row_px in 0_u32..9216,
        [from, to] in [0.0_f32..1.0, 0.0_f32..1.0],
    ) {
        let weaker = Brown { k1: strength * lens.k1, k2: 0.0, k3: 0.0, ..lens };
        let calibration = Calibration::new(cameras::square(weaker, FmcAxis::PlusX)).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let mesh = SourceMesh::new(&correction, spacing_px);
        prop_assume!(mesh.block_length().is_some());
        let row = whole_row(&correction, row_px, spacing_px);
        let whole = sources(&row, &mesh);
        let last = u32::from(row.count) - 1;
        let (from, to) = (share(from, last), share(to, last));
        let (from, to) = (from.min(to), from.max(to));
        let cut = VertexRow {
            first_col_px: from * u32::from(spacing_px),
            count: u16::try_from(to - from + 1).unwrap(),
            ..row
        };
        let expected = whole.iter().skip(usize::try_from(from).unwrap());
        for (found, expected) in sources(&cut, &mesh).iter().zip(expected) {
            let bits = |d: &Displacement| [d.dx_mm.to_bits(), d.dy_mm.to_bits()];
            prop_assert_eq!(bits(found), bits(expected));
        }
    }

    #[test]
    fn blocks_side_by_side_have_the_bits_of_one_after_the_other(
        lens in cameras::lenses(),
        strength in 0.01_f32..1.0,
        axis in cameras::axes(),
        motion in cameras::motions(),
        spacing_px in 1_u16..16,
        row_px in 0_u32..9216,
    ) {
        let weaker = Brown {
            k1: strength * lens.k1,
            k2: strength * lens.k2,
            k3: strength * lens.k3,
            ..lens
        };
        let calibration = Calibration::new(cameras::square(weaker, axis)).unwrap();
        let focus = cameras::focus(&calibration, 0.01);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let mesh = SourceMesh::new(&correction, spacing_px);
        prop_assume!(mesh.block_length().is_some());
        let row = whole_row(&correction, row_px, spacing_px);
        let whole = write(&row, &mesh, MeshFormat::Single);
        let spacing = u32::from(spacing_px);
        // Too short for a second block.
        let count = mesh.block_length().unwrap();
        let pieces = (0..row.count).step_by(usize::from(count)).flat_map(|first| {
            let piece = VertexRow {
                first_col_px: u32::from(first) * spacing,
                count: count.min(row.count - first),
                ..row
            };
            write(&piece, &mesh, MeshFormat::Single)
        });
        prop_assert!(pieces.eq(whole));
    }
}

/// Returns the bytes of a row.
fn write(row: &VertexRow, mesh: &SourceMesh<'_>, format: MeshFormat) -> Vec<u8> {
    let mut bytes = vec![0; usize::from(row.count) * format.bytes()];
    let written = row.write_words(mesh, format, &mut bytes).unwrap().len();
    assert_eq!(written, bytes.len());
    bytes
}

/// Largest error of a vertex that is solved by itself across an edge of the sensor, nm.
const SINGLE_NM: f64 = 1.5;

/// Returns a share of a number, rounded down.
fn share(share: f32, of: u32) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a few thousand"
    )]
    ((share * of as f32) as u32)
}

#[test]
fn vertices_of_a_strong_lens_are_those_that_are_solved_one_after_the_other() {
    let lens = Brown {
        k1: 9e-5,
        ..Brown::NONE
    };
    let mut parameters = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    parameters.distortion = lens;
    let calibration = Calibration::new(parameters).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let mesh = SourceMesh::new(&correction, 16);
    assert_eq!((mesh.block_length(), mesh.bound_nm()), (None, None));
    for row_px in [0, 40, 2999, 6015] {
        let row = whole_row(&correction, row_px, 16);
        for format in [MeshFormat::S16Q3, MeshFormat::Single] {
            let expected: Vec<u8> = row
                .words(&correction, format)
                .flat_map(Result::unwrap)
                .collect();
            let mut bytes = vec![0; expected.len()];
            assert_eq!(
                row.write_words(&mesh, format, &mut bytes).unwrap(),
                expected
            );
        }
    }
}

#[test]
fn sources_that_leave_the_sensor_go_on_as_those_of_its_edge() {
    // Pincushion distortion: a margin of up to 65 px has its sources off the sensor.
    let lens = Brown {
        k1: 3e-6,
        ..Brown::NONE
    };
    let calibration = Calibration::new(cameras::square(lens, FmcAxis::PlusY)).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let half_mm = correction.sensor().half_width_mm();
    for spacing_px in [1, 8, 32] {
        let mesh = SourceMesh::new(&correction, spacing_px);
        assert!(mesh.block_length().is_some());
        let mut off = 0;
        for row_px in [0, 20, 45, 60, 100, 4000, 9200] {
            let row = whole_row(&correction, row_px, spacing_px);
            let [error_nm, _] = row_error_nm(&correction, &row, &mesh);
            assert!(error_nm <= SINGLE_NM, "{error_nm} nm");
            let last = sources(&row, &mesh).pop().unwrap();
            off += usize::from(last.dx_mm > 0.03 && half_mm > 40.0);
        }
        assert_eq!(off, 7);
    }
}

/// All of them in one place, since no image is as wide as that many spacings.
#[test]
fn row_of_as_many_vertices_as_can_be_counted_has_all_of_them() {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion.k1 = -1e-6;
    let correction = FrameCorrection::without_motion(&Calibration::new(lens).unwrap());
    let row = VertexRow {
        first_col_px: 2000,
        row_px: 3000,
        spacing_px: 0,
        count: u16::MAX,
        origin_px: [0, 0],
    };
    let found = sources(&row, &SourceMesh::new(&correction, row.spacing_px));
    // 20 mm to the left of the centre K1·r³ is 8 µm to the right.
    let is_right = |one: &Displacement| (one.dx_mm - 0.008).abs() < 1e-4;
    assert!(found.iter().all(is_right), "{:?}", found.last());
}
