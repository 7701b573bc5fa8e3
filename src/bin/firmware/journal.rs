//! The log of what the link brings.

#[cfg(feature = "board-nucleo-h743zi")]
use fmc_camera::flight::fault::Fault;
use fmc_camera::io::link::frame::Damage;
use fmc_camera::io::link::message::{Refusal, Start, Unreadable};
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
        Event::Lost(damage) => defmt::warn!("frame lost: {=str}", damage_name(damage)),
        Event::Unreadable(Unreadable::OtherProtocol(version)) => {
            defmt::warn!("frame of protocol version {=u8}", version);
        }
        Event::Unreadable(Unreadable::NoHeader) => defmt::warn!("frame without a header"),
        Event::Refused(refusal) => defmt::warn!("refused: {=str}", refusal_name(refusal)),
        Event::Reset => defmt::info!("reset requested"),
        Event::PowerOff => defmt::info!("power off requested"),
    }
}

/// Something went wrong in flight.
#[cfg(feature = "board-nucleo-h743zi")]
pub(crate) fn note_fault(fault: Fault) {
    defmt::warn!("fault {=u8}: {=str}", fault.code(), fault.name());
}

fn damage_name(damage: Damage) -> &'static str {
    match damage {
        Damage::Truncated => "truncated",
        Damage::Oversized => "oversized",
        Damage::Crc => "wrong CRC",
    }
}

/// What was refused; the numbers are in the answer.
fn refusal_name(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::OtherProtocol => "other protocol",
        Refusal::Unknown => "unknown request",
        Refusal::OtherSession => "session not open",
        Refusal::OutOfOrder { .. } => "out of order",
        Refusal::Calibration(_) => "calibration not usable",
        Refusal::NoCalibration => "no calibration",
        Refusal::Exposure(_) => "exposure not possible",
        Refusal::NoFrame => "no frame",
        Refusal::OffSensor { .. } => "point off the sensor",
        Refusal::Distort { .. } => "no measured point",
        Refusal::TooMany => "too many points",
        Refusal::NoPowerSwitch => "no power switch",
        Refusal::NoFit => "no adjustment",
        Refusal::Observation { .. } => "observation",
        Refusal::Fit(_) => "fit",
        Refusal::NotPrepared => "not prepared for flight",
        Refusal::Settings(_) => "flight settings",
        Refusal::Travel(_) => "travel not possible",
        Refusal::FrameInFlight => "frame in flight",
        Refusal::RecordsKept(_) => "records not acknowledged",
        Refusal::NoRig => "no test rig",
        Refusal::OnRig => "on a test rig",
        Refusal::NotTold => "not to be told",
        Refusal::QueueFull => "too many events",
        Refusal::NoRowClock => "no row clock",
        Refusal::Mesh(_) => "mesh not possible",
    }
}
