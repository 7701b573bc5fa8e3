//! V/H on the command line: as a number or fraction, or as ground speed and height.

use std::fmt;

use clap::{ArgGroup, Args};
use fmc_camera_file::number::finite;

use super::ADVANCED;
use super::number::{number_or_fraction, positive};

/// V/H, given in one of two ways.
#[derive(Debug, Clone, Copy, PartialEq, Args)]
#[group(skip)]
#[command(group = ArgGroup::new("vh_or_speed").required(true).args(["vh", "ground_speed"]))]
pub struct VhOption {
    /// V/H, ground speed over height above ground, 1/s: a number or a fraction such as 70/700.
    #[arg(long, value_name = "PER_S", value_parser = number_or_fraction, allow_negative_numbers = true)]
    vh: Option<f64>,
    /// Ground speed, m/s; with --height it takes the place of --vh.
    #[arg(long, value_name = "M_S", requires = "height", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    ground_speed: Option<f64>,
    /// Height above ground, m; with --ground-speed it takes the place of --vh.
    #[arg(long, value_name = "M", requires = "ground_speed", conflicts_with = "vh", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    height: Option<f64>,
}

/// V/H of `camera vh`, given in one of two ways.
#[derive(Debug, Clone, Copy, PartialEq, Args)]
#[group(skip)]
#[command(group = ArgGroup::new("vh_or_speed").required(true).args(["vh", "ground_speed"]))]
pub struct VhArgument {
    /// V/H, ground speed over height above ground, 1/s: a number or a fraction such as 70/700.
    #[arg(value_name = "PER_S", value_parser = number_or_fraction, allow_negative_numbers = true)]
    vh: Option<f64>,
    /// Ground speed, m/s; with --height it takes the place of V/H.
    #[arg(long, value_name = "M_S", requires = "height", value_parser = finite, allow_negative_numbers = true, help_heading = ADVANCED)]
    ground_speed: Option<f64>,
    /// Height above ground, m; with --ground-speed it takes the place of V/H.
    #[arg(long, value_name = "M", requires = "ground_speed", conflicts_with = "vh", value_parser = positive, allow_negative_numbers = true, help_heading = ADVANCED)]
    height: Option<f64>,
}

impl VhOption {
    /// Creates the option of a V/H, 1/s.
    #[must_use]
    pub const fn of(vh_per_s: f64) -> Self {
        Self {
            vh: Some(vh_per_s),
            ground_speed: None,
            height: None,
        }
    }

    /// V/H, 1/s.
    #[must_use]
    pub fn per_s(&self) -> f64 {
        match (self.vh, self.ground_speed, self.height) {
            (None, Some(speed), Some(height)) => speed / height,
            // The group requires one of the two ways; no number passes the limits of a camera.
            (vh, _, _) => vh.unwrap_or(f64::NAN),
        }
    }

    /// V/H, 1/s, if an option gives it.
    #[must_use]
    pub fn given(&self) -> Option<f64> {
        (self.vh.is_some() || self.ground_speed.is_some()).then(|| self.per_s())
    }

    /// Returns the names of the options that give V/H.
    #[must_use]
    pub const fn names(&self) -> &'static str {
        match self.vh {
            Some(_) => "--vh",
            None => "--ground-speed over --height",
        }
    }
}

/// Writes the options as they were given.
impl fmt::Display for VhOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.vh, self.ground_speed, self.height) {
            (None, Some(speed), Some(height)) => {
                write!(f, "--ground-speed {speed} --height {height}")
            }
            _ => write!(f, "--vh {}", self.per_s()),
        }
    }
}

impl VhArgument {
    /// V/H, 1/s.
    #[must_use]
    pub fn per_s(&self) -> f64 {
        VhOption {
            vh: self.vh,
            ground_speed: self.ground_speed,
            height: self.height,
        }
        .per_s()
    }
}
