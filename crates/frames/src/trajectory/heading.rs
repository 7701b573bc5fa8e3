//! Columns of a trajectory in CSV.

use csv::StringRecord;
use fmc_camera_file::InputError;
use fmc_camera_file::number::finite;

use super::clock::{Clock, TimeScale, WEEK_S, WeekCount, weeks_s};
use super::sample::{
    Allowed, Attitude, HEADING, HEIGHT, LATITUDE, LONGITUDE, OrientationSigma, PITCH, ROLL,
    SECONDS_OF_WEEK, Sample,
};
use crate::columns::shown;
use crate::time;

/// Seconds of GPS time, with or without their week.
const GPS_SECONDS: &str = "gps_seconds_of_week";
const GPS_WEEK: &str = "gps_week";
/// UTC as Unix time, without leap seconds.
const UNIX_S: &str = "unix_s";
const UNIX_US: &str = "unix_us";

const GEOGRAPHIC: [&str; 3] = ["latitude_deg", "longitude_deg", "height_m"];
const CARTESIAN: [&str; 3] = ["x_m", "y_m", "z_m"];
const SIGMAS: [&str; 6] = [
    "sigma_x_m",
    "sigma_y_m",
    "sigma_z_m",
    "sigma_pitch_deg",
    "sigma_roll_deg",
    "sigma_yaw_deg",
];

/// Coordinates of a trajectory's places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinates {
    /// Latitude, longitude and height above the ellipsoid of WGS 84.
    Geographic,
    /// x, y and z of a system with z up, to whose axes the angles refer.
    Cartesian,
}

/// Column of the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TimeColumn {
    Gps { seconds: usize, week: Option<usize> },
    UnixS(usize),
    UnixUs(usize),
}

/// Places of the columns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    pub(super) names: Vec<String>,
    pub(super) coordinates: Coordinates,
    time: TimeColumn,
    place: [usize; 3],
    pitch: usize,
    roll: usize,
    /// Column of the third angle, and the sign that makes a yaw of it.
    yaw: (usize, f64),
    sigma: Option<[usize; 6]>,
}

/// Largest coordinates of a Cartesian system, m.
const COORDINATE: Allowed = Allowed::about_zero(1e8, "m");

/// Range of a σ.
const SIGMA: Allowed = Allowed {
    least: 0.0,
    most: 1e6,
    unit: "",
};

/// Range of Unix times, s: those that have a GPS time, up to the year 2200.
const UNIX: Allowed = Allowed {
    least: 315_964_800.0,
    most: 7.258e9,
    unit: "s",
};

impl Heading {
    /// Finds the columns.
    ///
    /// # Errors
    /// [`InputError`] that names the columns which are missing, or two that say the same.
    pub(super) fn find(file: &str, names: Vec<String>) -> Result<Self, InputError> {
        let refused = |text: String| InputError::invalid(format!("{file}, line 1: {text}"));
        let at = |wanted: &str| names.iter().position(|name| name == wanted);
        let all = |wanted: [&str; 3]| -> Option<[usize; 3]> {
            let [a, b, c] = wanted.map(at);
            Some([a?, b?, c?])
        };
        let time = match (at(GPS_SECONDS), at(UNIX_S), at(UNIX_US)) {
            (Some(seconds), None, None) => TimeColumn::Gps {
                seconds,
                week: at(GPS_WEEK),
            },
            (None, Some(column), None) => TimeColumn::UnixS(column),
            (None, None, Some(column)) => TimeColumn::UnixUs(column),
            _ => {
                return Err(refused(format!(
                    "one column of time is needed: {GPS_SECONDS} (with {GPS_WEEK}, if it is known), {UNIX_S} or {UNIX_US}"
                )));
            }
        };
        let (coordinates, place) = match (all(GEOGRAPHIC), all(CARTESIAN)) {
            (Some(place), None) => (Coordinates::Geographic, place),
            (None, Some(place)) => (Coordinates::Cartesian, place),
            _ => {
                return Err(refused(format!(
                    "the place is needed once: {} or {}",
                    GEOGRAPHIC.join(", "),
                    CARTESIAN.join(", ")
                )));
            }
        };
        let needed =
            |wanted: &str| at(wanted).ok_or_else(|| refused(format!("column {wanted} is missing")));
        let yaw = match (at("yaw_deg"), at("heading_deg")) {
            (Some(column), None) => (column, 1.0),
            (None, Some(column)) => (column, -1.0),
            _ => {
                return Err(refused(
                    "one of heading_deg, clockwise, and yaw_deg, anticlockwise, is needed"
                        .to_owned(),
                ));
            }
        };
        let sigma = SIGMAS.map(at);
        let sigma = match sigma.iter().flatten().count() {
            0 => None,
            6 => Some(sigma.map(Option::unwrap_or_default)),
            _ => {
                return Err(refused(format!(
                    "of {} all are needed, or none",
                    SIGMAS.join(", ")
                )));
            }
        };
        Ok(Self {
            coordinates,
            time,
            place,
            pitch: needed("pitch_deg")?,
            roll: needed("roll_deg")?,
            yaw,
            sigma,
            names,
        })
    }

    /// Returns the clock of the file, by its first row.
    ///
    /// # Errors
    /// The sentence for the user.
    pub(super) fn clock(&self, row: &StringRecord) -> Result<Clock, String> {
        let week = match self.time {
            TimeColumn::Gps { week: None, .. } => None,
            TimeColumn::Gps {
                week: Some(week), ..
            } => Some(self.whole(row, week)?),
            TimeColumn::UnixS(_) | TimeColumn::UnixUs(_) => Some(self.unix(row)?.0),
        };
        Ok(Clock {
            scale: TimeScale::Gps,
            week,
        })
    }

    /// Returns the sample of a row.
    ///
    /// # Errors
    /// The sentence for the user, without file and line.
    pub(super) fn sample(
        &self,
        row: &StringRecord,
        clock: Clock,
        weeks: &mut WeekCount,
    ) -> Result<Sample, String> {
        let in_week = |week: u64| clock.week.map_or(0.0, |first| weeks_s(week, first));
        let time_s = match self.time {
            TimeColumn::Gps {
                seconds,
                week: None,
            } => weeks.time_s(self.number(row, seconds, SECONDS_OF_WEEK)?),
            TimeColumn::Gps {
                seconds,
                week: Some(week),
            } => {
                let one_week = Allowed {
                    most: WEEK_S,
                    ..SECONDS_OF_WEEK
                };
                in_week(self.whole(row, week)?) + self.number(row, seconds, one_week)?
            }
            TimeColumn::UnixS(_) | TimeColumn::UnixUs(_) => {
                let (week, seconds) = self.unix(row)?;
                in_week(week) + seconds
            }
        };
        let (ranges, to_unit) = match self.coordinates {
            Coordinates::Geographic => (
                [LATITUDE.degrees(), LONGITUDE.degrees(), HEIGHT],
                [1_f64.to_radians(), 1_f64.to_radians(), 1.0],
            ),
            Coordinates::Cartesian => ([COORDINATE; 3], [1.0; 3]),
        };
        let mut place = [0.0; 3];
        for (index, value) in place.iter_mut().enumerate() {
            let of = |all: [usize; 3]| all.get(index).copied().unwrap_or_default();
            let range = ranges.get(index).copied().unwrap_or(COORDINATE);
            let unit = to_unit.get(index).copied().unwrap_or(1.0);
            *value = self.number(row, of(self.place), range)? * unit;
        }
        let (yaw, sign) = self.yaw;
        let angle = |column: usize, range: Allowed| {
            Ok::<_, String>(self.number(row, column, range.degrees())?.to_radians())
        };
        let sigma = match self.sigma {
            None => None,
            Some([x, y, z, pitch, roll, yaw]) => {
                let of = |column: usize| self.number(row, column, SIGMA);
                Some(OrientationSigma {
                    position_m: [of(x)?, of(y)?, of(z)?],
                    angles_rad: [of(pitch)?, of(roll)?, of(yaw)?].map(f64::to_radians),
                })
            }
        };
        Ok(Sample {
            time_s,
            place,
            attitude: Attitude {
                pitch_rad: angle(self.pitch, PITCH)?,
                roll_rad: angle(self.roll, ROLL)?,
                yaw_rad: sign * angle(yaw, HEADING)?,
            },
            sigma,
        })
    }

    /// Returns week and second of the week of a row in Unix time.
    fn unix(&self, row: &StringRecord) -> Result<(u64, f64), String> {
        let (unix_us, rest_s) = match self.time {
            TimeColumn::UnixUs(column) => (self.whole(row, column)?, 0.0),
            TimeColumn::UnixS(column)
            | TimeColumn::Gps {
                seconds: column, ..
            } => {
                let seconds = self.number(row, column, UNIX)?;
                (whole_us(seconds.floor()), seconds.fract())
            }
        };
        match time::gps(unix_us) {
            Some(instant) => Ok((instant.week, instant.seconds() + rest_s)),
            None => Err(format!(
                "{UNIX_US} = {unix_us}: is before GPS time began, 1980-01-06"
            )),
        }
    }

    fn number(&self, row: &StringRecord, column: usize, range: Allowed) -> Result<f64, String> {
        self.read(row, column, |text| range.check(finite(text)?))
    }

    fn whole(&self, row: &StringRecord, column: usize) -> Result<u64, String> {
        self.read(row, column, |text| {
            text.parse()
                .map_err(|_| "must be a whole number, at least 0".to_owned())
        })
    }

    fn read<T>(
        &self,
        row: &StringRecord,
        column: usize,
        read: impl FnOnce(&str) -> Result<T, String>,
    ) -> Result<T, String> {
        let text = row.get(column).unwrap_or_default();
        read(text).map_err(|fault| {
            let name = self.names.get(column).map_or("", String::as_str);
            format!("{name} = \"{}\": {fault}", shown(text))
        })
    }
}

/// Returns whole seconds in microseconds.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole seconds that were checked to be within the range of GPS time"
)]
fn whole_us(seconds: f64) -> u64 {
    seconds as u64 * 1_000_000
}
