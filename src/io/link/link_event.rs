//! Events of the link.

use super::message::{Refusal, Unreadable};
use super::packet::Damage;
use crate::flight::calibration_id::CalibrationId;

/// Result of a byte, for the log, and for actions that only the board can carry out.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkEvent {
    /// A packet was damaged on its way. Nothing is answered.
    Lost(Damage),
    /// A whole packet has no header of this version.
    Unreadable(Unreadable),
    /// A session was opened under this number.
    Connected(u32),
    /// A calibration is in use.
    Loaded(CalibrationId),
    /// A frame was predicted.
    Exposed,
    /// Another request was answered.
    Answered,
    /// A request was answered once more.
    Repeated,
    /// A request was refused.
    Refused(Refusal),
    /// The calibration in use is to be stored now
    /// ([`Station::store`](super::station::Station::store), feature `store`), which answers.
    Store,
    /// The camera is to start again once the answer has left.
    Reset,
    /// The camera is to switch off once the answer has left.
    PowerOff,
}
