//! Messages of the link.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use super::after_reset::AfterReset;
use super::packet::Packet;
use super::records_in_flash::RecordsInFlash;
pub use super::refusal::Refusal;
use super::{MAX_GRID_PART, MAX_OBSERVATIONS, MAX_PART, MAX_POINTS, PROTOCOL_VERSION};
use crate::flight::bring_up::{EdgeCounts, LineLevels, Trial, TrialReport};
use crate::flight::calibration_id::CalibrationId;
use crate::flight::clock_drift::ClockDrift;
use crate::flight::controller::state::State;
use crate::flight::controller::{self, Counts};
use crate::flight::event::Event;
use crate::flight::exposure::Exposure;
use crate::flight::findings::{Findings, LastFinding};
use crate::flight::frame_record::FrameRecord;
use crate::flight::in_doubt::InDoubt;
use crate::flight::interior_orientation::InteriorOrientation;
use crate::flight::rig::{RigAnswer, RigStep};
use crate::flight::settings::FlightSettings;
use crate::geometry::estimation::fit::Fit;
use crate::geometry::estimation::observation::Observation;
use crate::geometry::estimation::options::FitOptions;
use crate::geometry::frame_correction::Corrected;
use crate::geometry::grid::GridCarrier;
use crate::geometry::mesh::format::{MAX_WORD_BYTES, MeshFormat};
use crate::geometry::mesh::pixel_correction::PixelCorrection;
use crate::geometry::mesh::vertex::VertexRow;
use crate::geometry::sensor::SensorPoint;
use crate::io::instruments::WireBytes;
use crate::io::instruments::counters::InstrumentCounters;
use crate::io::store::{NothingStored, StoreOrder, StoredIdentity};

/// A batch of points.
pub type Points = Vec<SensorPoint, MAX_POINTS>;

/// A row of a warp engine's mesh, as the engine stores it.
pub type MeshBytes = Vec<u8, { MAX_POINTS * MAX_WORD_BYTES }>;

/// A batch of observations.
pub type Observations = Vec<Observation<f32>, MAX_OBSERVATIONS>;

/// Number of a request, and of its session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header {
    /// Number chosen by the PC when it connects; 0 belongs to no session.
    pub session: u32,
    /// One more than that of the last request; after 65535 comes 0.
    pub sequence: u16,
}

/// A request of the PC to the camera.
// Batches are the link's purpose, and determine the size of this type; a box would need a heap.
#[allow(clippy::large_enum_variant, reason = "no heap")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Starts a session; ends another that is open, and the current frame with it.
    Connect,
    /// Announces the parameters of a camera, which replace calibration, mechanism, shutter and
    /// limits once they are complete ([`super::loading`]). Ends a load that is under way.
    BeginLoad {
        /// Number of bytes, 1 to [`CALIBRATION_CAPACITY`](super::CALIBRATION_CAPACITY).
        length: u32,
        /// Their CRC-32.
        crc: u32,
        /// `true` if the flight that the camera is prepared for goes on with the calibration, which
        /// has to fit its settings; otherwise it ends, and has to be prepared anew.
        keeps_flight: bool,
    },
    /// Predicts a frame; the points that follow belong to it.
    Expose(Exposure),
    /// Reads the interior orientation of the current frame.
    InteriorOrientation,
    /// Corrects measured points.
    Correct(Points),
    /// Distorts ideal points.
    Distort(Points),
    /// The next part of the parameters announced.
    LoadPart(Part),
    /// Reads the digest of a grid of corrected points.
    Digest(Grid),
    /// Reads the counts of the link since the camera started.
    Counters,
    /// Starts the camera again; a volatile calibration is lost unless the camera is prepared.
    Reset(Ending),
    /// Switches the camera off, if it can.
    PowerOff(Ending),
    /// Starts an adjustment of the five coefficients; ends another.
    StartFit(FitOptions),
    /// Adds observations to the adjustment.
    Observe(Observations),
    /// Reads the coefficients of all observations so far. The calibration stays as it is.
    Fit,
    /// Prepares the camera for flight, in standby, with the loaded calibration. No record of an
    /// earlier flight may be left unacknowledged.
    Prepare(FlightSettings),
    /// Runs one round of the control loop on a test rig.
    Rig(RigStep),
    /// Reads the oldest frame record with this number or a higher one.
    FrameRecord(u32),
    /// Acknowledges all frame records up to this one, which are safe on the PC: the camera forgets
    /// them. What it forgot earlier may be acknowledged again.
    Acknowledge(FetchedRecord),
    /// Reads the state of the camera.
    Status,
    /// Makes the last exposed frame of the flight the current one; the points that follow belong to
    /// it.
    Flown,
    /// Passes on an event, now: a command, or the measurement of another instrument
    /// ([`Event::is_told`]).
    Tell(Event),
    /// Computes a row of a warp engine's mesh for the current frame, up to [`MAX_POINTS`] vertices.
    Mesh(VertexRow, MeshFormat),
    /// Computes the positions at which the vertices of a row of the recorded image are to be drawn,
    /// for the current frame, up to [`MAX_POINTS`].
    Corrections(VertexRow),
    /// Runs one round of the control loop on a test rig whose receiver and autopilot have wires of
    /// their own, on which so many bytes have been sent since the camera was prepared.
    Wired(RigStep, WireBytes),
    /// Asks for the counters of the wires of receiver and autopilot.
    Instruments,
    /// Announces the file of a residual grid, which comes before the parameters that state it and
    /// is not in use until they are ([`super::loading`]). Ends a load that is under way.
    BeginGrid {
        /// Part of the camera that carries it.
        carrier: GridCarrier,
        /// Number of bytes, 1 to [`MAX_FILE_BYTES`](crate::geometry::grid::MAX_FILE_BYTES).
        length: u32,
        /// CRC-32 with which the file ends.
        crc: u32,
    },
    /// The next part of the grid announced.
    GridPart(Part<MAX_GRID_PART>),
    /// Opens a session for reading beside the open one, which goes on; ends another for reading. It
    /// takes [`Self::Counters`], [`Self::Instruments`], [`Self::Status`], [`Self::FrameRecord`],
    /// [`Self::Acknowledge`], [`Self::Stored`] and [`Self::Inputs`], in any order and as often as
    /// wanted.
    ConnectReading,
    /// Stores the calibration in use, with its residual grids, under this origin and signature: in
    /// standby alone, with the supply good. A flight that the camera is prepared for goes on; of a
    /// camera that is not, no record may be left unacknowledged. Grids that were uploaded and are
    /// not in use are gone. The answer takes as long as the erasure of a sector, some seconds.
    Store(StoreOrder),
    /// Reads what is stored, as the start has found it or the last store has left it.
    Stored,
    /// Reads levels of the lines, counts of their edges, and the last trial: also before a camera
    /// is loaded.
    Inputs,
    /// Tries mechanism or shutter, bounded in size and time, on a camera that is not prepared
    /// ([`bring_up`](crate::flight::bring_up)). [`Self::Inputs`] tells what comes of it.
    Try(Trial),
}

/// Way in which a camera is started again or switched off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// Refused while the camera is armed or flies, and while frame records are not acknowledged.
    Orderly,
    /// Whatever is lost.
    Forced,
}

/// A frame record that the PC has fetched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FetchedRecord {
    /// Its number.
    pub sequence: u32,
    /// Its CRC-32, by [`super::digest::of_frame_record`].
    pub crc: u32,
}

/// An answer of the camera.
#[allow(clippy::large_enum_variant, reason = "no heap")]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// The session is open.
    Connected(Identity),
    /// The parameters are complete: the calibration is in use. A camera that was prepared is to be
    /// prepared again, unless the load keeps its flight.
    Loaded(CalibrationId),
    /// The frame, predicted or read again.
    InteriorOrientation(InteriorOrientation),
    /// The points, in order, with the distortion as evaluated before the subtraction.
    Points(Vec<Corrected, MAX_POINTS>),
    /// So many bytes of the parameters have come; the calibration before is in use.
    Loading(u32),
    /// The digest, by [`super::digest::of_grid`].
    Digest(u32),
    /// The counts of the link.
    Counters(Counters),
    /// The request will be carried out once this answer has left.
    Ending,
    /// The request is refused.
    Refused(Refusal),
    /// Number of points in the adjustment.
    Observed(u32),
    /// The five coefficients, with their precision.
    Fitted(Fit<f32>),
    /// The camera is prepared for flight.
    Prepared,
    /// Outputs of the camera in a round.
    Rig(RigAnswer),
    /// A frame record with its CRC-32, by [`super::digest::of_frame_record`]; `None` if there is
    /// none yet.
    FrameRecord(Option<(FrameRecord, u32)>),
    /// Number of frame records that are left.
    Kept(u32),
    /// State of the camera.
    Status(Status),
    /// Number and interior orientation of the frame that is the current one now.
    Flown(u32, InteriorOrientation),
    /// The event is queued for the next round of the control loop.
    Told,
    /// The row's vertices, in order.
    Mesh(MeshBytes),
    /// The corrections of the row's vertices, corrected - recorded, in order.
    Corrections(Vec<PixelCorrection, MAX_POINTS>),
    /// The counters of the wires of receiver and autopilot.
    Instruments(InstrumentCounters),
    /// The residual grid is complete and sound: parameters may state it.
    GridLoaded(GridCarrier),
    /// The calibration that is stored, or what is wrong with either slot.
    Stored(Result<StoredIdentity, NothingStored>),
    /// Levels of the lines, counts of their edges, and the last trial.
    Inputs(Inputs),
}

/// Lines of a board, for its bring-up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Inputs {
    /// Levels of the lines; `None` for a board that does not tell them.
    pub lines: Option<LineLevels>,
    /// `true` if the limit switch at the negative end counts as closed.
    pub limit_low: bool,
    /// `true` if the one at the positive end does.
    pub limit_high: bool,
    /// `true` if the supply is low.
    pub supply_low: bool,
    /// Counts of edges since the start.
    pub edges: EdgeCounts,
    /// Position of the stage, mm from the encoder's zero; `None` without a reading.
    pub offset_mm: Option<f32>,
    /// Drift of the camera's clock by the time pulses; `None` before it is measured.
    pub clock_drift: Option<ClockDrift>,
    /// The last trial, which may be under way; `None` before the first.
    pub trial: Option<TrialReport>,
}

/// The reason why the camera runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// It was switched on.
    PowerOn,
    /// It was restarted on request: by a message, by a debugger, or by the reset button.
    Requested,
    /// Its watchdog was not fed.
    Watchdog,
    /// A fault of processor or memory.
    Fault,
    /// Its stack was full.
    StackOverflow,
}

impl ResetCause {
    /// Returns the controller's start for a camera whose encoder counts on through an orderly
    /// start.
    #[must_use]
    pub const fn counting_on(self) -> controller::Start {
        match self {
            Self::PowerOn | Self::Requested => controller::Start::Orderly,
            Self::Watchdog | Self::Fault | Self::StackOverflow => controller::Start::AfterWatchdog,
        }
    }

    /// Returns the controller's start for a camera whose encoder counts from the stage's position
    /// at the start.
    #[must_use]
    pub const fn unreferenced(self) -> controller::Start {
        match self {
            Self::PowerOn | Self::Requested => controller::Start::Unreferenced,
            Self::Watchdog | Self::Fault | Self::StackOverflow => controller::Start::AfterWatchdog,
        }
    }
}

/// Identity of the camera.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of `fmc-camera`.
    pub version: String<16>,
    /// Build of that version.
    pub build: String<40>,
    /// Name of the board.
    pub board: String<24>,
    /// `true` if the camera can switch itself off.
    pub power_switch: bool,
    /// The reason why it runs.
    pub reset_cause: ResetCause,
    /// Points in one message.
    pub max_points: u16,
    /// The calibration in use.
    pub calibration: Option<CalibrationId>,
    /// Number of the start, and what it has made of a flight that the reset has ended.
    pub after_reset: AfterReset,
}

impl Identity {
    /// Returns the identity of a camera that has just started. Names that are too long are left
    /// empty.
    #[must_use]
    pub fn new(build: &str, board: &str, power_switch: bool, reset_cause: ResetCause) -> Self {
        Self {
            version: String::try_from(env!("CARGO_PKG_VERSION")).unwrap_or_default(),
            build: String::try_from(build).unwrap_or_default(),
            board: String::try_from(board).unwrap_or_default(),
            power_switch,
            reset_cause,
            #[expect(clippy::cast_possible_truncation, reason = "64 fits")]
            max_points: MAX_POINTS as u16,
            calibration: None,
            after_reset: AfterReset::FIRST,
        }
    }
}

/// State of a camera in flight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status {
    /// State of the controller.
    pub state: State,
    /// Counts since it was prepared.
    pub counts: Counts,
    /// Records that have not been acknowledged.
    pub kept: u32,
    /// `true` if the encoder has lost its place.
    pub is_place_lost: bool,
    /// Position of the stage in the last round, mm along the FMC axis from the encoder's zero, also
    /// while its place is lost; `None` on a test rig, or if it could not be read.
    pub offset_mm: Option<f32>,
    /// Root mean square of the stage's following error over about a second, µm, within 6 %.
    pub following_rms_um: f32,
    /// Counts of the findings of the aircraft's instruments since it was prepared.
    pub findings: Findings,
    /// The last of these findings; `None` if there was none.
    pub last_finding: Option<LastFinding>,
    /// Drift of the camera's clock by the time pulses; `None` before it is measured.
    pub clock_drift: Option<ClockDrift>,
    /// The calibration in use; `None` if it has no identity.
    pub calibration: Option<CalibrationId>,
    /// Place of the index mark by its last crossing, mm along the FMC axis from the calibrated
    /// position; `None` before the first, or without a mark.
    pub index_mm: Option<f32>,
    /// Exposures that crossings of the index mark have left in doubt, with those between; `None` if
    /// there are none.
    pub in_doubt: Option<InDoubt>,
    /// Number of the start, and what it has made of a flight that the reset has ended.
    pub after_reset: AfterReset,
    /// Copies of the records in flash, which a loss of the supply leaves.
    pub in_flash: RecordsInFlash,
}

/// A part of a camera's parameters, or of a residual grid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part<const CAPACITY: usize = MAX_PART> {
    /// CRC-32 of the whole, as announced.
    pub crc: u32,
    /// Offset of the part, bytes.
    pub offset: u32,
    /// Its bytes.
    pub bytes: Vec<u8, CAPACITY>,
}

/// The crossings of columns and rows, row by row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Grid {
    /// Columns, x in the sensor frame, mm.
    pub x_mm: Vec<f32, MAX_POINTS>,
    /// Rows, y in the sensor frame, mm.
    pub y_mm: Vec<f32, MAX_POINTS>,
}

impl Grid {
    /// The points: x first.
    pub fn points(&self) -> impl Iterator<Item = SensorPoint> {
        let row = |y_mm| move |x_mm: &f32| SensorPoint::new(*x_mm, y_mm);
        self.y_mm
            .iter()
            .flat_map(move |y_mm| self.x_mm.iter().map(row(*y_mm)))
    }
}

/// Counts of the link since the camera started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Requests acted on.
    pub done: u32,
    /// Requests refused by the camera: bad calibration, exposure or points.
    pub refused: u32,
    /// Requests answered again from memory.
    pub repeated: u32,
    /// Packets that ended too early.
    pub truncated: u32,
    /// Packets too long.
    pub oversized: u32,
    /// Packets with a wrong CRC.
    pub wrong_crc: u32,
    /// Packets of another protocol version.
    pub other_protocol: u32,
    /// Whole packets that hold no request.
    pub unknown: u32,
    /// Requests of a session that is not open.
    pub other_session: u32,
    /// Requests out of order.
    pub out_of_order: u32,
    /// Bytes lost because the camera did not take them in time.
    pub overrun_bytes: u32,
    /// Largest part of the stack in use, bytes.
    pub stack_used_bytes: u32,
}

/// The reason why not even the header of a payload can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unreadable {
    /// Its first byte is this version, not [`PROTOCOL_VERSION`].
    OtherProtocol(u8),
    /// It has no header.
    NoHeader,
}

impl Request {
    /// Writes the request into `packet`; `None` if it were longer than a packet can be.
    pub fn write(&self, header: Header, packet: &mut Packet) -> Option<()> {
        write(self, header, packet)
    }

    /// Reads a request; its body is `None` if the bytes after the header are not exactly one
    /// request.
    ///
    /// # Errors
    /// [`Unreadable`] for another protocol version, and for bytes without a header.
    pub fn read(payload: &[u8]) -> Result<(Header, Option<Self>), Unreadable> {
        read(payload)
    }
}

impl Answer {
    /// Writes the answer as [`Request::write`].
    pub fn write(&self, header: Header, packet: &mut Packet) -> Option<()> {
        write(self, header, packet)
    }

    /// Reads an answer as [`Request::read`].
    ///
    /// # Errors
    /// [`Unreadable`] for another protocol version, and for bytes without a header.
    pub fn read(payload: &[u8]) -> Result<(Header, Option<Self>), Unreadable> {
        read(payload)
    }
}

/// Writes a body into `packet`; `None` if it were longer than a packet can be.
pub(super) fn write(body: &impl Serialize, header: Header, packet: &mut Packet) -> Option<()> {
    packet.fill(&(PROTOCOL_VERSION, header, body))
}

fn read<'a, Body: Deserialize<'a>>(
    payload: &'a [u8],
) -> Result<(Header, Option<Body>), Unreadable> {
    let (header, (body, is_whole)) = header(payload).map(|(header, rest)| (header, body(rest)))?;
    Ok((header, body.ok().filter(|_| is_whole)))
}

/// Reads the header of a message. Returns it with the bytes of the body.
pub(super) fn header(payload: &[u8]) -> Result<(Header, &[u8]), Unreadable> {
    let (version, rest) = payload.split_first().ok_or(Unreadable::NoHeader)?;
    if *version != PROTOCOL_VERSION {
        return Err(Unreadable::OtherProtocol(*version));
    }
    postcard::take_from_bytes(rest).map_err(|_| Unreadable::NoHeader)
}

/// Reads the body of a message, of nearly a kilobyte, in place; `true` if it is all of the bytes.
#[inline]
pub(super) fn body<'a, Body: Deserialize<'a>>(bytes: &'a [u8]) -> (postcard::Result<Body>, bool) {
    let mut deserializer = postcard::Deserializer::from_bytes(bytes);
    let body = Body::deserialize(&mut deserializer);
    (body, deserializer.finalize().is_ok_and(<[u8]>::is_empty))
}
