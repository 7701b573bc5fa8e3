//! Trajectories against the motions that they were sampled from.

mod damaged;
mod motion;
mod places;
mod precision;
mod times;

use std::path::PathBuf;

use fmc_camera::flight::utc::UtcTime;
use fmc_camera_file::InputError;
use fmc_frames::trajectory::{ImageOrientation, Trajectory, TrajectoryOptions, Unavailable};

/// A file of a trajectory, which goes when it is dropped.
pub(crate) struct TrajectoryFile {
    folder: tempfile::TempDir,
}

impl TrajectoryFile {
    pub(crate) fn with(bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("trajectory"), bytes).unwrap();
        Self { folder }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("trajectory")
    }

    pub(crate) fn open(&self, options: &TrajectoryOptions) -> Result<Trajectory, InputError> {
        Trajectory::open(&self.path(), options, |_| {})
    }

    /// Opens it with the defaults, which must succeed.
    pub(crate) fn opened(&self) -> Trajectory {
        self.open(&TrajectoryOptions::default()).unwrap()
    }

    /// Returns the error of opening, without the folder.
    pub(crate) fn refusal(&self, options: &TrajectoryOptions) -> String {
        let text = self.open(options).unwrap_err().to_string();
        text.replace(&format!("{}/", self.folder.path().display()), "")
    }
}

/// 2026-03-01T00:00:00 UTC, a Sunday, in Unix seconds: the UTC week begins, the GPS week began 18 s
/// before.
pub(crate) const SUNDAY_UNIX_S: u32 = 1_772_323_200;

/// GPS week that began 18 s before [`SUNDAY_UNIX_S`].
pub(crate) const SUNDAY_GPS_WEEK: u64 = 2408;

/// Seconds of the GPS week at [`SUNDAY_UNIX_S`].
pub(crate) const SUNDAY_GPS_S: f64 = 18.0;

/// Returns UTC of a second of the GPS week.
pub(crate) fn utc_of(gps_s: f64, sigma_s: f32) -> UtcTime {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "microseconds of a few weeks"
    )]
    let us = ((gps_s - SUNDAY_GPS_S) * 1e6).round() as i64;
    UtcTime {
        unix_us: (u64::from(SUNDAY_UNIX_S) * 1_000_000)
            .checked_add_signed(us)
            .unwrap(),
        sigma_s,
    }
}

/// Returns the orientation at a second of the GPS week.
pub(crate) fn at(trajectory: &mut Trajectory, gps_s: f64) -> Result<ImageOrientation, Unavailable> {
    trajectory.at(Some(utc_of(gps_s, 0.0))).unwrap()
}
