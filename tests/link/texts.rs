//! Texts of refusals and of what has become of a flight, as the PC shows them.

use fmc_camera::flight::bring_up::NotTried;
use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::geometry::estimation::fit::FitError;
use fmc_camera::geometry::grid::{GridCarrier, GridError};
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::mesh::vertex::MeshError;
use fmc_camera::geometry::range::{OutOfRange, Quantity};
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::instruments::WireBytes;
use fmc_camera::io::link::after_reset::{FlightAfterReset, WithoutEyes};
use fmc_camera::io::link::message::Refusal;
use fmc_camera::io::link::{CALIBRATION_CAPACITY, MAX_POINTS};
use fmc_camera::io::store::NotStored;

use crate::controller::texts::assert_texts;

const TOO_FINE: OutOfRange = OutOfRange {
    quantity: Quantity::PixelUm,
    value: 0.25,
    min: 1.0,
    max: 50.0,
};

#[test]
fn refusal_of_a_session_or_of_points_says_why() {
    let too_many = format!("more than {MAX_POINTS} points");
    let off = DistortError::OffSensor(SensorPoint::new(1.0, -2.5));
    let too_few = FitError::TooFew {
        points: 2,
        needed: 5,
    };
    assert_texts(&[
        (
            Refusal::OtherProtocol,
            "it speaks another version of the protocol",
        ),
        (Refusal::Unknown, "it does not know the request"),
        (
            Refusal::OtherSession,
            "the session has ended: another host has connected, or the camera has restarted",
        ),
        (
            Refusal::OutOfOrder { expected: 17 },
            "the request is out of order: number 17 is the next",
        ),
        (Refusal::ReadingOnly, "the session is for reading alone"),
        (Refusal::NoFrame, "there has been no exposure"),
        (
            Refusal::Exposure(FrameError::NotFitted),
            "the camera has no fitted five-coefficient model",
        ),
        (
            Refusal::OffSensor { index: 4 },
            "point 4 of the batch is off the sensor",
        ),
        (
            Refusal::Distort {
                index: 5,
                error: off,
            },
            "point 5 of the batch: its measured point (1.0000, -2.5000) mm is off the sensor",
        ),
        (Refusal::TooMany, &too_many),
        (Refusal::NoFit, "no adjustment has been started"),
        (
            Refusal::Observation {
                index: 6,
                error: TOO_FINE,
            },
            "observation 6 of the batch: pixel_um = 0.25 is outside 1 to 50",
        ),
        (
            Refusal::Fit(too_few),
            "2 points where at least 5 are needed",
        ),
        (
            Refusal::NoEstimation,
            "its firmware was built without the adjustment of coefficients",
        ),
        (
            Refusal::Mesh(MeshError::Spacing {
                row_px: 8,
                mesh_px: 16,
            }),
            "the vertices are 8 px apart, and the mesh was prepared for 16 px",
        ),
        (
            Refusal::PolynomialMesh,
            "vertices of the recorded image cannot be drawn with residual grids: take sources",
        ),
    ]);
}

#[test]
fn refusal_of_a_load_or_a_store_says_why() {
    let length = format!("parameters of 999 bytes are not among 1 to {CALIBRATION_CAPACITY}");
    assert_texts(&[
        (
            Refusal::Calibration(TOO_FINE.into()),
            "the calibration is not usable: pixel_um = 0.25 is outside 1 to 50",
        ),
        (Refusal::NoCalibration, "no calibration is loaded"),
        (Refusal::LoadLength { length: 999 }, &length),
        (Refusal::NoLoad, "no load of a calibration is under way"),
        (
            Refusal::OtherLoad,
            "the part is of another calibration than announced",
        ),
        (
            Refusal::PartOutOfOrder { expected: 128 },
            "the part is not the next, which begins at byte 128",
        ),
        (
            Refusal::PartTooLong,
            "the part goes beyond the length announced",
        ),
        (
            Refusal::LoadCrc {
                computed: 0x00c0_ffee,
            },
            "what was loaded has CRC-32 00c0ffee, not the one announced",
        ),
        (
            Refusal::NoRecord,
            "the parameters are not a camera's of this version",
        ),
        (Refusal::NoGridMemory, "it has no memory for residual grids"),
        (
            Refusal::Grid {
                carrier: GridCarrier::Sensor,
                error: GridError::TooLong { bytes: 99_999 },
            },
            &format!(
                "residual grid of the sensor: {}",
                GridError::TooLong { bytes: 99_999 }
            ),
        ),
        (
            Refusal::Grids(GridMemoryError::Missing {
                carrier: GridCarrier::Lens,
                crc32: 0xab,
            }),
            "the residual grid of the lens with CRC-32 000000ab has not been loaded",
        ),
        (Refusal::NoStore, "it has no store for a calibration"),
        (
            Refusal::NotStandby(State::Degraded(Fault::Encoder)),
            "it is in state degraded: encoder (14), not in standby",
        ),
        (Refusal::SupplyLow, "its supply is low"),
        (
            Refusal::NotStored(NotStored::TooLong),
            "it does not store the calibration: it is longer than a slot",
        ),
    ]);
}

#[test]
fn refusal_of_a_flight_its_events_or_its_records_says_why() {
    let travel = FrameError::Time {
        needed_s: 0.75,
        available_s: 0.5,
    };
    assert_texts(&[
        (Refusal::NoPowerSwitch, "it cannot switch itself off"),
        (Refusal::NotPrepared, "it has not been prepared for flight"),
        (
            Refusal::Settings(TOO_FINE),
            "a setting of the flight is refused: pixel_um = 0.25 is outside 1 to 50",
        ),
        (
            Refusal::Travel(travel),
            "the travel takes 0.7500 s, there are 0.5000 s",
        ),
        (Refusal::FrameInFlight, "it is armed or in flight"),
        (
            Refusal::RecordsKept(3),
            "3 frame records have not been acknowledged",
        ),
        (
            Refusal::NotFetched { sequence: 8 },
            "record 8 has not been fetched as it is kept",
        ),
        (Refusal::NoRig, "it is not on a test rig"),
        (
            Refusal::OnRig,
            "it is on a test rig: events come with the rig's rounds",
        ),
        (Refusal::NoInputs, "it is on a test rig, which has no lines"),
        (
            Refusal::NotTold,
            "it takes such an event from its own inputs alone",
        ),
        (
            Refusal::QueueFull,
            "too many events wait for its control loop",
        ),
        (
            Refusal::NoRowClock,
            "it has no output that clocks the rows of a TDI sensor",
        ),
        (
            Refusal::OtherBytes(WireBytes {
                receiver: 12,
                autopilot: 34,
            }),
            "12 bytes of the receiver and 34 of the autopilot have come, \
             not as many as were sent",
        ),
        (
            Refusal::NoInstruments,
            "it has no wires of receiver and autopilot",
        ),
        (
            Refusal::NotTried(NotTried::NoReading),
            "its encoder gives no reading",
        ),
        (
            Refusal::OtherDrive(DriveKind::PositionCommand),
            "the settings are for a position command with an absolute sensor, \
             which its board does not have",
        ),
        (
            Refusal::OtherMechanism,
            "the flight was prepared for another mechanism: a stage, or rows of a TDI sensor",
        ),
    ]);
}

#[test]
fn fate_of_a_flight_after_a_reset_is_told_in_words() {
    assert_texts(&[
        (FlightAfterReset::Nothing, "no flight"),
        (
            FlightAfterReset::FliesOn,
            "the flight goes on, without force on the stage",
        ),
        (
            FlightAfterReset::StandsBy,
            "the flight is prepared, and not armed",
        ),
        (
            FlightAfterReset::SwitchedOff,
            "the flight does not go on by its settings",
        ),
        (
            FlightAfterReset::ResetAgain,
            "the flight does not go on: resets follow each other",
        ),
        (
            FlightAfterReset::Damaged,
            "what was kept of the flight is damaged",
        ),
        (
            FlightAfterReset::OtherBuild,
            "another build of the firmware has kept the flight",
        ),
        (
            FlightAfterReset::SettingsDamaged,
            "the flight cannot go on: its settings are damaged",
        ),
        (
            FlightAfterReset::NoCalibration,
            "the flight cannot go on: its calibration is gone",
        ),
        (
            FlightAfterReset::NoGrids,
            "the flight cannot go on: its residual grids are gone",
        ),
        (
            FlightAfterReset::NotFlyable,
            "the flight cannot go on: the camera cannot be prepared",
        ),
        (
            FlightAfterReset::FromFlash,
            "the records are from the flash: up to two after them may be missing",
        ),
    ]);
}

#[test]
fn time_without_eyes_is_zero_without_a_flight_and_unknown_while_it_goes_on() {
    let before_clock_ms = 566;
    assert_eq!(WithoutEyes::NoFlight.at_most_ms(), Some(0));
    assert_eq!(WithoutEyes::GoesOn { before_clock_ms }.at_most_ms(), None);
    let ended = |start_up_ms| WithoutEyes::AtMost {
        before_clock_ms,
        start_up_ms,
    };
    assert_eq!(ended(21).at_most_ms(), Some(587));
    assert_eq!(ended(u32::MAX).at_most_ms(), Some(u32::MAX));
}
