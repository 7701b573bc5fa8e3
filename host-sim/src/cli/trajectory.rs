//! Arguments of the trajectory of a flight.

use std::path::PathBuf;

use clap::{Arg, Args, ValueEnum};
use fmc_camera_file::number::finite;
use fmc_frames::trajectory::{
    GeographicPlace, LONGEST_GAP_S, OrientationSigma, TimeScale, TrajectoryOptions,
};

use super::number::positive;

/// Heading of the options for the trajectory.
const TRAJECTORY: &str = "Trajectory of a flight";

/// The trajectory of a flight.
#[derive(Debug, Args)]
#[group(skip)]
#[command(next_help_heading = TRAJECTORY)]
pub struct TrajectoryArgs {
    /// Trajectory of the navigation system, SBET or CSV (docs/formats.md): the exterior orientation
    /// at the centroid of each exposure, the time that belongs to its principal point. It is that
    /// of the navigation body, without lever arm and boresight of the camera.
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Table of the exterior orientations: CSV with `image`, `x_m`, `y_m`, `z_m`, `pitch_deg`,
    /// `roll_deg`, `yaw_deg`, their σ where the trajectory has σ, and the velocity.
    #[arg(long, value_name = "FILE.csv", requires = "trajectory")]
    pub orientation: Option<PathBuf>,
    /// Origin of the coordinates east, north and up of a geographic trajectory: latitude and
    /// longitude in degrees and height above the ellipsoid in m (WGS 84).
    #[arg(
        long,
        value_name = "LAT,LON,H",
        requires = "trajectory",
        value_parser = origin,
        allow_hyphen_values = true
    )]
    pub origin: Option<GeographicPlace>,
    /// Time scale of an SBET file.
    #[arg(long, value_name = "SCALE", requires = "trajectory")]
    pub trajectory_time: Option<TimeScaleName>,
    /// σ of a trajectory that does not have its own: east, north and up in m, pitch, roll and yaw
    /// in degrees.
    #[arg(
        long,
        value_name = "X,Y,Z,PITCH,ROLL,YAW",
        requires = "trajectory",
        value_parser = sigma
    )]
    pub trajectory_sigma: Option<OrientationSigma>,
    /// σ of an SBET file: the accuracy file (smrmsg) that was computed with it.
    #[arg(
        long,
        value_name = "FILE",
        requires = "trajectory",
        conflicts_with = "trajectory_sigma"
    )]
    pub trajectory_accuracy: Option<PathBuf>,
    /// Longest interval between samples that is interpolated, s.
    #[arg(
        long,
        value_name = "S",
        requires = "trajectory",
        value_parser = positive, allow_negative_numbers = true,
        default_value_t = LONGEST_GAP_S
    )]
    pub trajectory_gap: f64,
    /// Treatment of an exposure that the trajectory does not cover.
    #[arg(
        long,
        value_name = "ACTION",
        requires = "trajectory",
        default_value = "error"
    )]
    pub off_trajectory: OffTrajectoryName,
}

impl TrajectoryArgs {
    /// Returns what the trajectory does not say of itself.
    #[must_use]
    pub fn options(&self) -> TrajectoryOptions {
        TrajectoryOptions {
            scale: self.trajectory_time.map(|name| match name {
                TimeScaleName::Gps => TimeScale::Gps,
                TimeScaleName::Utc => TimeScale::Utc,
            }),
            longest_gap_s: self.trajectory_gap,
            sigma: self.trajectory_sigma,
            accuracy: self.trajectory_accuracy.clone(),
        }
    }
}

/// Time scale of an SBET file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TimeScaleName {
    /// Seconds of the GPS week.
    Gps,
    /// Seconds of the week in UTC.
    Utc,
}

/// Treatment of an exposure without an exterior orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OffTrajectoryName {
    /// The command fails with the first of them.
    Error,
    /// It has no orientation, and a list says why.
    Skip,
}

/// Makes the trajectory an option that needs the frames of a flight.
pub(super) fn needs_frames(arg: Arg) -> Arg {
    arg.requires("frame_source")
}

fn origin(text: &str) -> Result<GeographicPlace, String> {
    let [latitude, longitude, height_m] = numbers(text)?;
    let within = |name: &str, value: f64, most: f64| {
        if value.abs() <= most {
            return Ok(value);
        }
        Err(format!("{name} = {value} must be {} to {most}", -most))
    };
    Ok(GeographicPlace {
        latitude_rad: within("latitude", latitude, 90.0)?.to_radians(),
        longitude_rad: within("longitude", longitude, 360.0)?.to_radians(),
        height_m: within("height", height_m, 1e5)?,
    })
}

fn sigma(text: &str) -> Result<OrientationSigma, String> {
    let [x, y, z, pitch, roll, yaw] = numbers(text)?;
    if let Some(wrong) = [x, y, z, pitch, roll, yaw].iter().find(|one| **one <= 0.0) {
        return Err(format!("{wrong} is not positive"));
    }
    Ok(OrientationSigma {
        position_m: [x, y, z],
        angles_rad: [pitch, roll, yaw].map(f64::to_radians),
    })
}

/// Reads numbers with commas between them.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split(',').map(finite).collect::<Result<_, _>>()?;
    numbers
        .try_into()
        .map_err(|numbers: Vec<f64>| format!("{N} numbers are needed, not {}", numbers.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origin_and_sigma_are_in_degrees_and_metres() {
        let place = origin("47.5,-8.25, 450").unwrap();
        assert!((place.latitude_rad.to_degrees() - 47.5).abs() < 1e-12);
        assert!((place.longitude_rad.to_degrees() + 8.25).abs() < 1e-12);
        assert!((place.height_m - 450.0).abs() < 1e-12);
        let all = sigma("0.03,0.03,0.05,0.003,0.004,0.006").unwrap();
        assert!((all.angles_rad[1].to_degrees() - 0.004).abs() < 1e-15);
        for (text, fault) in [
            ("47.5,8.25", "3 numbers are needed, not 2"),
            ("97.5,8.25,1", "latitude = 97.5 must be -90 to 90"),
            ("47.5;8.25;1", "not a finite number"),
        ] {
            assert_eq!(origin(text).unwrap_err(), fault);
        }
        assert_eq!(sigma("1,1,1,1,0,1").unwrap_err(), "0 is not positive");
    }
}
