//! The log of what the link brings.

#[cfg(feature = "board-nucleo-h743zi")]
use fmc_camera::flight::fault::Fault;
use fmc_camera::io::link::message::Start;
use fmc_camera::io::link::station::Event;

/// The first line.
pub(crate) fn note_start(board: &str, build: &str, start: Start) {
    let after = match start {
        Start::PowerOn => "power on",
        Start::Requested => "request",
        Start::Watchdog => "watchdog",
        Start::Fault => "fault",
    };
    defmt::info!("{=str} {=str} starts after {=str}", board, build, after);
}

/// A line for each event that is not the ordinary flow of points.
pub(crate) fn note(event: Event) {
    match event {
        Event::Connected(session) => defmt::info!("session {=u32:#010x} opened", session),
        Event::Loaded(calibration) => {
            defmt::info!("calibration {=u32:#010x} in use", calibration.crc);
        }
        Event::Exposed | Event::Answered => {}
        Event::Repeated => defmt::warn!("request repeated"),
        Event::Lost(damage) => defmt::warn!("frame lost: {}", damage),
        Event::Unreadable(unreadable) => defmt::warn!("frame unreadable: {}", unreadable),
        Event::Refused(refusal) => defmt::warn!("refused: {}", refusal),
        Event::Reset => defmt::info!("reset requested"),
        Event::PowerOff => defmt::info!("power off requested"),
    }
}

/// Something went wrong in flight.
#[cfg(feature = "board-nucleo-h743zi")]
pub(crate) fn note_fault(fault: Fault) {
    defmt::warn!("fault {=u8}: {}", fault.code(), fault);
}
