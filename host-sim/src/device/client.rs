//! The PC's end of the link: one request at a time, repeated until it is answered.

use std::io::ErrorKind;
use std::time::{Duration, Instant};

use fmc_camera::io::link::message::{
    Answer, Counters, Ending, Header, Identity, Refusal, Request, Unreadable,
};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};

use super::link_error::{Heard, LinkError};
use super::port::Port;

/// Longest wait for an answer: the longest message is 11 ms on the wire at 921,600 baud, and the
/// camera's longest work, showing a calibration to be one-to-one, takes some milliseconds.
pub const ANSWER_WITHIN: Duration = Duration::from_secs(1);

/// The same of a store: an STM32H743 erases a sector in four seconds at most.
const STORED_WITHIN: Duration = Duration::from_secs(6);

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
        self.open(&Request::Connect)
    }

    /// Opens a session for reading under a random number, beside one that flies the camera; it ends
    /// another for reading.
    ///
    /// # Errors
    /// [`LinkError`], as for every request.
    pub fn connect_reading(&mut self) -> Result<Identity, LinkError> {
        self.open(&Request::ConnectReading)
    }

    fn open(&mut self, request: &Request) -> Result<Identity, LinkError> {
        self.given_up = None;
        self.last = Header {
            session: fastrand::u32(1..),
            // The first request has the number after this one: 0.
            sequence: u16::MAX,
        };
        match self.ask(request)? {
            Answer::Connected(identity) => Ok(identity),
            _ => Err(self.unexpected(request)),
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

    /// Starts the camera again; the session ends. If the answer was lost, [`Identity::reset_cause`]
    /// of the next connection tells whether the reset was done.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where that would lose a flight or its records, unless it is forced.
    pub fn reset(&mut self, ending: Ending) -> Result<(), LinkError> {
        self.ending(&Request::Reset(ending))
    }

    /// Switches the camera off; the session ends.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where it cannot, and as [`Self::reset`].
    pub fn power_off(&mut self, ending: Ending) -> Result<(), LinkError> {
        self.ending(&Request::PowerOff(ending))
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
            let deadline = Instant::now() + answer_within(request);
            match self.port.send(self.frame.bytes()) {
                Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                sent => sent?,
            }
            return match self.listen(header, deadline, &mut heard)? {
                Listened::Nothing => continue,
                Listened::Answer(Answer::Refused(Refusal::OtherSession)) => {
                    Err(LinkError::SessionEnded)
                }
                // Firmware that is older than the request, which changes nothing.
                Listened::Answer(Answer::Refused(refusal @ Refusal::Unknown))
                    if matches!(request, Request::Instruments) =>
                {
                    Err(LinkError::Refused {
                        request: name(request),
                        refusal,
                    })
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

const fn answer_within(request: &Request) -> Duration {
    match request {
        Request::Store(_) => STORED_WITHIN,
        _ => ANSWER_WITHIN,
    }
}

/// Returns true if a payload is that of the frame that was sent.
fn is_echo(payload: &[u8], frame: &[u8]) -> bool {
    let mut receiver = PacketReceiver::new();
    frame
        .iter()
        .any(|byte| matches!(receiver.receive(*byte), Some(Ok(sent)) if sent == payload))
}

/// Name of the requests that load a calibration.
pub(super) const LOAD: &str = "load calibration";

/// Name of the requests that load a residual grid.
pub(super) const LOAD_GRID: &str = "load grid";

/// Name of a request in messages.
const fn name(request: &Request) -> &'static str {
    match request {
        Request::Connect | Request::ConnectReading => "connect",
        Request::BeginLoad { .. } | Request::LoadPart(_) => LOAD,
        Request::Expose(_) => "expose",
        Request::InteriorOrientation => "frame record",
        Request::Correct(_) => "correct",
        Request::Distort(_) => "distort",
        Request::Digest(_) => "digest",
        Request::Counters => "counters",
        Request::Reset(_) => "reset",
        Request::PowerOff(_) => "power off",
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
        Request::Store(_) => "store",
        Request::Stored => "stored",
        Request::Inputs => "inputs",
        Request::Try(_) => "trial",
        Request::BeginGrid { .. } | Request::GridPart(_) => LOAD_GRID,
    }
}
