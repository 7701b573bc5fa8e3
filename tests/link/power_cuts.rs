//! Flights that end without supply: the records are in a ring of the flash.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{FrameRecord, Outcome, Reason};
use fmc_camera::flight::record_log::CAPACITY;
use fmc_camera::io::link::after_reset::FlightAfterReset;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, FetchedRecord, Request, ResetCause};
use fmc_camera::io::link::records_in_flash::RecordsInFlash;
use fmc_camera::io::store::record_ring::{ENTRY_WORDS, Erasing, RecordRing, RingState};

use crate::link::in_flight::Flight;
use crate::link::pc::camera_parameters;
use crate::store::flash_model::{Cell, Cut, FlashOf, Operation};

/// A flash whose sectors hold few entries.
pub(super) type Flash = FlashOf<6, 4096>;
pub(super) type Ring = RecordRing<Flash>;

/// Records that a loss of the supply may take.
const LOST: u32 = 2;

pub(super) fn ring(flash: Flash) -> Ring {
    RecordRing::open(flash, 0, 6).unwrap()
}

pub(super) fn blank_memory() -> &'static FlightMemory {
    Box::leak(Box::new(FlightMemory::blank()))
}

/// Starts a camera with memory and flash.
pub(super) fn start(
    cause: ResetCause,
    memory: &'static FlightMemory,
    flash: Flash,
) -> (Flight, Ring) {
    let mut flight = Flight::after_reset(cause, memory);
    let mut ring = ring(flash.started());
    flight.after_reset = flight.pc.station.keep_records_in(&mut ring);
    assert!(ring.flash_mut().operations.is_empty(), "a start only reads");
    (flight, ring)
}

/// Starts a camera that has been without supply.
pub(super) fn start_cold(flash: Flash) -> (Flight, Ring) {
    start(ResetCause::PowerOn, blank_memory(), flash)
}

/// A camera that has been armed.
pub(super) fn armed(flash: Flash) -> (Flight, Ring) {
    let (mut flight, mut ring) = start_cold(flash);
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(flight.prepare(), Answer::Prepared);
    settle(&mut flight, &mut ring);
    flight.arm();
    settle(&mut flight, &mut ring);
    (flight, ring)
}

/// Carries the ring's work on until there is none.
pub(super) fn settle(flight: &mut Flight, ring: &mut Ring) {
    flight.pc.station.keep_flight();
    for _ in 0..1000 {
        flight.pc.station.keep_records(ring);
        if ring.state() == RingState::Idle {
            return;
        }
    }
    panic!("the ring is {:?}", ring.state());
}

/// Takes an image, and leaves its record unwritten.
pub(super) fn expose(flight: &mut Flight) {
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Exposing);
    flight.run_until(State::Armed);
}

fn fetched(flight: &mut Flight, from: u32) -> Option<FrameRecord> {
    match flight.pc.ask(&Request::FrameRecord(from)) {
        Answer::FrameRecord(record) => record.map(|(record, _)| record),
        Answer::Refused(_) => None,
        other => panic!("{other:?}"),
    }
}

pub(super) fn all_records(flight: &mut Flight) -> Vec<FrameRecord> {
    let (mut records, mut next) = (Vec::new(), 0);
    while let Some(record) = fetched(flight, next) {
        next = record.sequence + 1;
        records.push(record);
    }
    records
}

fn in_flash(flight: &mut Flight) -> RecordsInFlash {
    match flight.pc.ask(&Request::Status) {
        Answer::Status(status) => status.in_flash,
        other => panic!("{other:?}"),
    }
}

/// Records of a camera when its supply failed.
struct Truth<'a> {
    records: &'a [FrameRecord],
    acknowledged: u32,
}

/// Starts a camera whose supply has failed, and holds its records to those that it had.
fn check(flash: &Flash, truth: &Truth<'_>) -> (Flight, Ring) {
    let (mut flight, ring) = start_cold(flash.clone());
    let found = all_records(&mut flight);
    let last = truth.records.last().map_or(0, |last| last.sequence);
    for record in &found {
        let known = truth
            .records
            .iter()
            .find(|it| it.sequence == record.sequence);
        // A word that was cut may be read once and not again.
        let is_lost =
            record.outcome == Outcome::Refused(Reason::Unusable) && record.sequence + LOST > last;
        assert!(known == Some(record) || is_lost, "{record:?}");
    }
    let through = found
        .last()
        .map_or(truth.acknowledged, |last| last.sequence);
    assert!(through + LOST >= last, "{through} of {last}");
    // Without a gap, from one that the camera may have known to be acknowledged.
    for pair in found.windows(2) {
        assert_eq!(pair[0].sequence + 1, pair[1].sequence);
    }
    if let Some(first) = found.first() {
        assert!(first.sequence <= truth.acknowledged + 1);
        let after_reset = flight.after_reset;
        assert_eq!(after_reset.outcome, FlightAfterReset::FromFlash);
        assert_eq!(after_reset.records, u32::try_from(found.len()).unwrap());
        assert_eq!((after_reset.boot, after_reset.flight), (2, 1));
        let lost = found
            .iter()
            .filter(|it| !truth.records.contains(it))
            .count();
        assert_eq!(after_reset.damaged, u32::try_from(lost).unwrap());
        assert!(lost <= 1 && after_reset.unfinished == 0);
    }
    (flight, ring)
}

/// Flies so many frames, acknowledges each `behind` later, and cuts the supply in every `nth` word
/// that is written. Returns the number of cuts.
fn fly_with_cuts(frames: u32, behind: u32, nth: usize) -> usize {
    let (mut flight, mut ring) = armed(Flash::blank());
    let (mut records, mut acknowledged, mut cuts, mut written) = (Vec::new(), 0, 0, 0);
    for frame in 1..=frames {
        expose(&mut flight);
        records.push(fetched(&mut flight, frame).unwrap());
        if let Some(through) = frame.checked_sub(behind).filter(|through| *through > 0) {
            assert!(matches!(flight.pc.acknowledge(through), Answer::Kept(_)));
            acknowledged = through;
        }
        loop {
            flight.pc.station.keep_flight();
            let before = ring.clone();
            ring.flash_mut().operations.clear();
            flight.pc.station.keep_records(&mut ring);
            let operations = ring.flash_mut().operations.clone();
            for operation in operations {
                written += 1;
                if written % nth != 0 {
                    continue;
                }
                let ways = match operation {
                    Operation::Write(_) => {
                        [Cut::First(0), Cut::First(20), Cut::Unstable, Cut::Failing]
                    }
                    Operation::Erase(_) => {
                        [Cut::First(20), Cut::Mixed, Cut::Unstable, Cut::Failing]
                    }
                };
                for cut in ways {
                    let mut cut_ring = before.clone();
                    let flash = cut_ring.flash_mut();
                    flash.operations.clear();
                    *flash = flash.clone().cut_at(0, cut);
                    // The cut is in the next word.
                    cut_ring.step(Erasing::Ahead);
                    let truth = Truth {
                        records: &records,
                        acknowledged,
                    };
                    let (mut again, mut ring) = check(&cut_ring.into_flash(), &truth);
                    // Another cut, of the camera that holds them: they are still there.
                    settle(&mut again, &mut ring);
                    let held = all_records(&mut again);
                    let (mut third, _) = start_cold(ring.into_flash());
                    let found = all_records(&mut third);
                    assert!(found.starts_with(&held), "{}", held.len());
                    assert!(found.len() <= held.len() + 1);
                    cuts += 1;
                }
            }
            if ring.state() == RingState::Idle {
                break;
            }
        }
    }
    cuts
}

#[test]
fn supply_that_fails_in_any_word_of_a_flight_loses_at_most_the_last_two_records() {
    let cuts = fly_with_cuts(15, 3, 1);
    assert!(cuts > 300, "{cuts}");
}

#[test]
fn flight_that_goes_round_the_ring_loses_at_most_the_last_two_records() {
    let cuts = fly_with_cuts(300, 20, 13);
    assert!(cuts > 200, "{cuts}");
}

#[test]
fn records_of_two_starts_keep_their_numbers_and_the_next_flight_counts_on() {
    let memory = blank_memory();
    let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
    let mut first_ring = ring(Flash::blank());
    flight.pc.station.keep_records_in(&mut first_ring);
    assert!(matches!(
        flight.pc.load(&camera_parameters()),
        Answer::Loaded(_)
    ));
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    expose(&mut flight);
    settle(&mut flight, &mut first_ring);
    // A reset leaves memory alone. The last entry may have been cut, and is written again once; and
    // each start is.
    let (mut flight, mut ring) = start(ResetCause::Watchdog, memory, first_ring.into_flash());
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::FliesOn);
    settle(&mut flight, &mut ring);
    assert_eq!(ring.flash_mut().operations.len(), 2 * ENTRY_WORDS);
    let (mut flight, mut ring) = start(ResetCause::Watchdog, memory, ring.into_flash());
    settle(&mut flight, &mut ring);
    assert_eq!(ring.flash_mut().operations.len(), ENTRY_WORDS);
    for _ in 0..100 {
        flight.round(None);
    }
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Exposing);
    flight.run_until(State::Degraded(Fault::Encoder));
    settle(&mut flight, &mut ring);
    assert_eq!(in_flash(&mut flight), RecordsInFlash::AllBut(0));
    let before = all_records(&mut flight);
    let numbers = |records: &[FrameRecord]| -> Vec<[u32; 3]> {
        let numbers = records.iter().map(|it| [it.sequence, it.boot, it.flight]);
        numbers.collect()
    };
    assert_eq!(numbers(&before), [[1, 1, 1], [2, 3, 1]]);

    let (mut flight, mut ring) = start_cold(ring.into_flash());
    let found = flight.after_reset;
    assert_eq!(found.outcome, FlightAfterReset::FromFlash);
    assert_eq!((found.boot, found.flight, found.records), (4, 1, 2));
    assert_eq!(found.last_round, Some(before[1].trigger));
    assert!(all_records(&mut flight) == before);
    // They are acknowledged one by one, and the camera flies again.
    assert!(matches!(
        flight.pc.load(&camera_parameters()),
        Answer::Refused(_)
    ));
    assert_eq!(flight.pc.acknowledge(2), Answer::Kept(0));
    assert!(matches!(
        flight.pc.load(&camera_parameters()),
        Answer::Loaded(_)
    ));
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.round(Some(Event::Trigger));
    settle(&mut flight, &mut ring);
    assert_eq!(numbers(&all_records(&mut flight)), [[1, 4, 2]]);
    let (mut flight, _) = start_cold(ring.into_flash());
    assert_eq!(numbers(&all_records(&mut flight)), [[1, 4, 2]]);
    assert_eq!(flight.after_reset.boot, 5);
}

#[test]
fn records_that_were_acknowledged_when_the_flight_had_ended_do_not_come_again() {
    let (mut flight, mut ring) = armed(Flash::blank());
    for _ in 0..3 {
        expose(&mut flight);
        settle(&mut flight, &mut ring);
    }
    flight.round(Some(Event::Command(Command::Disarm)));
    settle(&mut flight, &mut ring);
    assert_eq!(flight.pc.acknowledge(3), Answer::Kept(0));
    settle(&mut flight, &mut ring);
    let (mut flight, _) = start_cold(ring.into_flash());
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::Nothing);
    assert_eq!((flight.after_reset.boot, flight.after_reset.flight), (2, 1));
    assert!(all_records(&mut flight).is_empty());
}

#[test]
fn flight_without_a_record_left_tells_that_the_last_ones_may_be_missing() {
    let (mut flight, mut ring) = armed(Flash::blank());
    expose(&mut flight);
    settle(&mut flight, &mut ring);
    assert_eq!(flight.pc.acknowledge(1), Answer::Kept(0));
    // The next record tells the acknowledgement, too. Its frame is in flight.
    expose(&mut flight);
    settle(&mut flight, &mut ring);
    flight.round(Some(Event::Trigger));
    let (mut flight, _) = start_cold(ring.into_flash());
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::FromFlash);
    let found = all_records(&mut flight);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].sequence, 2);
}

#[test]
fn word_that_cannot_be_read_costs_its_record_alone() {
    let (mut flight, mut ring) = armed(Flash::blank());
    let mut places = Vec::new();
    for _ in 0..4 {
        expose(&mut flight);
        places.push(usize::try_from(ring.next()).unwrap());
        settle(&mut flight, &mut ring);
    }
    let before = all_records(&mut flight);
    let mut flash = ring.into_flash();
    flash.sectors[0][places[1] * ENTRY_WORDS + 3] = Cell::Failing;
    for _ in 0..2 {
        let (mut flight, _) = start_cold(flash.clone());
        assert_eq!(flight.after_reset.damaged, 1);
        let found = all_records(&mut flight);
        assert_eq!(found.len(), 4);
        let kept = [0, 2, 3].map(|index| found[index] == before[index]);
        assert_eq!(kept, [true; 3]);
        assert_eq!(found[1].outcome, Outcome::Refused(Reason::Unusable));
        assert_eq!(
            (found[1].sequence, found[1].boot, found[1].flight),
            (2, 1, 1)
        );
    }
}

#[test]
fn triggers_without_room_are_counted_after_a_loss_of_the_supply() {
    let (mut flight, mut ring) = armed(Flash::blank());
    flight.round(Some(Event::Command(Command::Disarm)));
    let last = u32::try_from(CAPACITY).unwrap() + 5;
    for _ in 0..last {
        flight.round(Some(Event::Trigger));
    }
    // They are written once in a second.
    for _ in 0..1100 {
        flight.round(None);
        settle(&mut flight, &mut ring);
    }
    let before = all_records(&mut flight);
    let (mut flight, _) = start_cold(ring.into_flash());
    assert_eq!(flight.after_reset.records, last);
    assert!(all_records(&mut flight) == before);
    let whole = u32::try_from(CAPACITY).unwrap();
    assert_eq!(flight.pc.acknowledge(whole), Answer::Kept(5));
    let fetched = FetchedRecord {
        sequence: last,
        crc: 0,
    };
    assert_eq!(
        flight.pc.ask(&Request::Acknowledge(fetched)),
        Answer::Kept(0)
    );
}

#[test]
fn status_tells_how_many_records_a_loss_of_the_supply_would_take() {
    let (mut flight, mut ring) = armed(Flash::blank());
    assert_eq!(in_flash(&mut flight), RecordsInFlash::AllBut(0));
    expose(&mut flight);
    assert_eq!(in_flash(&mut flight), RecordsInFlash::AllBut(1));
    settle(&mut flight, &mut ring);
    assert_eq!(in_flash(&mut flight), RecordsInFlash::AllBut(0));
    for sector in &mut ring.flash_mut().sectors {
        sector.resize(4096 / 32, Cell::Blank);
        for cell in sector.iter_mut().filter(|cell| **cell == Cell::Blank) {
            *cell = Cell::Failing;
        }
    }
    expose(&mut flight);
    for _ in 0..100 {
        flight.pc.station.keep_records(&mut ring);
    }
    assert_eq!(in_flash(&mut flight), RecordsInFlash::Worn);
    let without = Flight::loaded();
    let mut without = without;
    assert_eq!(without.prepare(), Answer::Prepared);
    assert_eq!(in_flash(&mut without), RecordsInFlash::NotKept);
}

#[test]
fn records_keep_their_calibration_after_a_loss_of_the_supply_wherever_it_was_exchanged() {
    let (mut flight, mut ring) = armed(Flash::blank());
    let mut records = Vec::new();
    for (frame, distance_mm) in (1..).zip([None, Some(60.0), None, Some(61.0), Some(62.0)]) {
        if let Some(distance_mm) = distance_mm {
            flight.round(Some(Event::Command(Command::Disarm)));
            // Whatever of it has been written before the exchange.
            flight.pc.station.keep_records(&mut ring);
            let mut other = camera_parameters();
            other.calibration.principal_distance_mm = distance_mm;
            let exchanged = flight.pc.exchange(&other);
            assert!(matches!(exchanged, Answer::Loaded(_)), "{exchanged:?}");
            flight.round(Some(Event::Command(Command::Arm)));
            flight.run_until(State::Armed);
        }
        expose(&mut flight);
        records.push(fetched(&mut flight, frame).unwrap());
        loop {
            flight.pc.station.keep_flight();
            flight.pc.station.keep_records(&mut ring);
            let truth = Truth {
                records: &records,
                acknowledged: 0,
            };
            check(&ring.clone().into_flash(), &truth);
            if ring.state() == RingState::Idle {
                break;
            }
        }
    }
    let made_with = |record: &FrameRecord| record.calibration.unwrap().crc;
    let crcs: Vec<u32> = records.iter().map(made_with).collect();
    assert!(crcs[0] != crcs[1] && crcs[1] == crcs[2] && crcs[2] != crcs[3] && crcs[3] != crcs[4]);
    let (mut flight, _) = start_cold(ring.into_flash());
    assert!(all_records(&mut flight) == records);
}
