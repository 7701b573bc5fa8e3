//! The store behind the link: a calibration that is stored is in use at the next start.

use fmc_camera::flight::calibration_id::{CalibrationId, Storage};
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Command, Event, Supply};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::fault::Fault;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::message::{Answer, Header, Refusal, Request, ResetCause};
use fmc_camera::io::link::station::LinkEvent;
use fmc_camera::io::store::{
    CalibrationStore, NotStored, SignatureVerifier, SlotFault, StoreOrder, StoreStep,
    StoredIdentity,
};

use crate::link::board::Board;
use crate::link::in_flight::{Flight, utc_less_time_us};
use crate::link::pc::{Pc, SESSION, packet};
use crate::store::calibrations::{Credulous, calibration, flash_after, order, origin, store_in};
use crate::store::flash_model::{Cell, Cut, FlashModel};
use crate::store::signed::{permitted, signed, signed_flash, trusting_store};

type Store = CalibrationStore<FlashModel, Credulous>;

/// Returns the PC of a camera that has started from a store.
fn started<V: SignatureVerifier>(store: &mut CalibrationStore<FlashModel, V>) -> Pc {
    let mut pc = Pc::unconnected();
    let _ = pc.station.load_stored(store);
    pc.ask(&Request::Connect);
    pc
}

/// Asks the camera to store what is in use.
pub(crate) fn store(pc: &mut Pc, flash: &mut Store, version: u16) -> Answer {
    store_signed(pc, flash, &order(version))
}

/// Asks the camera to store what is in use under a signature, as its main loop does.
fn store_signed<V: SignatureVerifier>(
    pc: &mut Pc,
    store: &mut CalibrationStore<FlashModel, V>,
    order: &StoreOrder,
) -> Answer {
    let header = Header {
        session: SESSION,
        sequence: pc.next,
    };
    pc.next += 1;
    let request = packet(header, &Request::Store(order.clone()));
    let mut answers = pc.send(request.bytes());
    if pc.event == Some(LinkEvent::Store) {
        assert!(answers.is_empty(), "{answers:?}");
        pc.event = Some(pc.station.store(store));
        // A zero alone is no packet.
        answers = pc.send(&[0]);
    }
    let [(answered, answer)] = &answers[..] else {
        panic!("{answers:?}");
    };
    assert_eq!(*answered, header);
    answer.clone()
}

fn identity(pc: &mut Pc) -> Option<CalibrationId> {
    pc.next = 0;
    match pc.ask(&Request::Connect) {
        Answer::Connected(identity) => identity.calibration,
        other => panic!("{other:?}"),
    }
}

fn points(pc: &mut Pc) -> Answer {
    let exposed = pc.ask(&Request::Expose(Exposure::new(0.02, 0.005)));
    assert!(
        matches!(exposed, Answer::InteriorOrientation(_)),
        "{exposed:?}"
    );
    let points = [(12.5, -7.25), (-20.0, 15.0)];
    let points = points.map(|(x_mm, y_mm)| SensorPoint::new(x_mm, y_mm));
    pc.ask(&Request::Correct(points.into_iter().collect()))
}

fn record(answer: Answer) -> StoredIdentity {
    match answer {
        Answer::Stored(Ok(record)) => record,
        other => panic!("{other:?}"),
    }
}

fn loaded(pc: &mut Pc, parameters: &CameraParameters) {
    let answer = pc.load(parameters);
    assert!(matches!(answer, Answer::Loaded(_)), "{answer:?}");
}

#[test]
fn calibration_that_was_stored_over_the_link_corrects_after_a_start_to_the_same_bits() {
    let mut flash = store_in(FlashModel::blank());
    let mut pc = started(&mut flash);
    let Answer::Stored(Err(nothing)) = pc.ask(&Request::Stored) else {
        panic!("something is stored");
    };
    assert!(nothing.is_blank());
    assert_eq!(identity(&mut pc), None);
    for version in [3, 4] {
        loaded(&mut pc, &calibration(version));
        assert_eq!(identity(&mut pc).unwrap().storage, Storage::Volatile);
        let before = points(&mut pc);
        let stored = record(store(&mut pc, &mut flash, version));
        assert_eq!(pc.event, Some(LinkEvent::Loaded(stored.id)));
        assert_eq!(stored.id.version, u32::from(version));
        assert_eq!(stored.id.storage, Storage::Stored);
        assert_eq!(stored.origin, origin(version));
        assert!(stored.is_sealed);
        // It is the stored one from now on.
        assert_eq!(identity(&mut pc), Some(stored.id));
        assert_eq!(record(pc.ask(&Request::Stored)), stored);
        pc = started(&mut flash);
        assert_eq!(identity(&mut pc), Some(stored.id));
        let found = record(pc.ask(&Request::Stored));
        assert_eq!((found.id, &found.origin), (stored.id, &stored.origin));
        assert_eq!(points(&mut pc), before);
    }
}

#[test]
fn camera_whose_slots_are_both_unreadable_answers_and_says_so_and_stores_again() {
    let mut flash = flash_after(&[3, 4]);
    for sector in &mut flash.sectors {
        sector[0] = Cell::Failing;
    }
    let mut flash = store_in(flash.started());
    let mut pc = started(&mut flash);
    let Answer::Stored(Err(nothing)) = pc.ask(&Request::Stored) else {
        panic!("a calibration is found");
    };
    assert_eq!(nothing.slots, [SlotFault::Unreadable { word: 0 }; 2]);
    assert_eq!(identity(&mut pc), None);
    assert_eq!(
        pc.ask(&Request::Expose(Exposure::new(0.02, 0.005))),
        Answer::Refused(Refusal::NoCalibration)
    );
    loaded(&mut pc, &calibration(4));
    assert_eq!(record(store(&mut pc, &mut flash, 4)).id.version, 4);
}

#[test]
fn store_that_is_asked_for_again_is_answered_from_memory() {
    let mut flash = store_in(FlashModel::blank());
    let mut pc = started(&mut flash);
    loaded(&mut pc, &calibration(3));
    let stored = record(store(&mut pc, &mut flash, 3));
    let writes = flash.flash_mut().operations.len();
    assert!(writes > 10);
    pc.next -= 1;
    let again = pc.ask(&Request::Store(order(3)));
    assert_eq!(record(again), stored);
    assert_eq!(pc.event, Some(LinkEvent::Repeated));
    assert_eq!(flash.flash_mut().operations.len(), writes);
    // Nothing waits for the board.
    assert_eq!(pc.station.store(&mut flash), LinkEvent::Answered);
    assert_eq!(flash.flash_mut().operations.len(), writes);
}

#[test]
fn store_needs_a_store_a_calibration_standby_a_good_supply_and_no_records() {
    let mut pc = Pc::loaded();
    for request in [Request::Stored, Request::Store(order(3))] {
        assert_eq!(pc.ask(&request), Answer::Refused(Refusal::NoStore));
    }
    let mut flash = store_in(FlashModel::blank());
    let mut pc = started(&mut flash);
    let refused = |answer| match answer {
        Answer::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    };
    assert_eq!(
        refused(store(&mut pc, &mut flash, 3)),
        Refusal::NoCalibration
    );

    let mut flight = Flight::loaded();
    let _ = flight.pc.station.load_stored(&mut flash);
    loaded(&mut flight.pc, &calibration(3));
    flight.prepare();
    assert_eq!(
        refused(store(&mut flight.pc, &mut flash, 3)),
        Refusal::NotStandby(State::Fault(Fault::Watchdog))
    );
    flight.arm();
    assert_eq!(
        refused(store(&mut flight.pc, &mut flash, 3)),
        Refusal::FrameInFlight
    );
    flight.round(Some(Event::Command(Command::Disarm)));
    flight.run_until(State::Standby);
    flight.round(Some(Event::Supply(Supply::Low)));
    assert_eq!(
        refused(store(&mut flight.pc, &mut flash, 3)),
        Refusal::SupplyLow
    );
    flight.round(Some(Event::Supply(Supply::Good)));
    assert_eq!(flash.flash_mut().operations, []);
    let stored = record(store(&mut flight.pc, &mut flash, 3));
    assert_eq!(identity(&mut flight.pc), Some(stored.id));
}

#[test]
fn flight_goes_on_with_a_calibration_that_is_stored_and_its_time_after_the_pause() {
    let mut flash = store_in(FlashModel::blank());
    let mut flight = Flight::loaded();
    let _ = flight.pc.station.load_stored(&mut flash);
    loaded(&mut flight.pc, &calibration(3));
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.arm();
    flight.know_utc();
    flight.expose();
    flight.round(Some(Event::Command(Command::Disarm)));
    let before = flight.status();
    let stored = record(store(&mut flight.pc, &mut flash, 3));
    // The main loop has stood still while a sector was erased.
    flight.pause(4.0);
    assert_eq!(flight.round(None).state, State::Standby);
    let after = flight.status();
    assert_eq!(after.calibration, Some(stored.id));
    assert_eq!((after.kept, after.findings), (before.kept, before.findings));
    assert_eq!(after.counts.triggers, before.counts.triggers);
    flight.arm();
    flight.expose();
    let [first, second] = flight.records()[..] else {
        panic!("two records");
    };
    assert_eq!(first.calibration, before.calibration);
    assert_eq!(first.calibration.unwrap().storage, Storage::Volatile);
    assert_eq!(second.calibration, Some(stored.id));
    assert!(!second.faults.contains(Fault::Clock), "{second:?}");
    let off_us = [first, second].map(|record| utc_less_time_us(&record).unwrap());
    assert!(off_us[0].abs_diff(off_us[1]) <= 1, "{off_us:?}");

    // A pause that nobody has told of is a jump of the clock.
    flight.round(Some(Event::Command(Command::Disarm)));
    flight.pause(4.0);
    flight.round(None);
    flight.arm();
    flight.expose();
    let third = flight.records()[2];
    assert!(third.faults.contains(Fault::Clock), "{third:?}");
    assert_eq!(utc_less_time_us(&third), None);
}

#[test]
fn session_for_reading_is_told_what_is_stored_and_cannot_store() {
    let mut flash = store_in(flash_after(&[3]));
    let mut pc = started(&mut flash);
    let header = Header {
        session: SESSION + 1,
        sequence: 0,
    };
    pc.ask_as(header, &Request::ConnectReading);
    assert_eq!(record(pc.ask_as(header, &Request::Stored)).id.version, 3);
    let refused = pc.ask_as(header, &Request::Store(order(3)));
    assert_eq!(refused, Answer::Refused(Refusal::ReadingOnly));
}

#[test]
fn older_version_and_a_flash_that_fails_are_refused_with_their_reasons() {
    let mut flash = store_in(flash_after(&[5]));
    let mut pc = started(&mut flash);
    loaded(&mut pc, &calibration(4));
    let older = NotStored::VersionNotRisen { highest: 5 };
    assert_eq!(
        store(&mut pc, &mut flash, 4),
        Answer::Refused(Refusal::NotStored(older))
    );
    // The calibration in use stays, volatile.
    assert_eq!(identity(&mut pc).unwrap().version, 4);
    assert_eq!(record(pc.ask(&Request::Stored)).id.version, 5);

    // The further seal is the first operation, the erasure the second.
    let failing = flash_after(&[5]).started().cut_at(1, Cut::First(0));
    let mut flash = store_in(failing);
    let mut pc = started(&mut flash);
    loaded(&mut pc, &calibration(6));
    let step = StoreStep::Erase;
    assert_eq!(
        store(&mut pc, &mut flash, 6),
        Answer::Refused(Refusal::NotStored(NotStored::Flash { slot: 1, step }))
    );
    assert_eq!(record(pc.ask(&Request::Stored)).id.version, 5);
    let in_use = identity(&mut pc).unwrap();
    assert_eq!((in_use.version, in_use.storage), (6, Storage::Volatile));
}

#[test]
fn low_supply_refuses_a_store_also_of_a_camera_that_is_not_prepared() {
    let mut flash = store_in(flash_after(&[3]));
    let mut board = Board::connected(ResetCause::PowerOn, 0);
    let _ = board.pc.station.load_stored(&mut flash);
    board.levels.supply_low = true;
    board.round();
    assert!(!board.deck().is_supply_good());
    let refused = board.pc.ask(&Request::Store(order(3)));
    assert_eq!(refused, Answer::Refused(Refusal::SupplyLow));
    board.levels.supply_low = false;
    board.round();
    assert!(board.deck().is_supply_good());
}

#[test]
fn loaded_calibration_stays_volatile_until_its_signature_is_that_of_the_key() {
    let mut flash = trusting_store(signed_flash(&[3]));
    let mut pc = started(&mut flash);
    let at_three = record(pc.ask(&Request::Stored));
    loaded(&mut pc, &calibration(4));
    let mut unsigned = signed(4);
    unsigned.authentication = None;
    let replayed = signed(3);
    let foreign = order(4);
    for (order, reason) in [
        (unsigned, NotStored::Unsigned),
        (replayed, NotStored::WrongSignature),
        (foreign, NotStored::WrongSignature),
    ] {
        let refused = store_signed(&mut pc, &mut flash, &order);
        assert_eq!(refused, Answer::Refused(Refusal::NotStored(reason)));
        let in_use = identity(&mut pc).unwrap();
        assert_eq!((in_use.version, in_use.storage), (4, Storage::Volatile));
        assert_eq!(record(pc.ask(&Request::Stored)).id, at_three.id);
    }
    assert_eq!(flash.flash_mut().operations, []);
    let stored = record(store_signed(&mut pc, &mut flash, &signed(4)));
    assert_eq!(identity(&mut pc), Some(stored.id));
    assert_eq!((stored.store, stored.highest_version), (2, 4));
    // Back to the older one with a permission, once.
    let back = permitted(3, &stored);
    loaded(&mut pc, &calibration(3));
    let stored = record(store_signed(&mut pc, &mut flash, &back));
    assert_eq!((stored.id.version, stored.highest_version), (3, 4));
    loaded(&mut pc, &calibration(5));
    let at_five = record(store_signed(&mut pc, &mut flash, &signed(5)));
    loaded(&mut pc, &calibration(3));
    let replayed = store_signed(&mut pc, &mut flash, &back);
    assert!(
        matches!(
            replayed,
            Answer::Refused(Refusal::NotStored(NotStored::OtherPermission { .. }))
        ),
        "{replayed:?}"
    );
    assert_eq!(record(pc.ask(&Request::Stored)).id, at_five.id);
}

#[test]
fn camera_whose_slots_are_signed_by_another_answers_and_says_so() {
    let mut flash = CalibrationStore::new(flash_after(&[3, 4]).started(), 0).unwrap();
    let mut pc = started(&mut flash);
    let Answer::Stored(Err(nothing)) = pc.ask(&Request::Stored) else {
        panic!("a calibration is found");
    };
    assert_eq!(nothing.slots, [SlotFault::NoKey; 2]);
    let mut flash = trusting_store(flash.into_flash());
    let mut pc = started(&mut flash);
    let Answer::Stored(Err(nothing)) = pc.ask(&Request::Stored) else {
        panic!("a calibration is found");
    };
    assert_eq!(nothing.slots, [SlotFault::WrongSignature; 2]);
    assert_eq!(identity(&mut pc), None);
    loaded(&mut pc, &calibration(4));
    let stored = record(store_signed(&mut pc, &mut flash, &signed(4)));
    assert_eq!((stored.id.version, stored.other), (4, None));
}
