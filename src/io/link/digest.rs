//! Digests by which camera and PC show each other that they have the same bits.

use crc::{CRC_32_ISO_HDLC, Crc, Digest, Table};
use postcard::ser_flavors::Flavor;
use postcard::serialize_with_flavor;
use serde::Serialize;

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

/// CRC-32 over a camera record as the link carries it, without the bytes themselves: that of the
/// calibration's identity. It is computed once for a calibration, so that a table of a kilobyte,
/// which a camera without link would need for it alone, is not worth while. `None` only if `serde`
/// could not write it.
#[must_use]
pub fn of_camera(record: &CameraParameters) -> Option<u32> {
    let mut digest = WITHOUT_TABLE.digest();
    add(record, &mut digest)?;
    if !record.grids.is_empty() {
        add(&record.grids, &mut digest)?;
    }
    Some(digest.finalize())
}

/// Returns the CRC-32 over a frame record as the link carries it; `None` only if it were longer
/// than the record's type allows.
#[must_use]
pub fn of_frame_record(record: &FrameRecord) -> Option<u32> {
    packet::checksum(record)
}

/// The CRC-32 of packets, bit by bit.
const WITHOUT_TABLE: Crc<u32, Table<0>> = Crc::<u32, Table<0>>::new(&CRC_32_ISO_HDLC);

/// Adds what `postcard` makes of a value.
fn add(value: &impl Serialize, digest: &mut Digest<'_, u32, Table<0>>) -> Option<()> {
    serialize_with_flavor(value, Summed(digest)).ok()
}

/// Digest of bytes, as many as have been written.
struct Summed<'a, 'c>(&'a mut Digest<'c, u32, Table<0>>);

impl Flavor for Summed<'_, '_> {
    type Output = ();

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.try_extend(&[byte])
    }

    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.0.update(bytes);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::of_camera;
    use crate::flight::camera::{CameraParameters, Mechanism};
    use crate::geometry::calibration::CalibrationParameters;
    use crate::geometry::five_coefficient::FiveCoefficients;
    use crate::geometry::grid::GridChecksums;
    use crate::geometry::shutter::ShutterProfile;
    use crate::io::link::loading::Upload;

    proptest! {
        #[test]
        fn identity_is_the_checksum_of_the_upload(
            numbers: [f32; 6],
            size_px: [u32; 2],
            version: u32,
            fitted in proptest::option::of(any::<f32>()),
            first_transfer in proptest::option::of(any::<f32>()),
            ramp in proptest::option::of(any::<f32>()),
            lens: Option<u32>,
            sensor: Option<u32>,
        ) {
            let [principal_distance_mm, pixel_um, k1, stroke_mm, slope_um, vh_per_s] = numbers;
            let mut calibration =
                CalibrationParameters::new(principal_distance_mm, size_px, pixel_um);
            calibration.distortion.k1 = k1;
            calibration.stroke_mm = stroke_mm;
            calibration.flatness.coefficients_um = [0.0, slope_um, 0.0, 0.0, 0.0];
            calibration.fitted = fitted.map(|kd1| FiveCoefficients {
                kd1,
                ..FiveCoefficients::default()
            });
            let mut record = CameraParameters::new(calibration);
            record.version = version;
            record.limits.vh_per_s = [0.0, vh_per_s];
            record.grids = GridChecksums { lens, sensor };
            if let Some(first_transfer) = first_transfer {
                record.mechanism = Mechanism::Tdi { first_transfer };
            }
            if let Some(opening_fraction) = ramp {
                record.shutter = ShutterProfile::Trapezoid {
                    opening_fraction,
                    closing_fraction: k1,
                };
            }
            prop_assert_eq!(of_camera(&record), Upload::of(&record).map(|upload| upload.crc()));
        }
    }
}
