//! Log of the link's events and of faults.

#[cfg(feature = "board-nucleo-h743zi")]
use fmc_camera::flight::{fault::Fault, in_doubt::InDoubt};
use fmc_camera::io::link::after_reset::{AfterReset, FlightAfterReset, WithoutEyes};
use fmc_camera::io::link::message::ResetCause;
use fmc_camera::io::link::station::LinkEvent;
#[cfg(feature = "store")]
use fmc_camera::io::store::{NothingStored, StoredIdentity};

/// Logs the first line.
pub(crate) fn note_start(board: &str, build: &str, start: ResetCause) {
    let after = match start {
        ResetCause::PowerOn => "power on",
        ResetCause::Requested => "request",
        ResetCause::Watchdog => "watchdog",
        ResetCause::Fault => "fault",
        ResetCause::StackOverflow => "stack overflow",
    };
    defmt::info!("{=str} {=str} starts after {=str}", board, build, after);
    #[cfg(test_key)]
    defmt::warn!("calibrations are trusted by the test key: everybody can sign them");
}

/// Logs what the start has found in the store.
#[cfg(feature = "store")]
pub(crate) fn note_stored(found: &Result<StoredIdentity, NothingStored>) {
    match found {
        Ok(record) => defmt::info!(
            "calibration {=u32:#010x} of slot {=u8}",
            record.id.crc,
            record.slot
        ),
        Err(nothing) if nothing.is_blank() => defmt::info!("no calibration is stored"),
        Err(nothing) => {
            let [first, second] = nothing.slots;
            defmt::warn!("no calibration is found: {}; {}", first, second);
        }
    }
}

/// Logs what the start has made of the flight before it.
pub(crate) fn note_flight(found: &AfterReset) {
    defmt::info!("start {=u32}: {=str}", found.boot, found.outcome.describe());
    if found.outcome != FlightAfterReset::Nothing {
        defmt::info!(
            "flight {=u32}: {=u32} records, {=u32} unfinished, {=u32} damaged",
            found.flight,
            found.records,
            found.unfinished,
            found.damaged
        );
    }
    match found.without_eyes {
        WithoutEyes::NoFlight => {}
        WithoutEyes::GoesOn { before_clock_ms }
        | WithoutEyes::AtMost {
            before_clock_ms, ..
        } => {
            defmt::warn!(
                "without eyes: {=u32} ms at most until the clock ran, and since then until the first round",
                before_clock_ms
            );
        }
        WithoutEyes::Unknown => defmt::warn!("without eyes: nobody knows how long"),
    }
}

/// Logs a line for each event that is not the ordinary flow of points.
pub(crate) fn note(event: LinkEvent) {
    match event {
        LinkEvent::Connected(session) => defmt::info!("session {=u32:#010x} opened", session),
        LinkEvent::Loaded(calibration) => {
            defmt::info!("calibration {=u32:#010x} in use", calibration.crc);
        }
        LinkEvent::Exposed | LinkEvent::Answered => {}
        LinkEvent::Repeated => defmt::warn!("request repeated"),
        LinkEvent::Lost(damage) => defmt::warn!("packet lost: {}", damage),
        LinkEvent::Unreadable(unreadable) => defmt::warn!("packet unreadable: {}", unreadable),
        LinkEvent::Refused(refusal) => defmt::warn!("refused: {}", refusal),
        LinkEvent::Store => defmt::info!("store requested"),
        LinkEvent::Reset => defmt::info!("reset requested"),
        LinkEvent::PowerOff => defmt::info!("power off requested"),
    }
}

/// Logs a fault in flight.
#[cfg(feature = "board-nucleo-h743zi")]
pub(crate) fn note_fault(fault: Fault) {
    defmt::warn!("fault {=u8}: {}", fault.code(), fault);
}

/// Logs that the encoder was wrong in earlier exposures.
#[cfg(feature = "board-nucleo-h743zi")]
pub(crate) fn note_doubt(exposures: InDoubt) {
    defmt::warn!("principal points are in doubt: {}", exposures);
}
