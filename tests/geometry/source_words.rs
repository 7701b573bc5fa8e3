//! Words of warp engines by differences: those of the sources, and of `distort`.

use crate::geometry::cameras;
use crate::geometry::source_mesh::{sources, whole_row};
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::format::{MeshFormat, OutOfFormat, Vertex};
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera::geometry::sensor::{FmcAxis, PixelPoint};
use proptest::prelude::*;

#[test]
fn words_are_those_of_distort_to_one_step() {
    let (mut words, mut others) = (0, 0);
    for record in cameras::published() {
        let calibration = Calibration::new(record).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let sensor = *correction.sensor();
        let mesh = SourceMesh::new(&correction, 8);
        for row_px in (0..sensor.height_px()).step_by(1000) {
            let row = whole_row(&correction, row_px, 8);
            let mut bytes = vec![0; 4 * usize::from(row.count)];
            let bytes = row
                .write_words(&mesh, MeshFormat::S16Q3, &mut bytes)
                .unwrap();
            for (index, word) in (0_u16..).zip(bytes.as_chunks::<4>().0) {
                let pixel = PixelPoint {
                    col_px: f32::from(8 * index),
                    row_px: f32::from(u16::try_from(row_px).unwrap()),
                };
                let Ok(distorted) = correction.distort(sensor.sensor_from_pixel(pixel)) else {
                    continue;
                };
                let Displacement { dx_mm, dy_mm } = distorted.distortion;
                let [x0, x1, y0, y1] = *word;
                for (found, mm) in [([x0, x1], dx_mm), ([y0, y1], -dy_mm)] {
                    let exact = 8.0 * f64::from(mm) / f64::from(sensor.pixel_mm());
                    let off = f64::from(i16::from_le_bytes(found)) - exact.round();
                    assert!(off.abs() <= 1.0, "{off} steps");
                    words += 1;
                    others += i32::from(off.abs() > 0.0);
                }
            }
        }
    }
    assert!(
        words > 100_000 && others < words / 1000,
        "{others} of {words}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn words_of_a_block_are_those_of_its_sources(
        lens in cameras::lenses(),
        spacing_px in 1_u16..40,
        row_px in 0_u32..9216,
        origin in [0_u32..9216, 0_u32..9216],
        format in prop::sample::select(MeshFormat::ALL.to_vec()),
    ) {
        let weaker = Brown { k0: 1e-4, k1: 0.1 * lens.k1, k2: 0.0, k3: 0.0, ..lens };
        let calibration = Calibration::new(cameras::square(weaker, FmcAxis::PlusX)).unwrap();
        let correction = FrameCorrection::without_motion(&calibration);
        let mesh = SourceMesh::new(&correction, spacing_px);
        prop_assume!(mesh.block_length().is_some());
        let row = VertexRow { origin_px: origin, ..whole_row(&correction, row_px, spacing_px) };
        let pixel_mm = correction.sensor().pixel_mm();
        let place = |place: u32, origin: u32| i32::try_from(place).unwrap() - i32::try_from(origin).unwrap();
        let expected: Vec<_> = sources(&row, &mesh).iter().zip(0_u32..).map(|(d, index)| {
            format.word(&Vertex {
                col_px: place(u32::from(spacing_px) * index, origin[0]),
                row_px: place(row_px, origin[1]),
                source_cols_px: d.dx_mm / pixel_mm,
                source_rows_px: -d.dy_mm / pixel_mm,
            })
        }).collect();
        let mut bytes = vec![0; format.bytes() * usize::from(row.count)];
        let refused = match row.write_words(&mesh, format, &mut bytes) {
            Ok(_) => None,
            Err(MeshError::Format(error)) => Some([error.col_px, error.row_px]),
            Err(error) => panic!("{error}"),
        };
        let first_refused = expected.iter().find_map(|word| word.as_ref().err());
        let written = expected.iter().take_while(|word| word.is_ok()).count();
        prop_assert_eq!(refused, first_refused.map(|error| [error.col_px, error.row_px]));
        // Steps of a format from the sums in steps and from those in mm differ by rounding.
        let most = if format == MeshFormat::Q12Q20 { 64 } else { 1 };
        for (found, expected) in bytes.chunks(format.bytes()).zip(&expected).take(written) {
            let expected = expected.as_ref().unwrap();
            for (found, expected) in steps(format, found).into_iter().zip(steps(format, expected)) {
                prop_assert!((found - expected).abs() <= most, "{found} {expected}");
            }
        }
    }
}

/// Returns both numbers of a word as whole numbers that rise with them.
fn steps(format: MeshFormat, word: &[u8]) -> [i64; 2] {
    let half = |at: usize| [word[at], word[at + 1]];
    let whole = |at: usize| [word[at], word[at + 1], word[at + 2], word[at + 3]];
    match format {
        MeshFormat::S16Q3 => [0, 2].map(|at| i64::from(i16::from_le_bytes(half(at)))),
        MeshFormat::Uq12Q4 => [0, 2].map(|at| i64::from(u16::from_le_bytes(half(at)))),
        MeshFormat::Q12Q20 => [0, 4].map(|at| i64::from(i32::from_le_bytes(whole(at)))),
        // 2⁻¹⁰ px.
        MeshFormat::Single => [0, 4].map(|at| {
            let scaled = 1024.0 * f32::from_le_bytes(whole(at));
            #[expect(clippy::cast_possible_truncation, reason = "fewer than 2⁴⁰")]
            (scaled.round() as i64)
        }),
    }
}

#[test]
fn errors_are_those_of_the_vertices_one_by_one() {
    let calibration = Calibration::new(cameras::published()[0]).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let mesh = SourceMesh::new(&correction, 16);
    let whole = whole_row(&correction, 5000, 16);
    let too_far = VertexRow {
        count: whole.count + 1,
        ..whole
    };
    let below = VertexRow {
        row_px: correction.sensor().height_px() + 16,
        ..whole
    };
    let dw100 = VertexRow {
        origin_px: [1000, 4000],
        ..whole
    };
    for (row, format) in [
        (too_far, MeshFormat::S16Q3),
        (below, MeshFormat::Single),
        (dw100, MeshFormat::Uq12Q4),
        (
            VertexRow {
                first_col_px: 2000,
                ..dw100
            },
            MeshFormat::Uq12Q4,
        ),
    ] {
        let expected = row.words(&correction, format).find_map(Result::err);
        let mut bytes = vec![0; format.bytes() * usize::from(row.count)];
        let found = row.write_words(&mesh, format, &mut bytes).err();
        match (found.unwrap(), expected.unwrap()) {
            (MeshError::Format(found), MeshError::Format(expected)) => {
                assert!((found.value_px - expected.value_px).abs() < 1e-3);
                let value_px = expected.value_px;
                assert_eq!(OutOfFormat { value_px, ..found }, expected);
            }
            (found, expected) => assert_eq!(found, expected),
        }
    }
    let other = SourceMesh::new(&correction, 8);
    assert_eq!(
        whole.sources(&other, &mut []).err(),
        Some(MeshError::Spacing {
            row_px: 16,
            mesh_px: 8
        })
    );
    let nothing = VertexRow {
        spacing_px: 0,
        ..whole
    };
    let mesh = SourceMesh::new(&correction, 0);
    assert_eq!(mesh.block_length(), None);
    let mut one = [Displacement::default(); 3];
    assert_eq!(nothing.sources(&mesh, &mut one).unwrap().len(), 3);
}
