//! Entries of the ring that a start finds alone, damaged, or of another flight than memory has.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::record_log::CAPACITY;
use fmc_camera::io::link::after_reset::FlightAfterReset;
use fmc_camera::io::link::deck::FlightDeck;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Identity, ResetCause};
use fmc_camera::io::link::station::Station;
use fmc_camera::io::store::record_flash::RecordFlash;
use fmc_camera::io::store::record_ring::{ENTRY_WORDS, Erasing, RecordRing, RingState};

use crate::link::in_flight::Flight;
use crate::link::pc::{Pc, camera_parameters};
use crate::link::power_cuts::{
    Flash, Ring, all_records, armed, blank_memory, expose, ring, settle, start, start_cold,
};
use crate::store::flash_model::Cell;

/// Makes the entry of a place unreadable.
fn damage(flash: &mut Flash, place: u32) {
    let word = usize::try_from(place).unwrap() * ENTRY_WORDS + 1;
    flash.sectors[0][word] = Cell::Failing;
}

/// Prepares and arms a camera that has been started.
fn fly(flight: &mut Flight, ring: &mut Ring) {
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(flight.prepare(), Answer::Prepared);
    settle(flight, ring);
    flight.arm();
    settle(flight, ring);
}

/// Returns the number of places that are written until there is no work.
fn entries_written(flight: &mut Flight, ring: &mut Ring) -> u32 {
    let before = ring.next();
    settle(flight, ring);
    ring.next() - before
}

#[test]
fn triggers_that_are_refused_for_want_of_room_are_written_once_a_second() {
    let (mut flight, mut ring) = armed(Flash::blank());
    flight.round(Some(Event::Command(Command::Disarm)));
    let whole = u32::try_from(CAPACITY).unwrap();
    for _ in 0..=whole {
        flight.round(Some(Event::Trigger));
    }
    settle(&mut flight, &mut ring);
    for _ in 0..900 {
        flight.round(Some(Event::Trigger));
        assert_eq!(entries_written(&mut flight, &mut ring), 0);
    }
    for _ in 0..200 {
        flight.round(None);
    }
    assert_eq!(entries_written(&mut flight, &mut ring), 1);
    flight.round(Some(Event::Trigger));
    assert_eq!(entries_written(&mut flight, &mut ring), 0);
    let (flight, _) = start_cold(ring.into_flash());
    assert_eq!(flight.after_reset.records, whole + 1 + 900);
}

#[test]
fn records_of_a_flight_whose_calibration_cannot_be_read_are_not_given() {
    let (mut flight, mut ring) = armed(Flash::blank());
    let first = ring.next();
    expose(&mut flight);
    settle(&mut flight, &mut ring);
    let mut flash = ring.into_flash();
    for place in 1..first {
        damage(&mut flash, place);
    }
    let (mut flight, mut ring) = start_cold(flash);
    let found = flight.after_reset;
    assert_eq!(found.outcome, FlightAfterReset::FromFlash);
    assert_eq!((found.flight, found.records, found.damaged), (1, 0, 0));
    assert!(all_records(&mut flight).is_empty());
    // The next flight has the next number, and its records are found.
    fly(&mut flight, &mut ring);
    expose(&mut flight);
    settle(&mut flight, &mut ring);
    let before = all_records(&mut flight);
    let (mut flight, _) = start_cold(ring.into_flash());
    assert_eq!((before.len(), before[0].flight), (1, 2));
    assert_eq!(all_records(&mut flight), before);
}

#[test]
fn record_that_is_missing_is_not_looked_for_in_the_flight_before() {
    let (mut flight, mut ring) = armed(Flash::blank());
    for _ in 0..3 {
        expose(&mut flight);
        settle(&mut flight, &mut ring);
    }
    flight.round(Some(Event::Command(Command::Disarm)));
    assert_eq!(flight.pc.acknowledge(3), Answer::Kept(0));
    settle(&mut flight, &mut ring);
    fly(&mut flight, &mut ring);
    let mut places = Vec::new();
    for _ in 0..2 {
        expose(&mut flight);
        places.push(ring.next());
        settle(&mut flight, &mut ring);
    }
    let before = all_records(&mut flight);
    assert_eq!(before.len(), 2);
    let mut flash = ring.into_flash();
    damage(&mut flash, places[0]);
    let (mut flight, _) = start_cold(flash);
    let after_reset = flight.after_reset;
    assert_eq!((after_reset.flight, after_reset.damaged), (2, 1));
    let found = all_records(&mut flight);
    assert_eq!((found.len(), found[0].flight), (2, 2));
    assert_ne!(found[0], before[0]);
    assert_eq!(found[1], before[1]);
}

#[test]
fn entry_that_is_not_one_of_this_firmware_is_passed_over() {
    let (mut flight, mut ring) = armed(Flash::blank());
    expose(&mut flight);
    settle(&mut flight, &mut ring);
    let before = all_records(&mut flight);
    assert!(ring.push(&[0xff; 20]));
    while ring.step(Erasing::Ahead) != RingState::Idle {}
    let (mut flight, _) = start_cold(ring.into_flash());
    assert_eq!(flight.after_reset.records, 1);
    assert_eq!(all_records(&mut flight), before);
}

#[test]
fn ring_of_another_flight_than_that_of_memory_changes_nothing_of_it() {
    // The ring of another camera, which has flown twice.
    let (mut other, mut other_ring) = armed(Flash::blank());
    expose(&mut other);
    other.round(Some(Event::Command(Command::Disarm)));
    assert_eq!(other.pc.acknowledge(1), Answer::Kept(0));
    settle(&mut other, &mut other_ring);
    fly(&mut other, &mut other_ring);
    expose(&mut other);
    settle(&mut other, &mut other_ring);
    let of_other = all_records(&mut other);
    // Memory with the first flight of this one.
    let memory = blank_memory();
    let (mut flight, mut own) = start(ResetCause::PowerOn, memory, Flash::blank());
    fly(&mut flight, &mut own);
    expose(&mut flight);
    settle(&mut flight, &mut own);
    let before = all_records(&mut flight);
    assert_eq!((before[0].flight, of_other[0].flight), (1, 2));
    let flash = other_ring.into_flash();
    let (mut flight, mut other_ring) = start(ResetCause::Watchdog, memory, flash);
    assert_eq!(flight.after_reset.flight, 1);
    assert_eq!(all_records(&mut flight), before);
    // They are written there: they are not those that the ring has.
    let written = entries_written(&mut flight, &mut other_ring);
    assert_eq!(written, 2, "calibration and record");
}

#[test]
fn ring_of_an_earlier_flight_than_the_last_of_memory_has_no_records_of_it() {
    let (mut flight, mut ring) = armed(Flash::blank());
    expose(&mut flight);
    settle(&mut flight, &mut ring);
    assert_eq!(all_records(&mut flight).len(), 1);
    // Memory of a camera whose second flight has ended with another calibration.
    let memory = blank_memory();
    let mut later = Flight::after_reset(ResetCause::PowerOn, memory);
    for _ in 0..2 {
        let loaded = later.pc.load(&camera_parameters());
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
        assert_eq!(later.prepare(), Answer::Prepared);
    }
    let loaded = later.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    let (mut flight, _) = start(ResetCause::Watchdog, memory, ring.into_flash());
    let found = flight.after_reset;
    assert_eq!((found.flight, found.records), (2, 0));
    assert_eq!(found.outcome, FlightAfterReset::Nothing);
    assert!(all_records(&mut flight).is_empty());
}

#[test]
fn armed_flight_of_which_no_record_is_left_tells_that_the_last_ones_may_be_missing() {
    let memory = blank_memory();
    let (mut flight, mut ring) = start(ResetCause::PowerOn, memory, Flash::blank());
    fly(&mut flight, &mut ring);
    // The flight goes on after a reset: its state is written under the number of the start.
    let (mut flight, mut ring) = start(ResetCause::Watchdog, memory, ring.into_flash());
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::FliesOn);
    flight.run_until(State::Degraded(Fault::Encoder));
    assert_eq!(entries_written(&mut flight, &mut ring), 1);
    let (mut flight, _) = start_cold(ring.into_flash());
    let found = flight.after_reset;
    assert_eq!(found.outcome, FlightAfterReset::FromFlash);
    assert_eq!((found.boot, found.flight, found.records), (3, 1, 0));
    assert!(all_records(&mut flight).is_empty());
}

#[test]
fn camera_with_a_ring_and_without_memory_has_its_records_after_every_start() {
    let (mut flight, mut first) = armed(Flash::blank());
    expose(&mut flight);
    settle(&mut flight, &mut first);
    let before = all_records(&mut flight);
    let mut pc = Pc::unconnected();
    let mut ring = ring(first.into_flash().started());
    let found = pc.station.keep_records_in(&mut ring);
    assert_eq!((found.boot, found.flight, found.records), (2, 1, 1));
    let holder = pc.station.deck_mut().record_holder().unwrap();
    assert_eq!(holder.record(1), before.first().copied());
}

/// A flash of which a word can be read once, and not again.
#[derive(Debug)]
struct Fading {
    model: Flash,
    offset: u32,
    reads: u32,
}

impl ErrorType for Fading {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Fading {
    const READ_SIZE: usize = Flash::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.reads += u32::from(offset == self.offset);
        if offset == self.offset && self.reads > 1 {
            return Err(NorFlashErrorKind::Other);
        }
        self.model.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.model.capacity()
    }
}

impl NorFlash for Fading {
    const WRITE_SIZE: usize = Flash::WRITE_SIZE;
    const ERASE_SIZE: usize = Flash::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.model.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.model.write(offset, bytes)
    }
}

impl RecordFlash for Fading {
    fn begin_erasure(&mut self, offset: u32) -> Result<(), Self::Error> {
        self.model.begin_erasure(offset)
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        self.model.end_erasure()
    }
}

#[test]
fn record_of_memory_that_the_flash_gives_once_and_not_again_is_written_again() {
    let memory = blank_memory();
    let (mut flight, mut own) = start(ResetCause::PowerOn, memory, Flash::blank());
    fly(&mut flight, &mut own);
    let mut places = Vec::new();
    for _ in 0..3 {
        expose(&mut flight);
        places.push(own.next());
        settle(&mut flight, &mut own);
    }
    let before = all_records(&mut flight);
    let flash = own.into_flash().started();
    let written = |offset| {
        let words = memory.words();
        let memory = Box::leak(Box::new(FlightMemory::of_words(words)));
        let fading = Fading {
            model: flash.clone(),
            offset,
            reads: 0,
        };
        let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
        let mut ring = RecordRing::open(fading, 0, 6).unwrap();
        flight.pc.station.keep_records_in(&mut ring);
        assert_eq!(all_records(&mut flight), before);
        let next = ring.next();
        for _ in 0..1000 {
            flight.pc.station.keep_records(&mut ring);
        }
        ring.next() - next
    };
    // The newest entry, whose last word may have been cut, and the number of the start.
    assert_eq!(written(u32::MAX), 2);
    let entry_bytes = u32::try_from(ENTRY_WORDS).unwrap() * 32;
    assert_eq!(written(places[1] * entry_bytes + 32), 3);
}

#[test]
fn flight_of_a_camera_without_identity_is_neither_in_the_ring_nor_in_memory() {
    let memory = blank_memory();
    let (mut flight, mut ring) = start(ResetCause::PowerOn, memory, Flash::blank());
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    // The board itself puts a camera into the deck.
    let camera = Camera::new(camera_parameters()).unwrap();
    assert_eq!(camera.id(), None);
    flight.pc.station.deck_mut().load(camera);
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.round(Some(Event::Trigger));
    assert_eq!(entries_written(&mut flight, &mut ring), 0);
    let (mut flight, _) = start(ResetCause::Watchdog, memory, ring.into_flash());
    let found = flight.after_reset;
    assert_eq!(found.outcome, FlightAfterReset::Nothing);
    assert_eq!((found.flight, found.records), (1, 0));
    // So is one of a board to which no calibration has come.
    let camera = Camera::new(camera_parameters()).unwrap();
    flight.pc.station.deck_mut().load(camera);
    assert_eq!(flight.prepare(), Answer::Prepared);
    let flight = Flight::after_reset(ResetCause::Watchdog, memory);
    let found = flight.after_reset;
    assert_eq!(found.outcome, FlightAfterReset::Nothing);
    assert_eq!((found.flight, found.records), (2, 0));
}

#[test]
fn flight_goes_on_with_the_calibration_that_the_board_has_put_into_use() {
    let memory = blank_memory();
    let (mut flight, mut ring) = start(ResetCause::PowerOn, memory, Flash::blank());
    fly(&mut flight, &mut ring);
    expose(&mut flight);
    let before = all_records(&mut flight);
    let identity = Identity::new("test build", "test board", true, ResetCause::Watchdog);
    let mut station = Station::new(identity, || 0);
    let id = station
        .load(&camera_parameters(), Storage::Volatile)
        .unwrap();
    let mut flight = Flight::of(station, memory);
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::FliesOn);
    let camera = flight.pc.station.deck_mut().camera().unwrap();
    assert_eq!(camera.id(), Some(id));
    assert_eq!(all_records(&mut flight), before);
}
