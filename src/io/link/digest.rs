//! Digests by which camera and PC show each other that they have the same bits.

use super::identity::Identity;
use super::message::Grid;
use super::packet::{self, CRC};
use crate::flight::camera::CameraParameters;
use crate::flight::frame_record::FrameRecord;
use crate::geometry::exposure_distortion::ExposureDistortion;
use crate::geometry::frame_correction::Corrected;

/// Returns the CRC-32 over the bits of every corrected point of a grid: x', y', dx, dy,
/// little-endian.
#[must_use]
pub fn of_grid<D: ExposureDistortion>(correction: &D, grid: &Grid) -> u32 {
    let mut digest = CRC.digest();
    for measured in grid.points() {
        let Corrected { point, distortion } = correction.correct(measured);
        for value in [point.x_mm, point.y_mm, distortion.dx_mm, distortion.dy_mm] {
            digest.update(&value.to_le_bytes());
        }
    }
    digest.finalize()
}

/// CRC-32 over a camera record as the link carries it: that of the calibration's identity.
#[must_use]
#[expect(
    clippy::inline_always,
    reason = "a program whose cameras have neither grids nor focus table is without their code"
)]
#[inline(always)]
pub fn of_camera(record: &CameraParameters) -> u32 {
    Identity::of(record)
}

/// Returns the CRC-32 over a frame record as the link carries it; `None` only if it were longer
/// than the record's type allows.
#[must_use]
pub fn of_frame_record(record: &FrameRecord) -> Option<u32> {
    packet::checksum(record)
}
