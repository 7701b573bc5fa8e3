//! Rows of pixel corrections: vertices off the image, other spacings, and how many are filled.

use crate::geometry::cameras;
use crate::geometry::pixel_correction::{corrections_of, first_point};
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};

/// Returns a frame and a row of three vertices of it, the last of them one spacing beyond the last
/// column.
fn at_the_end() -> (FrameCorrection, VertexRow) {
    let calibration = Calibration::new(cameras::published()[0]).unwrap();
    let correction = FrameCorrection::without_motion(&calibration);
    let sensor = *correction.sensor();
    let row = VertexRow {
        first_col_px: sensor.width_px() - 1 - 16,
        row_px: sensor.height_px() - 1 + 16,
        spacing_px: 16,
        count: 3,
        origin_px: [0, 0],
    };
    (correction, row)
}

#[test]
fn a_vertex_more_than_one_spacing_off_the_image_is_refused_by_name_and_nothing_is_filled() {
    let (correction, row) = at_the_end();
    let mesh = CorrectionMesh::new(&correction, 16);
    assert_eq!(corrections_of(&mesh, &row).len(), 3);
    let mut corrections = [PixelCorrection::default(); 5];
    let untouched = corrections;
    let refused = VertexRow { count: 5, ..row }
        .corrections(&mesh, &mut corrections)
        .unwrap_err();
    let [col_px, row_px] = [row.first_col_px + 3 * 16, row.row_px];
    assert_eq!(refused, MeshError::OffImage { col_px, row_px });
    assert!(refused.to_string().contains(&format!("column {col_px}")));
    let below = VertexRow {
        row_px: row_px + 1,
        ..row
    };
    let refused = below.corrections(&mesh, &mut corrections).unwrap_err();
    let off_image = MeshError::OffImage {
        col_px: row.first_col_px,
        row_px: row_px + 1,
    };
    assert_eq!(refused, off_image);
    for far in [u32::MAX, u32::MAX - 1, 1 << 24] {
        let row = VertexRow {
            first_col_px: far,
            ..row
        };
        assert!(row.corrections(&mesh, &mut corrections).is_err(), "{far}");
    }
    assert_eq!(corrections, untouched);
}

#[test]
fn a_mesh_of_another_spacing_is_refused() {
    let (correction, row) = at_the_end();
    let mesh = CorrectionMesh::new(&correction, 8);
    let refused = row.corrections(&mesh, &mut []).unwrap_err();
    let spacing = MeshError::Spacing {
        row_px: 16,
        mesh_px: 8,
    };
    assert_eq!(refused, spacing);
    assert_eq!(
        refused.to_string(),
        "the vertices are 16 px apart, and the mesh was prepared for 8 px"
    );
}

#[test]
fn as_many_vertices_are_filled_as_the_row_has_and_the_slice_has_room_for() {
    let (correction, row) = at_the_end();
    let mesh = CorrectionMesh::new(&correction, 16);
    let all = corrections_of(&mesh, &row);
    let mut room = [PixelCorrection::default(); 8];
    let filled = row.corrections(&mesh, &mut room).unwrap();
    assert_eq!(filled, all);
    let one = VertexRow { count: 1, ..row };
    assert_eq!(one.corrections(&mesh, &mut room).unwrap(), &all[..1]);
    let none = VertexRow { count: 0, ..row };
    assert!(none.corrections(&mesh, &mut room).unwrap().is_empty());
    // Vertices without room in the slice may lie off the image.
    let long = VertexRow {
        count: u16::MAX,
        ..row
    };
    assert_eq!(long.corrections(&mesh, &mut room[..3]).unwrap(), all);
    assert!(long.corrections(&mesh, &mut []).unwrap().is_empty());
}

#[test]
fn vertices_that_are_no_pixel_apart_are_all_the_first() {
    let (correction, _) = at_the_end();
    let row = VertexRow {
        first_col_px: 100,
        row_px: 100,
        spacing_px: 0,
        count: 3,
        origin_px: [0, 0],
    };
    let found = corrections_of(&CorrectionMesh::new(&correction, 0), &row);
    let point = first_point(correction.sensor(), &row);
    let expected_px = -correction.distortion(point).dx_mm / correction.sensor().pixel_mm();
    for vertex in &found {
        assert_eq!(vertex, &found[0]);
        assert!((vertex.cols_px - expected_px).abs() < 1e-3);
    }
}
