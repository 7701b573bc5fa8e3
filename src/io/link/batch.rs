//! Points, rows and meshes of a frame, as many as a message carries.

use heapless::Vec;

use super::MAX_POINTS;
use super::message::{MeshBytes, Points, Refusal};
use super::point_correction::PointCorrection;
use crate::geometry::frame_correction::{Corrected, FrameCorrection};
use crate::geometry::mesh::format::MeshFormat;
use crate::geometry::mesh::pixel_correction::{CorrectionMesh, PixelCorrection};
use crate::geometry::mesh::source_mesh::SourceMesh;
use crate::geometry::mesh::vertex::VertexRow;
use crate::geometry::sensor::SensorPoint;

pub(super) fn distort(
    correction: &PointCorrection<'_>,
    ideal: &Points,
) -> Result<Vec<Corrected, MAX_POINTS>, Refusal> {
    let mut measured = Vec::new();
    for (index, point) in (0..).zip(ideal) {
        let point = correction
            .distort(*point)
            .map_err(|error| Refusal::Distort { index, error })?;
        // There is room: the answer has as many points as the request.
        let _ = measured.push(point);
    }
    Ok(measured)
}

pub(super) fn mesh(
    correction: &PointCorrection<'_>,
    row: &VertexRow,
    format: MeshFormat,
) -> Result<MeshBytes, Refusal> {
    if usize::from(row.count) > MAX_POINTS {
        return Err(Refusal::TooMany);
    }
    // There is room for the longest words of a full row.
    let mut bytes = MeshBytes::new();
    bytes
        .resize_default(usize::from(row.count) * format.bytes())
        .map_err(|_| Refusal::TooMany)?;
    match correction {
        PointCorrection::Polynomial(correction) => row.write_words(
            &SourceMesh::new(*correction, row.spacing_px),
            format,
            &mut bytes,
        ),
        PointCorrection::Gridded(correction) => row.write_words(
            &SourceMesh::new(correction, row.spacing_px),
            format,
            &mut bytes,
        ),
    }
    .map_err(Refusal::Mesh)?;
    Ok(bytes)
}

pub(super) fn corrections(
    correction: &PointCorrection<'_>,
    row: &VertexRow,
) -> Result<Vec<PixelCorrection, MAX_POINTS>, Refusal> {
    let PointCorrection::Polynomial(correction) = correction else {
        return Err(Refusal::PolynomialMesh);
    };
    let mut corrections = Vec::new();
    corrections
        .resize_default(usize::from(row.count))
        .map_err(|_| Refusal::TooMany)?;
    let mesh = CorrectionMesh::new(correction, row.spacing_px);
    row.corrections(&mesh, &mut corrections)
        .map_err(Refusal::Mesh)?;
    Ok(corrections)
}

/// Checks that all points are on the sensor, where a correction is defined.
pub(super) fn on_sensor(
    correction: &FrameCorrection,
    points: impl Iterator<Item = SensorPoint>,
) -> Result<(), Refusal> {
    for (index, point) in (0..).zip(points) {
        if !correction.contains(point) {
            return Err(Refusal::OffSensor { index });
        }
    }
    Ok(())
}
