//! The camera's answers to the requests of a session.

use super::after_reset::AfterReset;
use super::contents::Contents;
use super::deck::{self, FlightDeck};
use super::fitting::Fitting;
use super::flight_keeper::FlightKeeper;
use super::grid_loading::{GridLoading, GridProgress};
use super::link_event::LinkEvent;
use super::loading::Loading;
use super::message::{Answer, Counters, Ending, Header, Identity, Refusal, Request, Unreadable};
use super::packet::Damage;
use super::point_correction::PointCorrection;
#[cfg(feature = "store")]
use super::record_keeper::RecordKeeper;
use super::reply::Reply;
use super::shelf::Shelf;
use super::{batch, digest, message, round};
use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::camera::{self, Camera, CameraParameters};
use crate::flight::exposure::Exposure;
use crate::flight::frame_record::FrameRecord;
use crate::flight::interior_orientation::InteriorOrientation;
use crate::flight::rig::{RigAnswer, RigStep};
use crate::flight::settings::FlightSettings;
use crate::io::instruments::WireBytes;

/// The part that reads requests and writes answers.
#[derive(Debug)]
pub(super) struct Responder<Deck> {
    pub(super) identity: Identity,
    pub(super) stack_used_bytes: fn() -> u32,
    /// The last request of the session that was answered.
    pub(super) last: Option<Header>,
    /// The session for reading that is open beside it.
    pub(super) reading: Option<u32>,
    pub(super) loading: Loading,
    pub(super) grids: GridLoading,
    pub(super) frame: Option<camera::Frame>,
    /// The deck, which owns the camera, in flight or not.
    pub(super) deck: Deck,
    pub(super) fitting: Fitting,
    pub(super) shelf: Shelf,
    pub(super) keeper: FlightKeeper,
    #[cfg(feature = "store")]
    pub(super) records: RecordKeeper,
    pub(super) reply: Reply,
    pub(super) counters: Counters,
}

impl<Deck: FlightDeck> Responder<Deck> {
    pub(super) fn lost(&mut self, damage: Damage) -> LinkEvent {
        count(match damage {
            Damage::Truncated => &mut self.counters.truncated,
            Damage::Oversized => &mut self.counters.oversized,
            Damage::Crc => &mut self.counters.wrong_crc,
        });
        LinkEvent::Lost(damage)
    }

    pub(super) fn answer(&mut self, payload: &[u8]) -> LinkEvent {
        let (header, rest) = match message::header(payload) {
            Ok(header) => header,
            Err(unreadable) => {
                count(match unreadable {
                    Unreadable::OtherProtocol(_) => &mut self.counters.other_protocol,
                    Unreadable::NoHeader => &mut self.counters.unknown,
                });
                if let Unreadable::OtherProtocol(_) = unreadable {
                    // The first byte of the answer tells the sender the version of this protocol.
                    self.reply.refuse_aside(NOBODY, Refusal::OtherProtocol);
                }
                return LinkEvent::Unreadable(unreadable);
            }
        };
        match self.answer_round(header, rest) {
            Some(event) => event,
            None => self.answer_other(header, rest),
        }
    }

    /// Answers a request for a round; `None` if it is another. Neither this function nor the next
    /// needs the stack of the other.
    #[inline(never)]
    fn answer_round(&mut self, header: Header, rest: &[u8]) -> Option<LinkEvent> {
        let (step, sent) = round::read(rest)?;
        if let Err(event) = self.admit(header) {
            return Some(event);
        }
        let done = self.step(header, &step, sent);
        Some(self.conclude(header, done))
    }

    /// Answers a request other than for a round.
    #[inline(never)]
    fn answer_other(&mut self, header: Header, rest: &[u8]) -> LinkEvent {
        let (body, is_whole) = message::body::<Request>(rest);
        let request = body.as_ref().ok().filter(|_| is_whole);
        if let Some(event) = self.answer_reading(header, request) {
            return event;
        }
        let admitted = match request {
            Some(Request::Connect) if !self.reply.is_kept(header) => Ok(()),
            _ => self.admit(header),
        };
        if let Err(event) = admitted {
            return event;
        }
        self.last = Some(header);
        let done = match request {
            Some(Request::Prepare(settings)) => self.prepare(header, settings),
            Some(Request::Store(order)) => {
                let ordered = self.shelf.order(&self.deck, header, order);
                ordered.map(|()| LinkEvent::Store)
            }
            Some(request) => self.act(header, request),
            None => Err(Refusal::Unknown),
        };
        self.conclude(header, done)
    }

    /// Admits the next request of the open session; answers another again, or refuses it aside.
    fn admit(&mut self, header: Header) -> Result<(), LinkEvent> {
        if self.reply.send_again(header) {
            count(&mut self.counters.repeated);
            return Err(LinkEvent::Repeated);
        }
        if let Err(refusal) = self.in_order(header) {
            count(match refusal {
                Refusal::OtherSession => &mut self.counters.other_session,
                _ => &mut self.counters.out_of_order,
            });
            self.reply.refuse_aside(header, refusal);
            return Err(LinkEvent::Refused(refusal));
        }
        self.last = Some(header);
        Ok(())
    }

    /// Counts an answer, or sends a refusal.
    pub(super) fn conclude(
        &mut self,
        header: Header,
        done: Result<LinkEvent, Refusal>,
    ) -> LinkEvent {
        match done {
            // The board's answer follows.
            Ok(LinkEvent::Store) => LinkEvent::Store,
            Ok(event) => {
                count(&mut self.counters.done);
                event
            }
            Err(refusal) => {
                count(match refusal {
                    Refusal::Unknown => &mut self.counters.unknown,
                    _ => &mut self.counters.refused,
                });
                self.reply.send(header, &Answer::Refused(refusal));
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

    /// Acts on a request and writes its answer. The longest contents are written from where they
    /// lie.
    #[inline(never)]
    fn act(&mut self, header: Header, request: &Request) -> Result<LinkEvent, Refusal> {
        let mut event = LinkEvent::Answered;
        let answer = match request {
            Request::Connect => {
                self.frame = None;
                self.fitting.end();
                self.loading.end();
                self.grids.end();
                event = LinkEvent::Connected(header.session);
                self.connected()
            }
            Request::BeginLoad { .. }
            | Request::LoadPart(_)
            | Request::BeginGrid { .. }
            | Request::GridPart(_) => {
                let answer = self.take_load(request)?;
                if let Answer::Loaded(id) = answer {
                    event = LinkEvent::Loaded(id);
                }
                answer
            }
            Request::Expose(exposure) => {
                event = LinkEvent::Exposed;
                Answer::InteriorOrientation(self.expose(exposure)?)
            }
            Request::InteriorOrientation => {
                let frame = self.frame.as_ref().ok_or(Refusal::NoFrame)?;
                Answer::InteriorOrientation(frame.interior)
            }
            Request::Correct(_)
            | Request::Distort(_)
            | Request::Mesh(..)
            | Request::Corrections(_) => {
                self.answer_points(header, request)?;
                return Ok(event);
            }
            Request::Digest(grid) => {
                deck::check_idle(&self.deck)?;
                let correction = PointCorrection::of(self.frame.as_ref(), &self.grids)?;
                batch::on_sensor(correction.polynomial(), grid.points())?;
                Answer::Digest(correction.digest(grid))
            }
            Request::Reset(ending) => {
                self.check_ending(*ending)?;
                event = LinkEvent::Reset;
                Answer::Ending
            }
            Request::PowerOff(ending) if self.identity.power_switch => {
                self.check_ending(*ending)?;
                self.keeper.note_power_off();
                event = LinkEvent::PowerOff;
                Answer::Ending
            }
            Request::PowerOff(_) => return Err(Refusal::NoPowerSwitch),
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
            // These are answered apart, without the stack that this function takes.
            Request::Prepare(_)
            | Request::Store(_)
            | Request::Rig(_)
            | Request::Wired(..)
            | Request::ConnectReading => {
                return Err(Refusal::Unknown);
            }
            Request::Counters
            | Request::Instruments
            | Request::FrameRecord(_)
            | Request::Acknowledge(_)
            | Request::Stored
            | Request::Inputs
            | Request::Status => self.read(request)?,
            Request::Flown => {
                let (sequence, frame) = deck::latest(&self.deck).ok_or(Refusal::NoFrame)?;
                self.frame = Some(frame);
                Answer::Flown(sequence, frame.interior)
            }
            Request::Tell(event) => {
                self.deck.tell(*event)?;
                Answer::Told
            }
            Request::Try(trial) => {
                self.deck.try_out(*trial)?;
                Answer::Told
            }
        };
        self.reply.send(header, &answer);
        Ok(event)
    }

    /// Identity of the camera.
    fn connected(&self) -> Answer {
        Answer::Connected(Identity {
            calibration: self.deck.camera().and_then(Camera::id),
            ..self.identity.clone()
        })
    }

    /// Checks that the camera may be ended.
    fn check_ending(&self, ending: Ending) -> Result<(), Refusal> {
        match ending {
            Ending::Orderly => deck::check_over(&self.deck),
            Ending::Forced => Ok(()),
        }
    }

    /// Acts on a request that a session for reading may make.
    #[inline(never)]
    fn read(&mut self, request: &Request) -> Result<Answer, Refusal> {
        Ok(match request {
            Request::Counters => Answer::Counters(self.counters()),
            Request::Instruments => Answer::Instruments(
                self.deck
                    .instruments()
                    .ok_or(Refusal::NoInstruments)?
                    .counters(),
            ),
            Request::FrameRecord(from) => Answer::FrameRecord(self.frame_record(*from)?),
            Request::Acknowledge(fetched) => {
                Answer::Kept(deck::acknowledge(&mut self.deck, *fetched)?)
            }
            Request::Status => {
                let after_reset = AfterReset {
                    flight: self.keeper.head.flight,
                    ..self.identity.after_reset
                };
                #[cfg(feature = "store")]
                let in_flash = |controller: &_| self.records.in_flash(controller);
                #[cfg(not(feature = "store"))]
                let in_flash = |_: &_| super::records_in_flash::RecordsInFlash::NotKept;
                Answer::Status(deck::status(&self.deck, after_reset, in_flash)?)
            }
            Request::Stored => self.shelf.tell()?,
            Request::Inputs => Answer::Inputs(self.deck.inputs().ok_or(Refusal::NoInputs)?),
            _ => return Err(Refusal::ReadingOnly),
        })
    }

    /// Answers a request of the session for reading, or opens it; `None` if it is of another. Its
    /// requests may be made again, so that no answer is kept for them, and that of the other
    /// session stays.
    #[inline(never)]
    fn answer_reading(&mut self, header: Header, request: Option<&Request>) -> Option<LinkEvent> {
        let opens = matches!(request, Some(Request::ConnectReading));
        let is_of_other = self.last.is_some_and(|last| last.session == header.session);
        if is_of_other || !opens && self.reading != Some(header.session) {
            return None;
        }
        let answer = match request {
            Some(_) if opens => {
                self.reading = Some(header.session);
                Ok(self.connected())
            }
            Some(request) => self.read(request),
            None => Err(Refusal::Unknown),
        };
        let event = match &answer {
            Ok(_) if opens => LinkEvent::Connected(header.session),
            Ok(_) => LinkEvent::Answered,
            Err(refusal) => LinkEvent::Refused(*refusal),
        };
        count(match answer {
            Ok(_) => &mut self.counters.done,
            Err(Refusal::Unknown) => &mut self.counters.unknown,
            Err(_) => &mut self.counters.refused,
        });
        let answer = answer.unwrap_or_else(Answer::Refused);
        self.reply.send_aside(header, &answer);
        Some(event)
    }

    /// Answers a request for points of the current frame.
    fn answer_points(&mut self, header: Header, request: &Request) -> Result<(), Refusal> {
        let correction = PointCorrection::of(self.frame.as_ref(), &self.grids)?;
        let answer = match request {
            Request::Correct(measured) => {
                batch::on_sensor(correction.polynomial(), measured.iter().copied())?;
                let points = Contents::Corrected(&correction, measured);
                self.reply.send_contents(header, &points);
                return Ok(());
            }
            Request::Distort(ideal) => Answer::Points(batch::distort(&correction, ideal)?),
            Request::Mesh(row, format) => Answer::Mesh(batch::mesh(&correction, row, *format)?),
            Request::Corrections(row) => Answer::Corrections(batch::corrections(&correction, row)?),
            _ => return Err(Refusal::Unknown),
        };
        self.reply.send(header, &answer);
        Ok(())
    }

    /// Prepares the camera: the deepest work, for which no room for an answer is kept.
    #[inline(never)]
    fn prepare(&mut self, header: Header, settings: &FlightSettings) -> Result<LinkEvent, Refusal> {
        deck::prepare(&mut self.deck, settings)?;
        self.keeper
            .begin(settings, self.shelf.in_use.as_ref(), self.deck.controller());
        self.note_prepared(header);
        Ok(LinkEvent::Answered)
    }

    #[inline(never)]
    fn note_prepared(&mut self, header: Header) {
        self.reply.send(header, &Answer::Prepared);
    }

    /// Runs a round of a test rig. It is not inlined: two copies of the controller would take twice
    /// the stack.
    #[inline(never)]
    fn step(
        &mut self,
        header: Header,
        step: &RigStep,
        sent: Option<WireBytes>,
    ) -> Result<LinkEvent, Refusal> {
        let mut answer = RigAnswer::silent();
        let stepped = self.deck.step(step, sent, &mut answer);
        stepped.ok_or(Refusal::NoRig)??;
        self.reply.send_contents(header, &Contents::Rig(&answer));
        Ok(LinkEvent::Answered)
    }

    fn frame_record(&self, from: u32) -> Result<Option<(FrameRecord, u32)>, Refusal> {
        let record = deck::record(&self.deck, from)?;
        // Every record fits its digest's buffer.
        Ok(record.and_then(|record| Some((record, digest::of_frame_record(&record)?))))
    }

    /// Takes an announcement or a part of parameters or of a grid. The last part of parameters puts
    /// the calibration into use. Apart, so that reading any request does not need the stack of this
    /// one.
    #[inline(never)]
    fn take_load(&mut self, request: &Request) -> Result<Answer, Refusal> {
        match request {
            Request::BeginLoad {
                length,
                crc,
                keeps_flight,
            } => {
                deck::check_load(&self.deck, *keeps_flight)?;
                self.grids.end();
                self.loading.begin(*length, *crc, *keeps_flight)?;
                Ok(Answer::Loading(0))
            }
            Request::BeginGrid {
                carrier,
                length,
                crc,
            } => {
                deck::check_idle(&self.deck)?;
                self.loading.end();
                self.grids.begin(*carrier, *length, *crc)?;
                Ok(Answer::Loading(0))
            }
            Request::LoadPart(part) => {
                let keeps_flight = self.loading.keeps_flight();
                deck::check_load(&self.deck, keeps_flight)?;
                if !self.loading.add(part)? {
                    return Ok(Answer::Loading(self.loading.received()));
                }
                let (record, crc) = self.loading.finish()?;
                self.load(&record, crc, Storage::Volatile, keeps_flight)
                    .map(Answer::Loaded)
            }
            Request::GridPart(part) => {
                deck::check_idle(&self.deck)?;
                Ok(match self.grids.add(part)? {
                    GridProgress::Bytes(received) => Answer::Loading(received),
                    GridProgress::Loaded(carrier) => Answer::GridLoaded(carrier),
                })
            }
            _ => Err(Refusal::Unknown),
        }
    }

    /// Puts a calibration into use. With `keeps_flight` a flight that is under way goes on with it;
    /// otherwise it ends.
    pub(super) fn load(
        &mut self,
        record: &CameraParameters,
        crc: u32,
        storage: Storage,
        keeps_flight: bool,
    ) -> Result<CalibrationId, Refusal> {
        let loaded = self.put_into_use(record, crc, storage, keeps_flight)?;
        match self.deck.controller() {
            Some(controller) => self.keeper.exchange(record, controller),
            None => self.keeper.end(),
        }
        Ok(loaded)
    }

    /// Copies what has changed of the flight.
    #[inline]
    pub(super) fn keep_flight(&mut self) {
        if let Some(first) = self.keeper.keep(self.deck.record_holder_mut()) {
            self.identity.after_reset.without_eyes.end(first);
        }
    }

    pub(super) fn put_into_use(
        &mut self,
        record: &CameraParameters,
        crc: u32,
        storage: Storage,
        keeps_flight: bool,
    ) -> Result<CalibrationId, Refusal> {
        let camera = Camera::identified(record, crc, storage).map_err(Refusal::Calibration)?;
        if keeps_flight {
            self.deck.check_exchange(&camera)?;
        }
        let camera = self.grids.put_into_use(camera)?;
        if keeps_flight {
            self.deck.exchange(camera);
        } else {
            self.deck.load(camera);
        }
        self.shelf.in_use = Some(*record);
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

    pub(super) fn counters(&self) -> Counters {
        Counters {
            stack_used_bytes: (self.stack_used_bytes)(),
            ..self.counters
        }
    }
}

/// The header of an answer to a request whose own cannot be read.
pub const NOBODY: Header = Header {
    session: 0,
    sequence: 0,
};

pub(super) fn count(counter: &mut u32) {
    count_more(counter, 1);
}

/// Adds to a counter, which stops at its largest value.
pub(super) fn count_more(counter: &mut u32, by: u32) {
    *counter = counter.saturating_add(by);
}
