//! Reasons for which the camera refuses a request.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::{CALIBRATION_CAPACITY, MAX_POINTS};
use crate::flight::bring_up::NotTried;
use crate::flight::camera::FrameError;
use crate::flight::controller::NotExchanged;
use crate::flight::controller::state::State;
use crate::flight::drive::kind::DriveKind;
use crate::flight::grid_memory::GridMemoryError;
use crate::geometry::calibration::CalibrationError;
use crate::geometry::estimation::fit::FitError;
use crate::geometry::grid::{GridCarrier, GridError};
use crate::geometry::inverse::DistortError;
use crate::geometry::mesh::vertex::MeshError;
use crate::geometry::range::OutOfRange;
use crate::io::instruments::WireBytes;
use crate::io::store::NotStored;

/// Why the camera does not do what it is asked for. Nothing has changed, except that after an
/// [`Refusal::Exposure`] there is no frame, and that a load is over whose last part is refused with
/// [`Refusal::LoadCrc`], [`Refusal::NoRecord`], [`Refusal::Calibration`], [`Refusal::Grid`] or
/// [`Refusal::Grids`], and in a flight that is to go on with [`Refusal::OtherMechanism`],
/// [`Refusal::Settings`] or [`Refusal::Travel`]. After [`Refusal::NotStored`] grids that were
/// uploaded and are not in use are gone, and with [`NotStored::Flash`] the slot that it names has
/// been written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The request is of another version of this protocol; the answer's first byte is the camera's
    /// version.
    OtherProtocol,
    /// The bytes are not a request of this version.
    Unknown,
    /// The session is not open: another took its place, or the camera has started again.
    OtherSession,
    /// The request is not the next one of the session.
    OutOfOrder {
        /// The sequence number of the next request.
        expected: u16,
    },
    /// The calibration is not usable; the previous one stays.
    Calibration(CalibrationError),
    /// There is no calibration yet.
    NoCalibration,
    /// The exposure cannot be taken.
    Exposure(FrameError),
    /// There is no frame yet.
    NoFrame,
    /// A measured point, or that of an observation, is not on the sensor.
    OffSensor {
        /// Its index in the batch, row or grid.
        index: u16,
    },
    /// An ideal point has no measured one.
    Distort {
        /// Its index in the batch.
        index: u16,
        /// The reason.
        error: DistortError,
    },
    /// There are more points than fit an answer.
    TooMany,
    /// This camera cannot switch itself off.
    NoPowerSwitch,
    /// No adjustment has been started.
    NoFit,
    /// An observation is out of range.
    Observation {
        /// Its index in the batch.
        index: u16,
        /// The number that is out of range.
        error: OutOfRange,
    },
    /// The observations do not determine the coefficients.
    Fit(FitError),
    /// The camera has not been prepared for flight.
    NotPrepared,
    /// A setting of the flight, or a temperature that is told, is out of its range.
    Settings(OutOfRange),
    /// The mechanism cannot make the travel, or not in the time between triggers.
    Travel(FrameError),
    /// A frame is in flight, or the camera is armed, with compensation or without: calibration and
    /// settings stay, and nothing is begun that lasts longer than a round of the control loop.
    FrameInFlight,
    /// This number of frame records has not been acknowledged, and would be lost.
    RecordsKept(u32),
    /// The camera is not on a test rig: its board has the time.
    NoRig,
    /// The camera is on a test rig: events come with the rig's rounds.
    OnRig,
    /// The camera takes such an event from its own inputs alone, not from a message.
    NotTold,
    /// The queue of the control loop has no place for another event of this kind.
    QueueFull,
    /// The camera has no output that clocks the rows of a TDI sensor.
    NoRowClock,
    /// A vertex of the mesh is off the image, has no source, or has a source that the format cannot
    /// hold.
    Mesh(MeshError),
    /// The firmware was built without the adjustment of the five coefficients.
    NoEstimation,
    /// No camera's parameters have such a length.
    LoadLength {
        /// The length announced, bytes.
        length: u32,
    },
    /// No load is under way.
    NoLoad,
    /// The part is of other parameters than those announced last.
    OtherLoad,
    /// The part is not the next one.
    PartOutOfOrder {
        /// The offset of the next, bytes.
        expected: u32,
    },
    /// The part goes beyond the length announced.
    PartTooLong,
    /// The parameters or the grid are complete, and their CRC-32 is not the one announced.
    LoadCrc {
        /// That of the bytes that have come.
        computed: u32,
    },
    /// The parameters are complete, and no record of a camera.
    NoRecord,
    /// Only so many bytes have come on the wires, or more than were sent. Missing bytes may still
    /// be on their way: the request may be made again.
    OtherBytes(WireBytes),
    /// The camera has no wires of receiver and autopilot.
    NoInstruments,
    /// The camera has no memory for residual grids.
    NoGridMemory,
    /// The file of a residual grid is none, damaged, or too long.
    Grid {
        /// Part as whose grid it was announced.
        carrier: GridCarrier,
        /// The reason.
        error: GridError,
    },
    /// The residual grids that the parameters state have not been loaded, or do not fit the camera;
    /// the calibration before stays in use.
    Grids(GridMemoryError),
    /// Vertices of the recorded image are drawn by the polynomial's differences, which residual
    /// grids do not have.
    PolynomialMesh,
    /// The record is not kept as it was acknowledged: none is forgotten that has not been fetched
    /// as it is now.
    NotFetched {
        /// Its number.
        sequence: u32,
    },
    /// The session is for reading.
    ReadingOnly,
    /// The board has no store for a calibration.
    NoStore,
    /// The camera is in this state, and not in standby.
    NotStandby(State),
    /// The supply is low.
    SupplyLow,
    /// The calibration in use is not stored.
    NotStored(NotStored),
    /// The camera is on a test rig, which has no lines.
    NoInputs,
    /// The trial is refused.
    NotTried(NotTried),
    /// The settings are for this kind of drive, which the board does not have.
    OtherDrive(DriveKind),
    /// The flight under way has another mechanism, a stage or the rows of a TDI sensor: the
    /// calibration before stays.
    OtherMechanism,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherProtocol => f.write_str("it speaks another version of the protocol"),
            Self::Unknown => f.write_str("it does not know the request"),
            Self::OtherSession => f.write_str(
                "the session has ended: another host has connected, or the camera has restarted",
            ),
            Self::OutOfOrder { expected } => {
                write!(
                    f,
                    "the request is out of order: number {expected} is the next"
                )
            }
            Self::Calibration(error) => write!(f, "the calibration is not usable: {error}"),
            Self::NoCalibration => f.write_str("no calibration is loaded"),
            Self::Exposure(error) => error.fmt(f),
            Self::NoFrame => f.write_str("there has been no exposure"),
            Self::OffSensor { index } => write!(f, "point {index} of the batch is off the sensor"),
            Self::Distort { index, error } => write!(f, "point {index} of the batch: {error}"),
            Self::TooMany => write!(f, "more than {MAX_POINTS} points"),
            Self::NoPowerSwitch => f.write_str("it cannot switch itself off"),
            Self::NoFit => f.write_str("no adjustment has been started"),
            Self::Observation { index, error } => {
                write!(f, "observation {index} of the batch: {error}")
            }
            Self::Fit(error) => error.fmt(f),
            Self::NotPrepared => f.write_str("it has not been prepared for flight"),
            Self::Settings(error) => write!(f, "a setting of the flight is refused: {error}"),
            Self::Travel(error) => error.fmt(f),
            Self::FrameInFlight => f.write_str("it is armed or in flight"),
            Self::RecordsKept(count) => {
                write!(f, "{count} frame records have not been acknowledged")
            }
            Self::NoRig => f.write_str("it is not on a test rig"),
            Self::OnRig => f.write_str("it is on a test rig: events come with the rig's rounds"),
            Self::NotTold => f.write_str("it takes such an event from its own inputs alone"),
            Self::QueueFull => f.write_str("too many events wait for its control loop"),
            Self::NoRowClock => {
                f.write_str("it has no output that clocks the rows of a TDI sensor")
            }
            Self::Mesh(error) => error.fmt(f),
            Self::NoEstimation => {
                f.write_str("its firmware was built without the adjustment of coefficients")
            }
            Self::LoadLength { length } => write!(
                f,
                "parameters of {length} bytes are not among 1 to {CALIBRATION_CAPACITY}"
            ),
            Self::NoLoad => f.write_str("no load of a calibration is under way"),
            Self::OtherLoad => f.write_str("the part is of another calibration than announced"),
            Self::PartOutOfOrder { expected } => {
                write!(
                    f,
                    "the part is not the next, which begins at byte {expected}"
                )
            }
            Self::PartTooLong => f.write_str("the part goes beyond the length announced"),
            Self::LoadCrc { computed } => write!(
                f,
                "what was loaded has CRC-32 {computed:08x}, not the one announced"
            ),
            Self::NoRecord => f.write_str("the parameters are not a camera's of this version"),
            Self::OtherBytes(WireBytes {
                receiver,
                autopilot,
            }) => write!(
                f,
                "{receiver} bytes of the receiver and {autopilot} of the autopilot have come, not as many as were sent"
            ),
            Self::NoInstruments => f.write_str("it has no wires of receiver and autopilot"),
            Self::NoGridMemory => f.write_str("it has no memory for residual grids"),
            Self::Grid { carrier, error } => write!(f, "residual grid of the {carrier}: {error}"),
            Self::Grids(error) => error.fmt(f),
            Self::NotFetched { sequence } => {
                write!(f, "record {sequence} has not been fetched as it is kept")
            }
            Self::ReadingOnly => f.write_str("the session is for reading alone"),
            Self::NoStore => f.write_str("it has no store for a calibration"),
            Self::NotStandby(state) => write!(f, "it is in state {state}, not in standby"),
            Self::SupplyLow => f.write_str("its supply is low"),
            Self::NotStored(error) => write!(f, "it does not store the calibration: {error}"),
            Self::PolynomialMesh => f.write_str(
                "vertices of the recorded image cannot be drawn with residual grids: take sources",
            ),
            Self::NoInputs => f.write_str("it is on a test rig, which has no lines"),
            Self::NotTried(error) => error.fmt(f),
            Self::OtherDrive(asked) => write!(
                f,
                "the settings are for {asked}, which its board does not have"
            ),
            Self::OtherMechanism => NotExchanged::OtherMechanism.fmt(f),
        }
    }
}

impl core::error::Error for Refusal {}
