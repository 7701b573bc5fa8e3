//! One sample of a trajectory.

use std::f64::consts::{FRAC_PI_2, PI};

/// Place and attitude of the navigation body at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// Seconds since the week began in which the trajectory does.
    pub(super) time_s: f64,
    /// Latitude, longitude, rad, and height, m; or x, y, z, m.
    pub(super) place: [f64; 3],
    /// Attitude of the body.
    pub(super) attitude: Attitude,
    /// σ of both, where the file has it.
    pub(super) sigma: Option<OrientationSigma>,
}

/// Angles of the body: `ground_from_body = Rz(yaw)·Rx(pitch)·Ry(roll)`.
///
/// The body's axes are right, forward and up, those of the ground east, north and up, or x, y and z
/// of the trajectory. All angles are right-handed: pitch nose up, roll right side down, yaw nose to
/// the left, so that yaw is minus the heading.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Attitude {
    /// About the axis to the right, rad.
    pub pitch_rad: f64,
    /// About the axis forward, rad.
    pub roll_rad: f64,
    /// About the axis up, rad.
    pub yaw_rad: f64,
}

/// σ of a place and of the three angles.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OrientationSigma {
    /// East, north and up, or x, y and z, m.
    pub position_m: [f64; 3],
    /// Pitch, roll and yaw, rad.
    pub angles_rad: [f64; 3],
}

impl OrientationSigma {
    /// Returns both, as independent errors add.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self {
            position_m: each(self.position_m, other.position_m, f64::hypot),
            angles_rad: each(self.angles_rad, other.angles_rad, f64::hypot),
        }
    }

    /// Returns the σ at a share of the way to another, by which errors that are alike grow.
    pub(super) fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |a, b| each(a, b, |a, b| a + (b - a) * share);
        Self {
            position_m: between(self.position_m, other.position_m),
            angles_rad: between(self.angles_rad, other.angles_rad),
        }
    }
}

/// Returns the numbers of a binary record: `f64`, little endian.
pub(super) fn numbers_of<const COUNT: usize>(bytes: &[u8]) -> [f64; COUNT] {
    let mut numbers = [0.0; COUNT];
    let (parts, _) = bytes.as_chunks::<8>();
    for (number, part) in numbers.iter_mut().zip(parts) {
        *number = f64::from_le_bytes(*part);
    }
    numbers
}

/// Returns what `of` gives of each pair.
pub(super) fn each(
    [ax, ay, az]: [f64; 3],
    [bx, by, bz]: [f64; 3],
    of: impl Fn(f64, f64) -> f64,
) -> [f64; 3] {
    [of(ax, bx), of(ay, by), of(az, bz)]
}

/// Range of a number of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Allowed {
    pub(super) least: f64,
    pub(super) most: f64,
    pub(super) unit: &'static str,
}

/// Ranges of angles and heights; seconds of the week may go on into a second week.
pub(super) const LATITUDE: Allowed = Allowed::about_zero(FRAC_PI_2, "rad");
pub(super) const LONGITUDE: Allowed = Allowed::about_zero(2.0 * PI, "rad");
pub(super) const HEIGHT: Allowed = Allowed::about_zero(1e5, "m");
pub(super) const ROLL: Allowed = Allowed::about_zero(PI, "rad");
pub(super) const PITCH: Allowed = Allowed::about_zero(FRAC_PI_2, "rad");
pub(super) const HEADING: Allowed = Allowed::about_zero(4.0 * PI, "rad");
pub(super) const SECONDS_OF_WEEK: Allowed = Allowed {
    least: 0.0,
    most: 2.0 * super::clock::WEEK_S,
    unit: "s",
};

impl Allowed {
    pub(super) const fn about_zero(most: f64, unit: &'static str) -> Self {
        Self {
            least: -most,
            most,
            unit,
        }
    }

    /// Returns the range in degrees.
    pub(super) const fn degrees(self) -> Self {
        Self {
            least: self.least.to_degrees(),
            most: self.most.to_degrees(),
            unit: "°",
        }
    }

    /// Checks a number.
    ///
    /// # Errors
    /// The sentence for the user.
    pub(super) fn check(self, value: f64) -> Result<f64, String> {
        if (self.least..=self.most).contains(&value) {
            return Ok(value);
        }
        Err(format!(
            "must be {} to {} {}",
            self.least, self.most, self.unit
        ))
    }
}
