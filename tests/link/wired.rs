//! Cameras to which wires of receiver and autopilot lead: on a board, and on a test rig.

use fmc_camera::flight::bring_up::{NotTried, Trial};
use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::clock_drift::ClockDrift;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::flown_deck::FlownDeck;
use fmc_camera::flight::input_levels::InputLevels;
use fmc_camera::flight::rig::RigStep;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::{VhEstimate, VhSample};
use fmc_camera::io::instruments::{Instruments, Wire, WireBytes};
use fmc_camera::io::link::deck::{FlightDeck, RigDeck};
use fmc_camera::io::link::message::{Answer, Header, Identity, Refusal, Request, ResetCause};
use fmc_camera::io::link::station::Station;
use fmc_camera::io::link::wired_deck::WiredDeck;

use crate::link::pc::{Pc, SESSION, camera_parameters};

/// 50 knots over ground.
const SPEED: &[u8] = b"$GPVTG,054.7,T,,M,50.0,N,,K,A*10\r\n";
const SPEED_M_S: f32 = 50.0 * 1852.0 / 3600.0;

type Deck = WiredDeck<RigDrive>;

fn flown() -> FlownDeck<RigDrive> {
    let drive = RigDrive::new(DriveSettings::default()).unwrap();
    FlownDeck::new(drive, ResetCause::PowerOn.unreferenced())
}

/// Returns a PC with a session on a board with wires, its camera loaded.
fn board() -> Pc<Deck> {
    let identity = Identity::new("test build", "test board", false, ResetCause::PowerOn);
    let deck = WiredDeck::new(flown(), Instruments::new());
    let mut pc = Pc::of(Station::with(identity, || 0, deck));
    assert!(matches!(pc.ask(&Request::Connect), Answer::Connected(_)));
    let loaded = pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    pc
}

fn prepare<D: FlightDeck>(pc: &mut Pc<D>) {
    let prepared = pc.ask(&Request::Prepare(FlightSettings::default()));
    assert_eq!(prepared, Answer::Prepared);
}

/// Runs a round at a time, ms.
fn round(pc: &mut Pc<Deck>, ms: u64) {
    pc.station.deck_mut().round(Time::from_us(1000 * ms));
}

/// Sends a sentence, and runs the rounds from a time on that read it.
fn send_speed(pc: &mut Pc<Deck>, from_ms: u64) {
    for byte in SPEED {
        pc.station.deck_mut().hear(Wire::Receiver, *byte);
    }
    for ms in from_ms..from_ms + 4 {
        round(pc, ms);
    }
}

fn vh(pc: &mut Pc<Deck>, ms: u64) -> Option<VhEstimate> {
    let controller = pc.station.deck_mut().controller().unwrap();
    controller.vh().estimate(Time::from_us(1000 * ms))
}

fn crowded_out(pc: &mut Pc<Deck>) -> u32 {
    match pc.ask(&Request::Instruments) {
        Answer::Instruments(counters) => counters.crowded_out,
        other => panic!("{other:?}"),
    }
}

#[test]
fn sentence_on_the_wire_and_height_over_the_link_give_vh() {
    let mut pc = board();
    prepare(&mut pc);
    round(&mut pc, 100);
    let height = Event::Vh(VhSample::HeightAboveGround(500.0));
    assert_eq!(pc.ask(&Request::Tell(height)), Answer::Told);
    round(&mut pc, 101);
    assert_eq!(vh(&mut pc, 101), None);
    send_speed(&mut pc, 102);
    let estimate = vh(&mut pc, 106).unwrap();
    assert!((estimate.vh_per_s - SPEED_M_S / 500.0).abs() < 1e-6);
    assert_eq!(crowded_out(&mut pc), 0);
}

#[test]
fn sample_of_the_wire_for_which_the_queue_has_no_place_is_counted() {
    let mut pc = board();
    // Before the camera is prepared nobody waits for samples, and none is crowded out.
    send_speed(&mut pc, 10);
    assert_eq!(crowded_out(&mut pc), 0);
    prepare(&mut pc);
    let received = |pc: &mut Pc<Deck>| pc.station.deck_mut().instruments().unwrap().received();
    assert_eq!(received(&mut pc), WireBytes::default(), "a new flight");
    round(&mut pc, 100);
    // All but the end of the line.
    let (begin, end) = SPEED.split_at(SPEED.len() - 2);
    for byte in begin {
        pc.station.deck_mut().hear(Wire::Receiver, *byte);
    }
    for ms in 101..105 {
        round(&mut pc, ms);
    }
    for byte in end {
        pc.station.deck_mut().hear(Wire::Receiver, *byte);
    }
    let direct = Event::Vh(VhSample::Direct(0.1));
    for _ in 0..4 {
        assert_eq!(pc.ask(&Request::Tell(direct)), Answer::Told);
    }
    send_speed(&mut pc, 105);
    assert_eq!(crowded_out(&mut pc), 1);
    let bytes = u32::try_from(2 * SPEED.len()).unwrap();
    assert_eq!(received(&mut pc).receiver, bytes);
    pc.station.deck_mut().count_lost(Wire::Autopilot, 7);
    let counters = pc.station.deck_mut().instruments().unwrap().counters();
    assert_eq!(counters.autopilot.lost_bytes, 7);
}

#[test]
fn camera_with_wires_answers_as_one_without() {
    let mut pc = board();
    let other = Answer::Refused(Refusal::NoRig);
    assert_eq!(pc.ask(&Request::Rig(RigStep::default())), other);
    let sent = WireBytes::default();
    assert_eq!(pc.ask(&Request::Wired(RigStep::default(), sent)), other);
    let shutter = |exposure_s| Request::Try(Trial::Shutter { exposure_s });
    let Answer::Refused(Refusal::NotTried(refused)) = pc.ask(&shutter(-1.0)) else {
        panic!("an exposure of negative length");
    };
    assert!(matches!(refused, NotTried::OutOfBounds { .. }));
    assert_eq!(pc.ask(&shutter(0.01)), Answer::Told);
    prepare(&mut pc);
    let prepared = Answer::Refused(Refusal::NotTried(NotTried::Prepared));
    assert_eq!(pc.ask(&shutter(0.01)), prepared);
    // Another calibration takes the place of the one in use.
    let mut other = camera_parameters();
    other.calibration.pixel_um = 3.9;
    let Answer::Loaded(exchanged) = pc.exchange(&other) else {
        panic!("not exchanged");
    };
    let drift = ClockDrift::after_correction(1.5, 0.25);
    let deck = pc.station.deck_mut();
    assert_eq!(deck.camera().and_then(Camera::id), Some(exchanged));
    deck.flown_mut().note_clock(Some(drift));
    deck.flown_mut().drive_mut().set_count(5000);
    assert!(deck.is_supply_good());
    deck.flown_mut().see(InputLevels {
        supply_low: true,
        ..InputLevels::GOOD
    });
    assert!(!deck.is_supply_good());
    assert_eq!(deck.offset_mm(), None, "no round yet");
    round(&mut pc, 100);
    let offset_mm = pc.station.deck_mut().flown_mut().offset_mm();
    assert!(offset_mm.is_some());
    let Answer::Inputs(inputs) = pc.ask(&Request::Inputs) else {
        panic!("no inputs");
    };
    assert!(inputs.supply_low && !inputs.limit_low && !inputs.limit_high);
    assert_eq!(inputs.clock_drift, Some(drift));
    assert_eq!(inputs.offset_mm, offset_mm);
    let Answer::Status(status) = pc.ask(&Request::Status) else {
        panic!("no status");
    };
    assert_eq!(
        (status.offset_mm, status.clock_drift),
        (offset_mm, Some(drift))
    );
    // A trigger in standby is refused, and its record kept until it is acknowledged.
    let flown = pc.station.deck_mut().flown_mut();
    flown.capture(Time::from_us(100_500), Event::Trigger);
    round(&mut pc, 101);
    let Answer::FrameRecord(Some((record, _))) = pc.ask(&Request::FrameRecord(1)) else {
        panic!("no record");
    };
    assert_eq!((record.sequence, record.calibration), (1, Some(exchanged)));
    assert_eq!(pc.acknowledge(1), Answer::Kept(0));
}

/// Checks that a camera without a calibration holds records, and that its flight goes on once it
/// has one.
fn assert_holds_and_goes_on<D: FlightDeck>(deck: &mut D) {
    let id = Camera::identified(&camera_parameters(), 1, Storage::Stored)
        .unwrap()
        .id();
    let settings = FlightSettings::default();
    let no_camera = Err(Refusal::NoCalibration);
    assert_eq!(deck.prepare(&settings), no_camera);
    assert_eq!(deck.prepare_after_reset(&settings, false), no_camera);
    assert!(deck.record_holder().is_none());
    deck.count_from(3, 8);
    deck.hold_records(id.unwrap());
    let held = deck.record_holder().unwrap();
    assert_eq!((held.flight(), held.calibration()), (8, id));
    assert!(deck.record_holder_mut().is_some());
    assert!(deck.controller().is_none());
    deck.load(Camera::new(camera_parameters()).unwrap());
    deck.prepare_after_reset(&settings, false).unwrap();
    assert_eq!(deck.controller().unwrap().flight(), 8, "the same flight");
    deck.prepare(&settings).unwrap();
    assert_eq!(deck.controller().unwrap().flight(), 9, "the next");
}

#[test]
fn every_deck_holds_the_records_of_a_flight_that_its_camera_is_not_prepared_for() {
    assert_holds_and_goes_on(&mut flown());
    assert_holds_and_goes_on(&mut RigDeck::after(ResetCause::Requested));
    let mut wired = WiredDeck::new(flown(), Instruments::of_system(9));
    wired.hear(Wire::Autopilot, 0xfd);
    assert_holds_and_goes_on(&mut wired);
    let instruments = wired.instruments().unwrap();
    assert_eq!(instruments.received(), WireBytes::default());
    assert_eq!(instruments.counters().autopilot.system, Some(9));
}

#[test]
fn rig_whose_bytes_are_not_all_there_waits_for_them_and_then_hears_them() {
    let mut pc = Pc::loaded();
    let deck = pc.station.deck_mut();
    deck.hear(Wire::Receiver, b'$');
    deck.count_lost(Wire::Receiver, 5);
    let none = Answer::Refused(Refusal::NoInstruments);
    assert_eq!(pc.ask(&Request::Instruments), none);
    prepare(&mut pc);
    let (end, begin) = SPEED.split_last().unwrap();
    for byte in begin {
        pc.station.deck_mut().hear(Wire::Receiver, *byte);
    }
    pc.station.deck_mut().count_lost(Wire::Autopilot, 6);
    let bytes = u32::try_from(SPEED.len()).unwrap();
    let sent = |receiver| WireBytes {
        receiver,
        autopilot: 0,
    };
    let mut step = RigStep {
        time: Time::from_us(1000),
        ..RigStep::default()
    };
    let height = Event::Vh(VhSample::HeightAboveGround(500.0));
    step.events.push((step.time, height)).unwrap();
    let refused = pc.ask(&Request::Wired(step.clone(), sent(bytes)));
    let other = Refusal::OtherBytes(sent(bytes - 1));
    assert_eq!(refused, Answer::Refused(other));
    pc.station.deck_mut().hear(Wire::Receiver, *end);
    for ms in 1..=4 {
        step.time = Time::from_us(1000 * ms);
        let stepped = pc.ask(&Request::Wired(step.clone(), sent(bytes)));
        assert!(matches!(stepped, Answer::Rig(_)), "{stepped:?}");
        step.events.clear();
    }
    let controller = pc.station.deck_mut().controller().unwrap();
    let estimate = controller.vh().estimate(step.time).unwrap();
    assert!((estimate.vh_per_s - SPEED_M_S / 500.0).abs() < 1e-6);
    let Answer::Instruments(counters) = pc.ask(&Request::Instruments) else {
        panic!("no counts");
    };
    assert_eq!(
        (counters.receiver.bytes, counters.receiver.read),
        (bytes, 1)
    );
    assert_eq!(counters.receiver.lost_bytes, 0, "before the flight");
    assert_eq!(counters.autopilot.lost_bytes, 6);
}

#[test]
fn round_of_another_session_or_out_of_order_is_refused_and_not_run() {
    let mut pc = Pc::loaded();
    prepare(&mut pc);
    let request = Request::Rig(RigStep {
        time: Time::from_us(1000),
        ..RigStep::default()
    });
    let other = Header {
        session: SESSION + 1,
        sequence: pc.next,
    };
    let refused = pc.ask_as(other, &request);
    assert_eq!(refused, Answer::Refused(Refusal::OtherSession));
    let expected = pc.next;
    let later = Header {
        session: SESSION,
        sequence: expected + 1,
    };
    let refused = pc.ask_as(later, &request);
    assert_eq!(refused, Answer::Refused(Refusal::OutOfOrder { expected }));
    let controller = pc.station.deck_mut().controller().unwrap();
    assert_eq!(controller.counts().late_ticks, 0);
    assert!(matches!(pc.ask(&request), Answer::Rig(_)));
    let counters = pc.station.counters();
    assert_eq!((counters.other_session, counters.out_of_order), (1, 1));
}
