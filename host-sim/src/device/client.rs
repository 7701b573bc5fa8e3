//! The PC's end of the link: one request at a time, repeated until it is answered.

use std::io::ErrorKind;
use std::time::{Duration, Instant};

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::estimation::fit::Fit;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::mesh::MeshRow;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::io::link::message::{
    Answer, CalibrationIdentity, Counters, Grid, Header, Identity, Observations, Points, Refusal,
    Request, Unreadable,
};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};

use super::link_error::{Heard, LinkError};
use super::port::Port;

/// Longest wait for an answer: the longest message is 11 ms on the wire at 921,600 baud, and the
/// camera's longest work, showing a calibration to be one-to-one, takes some milliseconds.
pub const ANSWER_WITHIN: Duration = Duration::from_secs(1);

/// Number of times a request is sent before it is given up. The camera answers a request that it
/// has already obeyed from its memory.
pub const TRIES: u32 = 5;

/// Result of listening within a time limit.
#[allow(clippy::large_enum_variant, reason = "one at a time")]
enum Listened {
    /// No answer to the request.
    Nothing,
    /// The answer.
    Answer(Answer),
    /// An answer of a kind that this program does not know.
    Unknown,
}

/// A conversation with a camera.
///
/// Once a request has failed by anything but a refusal, the camera's state is unknown: every later
/// request fails alike, until [`Self::connect`] opens another session.
#[derive(Debug)]
pub struct Client<P> {
    port: P,
    receiver: PacketReceiver,
    last: Header,
    frame: Packet,
    /// Number of times the last request was repeated.
    repeats: u32,
    given_up: Option<LinkError>,
}

impl<P: Port> Client<P> {
    /// Returns a client before its first session.
    #[must_use]
    pub const fn new(port: P) -> Self {
        Self {
            port,
            receiver: PacketReceiver::new(),
            last: Header {
                session: 0,
                sequence: 0,
            },
            frame: Packet::EMPTY,
            repeats: 0,
            given_up: None,
        }
    }

    /// Opens a session under a random number; it ends any other that the camera has open.
    ///
    /// # Errors
    /// [`LinkError`], as for every request.
    pub fn connect(&mut self) -> Result<Identity, LinkError> {
        self.given_up = None;
        self.last = Header {
            session: fastrand::u32(1..),
            // The first request has the number after this one: 0.
            sequence: u16::MAX,
        };
        match self.ask(&Request::Connect)? {
            Answer::Connected(identity) => Ok(identity),
            _ => Err(self.unexpected(&Request::Connect)),
        }
    }

    /// Replaces the camera's calibration, mechanism, shutter and limits.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where the calibration is not usable.
    pub fn load(&mut self, record: &CameraParameters) -> Result<CalibrationIdentity, LinkError> {
        let request = Request::Load(*record);
        match self.ask(&request)? {
            Answer::Loaded(calibration) => Ok(calibration),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Predicts a frame.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where the exposure cannot be taken.
    pub fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, LinkError> {
        self.predicted(&Request::Expose(*exposure))
    }

    /// Returns the interior orientation of the current frame.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where there is none.
    pub fn interior_orientation(&mut self) -> Result<InteriorOrientation, LinkError> {
        self.predicted(&Request::InteriorOrientation)
    }

    fn predicted(&mut self, request: &Request) -> Result<InteriorOrientation, LinkError> {
        match self.ask(request)? {
            Answer::InteriorOrientation(interior) => Ok(interior),
            _ => Err(self.unexpected(request)),
        }
    }

    /// Corrects a batch of measured points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a point off the sensor.
    pub fn correct(&mut self, measured: Points) -> Result<Vec<Corrected>, LinkError> {
        let asked = measured.len();
        self.points(&Request::Correct(measured), asked)
    }

    /// Distorts a batch of ideal points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a point that has no measured one.
    pub fn distort(&mut self, ideal: Points) -> Result<Vec<Corrected>, LinkError> {
        let asked = ideal.len();
        self.points(&Request::Distort(ideal), asked)
    }

    fn points(&mut self, request: &Request, asked: usize) -> Result<Vec<Corrected>, LinkError> {
        match self.ask(request)? {
            Answer::Points(points) if points.len() == asked => Ok(points.to_vec()),
            _ => Err(self.unexpected(request)),
        }
    }

    /// Returns the distortion along a row of the sensor.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a row that leaves the sensor.
    pub fn row(&mut self, row: MeshRow) -> Result<Vec<Displacement>, LinkError> {
        let request = Request::Row(row);
        match self.ask(&request)? {
            Answer::Row(row_answered) if row_answered.len() == usize::from(row.count) => {
                Ok(row_answered.to_vec())
            }
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the digest of a grid of corrected points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a grid that leaves the sensor.
    pub fn digest(&mut self, grid: &Grid) -> Result<u32, LinkError> {
        let request = Request::Digest(grid.clone());
        match self.ask(&request)? {
            Answer::Digest(digest) => Ok(digest),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Starts an adjustment of the five coefficients.
    ///
    /// # Errors
    /// [`LinkError::Refused`] without a calibration.
    pub fn start_fit(&mut self, options: FitOptions) -> Result<(), LinkError> {
        let request = Request::StartFit(options);
        match self.ask(&request)? {
            Answer::Observed(0) => Ok(()),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Adds observations to the adjustment and returns its number of points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for an observation that is not believable.
    pub fn observe(&mut self, observations: Observations) -> Result<u32, LinkError> {
        let request = Request::Observe(observations);
        match self.ask(&request)? {
            Answer::Observed(points) => Ok(points),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the coefficients of all observations so far.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where they do not determine them.
    pub fn fit(&mut self) -> Result<Fit<f32>, LinkError> {
        match self.ask(&Request::Fit)? {
            Answer::Fitted(fit) => Ok(fit),
            _ => Err(self.unexpected(&Request::Fit)),
        }
    }

    /// Returns a row of a warp engine's mesh, as the engine stores it.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a vertex without a source, or with one that the format does not hold.
    pub fn mesh(&mut self, row: VertexRow, format: MeshFormat) -> Result<Vec<u8>, LinkError> {
        let request = Request::Mesh(row, format);
        match self.ask(&request)? {
            Answer::Mesh(bytes) if bytes.len() == usize::from(row.count) * format.bytes() => {
                Ok(bytes.to_vec())
            }
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the displacements with which the vertices of a row of the recorded image are to be
    /// drawn, corrected - recorded.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a vertex off the image.
    pub fn corrections(&mut self, row: VertexRow) -> Result<Vec<PixelCorrection>, LinkError> {
        let request = Request::Corrections(row);
        match self.ask(&request)? {
            Answer::Corrections(corrections) if corrections.len() == usize::from(row.count) => {
                Ok(corrections.to_vec())
            }
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the counters that the camera's end of the link has kept since it started.
    ///
    /// # Errors
    /// [`LinkError`], as for every request.
    pub fn counters(&mut self) -> Result<Counters, LinkError> {
        match self.ask(&Request::Counters)? {
            Answer::Counters(counters) => Ok(counters),
            _ => Err(self.unexpected(&Request::Counters)),
        }
    }

    /// Starts the camera again; the session ends. If the answer was lost, [`Identity::start`] of
    /// the next connection tells whether the reset was done.
    ///
    /// # Errors
    /// [`LinkError`], as for every request.
    pub fn reset(&mut self) -> Result<(), LinkError> {
        self.ending(&Request::Reset)
    }

    /// Switches the camera off; the session ends.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where it cannot.
    pub fn power_off(&mut self) -> Result<(), LinkError> {
        self.ending(&Request::PowerOff)
    }

    fn ending(&mut self, request: &Request) -> Result<(), LinkError> {
        match self.ask(request) {
            Ok(Answer::Ending) => {
                self.given_up = Some(LinkError::SessionEnded);
                Ok(())
            }
            // The answer was lost, and the repeated request met a camera that had already obeyed
            // the first.
            Err(LinkError::SessionEnded | LinkError::Closed) if self.repeats > 0 => Ok(()),
            Ok(_) => Err(self.unexpected(request)),
            Err(error) => Err(error),
        }
    }

    pub(super) fn unexpected(&mut self, request: &Request) -> LinkError {
        let error = LinkError::Unexpected {
            request: name(request),
        };
        self.given_up = Some(error);
        error
    }

    /// Sends a request and returns its answer; a refusal is an error.
    pub(super) fn ask(&mut self, request: &Request) -> Result<Answer, LinkError> {
        if let Some(error) = self.given_up {
            return Err(error);
        }
        let answer = self.converse(request);
        if let Err(error) = &answer
            && !matches!(error, LinkError::Refused { .. })
        {
            self.given_up = Some(*error);
        }
        answer
    }

    fn converse(&mut self, request: &Request) -> Result<Answer, LinkError> {
        let unexpected = LinkError::Unexpected {
            request: name(request),
        };
        // Each sequence number is used once: to a number that it knows the camera repeats its
        // earlier answer.
        self.last.sequence = self.last.sequence.wrapping_add(1);
        let header = self.last;
        request.write(header, &mut self.frame).ok_or(unexpected)?;
        let mut heard = Heard::default();
        for repeats in 0..TRIES {
            self.repeats = repeats;
            let deadline = Instant::now() + ANSWER_WITHIN;
            match self.port.send(self.frame.bytes()) {
                Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                sent => sent?,
            }
            return match self.listen(header, deadline, &mut heard)? {
                Listened::Nothing => continue,
                Listened::Answer(Answer::Refused(Refusal::OtherSession)) => {
                    Err(LinkError::SessionEnded)
                }
                // Such a refusal does not tell whether the camera has obeyed the request.
                Listened::Answer(Answer::Refused(
                    Refusal::OutOfOrder { .. } | Refusal::Unknown,
                )) => Err(unexpected),
                Listened::Answer(Answer::Refused(refusal)) => Err(LinkError::Refused {
                    request: name(request),
                    refusal,
                }),
                Listened::Answer(answer) => Ok(answer),
                Listened::Unknown => Err(unexpected),
            };
        }
        Err(LinkError::NoAnswer {
            request: name(request),
            tries: TRIES,
            heard,
        })
    }

    /// Waits for the answer with this header.
    fn listen(
        &mut self,
        header: Header,
        deadline: Instant,
        heard: &mut Heard,
    ) -> Result<Listened, LinkError> {
        let mut buffer = [0; 2048];
        loop {
            let count = self.port.receive(&mut buffer, deadline)?;
            if count == 0 {
                return Ok(Listened::Nothing);
            }
            heard.bytes += count;
            for byte in buffer.get(..count).unwrap_or_default() {
                let Some(Ok(payload)) = self.receiver.receive(*byte) else {
                    continue;
                };
                match Answer::read(payload) {
                    Err(Unreadable::OtherProtocol(version)) => {
                        return Err(LinkError::OtherProtocol(version));
                    }
                    Ok((answered, answer)) if answered == header => {
                        if answer.is_none() && is_echo(payload, self.frame.bytes()) {
                            return Err(LinkError::Echo);
                        }
                        return Ok(answer.map_or(Listened::Unknown, Listened::Answer));
                    }
                    // Answers to an earlier session or request.
                    Ok(_) | Err(Unreadable::NoHeader) => heard.others += 1,
                }
            }
            if Instant::now() >= deadline {
                return Ok(Listened::Nothing);
            }
        }
    }
}

/// Returns true if a payload is that of the frame that was sent.
fn is_echo(payload: &[u8], frame: &[u8]) -> bool {
    let mut receiver = PacketReceiver::new();
    frame
        .iter()
        .any(|byte| matches!(receiver.receive(*byte), Some(Ok(sent)) if sent == payload))
}

/// Name of a request in messages.
const fn name(request: &Request) -> &'static str {
    match request {
        Request::Connect => "connect",
        Request::Load(_) => "load calibration",
        Request::Expose(_) => "expose",
        Request::InteriorOrientation => "frame record",
        Request::Correct(_) => "correct",
        Request::Distort(_) => "distort",
        Request::Row(_) => "row",
        Request::Digest(_) => "digest",
        Request::Counters => "counters",
        Request::Reset => "reset",
        Request::PowerOff => "power off",
        Request::StartFit(_) => "start fit",
        Request::Observe(_) => "observe",
        Request::Fit => "fit",
        Request::Prepare(_) => "prepare",
        Request::Rig(_) => "rig",
        Request::FrameRecord(_) => "frame record",
        Request::Acknowledge(_) => "acknowledge",
        Request::Status => "status",
        Request::Flown => "flown",
        Request::Tell(_) => "tell",
        Request::Mesh(..) => "mesh",
        Request::Corrections(_) => "corrections",
        Request::Wired(..) => "wired",
        Request::Instruments => "instruments",
    }
}
