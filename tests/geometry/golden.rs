//! Bits of the results, which are the same on every machine and in every version.

use crate::geometry::cameras;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};

/// CRC-32 (ISO-HDLC) over the little-endian bits of x', y', dx, dy of 41 x 41 points of the five
/// published cameras, opened 0.1 mm off, 0.1 mm of travel, detector 5 µm out of its plane.
const DIGEST: u32 = 0x4135_3d8e;

#[test]
fn answers_have_the_recorded_bits() {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    let travel = UniformTravel {
        opening_offset_mm: 0.1,
        speed_mm_s: 10.0,
        exposure_s: 0.01,
    };
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let motion = PrincipalPointMotion::from_plan(travel, &shutter);
    for record in cameras::published() {
        let calibration = Calibration::new(record).unwrap();
        let focus = cameras::focus(&calibration, 0.005);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let measured = cameras::grid(&calibration, 41);
        let mut in_place = measured.clone();
        correction.correct_slice(&mut in_place);
        for (measured, ideal) in measured.into_iter().zip(in_place) {
            let corrected = correction.correct(measured);
            assert_eq!(corrected.point, ideal, "slice and single point differ");
            for value in [
                ideal.x_mm,
                ideal.y_mm,
                corrected.distortion.dx_mm,
                corrected.distortion.dy_mm,
            ] {
                digest.update(&value.to_le_bytes());
            }
        }
    }
    assert_eq!(digest.finalize(), DIGEST, "the arithmetic has changed");
}
