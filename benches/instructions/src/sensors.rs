//! Sensors of an aircraft at 50 m/s, 500 m above the ground, with every kind of sensor.

use fmc_camera::flight::event::{AttitudeSample, Event};
use fmc_camera::flight::vh::VhSample;

/// Rounds from one sample of V/H to the next; each of the seven comes ten times a second.
const SAMPLE_ROUNDS: u32 = 14;
/// Rounds from one attitude to the next: 100 Hz.
const ATTITUDE_ROUNDS: u32 = 10;
/// Rounds from one time pulse to the next.
const SECOND_ROUNDS: u32 = 1000;
/// Rounds from a pulse to the message in which the receiver names it.
const NAMED_ROUNDS: u32 = 100;
/// 2026-01-01, µs since 1970.
const START_UNIX_US: u64 = 1_767_225_600_000_000;

/// Attitude in turbulence.
pub(crate) const ATTITUDE: AttitudeSample = AttitudeSample {
    pitch_deg: 1.0,
    roll_deg: -2.0,
    drift_deg: 3.0,
    rates_deg_s: [0.5, -0.5, 0.2],
};

/// Returns a sample of V/H, from each of the seven sources in turn, with changing values.
pub(crate) fn sample(index: u32) -> VhSample {
    let wobble = if (index / 7).is_multiple_of(2) {
        1.0
    } else {
        1.0005
    };
    match index % 7 {
        0 => VhSample::Direct(0.1 * wobble),
        1 => VhSample::GroundSpeed(50.0 * wobble),
        2 => VhSample::InertialSpeed(50.0 * wobble),
        3 => VhSample::HeightAboveGround(500.0 * wobble),
        4 => VhSample::LaserHeight(500.0 * wobble),
        5 => VhSample::Altitude(700.0 * wobble),
        _ => VhSample::TerrainHeight(200.0 * wobble),
    }
}

/// Returns the events of the sensors in a round.
pub(crate) fn events(round: u32) -> [Option<Event>; 3] {
    let comes = |period: u32, at: u32| round % period == at;
    let seconds = u64::from(round / SECOND_ROUNDS);
    [
        comes(SAMPLE_ROUNDS, 0).then(|| Event::Vh(sample(round / SAMPLE_ROUNDS))),
        comes(ATTITUDE_ROUNDS, 0).then_some(Event::Attitude(ATTITUDE)),
        if comes(SECOND_ROUNDS, 0) {
            Some(Event::TimePulse)
        } else if comes(SECOND_ROUNDS, NAMED_ROUNDS) {
            Some(Event::GnssTime(START_UNIX_US + 1_000_000 * seconds))
        } else {
            None
        },
    ]
}
