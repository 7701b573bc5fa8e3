//! Accuracy of a trajectory: the file of σ ("smrmsg") that goes with an SBET file.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use fmc_camera_file::InputError;

use super::clock::WeekCount;
use super::sample::{Allowed, OrientationSigma, SECONDS_OF_WEEK, numbers_of};

/// Numbers of a record: time, σ of the position north, east and down (m), of the velocity (3), of
/// roll, pitch and heading (minutes of arc); `f64`, little endian.
const NUMBERS: usize = 10;

const BYTES: usize = NUMBERS * size_of::<f64>();

/// Most records that are kept; of a longer file every second, fourth and so on.
const MOST: usize = 16_384;

/// Range of σ.
const POSITION: Allowed = Allowed {
    least: 0.0,
    most: 1e6,
    unit: "m",
};
const ANGLE: Allowed = Allowed {
    least: 0.0,
    most: 21_600.0,
    unit: "minutes of arc",
};

/// σ of a trajectory over time. Kept in memory are at most 16,384 records, evenly over the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Accuracy {
    file: String,
    records: Vec<(f64, OrientationSigma)>,
}

impl Accuracy {
    /// Reads a file.
    ///
    /// # Errors
    /// [`InputError`] naming file, record, number, value and allowed range: half a record, a σ that
    /// is none or out of its range, a time that does not ascend, fewer than two records.
    pub(super) fn read(path: &Path) -> Result<Self, InputError> {
        let file = path.display().to_string();
        let unreadable = |error: &io::Error| InputError::reading(path, error);
        let source = File::open(path).map_err(|error| unreadable(&error))?;
        let length = source.metadata().map_err(|error| unreadable(&error))?.len();
        if !length.is_multiple_of(BYTES as u64) || length < 2 * BYTES as u64 {
            return Err(InputError::invalid(format!(
                "{file}: {length} bytes are not two or more whole records of {BYTES} bytes"
            ))
            .with_help("--trajectory-accuracy takes the smrmsg file beside an SBET file"));
        }
        let mut source = BufReader::with_capacity(1 << 18, source);
        let mut weeks = WeekCount::default();
        let mut records = Vec::new();
        let (mut step, mut last, mut last_s) = (1_u64, None, f64::NEG_INFINITY);
        let mut bytes = [0; BYTES];
        for number in 0..length / BYTES as u64 {
            source
                .read_exact(&mut bytes)
                .map_err(|error| unreadable(&error))?;
            let refused = |fault: String| {
                InputError::invalid(format!("{file}, record {}: {fault}", number + 1))
            };
            let (seconds, sigma) = record(&bytes).map_err(refused)?;
            let time_s = weeks.time_s(seconds);
            if time_s <= last_s {
                return Err(refused(format!(
                    "time = {seconds}: must be later than {last_s}"
                )));
            }
            last_s = time_s;
            last = Some((time_s, sigma));
            if number.is_multiple_of(step) {
                records.extend(last.take());
            }
            if records.len() > MOST {
                let mut index = 0;
                records.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                step *= 2;
            }
        }
        // The last record ends the time that is covered.
        records.extend(last);
        Ok(Self { file, records })
    }

    /// Returns σ at a time, linear between records.
    ///
    /// # Errors
    /// [`InputError`] naming the file, if it does not cover the time.
    pub(super) fn at(&self, time_s: f64) -> Result<OrientationSigma, InputError> {
        let after = self.records.partition_point(|(at_s, _)| *at_s <= time_s);
        let before = after
            .saturating_sub(1)
            .min(self.records.len().saturating_sub(2));
        match self.records.get(before..before + 2) {
            Some([(from_s, a), (to_s, b)]) if (*from_s..=*to_s).contains(&time_s) => {
                let share = (time_s - from_s) / (to_s - from_s);
                Ok(a.towards(b, share))
            }
            _ => Err(InputError::invalid(format!(
                "{}: {time_s:.3} s of the week is outside its times, {:.3} to {:.3} s",
                self.file,
                self.records.first().map_or(0.0, |(at_s, _)| *at_s),
                self.records.last().map_or(0.0, |(at_s, _)| *at_s),
            ))),
        }
    }
}

/// Returns time and σ of a record.
fn record(bytes: &[u8; BYTES]) -> Result<(f64, OrientationSigma), String> {
    let [time, north, east, down, _, _, _, roll, pitch, heading]: [f64; NUMBERS] =
        numbers_of(bytes);
    for (name, value, allowed) in [
        ("time", time, SECONDS_OF_WEEK),
        ("σ north", north, POSITION),
        ("σ east", east, POSITION),
        ("σ down", down, POSITION),
        ("σ of roll", roll, ANGLE),
        ("σ of pitch", pitch, ANGLE),
        ("σ of heading", heading, ANGLE),
    ] {
        allowed
            .check(value)
            .map_err(|fault| format!("{name} = {value}: {fault}"))?;
    }
    let sigma = OrientationSigma {
        position_m: [east, north, down],
        angles_rad: [pitch, roll, heading].map(|minutes| (minutes / 60.0).to_radians()),
    };
    Ok((time, sigma))
}
