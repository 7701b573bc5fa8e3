//! The camera's end of the link: it takes bytes and returns bytes, without clock and port.

use super::after_reset::AfterReset;
use super::deck::{self, FlightDeck, RigDeck};
use super::digest;
use super::fitting::Fitting;
use super::flight_keeper::FlightKeeper;
use super::flight_memory::FlightMemory;
use super::grid_loading::GridLoading;
pub use super::link_event::LinkEvent;
use super::loading::Loading;
use super::message::{Counters, Identity, Refusal};
use super::packet::PacketReceiver;
#[cfg(feature = "store")]
use super::record_keeper::RecordKeeper;
use super::reply::Reply;
pub use super::responder::NOBODY;
use super::responder::{Responder, count_more};
use super::shelf::Shelf;
use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::camera::CameraParameters;
use crate::flight::grid_memory::GridMemory;
#[cfg(feature = "store")]
use crate::io::store::{
    CalibrationStore, NothingStored, SignatureVerifier, StoredIdentity, record_flash::RecordFlash,
    record_ring::RecordRing,
};
#[cfg(feature = "store")]
use embedded_storage::nor_flash::NorFlash;

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
                reading: None,
                loading: Loading::NONE,
                grids: GridLoading::NONE,
                frame: None,
                fitting: Fitting::NONE,
                shelf: Shelf::NONE,
                keeper: FlightKeeper::NONE,
                #[cfg(feature = "store")]
                records: RecordKeeper::NONE,
                reply: Reply::NONE,
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

    /// Gives the camera memory for residual grids; without, it refuses a camera that has some.
    pub const fn keep_grids_in(&mut self, memory: &'static mut GridMemory) {
        self.responder.grids.keep_in(memory);
    }

    /// Memory for residual grids, into which a board puts those that it has in its own store before
    /// it [loads](Self::load) the camera that states them; `None` in a camera without.
    pub fn grid_memory_mut(&mut self) -> Option<&mut GridMemory> {
        self.responder.grids.memory_mut()
    }

    /// Puts a calibration into use that the board has in its own store, or was built with, as a
    /// load over the link does that ends an earlier flight.
    ///
    /// # Errors
    /// [`Refusal`] as of the last part of a load.
    pub fn load(
        &mut self,
        record: &CameraParameters,
        storage: Storage,
    ) -> Result<CalibrationId, Refusal> {
        deck::check_over(&self.responder.deck)?;
        let crc = digest::of_camera(record);
        self.responder.load(record, crc, storage, false)
    }

    /// Puts the calibration into use that a store holds, at the start, and returns what was found.
    /// Whatever that is, the link answers: [`Request::Stored`](super::message::Request::Stored)
    /// tells it. From then on the PC may ask for a store ([`LinkEvent::Store`]).
    #[cfg(feature = "store")]
    pub fn load_stored<F: NorFlash, V: SignatureVerifier>(
        &mut self,
        store: &mut CalibrationStore<F, V>,
    ) -> &Result<StoredIdentity, NothingStored> {
        self.responder.start_from(store)
    }

    /// Stores the calibration in use, after [`LinkEvent::Store`] and before the next byte, and
    /// answers; it is the stored one from then on, also in the flight that is under way. Returns
    /// what has come of it.
    #[cfg(feature = "store")]
    pub fn store<F: NorFlash, V: SignatureVerifier>(
        &mut self,
        store: &mut CalibrationStore<F, V>,
    ) -> LinkEvent {
        self.responder.carry_out(store)
    }

    /// Bounds the time from the last round before this start until the camera's clock ran, by the
    /// board, ms: how long rounds may be missing before the watchdog, or whatever else has led to
    /// the start, resets the camera, and how long the start-up takes until the clock runs. `None`,
    /// as without this call, where the board cannot tell, as after a loss of the supply.
    ///
    /// It is called before [`Self::keep_flight_in`], whose findings tell it
    /// ([`WithoutEyes`](super::after_reset::WithoutEyes)).
    pub const fn bound_reset(&mut self, at_most_ms: Option<u32>) {
        self.responder.keeper.reset_ms = at_most_ms;
    }

    /// Keeps the flight in memory that a reset leaves alone, and takes up the one that is there:
    /// the camera is prepared as it was, and goes on to fly if it was armed. Returns the findings.
    ///
    /// It is called once, after a stored calibration has been put into use and before the first
    /// round.
    pub fn keep_flight_in(&mut self, memory: &'static FlightMemory) -> AfterReset {
        self.responder.keep_flight_in(memory)
    }

    /// Copies what has changed of the flight into that memory: after every round of the control
    /// loop, and before a part of an answer leaves.
    #[inline]
    pub fn keep_flight(&mut self) {
        self.responder.keep_flight();
    }

    /// Keeps the records in a ring of the flash, and takes up those that are there and not
    /// acknowledged, unless memory has had them. Returns the findings.
    ///
    /// It is called once, after [`Self::keep_flight_in`] and before the first round.
    #[cfg(feature = "store")]
    pub fn keep_records_in<F: RecordFlash>(&mut self, ring: &mut RecordRing<F>) -> AfterReset {
        self.responder.keep_records_in(ring)
    }

    /// Carries the ring's work on, by one word of the flash at most: after every round of the
    /// control loop and every request.
    #[cfg(feature = "store")]
    #[inline]
    pub fn keep_records<F: RecordFlash>(&mut self, ring: &mut RecordRing<F>) {
        self.responder.keep_records(ring);
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
        self.responder.reply.to_send()
    }

    /// Notes that a number of bytes of [`Self::to_send`] are on their way.
    pub fn sent(&mut self, bytes: usize) {
        self.responder.reply.note_sent(bytes);
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
