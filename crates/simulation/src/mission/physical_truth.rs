//! True values of a mission's exposures, in the frames of a record.

use fmc_camera_file::CameraFile;

use super::camera_clock::CameraClock;
use super::clock::seconds;
use super::oracle::FrameTruth;
use super::scenario::MissionScenario;
use super::sensors::FIRST_PULSE_US;
use crate::judge::truth::PhysicalTruth;

/// Relation of a mission's true exposures to the frames of a record.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrueWorld<'a> {
    camera: &'a CameraFile,
    clock: &'a CameraClock,
    /// Second that the receiver's first pulse begins, since 1970.
    first_pulse_unix_s: Option<i64>,
}

impl<'a> TrueWorld<'a> {
    /// Creates the world of a scenario, in which the camera had this clock.
    pub(super) fn of(scenario: &'a MissionScenario, clock: &'a CameraClock) -> Self {
        let gnss = scenario.written.gnss.as_ref();
        Self {
            camera: &scenario.camera,
            clock,
            first_pulse_unix_s: gnss.map(|gnss| gnss.first_pulse_unix_s),
        }
    }

    /// Returns the true values of an exposure.
    pub(super) fn truth(&self, truth: &FrameTruth) -> PhysicalTruth {
        let [x0, y0] = self.camera.principal_point_mm;
        let axis @ [ex, ey] = self.camera.fmc.axis.unit();
        let offset_mm = truth.centroid_offset_mm;
        let pixel_mm = self.camera.sensor.pixel_um / 1000.0;
        PhysicalTruth {
            principal_point_mm: [x0 + offset_mm * ex, y0 + offset_mm * ey],
            axis,
            centroid_us: 1e6 * self.clock.shown_s(truth.centroid_s),
            centroid_unix_ns: self
                .first_pulse_unix_s
                .map(|first_s| 1_000_000_000 * first_s + nanoseconds(truth.centroid_s)),
            vh_per_s: truth.vh_per_s,
            smear_px: truth.smear_mm / pixel_mm,
            compensation_px: truth.compensation_smear_mm / pixel_mm,
        }
    }
}

/// Returns the time since the first pulse, ns.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a flight is shorter than 2^53 ns"
)]
fn nanoseconds(time_s: f64) -> i64 {
    (1e9 * (time_s - seconds(FIRST_PULSE_US))).round() as i64
}
