//! Mesh rows for warp engines and graphics processors.

use core::hint::black_box;

use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::mesh::displacement_rows::{DisplacementRows, RESTART_INTERVAL};
use fmc_camera::geometry::mesh::format::{MAX_WORD_BYTES, MeshFormat};
use fmc_camera::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::{Camera, FrameCorrection};

use crate::counter::Counter;
use crate::specimen::{EXPOSURE, POINTS, full, short, wide};

/// Repetitions of work that is done once per frame or row.
const FRAMES: u32 = 100;
#[expect(clippy::cast_possible_truncation, reason = "1024 points")]
const PER_POINT: (u32, &str) = (POINTS as u32, "point");

/// Spacing of every eighth pixel of 3.76 µm: 30.8 mm of the sensor.
const MESH_STEP_MM: f32 = 8.0 * 0.00376;
/// Row of the vertices of meshes.
const ROW: VertexRow = VertexRow {
    first_col_px: 8,
    row_px: 800,
    spacing_px: 8,
    count: 1024,
    origin_px: [0, 0],
};
const ROW_START: SensorPoint = SensorPoint::new(-26.0, 15.0);

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    mesh_rows(counter)?;
    mesh_rows_of_other_spacings(counter)?;
    let correction = Camera::new(short()).ok()?.frame(&EXPOSURE).ok()?.correction;
    source_rows(counter, &correction)?;
    pixel_corrections(counter)
}

/// Counts displacements along rows of the measured image: without K3, with it, and with all terms.
fn mesh_rows(counter: &mut Counter) -> Option<()> {
    let mut without_k3 = short();
    without_k3.calibration.distortion.k3 = 0.0;
    for (kernel, parameters) in [
        ("mesh_row", without_k3),
        ("mesh_row_k3", short()),
        ("mesh_row_k3_full", full()),
    ] {
        let correction = Camera::new(parameters)
            .ok()?
            .frame(&EXPOSURE)
            .ok()?
            .correction;
        let rows = DisplacementRows::new(&correction, MESH_STEP_MM);
        // The differences restart as rarely as they ever do.
        (rows.restart_interval() == RESTART_INTERVAL.get()).then_some(())?;
        let mut row = [Displacement::default(); POINTS];
        counter.count(kernel, PER_POINT, || {
            black_box(&rows)
                .row(black_box(ROW_START))
                .write(black_box(&mut row));
            Some(())
        })?;
        black_box(row);
    }
    let correction = Camera::new(full()).ok()?.frame(&EXPOSURE).ok()?.correction;
    counter.count("mesh_row_setup", (FRAMES, "row"), || {
        let rows = DisplacementRows::new(&correction, MESH_STEP_MM);
        for _ in 0..FRAMES {
            black_box(black_box(&rows).row(black_box(ROW_START)));
        }
        Some(())
    })?;
    counter.count("mesh_rows_setup", (FRAMES, "frame"), || {
        for _ in 0..FRAMES {
            black_box(DisplacementRows::new(black_box(&correction), MESH_STEP_MM));
        }
        Some(())
    })
}

/// Counts displacements with K3 along rows of the whole sensor, with the work that is done once per
/// row: the wider the spacing, the fewer points share it.
fn mesh_rows_of_other_spacings(counter: &mut Counter) -> Option<()> {
    for (kernel, parameters, spacing_px) in [
        ("mesh_row_k3_16px", short(), 16_u16),
        ("mesh_row_k3_32px", short(), 32),
        ("mesh_row_k3_64px", short(), 64),
        ("mesh_row_k3_128px", short(), 128),
        ("mesh_row_k3_64px_104mm", wide(), 64),
        ("mesh_row_k3_128px_104mm", wide(), 128),
    ] {
        let correction = Camera::new(parameters)
            .ok()?
            .frame(&EXPOSURE)
            .ok()?
            .correction;
        let sensor = *correction.sensor();
        let count = sensor.width_px() / u32::from(spacing_px) + 1;
        let rows = DisplacementRows::new(&correction, f32::from(spacing_px) * sensor.pixel_mm());
        let first = SensorPoint::new(-sensor.half_width_mm(), ROW_START.y_mm);
        let mut row = [Displacement::default(); POINTS];
        let row = row.get_mut(..usize::try_from(count).ok()?)?;
        counter.count(kernel, (count, "point"), || {
            black_box(&rows)
                .row(black_box(first))
                .write(black_box(&mut *row));
            Some(())
        })?;
        black_box(row);
    }
    Some(())
}

/// Counts sources along a row of the ideal image, in mm and as a warp engine stores them.
fn source_rows(counter: &mut Counter, correction: &FrameCorrection) -> Option<()> {
    counter.count("mesh_sources_setup", (FRAMES, "frame"), || {
        for _ in 0..FRAMES {
            black_box(SourceMesh::new(black_box(correction), 8));
        }
        Some(())
    })?;
    let mesh = SourceMesh::new(correction, 8);
    // Blocks are as long as they ever are.
    (mesh.block_length() == Some(64)).then_some(())?;
    let mut sources = [Displacement::default(); POINTS];
    counter.count("mesh_source_row", PER_POINT, || {
        black_box(&ROW)
            .sources(black_box(&mesh), black_box(&mut sources))
            .ok()?;
        Some(())
    })?;
    black_box(sources);
    for (kernel, format) in [
        ("mesh_words_s16q3", MeshFormat::S16Q3),
        ("mesh_words_single", MeshFormat::Single),
    ] {
        let mut bytes = [0; POINTS * MAX_WORD_BYTES];
        counter.count(kernel, PER_POINT, || {
            black_box(&ROW)
                .write_words(black_box(&mesh), format, black_box(&mut bytes))
                .ok()?;
            Some(())
        })?;
        black_box(bytes);
    }
    Some(())
}

/// Counts vertices of the recorded image as a graphics processor draws them: without K3, and with
/// it.
fn pixel_corrections(counter: &mut Counter) -> Option<()> {
    let mut without_k3 = short();
    without_k3.calibration.distortion.k3 = 0.0;
    for (kernel, parameters) in [
        ("mesh_corrections", without_k3),
        ("mesh_corrections_k3", short()),
    ] {
        let correction = Camera::new(parameters)
            .ok()?
            .frame(&EXPOSURE)
            .ok()?
            .correction;
        let mesh = CorrectionMesh::new(&correction, 8);
        let mut corrections = [PixelCorrection::default(); POINTS];
        counter.count(kernel, PER_POINT, || {
            let row = black_box(&ROW);
            row.corrections(black_box(&mesh), black_box(&mut corrections))
                .ok()?;
            Some(())
        })?;
        black_box(corrections);
    }
    Some(())
}
