//! Time without eyes: triggers that come while a camera resets, and the number that bounds them.

use fmc_camera::flight::event::Event;
use fmc_camera::flight::grid_memory::GridMemory;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera::io::link::after_reset::{FlightAfterReset, WithoutEyes};
use fmc_camera::io::link::deck::FlightDeck as _;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Identity, Refusal, ResetCause};
use fmc_camera::io::link::station::Station;

use crate::geometry::spline::wave;
use crate::link::grids::{grid, send, stating};
use crate::link::in_flight::{Flight, RESET_MS};
use crate::link::pc::{STACK_USED, camera_parameters};

/// Time of a start, from its clock on until the first round, ms.
const START_UP_MS: u32 = 23;

fn blank() -> &'static FlightMemory {
    Box::leak(Box::new(FlightMemory::blank()))
}

fn armed(memory: &'static FlightMemory) -> Flight {
    let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
    assert_eq!(flight.after_reset.without_eyes, WithoutEyes::NoFlight);
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    flight
}

/// The time, as the camera tells it now.
fn without_eyes(flight: &mut Flight) -> WithoutEyes {
    flight.status().after_reset.without_eyes
}

/// Lets the start take its time, and makes the first round.
fn start_up(flight: &mut Flight) {
    let before = f32::from(u16::try_from(START_UP_MS - 1).unwrap());
    flight.pause(1e-3 * before);
    flight.round(None);
}

#[test]
fn triggers_without_a_record_are_those_of_the_time_that_the_camera_tells() {
    for (cause, reset_ms) in [
        (ResetCause::Watchdog, RESET_MS),
        (ResetCause::Fault, 40),
        (ResetCause::StackOverflow, 41),
        (ResetCause::Requested, 10),
    ] {
        let memory = blank();
        let mut flight = armed(memory);
        let (mut fired, before) = (0, flight.status().counts.triggers);
        // A trigger in every millisecond, through the reset.
        for _ in 0..5 {
            flight.round(Some(Event::Trigger));
            fired += 1;
        }
        assert_eq!(flight.status().counts.triggers, before + fired);
        fired += reset_ms + START_UP_MS - 1;
        let mut flight = Flight::after_reset(cause, memory);
        let told = without_eyes(&mut flight);
        assert_eq!(
            told,
            WithoutEyes::GoesOn {
                before_clock_ms: RESET_MS
            }
        );
        assert_eq!(told.at_most_ms(), None);
        start_up(&mut flight);
        for _ in 0..5 {
            flight.round(Some(Event::Trigger));
            fired += 1;
        }
        let status = flight.status();
        let told = status.after_reset.without_eyes;
        assert_eq!(
            told,
            WithoutEyes::AtMost {
                before_clock_ms: RESET_MS,
                start_up_ms: START_UP_MS
            }
        );
        let without_record = fired - (status.counts.triggers - before);
        let at_most_ms = told.at_most_ms().unwrap();
        assert!(
            without_record == reset_ms + START_UP_MS - 1 && without_record <= at_most_ms,
            "{without_record} triggers, {at_most_ms} ms"
        );
        // Later rounds change nothing.
        assert_eq!(without_eyes(&mut flight), told);
    }
}

#[test]
fn time_without_eyes_is_unknown_where_nobody_can_bound_it() {
    let memory = blank();
    armed(memory);
    // The reset is one that the board cannot bound, as by its pin.
    let words = memory.words();
    let identity = Identity::new("test build", "test board", true, ResetCause::Requested);
    let unbounded = Station::new(identity, || STACK_USED);
    let memory = Box::leak(Box::new(FlightMemory::of_words(words)));
    let mut flight = Flight::of(unbounded, memory);
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::FliesOn);
    assert_eq!(without_eyes(&mut flight), WithoutEyes::Unknown);
    start_up(&mut flight);
    assert_eq!(without_eyes(&mut flight), WithoutEyes::Unknown);
    // The next is bounded.
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert!(matches!(
        without_eyes(&mut flight),
        WithoutEyes::GoesOn { .. }
    ));
    // No round has come in that start, which may have lasted for any time.
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert_eq!(without_eyes(&mut flight), WithoutEyes::Unknown);
    start_up(&mut flight);
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert!(matches!(
        without_eyes(&mut flight),
        WithoutEyes::GoesOn { .. }
    ));
    // Memory of no use, and a camera that was not prepared.
    let build = "another build";
    for expected in [WithoutEyes::Unknown, WithoutEyes::NoFlight] {
        let flight = Flight::of_build(build, ResetCause::Watchdog, memory);
        assert_eq!(flight.after_reset.without_eyes, expected);
    }
    let flight = Flight::after_reset(ResetCause::Fault, blank());
    assert_eq!(flight.after_reset.outcome, FlightAfterReset::Damaged);
    assert_eq!(flight.after_reset.without_eyes, WithoutEyes::Unknown);
}

#[cfg(feature = "store")]
#[test]
fn time_without_eyes_of_a_reset_while_a_calibration_is_stored_is_unknown() {
    use crate::link::stored::store;
    use crate::store::calibrations::{calibration, store_in};
    use crate::store::flash_model::FlashModel;

    let memory = blank();
    let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
    let mut flash = store_in(FlashModel::blank());
    assert!(flight.pc.station.load_stored(&mut flash).is_err());
    let loaded = flight.pc.load(&calibration(3));
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.round(None);
    let goes_on = WithoutEyes::GoesOn {
        before_clock_ms: RESET_MS,
    };
    let now = || Box::leak(Box::new(FlightMemory::of_words(memory.words())));
    let told = || {
        let flight = Flight::after_reset(ResetCause::Watchdog, now());
        flight.after_reset.without_eyes
    };
    assert_eq!(told(), goes_on);
    // The board feeds its watchdog for seconds meanwhile, and makes no round.
    let stored = store(&mut flight.pc, &mut flash, 3);
    assert!(matches!(stored, Answer::Stored(Ok(_))), "{stored:?}");
    assert_eq!(told(), WithoutEyes::Unknown);
    flight.round(None);
    assert_eq!(told(), goes_on);
}

#[test]
fn flight_with_residual_grids_that_were_loaded_comes_back_without_them_and_holds_its_records() {
    let memory = blank();
    let with_grids = |cause| {
        let identity = Identity::new("test build", "test board", true, cause);
        let mut station = Station::new(identity, || STACK_USED);
        station.keep_grids_in(Box::leak(Box::new(GridMemory::EMPTY)));
        station.bound_reset(Some(RESET_MS));
        Flight::of(station, memory)
    };
    let mut flight = with_grids(ResetCause::PowerOn);
    let lens = grid(GridCarrier::Lens, |column, row| wave(row, column));
    let load = |flight: &mut Flight| {
        let sent = send(&mut flight.pc, &lens);
        assert_eq!(sent, Answer::GridLoaded(GridCarrier::Lens));
        let loaded = flight.pc.load(&stating(Some(&lens), None));
        assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    };
    load(&mut flight);
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    flight.expose();
    flight.expose();
    let before = flight.status();

    let mut flight = with_grids(ResetCause::Watchdog);
    let found = flight.after_reset;
    assert_eq!(found.outcome, FlightAfterReset::NoGrids);
    assert_eq!((found.records, found.damaged, found.unfinished), (2, 0, 0));
    // Triggers leave no record until it is prepared again.
    let goes_on = WithoutEyes::GoesOn {
        before_clock_ms: RESET_MS,
    };
    assert_eq!(without_eyes(&mut flight), goes_on);
    let status = flight.status();
    assert_eq!(status.calibration, before.calibration);
    assert_eq!(
        (status.kept, status.counts.exposed),
        (2, before.counts.exposed)
    );
    assert!(flight.pc.station.deck_mut().controller().is_none());
    let kept = Answer::Refused(Refusal::RecordsKept(2));
    assert_eq!(flight.pc.load(&camera_parameters()), kept);
    assert_eq!(flight.pc.acknowledge(2), Answer::Kept(0));
    load(&mut flight);
    assert_eq!(flight.prepare(), Answer::Prepared);
    assert_eq!(flight.status().calibration, before.calibration);
    assert_eq!(without_eyes(&mut flight), goes_on);
    flight.pause(100.0);
    flight.round(Some(Event::Trigger));
    assert_eq!(flight.status().counts.triggers, 1);
    let WithoutEyes::AtMost { start_up_ms, .. } = without_eyes(&mut flight) else {
        panic!("a round has come");
    };
    assert!((100_000..100_100).contains(&start_up_ms), "{start_up_ms}");
}
