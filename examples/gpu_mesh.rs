//! Mesh with which a graphics processor draws a frame corrected: its vertices are pixels of the
//! recorded image, each drawn at its corrected place. `cargo run --example gpu_mesh`;
//! `host-sim mesh --format gpu` writes the files.

use std::{error::Error, fmt::Write as _};

use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::{Brown, CalibrationParameters, Camera, CameraParameters, Exposure};

const COLUMNS_PX: u16 = 14204;
const ROWS_PX: u16 = 10652;
/// Distance from one vertex to the next.
const SPACING_PX: u16 = 64;
/// Vertices of a row: the last one lies at the image's end or up to one spacing beyond.
const VERTICES: u16 = (COLUMNS_PX - 1).div_ceil(SPACING_PX) + 1;

/// Describes the mesh of an exposure: its size, its bounds, and the correction at four of its
/// vertices.
pub(crate) fn mesh() -> Result<String, Box<dyn Error>> {
    let mut lens = CalibrationParameters::new(51.3712, [COLUMNS_PX.into(), ROWS_PX.into()], 3.76);
    lens.distortion = Brown {
        k1: -1.6056e-5,
        k2: 6.18966e-9,
        k3: -1.31329e-12,
        ..Brown::default()
    };
    let frame =
        Camera::new(CameraParameters::new(lens))?.frame(&Exposure::new(0.17, 1.0 / 200.0))?;
    let mesh = CorrectionMesh::new(&frame.correction, SPACING_PX);

    let mut text = String::new();
    let mut largest_px = 0.0_f32;
    let mut vertices = 0;
    let mut corrections = [PixelCorrection::default(); VERTICES as usize];
    for row_px in (0..ROWS_PX - 1 + SPACING_PX).step_by(SPACING_PX.into()) {
        let row = VertexRow {
            first_col_px: 0,
            row_px: row_px.into(),
            spacing_px: SPACING_PX,
            count: VERTICES,
            origin_px: [0, 0],
        };
        // Each row in turn is written to the buffer that the graphics processor reads.
        let filled = row.corrections(&mesh, &mut corrections)?;
        vertices += filled.len();
        for (index, correction) in filled.iter().enumerate() {
            largest_px = largest_px.max(libm::hypotf(correction.cols_px, correction.rows_px));
            if row_px % 5120 == 0 && index % 111 == 0 && index > 0 {
                let col_px = index * usize::from(SPACING_PX);
                let PixelCorrection { cols_px, rows_px } = correction;
                writeln!(
                    text,
                    "({col_px}, {row_px}) px goes {cols_px:.3} columns, {rows_px:.3} rows"
                )?;
            }
        }
    }
    writeln!(
        text,
        "{vertices} vertices, the longest way {largest_px:.1} px"
    )?;
    writeln!(
        text,
        "at a vertex right to {:.5} px, between vertices to {:.4} px",
        mesh.rounding_bound_px(largest_px),
        mesh.interpolation_bound_px()
    )?;
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", mesh()?);
    Ok(())
}
