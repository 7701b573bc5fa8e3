//! Vertices as warp engines store them, read back as their documents define them.

use crate::geometry::cameras;
use crate::geometry::mesh::{corrections, half_a_millimetre, wide};
use crate::geometry::source_row::source_f64;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::mesh::format::{MeshFormat, OutOfFormat, PixelAxis, Vertex};
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};

/// Returns source minus output pixel, columns and rows, of a vertex as stored.
fn displacement_px(format: MeshFormat, word: &[u8], [col, row]: [f64; 2]) -> [f64; 2] {
    let half = |at: usize| [word[at], word[at + 1]];
    let whole = |at: usize| [word[at], word[at + 1], word[at + 2], word[at + 3]];
    match format {
        MeshFormat::S16Q3 => [0, 2].map(|at| f64::from(i16::from_le_bytes(half(at))) / 8.0),
        MeshFormat::Uq12Q4 => {
            // The word has 32 bits, columns in its low half.
            let word = u32::from_le_bytes(whole(0));
            let [x, y] = [word & 0xffff, word >> 16].map(|q| f64::from(q) / 16.0);
            [x - col, y - row]
        }
        MeshFormat::Q12Q20 => {
            let [x, y] = [0, 4].map(|at| f64::from(i32::from_le_bytes(whole(at))) / 1_048_576.0);
            [x - col, y - row]
        }
        MeshFormat::Single => {
            let [x, y] = [0, 4].map(|at| f64::from(f32::from_le_bytes(whole(at))));
            [x - col, y - row]
        }
    }
}

#[test]
fn every_format_gives_the_exact_source_within_its_quantisation() {
    // Error of the sources themselves, 0.3 nm of pixels of at least 3.76 µm, and of the place of
    // the pixel.
    const BEFORE_PX: f64 = 2e-4;
    for record in cameras::published()
        .into_iter()
        .chain(half_a_millimetre().map(wide))
    {
        let calibration = Calibration::new(record).unwrap();
        let sensor = *calibration.sensor();
        let pixel_mm = f64::from(record.pixel_um) / 1000.0;
        let middle = [record.width_px, record.height_px].map(|side| f64::from(side - 1) / 2.0);
        for correction in corrections(&calibration) {
            for format in MeshFormat::ALL {
                // Every format holds this part of the image, near the corner.
                let origin_px = [sensor.width_px() - 1600, sensor.height_px() - 1400];
                let row = VertexRow {
                    first_col_px: origin_px[0] + 200,
                    row_px: origin_px[1] + 992,
                    spacing_px: 16,
                    count: 60,
                    origin_px,
                };
                let limit_px = BEFORE_PX + f64::from(format.quantisation_px(1800.0));
                for (index, word) in (0_u32..).zip(row.words(&correction, format)) {
                    let word = word.unwrap();
                    assert_eq!(word.len(), format.bytes());
                    let pixel = [row.first_col_px + 16 * index, row.row_px].map(f64::from);
                    let ideal = [
                        (pixel[0] - middle[0]) * pixel_mm,
                        (middle[1] - pixel[1]) * pixel_mm,
                    ];
                    let [dx, dy] = source_f64(&correction, ideal);
                    let expected = [dx / pixel_mm, -dy / pixel_mm];
                    let place = [
                        pixel[0] - f64::from(origin_px[0]),
                        pixel[1] - f64::from(origin_px[1]),
                    ];
                    let found = displacement_px(format, &word, place);
                    for axis in 0..2 {
                        let error_px = found[axis] - expected[axis];
                        assert!(error_px.abs() <= limit_px, "{format:?}: {error_px} px");
                    }
                }
            }
        }
    }
}

fn vertex(col_px: i32, source_cols_px: f32) -> Vertex {
    Vertex {
        col_px,
        row_px: 5,
        source_cols_px,
        source_rows_px: 0.0,
    }
}

#[test]
fn the_last_number_that_fits_fits_and_the_next_is_refused_by_name() {
    // Column and displacement of the last vertex that fits at either end, and a step beyond.
    let ends = [
        (MeshFormat::S16Q3, (0, 4095.875), 0.125),
        (MeshFormat::S16Q3, (0, -4096.0), -0.125),
        (MeshFormat::Uq12Q4, (4090, 5.9375), 0.0625),
        (MeshFormat::Uq12Q4, (3, -3.0), -0.0625),
        (MeshFormat::Q12Q20, (2047, 0.5), 0.5),
        (MeshFormat::Q12Q20, (-2048, 0.0), -1.0 / 1_048_576.0),
    ];
    for (format, (col_px, last), step) in ends {
        assert!(format.word(&vertex(col_px, last)).is_ok(), "{format:?}");
        let refused = format.word(&vertex(col_px, last + step)).unwrap_err();
        let OutOfFormat {
            axis,
            min_px,
            max_px,
            ..
        } = refused;
        assert_eq!(axis, PixelAxis::Columns);
        let text = refused.to_string();
        for part in [
            format!("column {col_px}, row 5"),
            format!("{min_px} to {max_px} px"),
        ] {
            assert!(text.contains(&part), "{text}");
        }
    }
}

#[test]
fn a_number_beyond_thirty_two_bits_is_refused_where_its_sum_would_fit() {
    // 32 bits in steps of 2⁻²⁰ hold 2000 px but not 3000 px.
    assert!(MeshFormat::Q12Q20.word(&vertex(-1000, 3000.0)).is_err());
    for format in MeshFormat::ALL {
        assert!(format.word(&vertex(0, f32::NAN)).is_err(), "{format:?}");
        assert!(
            format.word(&vertex(0, f32::INFINITY)).is_err(),
            "{format:?}"
        );
    }
}

#[test]
fn a_source_before_the_origin_does_not_fit_the_unsigned_format() {
    let [.., all] = half_a_millimetre();
    let calibration = Calibration::new(wide(all)).unwrap();
    let [correction, ..] = corrections(&calibration)[..] else {
        panic!("there are corrections");
    };
    let row = VertexRow {
        first_col_px: 0,
        row_px: 0,
        spacing_px: 16,
        count: 1,
        origin_px: [0, 0],
    };
    // With 0.5 mm of positive distortion the source of the first pixel is 50 pixels off the image.
    let error = row.words(&correction, MeshFormat::Uq12Q4).next().unwrap();
    let Err(MeshError::Format(refused)) = error else {
        panic!("{error:?}");
    };
    assert!(refused.value_px < -40.0 && refused.value_px > -60.0);
}
