//! Records whose exposures no crossing of the index mark has confirmed when the camera ends.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome};
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{Answer, Request, ResetCause};

use crate::link::in_flight::Flight;
use crate::link::pc::camera_parameters;
use crate::link::power_cuts::{
    Flash, Ring, all_records, blank_memory, expose, settle, start, start_cold,
};

/// Starts a camera with an index mark, and arms it.
fn armed(memory: &'static FlightMemory) -> (Flight, Ring) {
    let (mut flight, mut ring) = start(ResetCause::PowerOn, memory, Flash::blank());
    flight.has_index = true;
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    let mut settings = FlightSettings::default();
    settings.drive.index_mm = Some(0.0);
    let prepared = flight.pc.ask(&Request::Prepare(settings));
    assert_eq!(prepared, Answer::Prepared);
    settle(&mut flight, &mut ring);
    flight.arm();
    settle(&mut flight, &mut ring);
    (flight, ring)
}

/// Takes a frame until its record is there, while the stage has not returned.
fn expose_without_return(flight: &mut Flight) {
    flight.round(Some(Event::Trigger));
    flight.run_until(State::FlyBack);
}

fn are_unreferenced(records: &[FrameRecord]) -> Vec<bool> {
    let flags = records
        .iter()
        .map(|it| it.flags.contains(Flag::Unreferenced));
    flags.collect()
}

fn sigma_mm(record: &FrameRecord) -> f32 {
    match &record.outcome {
        Outcome::Exposed(frame) => frame.principal_point_sigma.total_mm(),
        Outcome::Refused(reason) => panic!("{reason}"),
    }
}

fn in_doubt(flight: &mut Flight) -> Option<InDoubt> {
    flight.status().in_doubt
}

/// Checks that the last of two records is in doubt, and the first as it was.
fn assert_last_is_doubted(flight: &mut Flight, before: &[FrameRecord]) {
    let found = all_records(flight);
    assert_eq!(are_unreferenced(&found), [false, true]);
    assert_eq!(found[0], before[0]);
    let exposures = in_doubt(flight).unwrap();
    assert!(
        exposures.contains(2) && !exposures.contains(1),
        "{exposures:?}"
    );
    assert!(!exposures.is_fault);
    let expected_mm = libm::hypotf(sigma_mm(&before[1]), exposures.off_mm);
    assert!((sigma_mm(&found[1]) / expected_mm - 1.0).abs() < 1e-3);
}

#[test]
fn exposure_that_waits_for_the_way_back_is_in_doubt_after_a_reset_and_after_a_loss_of_supply() {
    let memory = blank_memory();
    let (mut flight, mut ring) = armed(memory);
    expose(&mut flight);
    expose_without_return(&mut flight);
    settle(&mut flight, &mut ring);
    let before = all_records(&mut flight);
    assert_eq!(are_unreferenced(&before), [false, false]);
    let flash = ring.into_flash();
    let copy = Box::leak(Box::new(FlightMemory::of_words(memory.words())));
    let (mut again, _) = start(ResetCause::Watchdog, copy, flash.clone());
    assert_last_is_doubted(&mut again, &before);
    let (mut cold, _) = start_cold(flash);
    assert_last_is_doubted(&mut cold, &before);
}
