//! The camera's end of the link: it takes bytes and returns bytes, without clock and port.

use super::deck::{self, FlightDeck, RigDeck};
use super::fitting::Fitting;
use super::loading::Loading;
use super::message::{Answer, Counters, Header, Identity, Part, Refusal, Request, Unreadable};
use super::packet::{Damage, Packet, PacketReceiver};
use super::{batch, digest};
use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::camera::{self, Camera, CameraParameters};
use crate::flight::exposure::Exposure;
use crate::flight::frame_record::FrameRecord;
use crate::flight::interior_orientation::InteriorOrientation;
use crate::flight::rig::RigStep;
use crate::io::instruments::WireBytes;

/// Result of a byte, for the log, and for actions that only the board can carry out.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkEvent {
    /// A packet was damaged on its way. Nothing is answered.
    Lost(Damage),
    /// A whole packet has no header of this version.
    Unreadable(Unreadable),
    /// A session was opened under this number.
    Connected(u32),
    /// A calibration is in use.
    Loaded(CalibrationId),
    /// A frame was predicted.
    Exposed,
    /// Another request was answered.
    Answered,
    /// A request was answered once more.
    Repeated,
    /// A request was refused.
    Refused(Refusal),
    /// The camera is to start again once the answer has left.
    Reset,
    /// The camera is to switch off once the answer has left.
    PowerOff,
}

/// The camera's end of the link.
///
/// The board passes in the bytes that arrive, sends the bytes [to send](Self::to_send), and passes
/// in no further byte before those have left: another request's answer would cut the first short,
/// and the PC would have to ask again.
#[derive(Debug)]
pub struct Station<Deck = RigDeck> {
    receiver: PacketReceiver,
    responder: Responder<Deck>,
}

impl Station {
    /// Returns a station without session and calibration, its camera on a test rig.
    #[must_use]
    pub const fn new(identity: Identity, stack_used_bytes: fn() -> u32) -> Self {
        let deck = RigDeck::after(identity.reset_cause);
        Self::with(identity, stack_used_bytes, deck)
    }
}

impl<Deck: FlightDeck> Station<Deck> {
    /// Returns a station without session and calibration.
    #[must_use]
    pub const fn with(identity: Identity, stack_used_bytes: fn() -> u32, deck: Deck) -> Self {
        Self {
            receiver: PacketReceiver::new(),
            responder: Responder {
                identity,
                stack_used_bytes,
                deck,
                last: None,
                kept: None,
                loading: Loading::NONE,
                frame: None,
                fitting: Fitting::NONE,
                answer: Packet::EMPTY,
                aside: Packet::EMPTY,
                to_send: Which::Answer,
                sent: 0,
                counters: Counters {
                    done: 0,
                    refused: 0,
                    repeated: 0,
                    truncated: 0,
                    oversized: 0,
                    wrong_crc: 0,
                    other_protocol: 0,
                    unknown: 0,
                    other_session: 0,
                    out_of_order: 0,
                    overrun_bytes: 0,
                    stack_used_bytes: 0,
                },
            },
        }
    }

    /// Puts a calibration into use that the board has in its own store, or was built with, as a load over the link does.
    ///
    /// # Errors
    /// [`Refusal`] as of the last part of a load.
    pub fn load(
        &mut self,
        record: &CameraParameters,
        storage: Storage,
    ) -> Result<CalibrationId, Refusal> {
        deck::check_over(&self.responder.deck)?;
        let crc = digest::of_camera(record).ok_or(Refusal::NoRecord)?;
        self.responder.load(*record, crc, storage)
    }

    /// Takes a byte from the wire. Returns an event if the byte ends a packet.
    pub fn receive(&mut self, byte: u8) -> Option<LinkEvent> {
        let event = match self.receiver.receive(byte)? {
            Ok(payload) => self.responder.answer(payload),
            Err(damage) => self.responder.lost(damage),
        };
        Some(event)
    }

    /// The part of the answer that is left to be sent.
    #[must_use]
    pub fn to_send(&self) -> &[u8] {
        let packet = match self.responder.to_send {
            Which::Answer => &self.responder.answer,
            Which::Aside => &self.responder.aside,
        };
        packet
            .bytes()
            .get(self.responder.sent..)
            .unwrap_or_default()
    }

    /// Notes that a number of bytes of [`Self::to_send`] are on their way.
    pub fn sent(&mut self, bytes: usize) {
        self.responder.sent = self.responder.sent.saturating_add(bytes);
    }

    /// Counts bytes that arrived and could not be taken.
    pub fn count_overrun(&mut self, bytes: u32) {
        count_more(&mut self.responder.counters.overrun_bytes, bytes);
    }

    /// The counts of the link since the camera started.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.responder.counters()
    }

    /// The camera in flight.
    pub const fn deck_mut(&mut self) -> &mut Deck {
        &mut self.responder.deck
    }
}

/// The packet that is on its way, of two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Which {
    /// The answer to the last request of the session.
    Answer,
    /// The refusal of a message that is not the next of the session.
    Aside,
}

/// The part that reads requests and writes answers.
#[derive(Debug)]
struct Responder<Deck> {
    identity: Identity,
    stack_used_bytes: fn() -> u32,
    /// The last request of the session that was answered.
    last: Option<Header>,
    /// The request to which the kept answer belongs.
    kept: Option<Header>,
    loading: Loading,
    frame: Option<camera::Frame>,
    /// The camera, in flight or not: everybody borrows it from here.
    deck: Deck,
    fitting: Fitting,
    answer: Packet,
    /// The refusal of a message that is not the next of the session: the answer stays meanwhile,
    /// and can be asked for again.
    aside: Packet,
    to_send: Which,
    sent: usize,
    counters: Counters,
}

impl<Deck: FlightDeck> Responder<Deck> {
    fn lost(&mut self, damage: Damage) -> LinkEvent {
        count(match damage {
            Damage::Truncated => &mut self.counters.truncated,
            Damage::Oversized => &mut self.counters.oversized,
            Damage::Crc => &mut self.counters.wrong_crc,
        });
        LinkEvent::Lost(damage)
    }

    fn answer(&mut self, payload: &[u8]) -> LinkEvent {
        let (header, request) = match Request::read(payload) {
            Ok(message) => message,
            Err(unreadable) => {
                count(match unreadable {
                    Unreadable::OtherProtocol(_) => &mut self.counters.other_protocol,
                    Unreadable::NoHeader => &mut self.counters.unknown,
                });
                if let Unreadable::OtherProtocol(_) = unreadable {
                    // The first byte of the answer tells the sender the version of this protocol.
                    self.refuse_aside(NOBODY, Refusal::OtherProtocol);
                }
                return LinkEvent::Unreadable(unreadable);
            }
        };
        if self.kept == Some(header) {
            self.to_send = Which::Answer;
            self.sent = 0;
            count(&mut self.counters.repeated);
            return LinkEvent::Repeated;
        }
        let connects = matches!(request, Some(Request::Connect));
        if !connects && let Err(refusal) = self.in_order(header) {
            count(match refusal {
                Refusal::OtherSession => &mut self.counters.other_session,
                _ => &mut self.counters.out_of_order,
            });
            self.refuse_aside(header, refusal);
            return LinkEvent::Refused(refusal);
        }
        self.last = Some(header);
        let done = match request {
            Some(request) => self.act(header, &request),
            None => Err(Refusal::Unknown),
        };
        match done {
            Ok((answer, event)) => {
                count(&mut self.counters.done);
                self.send(header, &answer);
                event
            }
            Err(refusal) => {
                count(match refusal {
                    Refusal::Unknown => &mut self.counters.unknown,
                    _ => &mut self.counters.refused,
                });
                self.send(header, &Answer::Refused(refusal));
                LinkEvent::Refused(refusal)
            }
        }
    }

    /// Checks that a request is the next of the open session.
    fn in_order(&self, header: Header) -> Result<(), Refusal> {
        let last = self
            .last
            .filter(|last| last.session == header.session)
            .ok_or(Refusal::OtherSession)?;
        let expected = last.sequence.wrapping_add(1);
        if header.sequence == expected {
            Ok(())
        } else {
            Err(Refusal::OutOfOrder { expected })
        }
    }

    fn act(&mut self, header: Header, request: &Request) -> Result<(Answer, LinkEvent), Refusal> {
        let answer = match request {
            Request::Connect => {
                self.frame = None;
                self.fitting.end();
                self.loading.end();
                let identity = Identity {
                    calibration: self.deck.camera().and_then(Camera::id),
                    ..self.identity.clone()
                };
                return Ok((
                    Answer::Connected(identity),
                    LinkEvent::Connected(header.session),
                ));
            }
            Request::BeginLoad { length, crc } => {
                deck::check_over(&self.deck)?;
                self.loading.begin(*length, *crc)?;
                Answer::Loading(0)
            }
            Request::LoadPart(part) => match self.load_part(part)? {
                Some(id) => return Ok((Answer::Loaded(id), LinkEvent::Loaded(id))),
                None => Answer::Loading(self.loading.received()),
            },
            Request::Expose(exposure) => {
                return Ok((
                    Answer::InteriorOrientation(self.expose(exposure)?),
                    LinkEvent::Exposed,
                ));
            }
            Request::InteriorOrientation => Answer::InteriorOrientation(self.frame()?.interior),
            Request::Correct(measured) => {
                Answer::Points(batch::correct(&self.frame()?.correction, measured)?)
            }
            Request::Distort(ideal) => {
                Answer::Points(batch::distort(&self.frame()?.correction, ideal)?)
            }
            Request::Digest(grid) => {
                deck::check_idle(&self.deck)?;
                let correction = &self.frame()?.correction;
                batch::on_sensor(correction, grid.points())?;
                Answer::Digest(digest::of_grid(correction, grid))
            }
            Request::Counters => Answer::Counters(self.counters()),
            Request::Reset => return Ok((Answer::Ending, LinkEvent::Reset)),
            Request::PowerOff if self.identity.power_switch => {
                return Ok((Answer::Ending, LinkEvent::PowerOff));
            }
            Request::PowerOff => return Err(Refusal::NoPowerSwitch),
            Request::StartFit(options) => {
                deck::check_idle(&self.deck)?;
                Answer::Observed(self.fitting.start(self.deck.camera(), *options)?)
            }
            Request::Observe(observations) => {
                deck::check_idle(&self.deck)?;
                Answer::Observed(self.fitting.observe(self.deck.camera(), observations)?)
            }
            Request::Fit => {
                deck::check_idle(&self.deck)?;
                Answer::Fitted(self.fitting.fit()?)
            }
            Request::Prepare(settings) => {
                deck::prepare(&mut self.deck, settings)?;
                Answer::Prepared
            }
            Request::Rig(step) => self.step(step, None)?,
            Request::Wired(step, sent) => self.step(step, Some(*sent))?,
            Request::Instruments => Answer::Instruments(
                self.deck
                    .instruments()
                    .ok_or(Refusal::NoInstruments)?
                    .counters(),
            ),
            Request::FrameRecord(from) => Answer::FrameRecord(self.frame_record(*from)?),
            Request::Acknowledge(through) => {
                Answer::Kept(deck::acknowledge(&mut self.deck, *through)?)
            }
            Request::Status => Answer::Status(deck::status(&self.deck)?),
            Request::Flown => {
                let (sequence, frame) = deck::latest(&self.deck).ok_or(Refusal::NoFrame)?;
                self.frame = Some(frame);
                Answer::Flown(sequence, frame.interior)
            }
            Request::Tell(event) => {
                self.deck.tell(*event)?;
                Answer::Told
            }
            Request::Mesh(row, format) => {
                Answer::Mesh(batch::mesh(&self.frame()?.correction, row, *format)?)
            }
            Request::Corrections(row) => {
                Answer::Corrections(batch::corrections(&self.frame()?.correction, row)?)
            }
        };
        Ok((answer, LinkEvent::Answered))
    }

    /// Runs a round of a test rig. It is not inlined: two copies of the controller would take twice the stack.
    #[inline(never)]
    fn step(&mut self, step: &RigStep, sent: Option<WireBytes>) -> Result<Answer, Refusal> {
        let answer = self.deck.step(step, sent).ok_or(Refusal::NoRig)??;
        Ok(Answer::Rig(answer))
    }

    fn frame_record(&self, from: u32) -> Result<Option<(FrameRecord, u32)>, Refusal> {
        let record = deck::record(&self.deck, from)?;
        // Every record fits its digest's buffer.
        Ok(record.and_then(|record| Some((record, digest::of_frame_record(&record)?))))
    }

    /// Takes a part; the last puts the calibration into use. Apart, so that reading any request does not need the stack
    /// of this one.
    #[inline(never)]
    fn load_part(&mut self, part: &Part) -> Result<Option<CalibrationId>, Refusal> {
        deck::check_over(&self.deck)?;
        if !self.loading.add(part)? {
            return Ok(None);
        }
        let (record, crc) = self.loading.finish()?;
        self.load(record, crc, Storage::Volatile).map(Some)
    }

    fn load(
        &mut self,
        record: CameraParameters,
        crc: u32,
        storage: Storage,
    ) -> Result<CalibrationId, Refusal> {
        let camera = Camera::identified(record, crc, storage).map_err(Refusal::Calibration)?;
        self.deck.load(camera);
        self.frame = None;
        self.fitting.end();
        Ok(CalibrationId {
            serial: record.serial,
            version: record.version,
            crc,
            storage,
        })
    }

    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, Refusal> {
        let camera = self.deck.camera().ok_or(Refusal::NoCalibration)?;
        // Points that follow a refused exposure must not meet the previous frame.
        self.frame = None;
        let frame = camera.frame(exposure).map_err(Refusal::Exposure)?;
        self.frame = Some(frame);
        Ok(frame.interior)
    }

    fn frame(&self) -> Result<&camera::Frame, Refusal> {
        self.frame.as_ref().ok_or(Refusal::NoFrame)
    }

    fn counters(&self) -> Counters {
        Counters {
            stack_used_bytes: (self.stack_used_bytes)(),
            ..self.counters
        }
    }

    /// Sends a refusal that is not an answer within the session.
    fn refuse_aside(&mut self, header: Header, refusal: Refusal) {
        self.to_send = Which::Aside;
        self.sent = 0;
        // A refusal fits a packet.
        let _ = Answer::Refused(refusal).write(header, &mut self.aside);
    }

    fn send(&mut self, header: Header, answer: &Answer) {
        self.to_send = Which::Answer;
        self.sent = 0;
        self.kept = answer.write(header, &mut self.answer).map(|()| header);
    }
}

/// The header of an answer to a request whose own cannot be read.
pub const NOBODY: Header = Header {
    session: 0,
    sequence: 0,
};

fn count(counter: &mut u32) {
    count_more(counter, 1);
}

/// Adds to a counter, which stops at its largest value.
fn count_more(counter: &mut u32, by: u32) {
    *counter = counter.saturating_add(by);
}
