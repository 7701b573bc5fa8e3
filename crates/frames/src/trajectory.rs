//! Exterior orientation of the frames, from the trajectory of a navigation system.
//!
//! A [`Trajectory`] is an SBET file or a table in CSV. [`Trajectory::at`] gives place and attitude
//! of the navigation body at the centroid of an exposure, the time that belongs to its principal
//! point, with σ. The file stays where it is: kept in memory are an index of bounded size and the
//! samples about the last exposure, whatever the length of the flight.

mod accuracy;
mod clock;
mod heading;
mod image_orientation;
mod index;
mod interpolation;
mod local_level;
mod open;
mod rotation;
mod sample;
mod samples;
mod sbet;

use std::fmt;

use fmc_camera::flight::utc::UtcTime;
use fmc_camera_file::InputError;

use self::accuracy::Accuracy;
pub use self::clock::TimeScale;
pub use self::heading::Coordinates;
pub use self::image_orientation::{GeographicPlace, ImageOrientation, Place};
use self::index::Index;
pub use self::open::{LONGEST_GAP_S, TrajectoryOptions};
use self::sample::Sample;
pub use self::sample::{Attitude, OrientationSigma};
use self::samples::SampleFile;

/// Reason why an exposure has no orientation. Times are seconds since the week began in which the
/// trajectory does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unavailable {
    /// The time of the exposure is not known in UTC.
    NoUtc,
    /// The trajectory does not cover it.
    Outside {
        /// Time of the exposure, s.
        time_s: f64,
        /// First sample, s.
        first_s: f64,
        /// Last sample, s.
        last_s: f64,
        /// Scale of these times.
        scale: TimeScale,
    },
    /// The samples about it are too far from each other.
    Gap {
        /// Time between them, s.
        gap_s: f64,
        /// Largest that is allowed, s.
        longest_s: f64,
    },
    /// There are fewer than three samples about it between gaps.
    Short,
}

impl fmt::Display for Unavailable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoUtc => f.write_str("its centroid has no UTC"),
            Self::Outside {
                time_s,
                first_s,
                last_s,
                scale,
            } => write!(
                f,
                "its centroid at {time_s:.3} s of the week ({}) is outside the trajectory, {first_s:.3} to {last_s:.3} s",
                scale.name()
            ),
            Self::Gap { gap_s, longest_s } => write!(
                f,
                "the samples about its centroid are {gap_s:.3} s from each other; allowed are {longest_s} s"
            ),
            Self::Short => {
                f.write_str("about its centroid there are fewer than three samples between gaps")
            }
        }
    }
}

/// A trajectory on its file.
#[derive(Debug)]
pub struct Trajectory {
    file: SampleFile,
    index: Index,
    coordinates: Coordinates,
    longest_gap_s: f64,
    sigma: Option<OrientationSigma>,
    accuracy: Option<Accuracy>,
    /// Part of the index whose samples are in memory, and these.
    part: Option<usize>,
    samples: Vec<Sample>,
}

impl Trajectory {
    /// Coordinates of the places.
    #[must_use]
    pub const fn coordinates(&self) -> Coordinates {
        self.coordinates
    }

    /// Number of samples.
    #[must_use]
    pub const fn len(&self) -> u64 {
        self.index.count
    }

    /// Returns `false`: a trajectory has at least three samples.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.index.count == 0
    }

    /// Number of intervals between samples that are longer than the longest gap.
    #[must_use]
    pub const fn gaps(&self) -> u64 {
        self.index.gaps
    }

    /// Returns `true` if the file states the week of its times. Otherwise they are taken for times
    /// of the week in which the exposures are.
    #[must_use]
    pub const fn has_week(&self) -> bool {
        self.file.clock.week.is_some()
    }

    /// Returns the orientation at the centroid of an exposure.
    ///
    /// # Errors
    /// [`InputError`] if the file cannot be read any more, or the file of its accuracy does not
    /// cover the time; inside, why there is no orientation.
    pub fn at(
        &mut self,
        centroid: Option<UtcTime>,
    ) -> Result<Result<ImageOrientation, Unavailable>, InputError> {
        let Index {
            first_s, last_s, ..
        } = self.index;
        let Some(centroid) = centroid else {
            return Ok(Err(Unavailable::NoUtc));
        };
        let Some(time_s) = self.file.clock.seconds(centroid.unix_us, first_s) else {
            return Ok(Err(Unavailable::NoUtc));
        };
        if !(first_s..=last_s).contains(&time_s) {
            return Ok(Err(Unavailable::Outside {
                time_s,
                first_s,
                last_s,
                scale: self.file.clock.scale,
            }));
        }
        self.load(time_s)?;
        let mut found = self.interpolate(time_s, f64::from(centroid.sigma_s));
        if let (Ok(orientation), Some(accuracy)) = (&mut found, &self.accuracy) {
            orientation.trajectory_sigma = Some(accuracy.at(time_s)?);
        }
        Ok(found)
    }

    fn interpolate(&self, time_s: f64, sigma_s: f64) -> Result<ImageOrientation, Unavailable> {
        let after = self.samples.partition_point(|one| one.time_s <= time_s);
        let before = after
            .saturating_sub(1)
            .min(self.samples.len().saturating_sub(2));
        let is_gap = |index: usize| match self.samples.get(index..index + 2) {
            Some([a, b]) => b.time_s - a.time_s > self.longest_gap_s,
            _ => true,
        };
        let between = self.samples.get(before..before + 2);
        if let (Some([a, b]), true) = (between, is_gap(before)) {
            return Err(Unavailable::Gap {
                gap_s: b.time_s - a.time_s,
                longest_s: self.longest_gap_s,
            });
        }
        let least = before.saturating_sub(interpolation::FAR);
        let most = before + interpolation::FAR;
        let first = (least..before).rev().find(|index| is_gap(*index));
        let first = first.map_or(least, |gap| gap + 1);
        let last = (before..most).find(|index| is_gap(*index)).unwrap_or(most);
        let stretch = self.samples.get(first..=last).ok_or(Unavailable::Short)?;
        let orientation =
            interpolation::at(stretch, before - first, self.coordinates, time_s, sigma_s);
        let mut orientation = orientation.ok_or(Unavailable::Short)?;
        orientation.trajectory_sigma = orientation.trajectory_sigma.or(self.sigma);
        Ok(orientation)
    }

    /// Reads the samples about a time into memory, with more than the interpolation needs to both
    /// sides.
    fn load(&mut self, time_s: f64) -> Result<(), InputError> {
        let part = self.index.part(time_s);
        if self.part == Some(part) {
            return Ok(());
        }
        self.part = None;
        self.samples.clear();
        let (from, most) = self.index.around(part);
        let samples = &mut self.samples;
        self.file.read(from, |sample, _| {
            samples.push(sample);
            Ok(samples.len() < most)
        })?;
        self.part = Some(part);
        Ok(())
    }
}
