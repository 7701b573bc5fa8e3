//! A record of an SBET file ("smoothed best estimate of trajectory").

use super::clock::WeekCount;
use super::sample::{
    Allowed, Attitude, HEADING, HEIGHT, LATITUDE, LONGITUDE, PITCH, ROLL, SECONDS_OF_WEEK, Sample,
    numbers_of,
};

/// Numbers of a record: time, latitude, longitude, height, velocity (3), roll, pitch, platform
/// heading, wander angle, acceleration (3), angular rate (3); `f64`, little endian.
const NUMBERS: usize = 17;

/// Size of a record, bytes.
pub(super) const BYTES: usize = NUMBERS * size_of::<f64>();

/// A record as it stands in the file.
pub(super) type Bytes = [u8; BYTES];

/// Wander angles.
const WANDER: Allowed = HEADING;

/// Returns the sample of a record.
///
/// # Model
/// The angles are those of a body with the axes forward, right and down against north, east and
/// down, with `heading = platform heading - wander angle`. Velocities are not used: their axes
/// differ between the programs that write such files.
///
/// # Errors
/// The sentence for the user, without file and record.
pub(super) fn sample(bytes: &Bytes, weeks: &mut WeekCount) -> Result<Sample, String> {
    let [
        seconds,
        latitude,
        longitude,
        height_m,
        _,
        _,
        _,
        roll_rad,
        pitch_rad,
        heading,
        wander,
        ..,
    ]: [f64; NUMBERS] = numbers_of(bytes);
    for (name, value, allowed) in [
        ("time", seconds, SECONDS_OF_WEEK),
        ("latitude", latitude, LATITUDE),
        ("longitude", longitude, LONGITUDE),
        ("height", height_m, HEIGHT),
        ("roll", roll_rad, ROLL),
        ("pitch", pitch_rad, PITCH),
        ("platform heading", heading, HEADING),
        ("wander angle", wander, WANDER),
    ] {
        allowed
            .check(value)
            .map_err(|fault| format!("{name} = {value}: {fault}"))?;
    }
    Ok(Sample {
        time_s: weeks.time_s(seconds),
        place: [latitude, longitude, height_m],
        attitude: Attitude {
            pitch_rad,
            roll_rad,
            yaw_rad: wander - heading,
        },
        sigma: None,
    })
}
