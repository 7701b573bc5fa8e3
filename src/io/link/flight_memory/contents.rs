//! Contents of the memory that a reset leaves alone.

use serde::{Deserialize, Serialize};

use crate::flight::calibration_id::CalibrationId;
use crate::flight::controller::FlightState;
use crate::flight::flown_calibrations::EarlierList;
use crate::flight::record_log::Entry;

/// State of the camera and of its flight, besides settings, parameters and records.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptHead {
    /// CRC-32 of the firmware's build. It is the first field in every layout: another firmware may
    /// write the others otherwise.
    pub(crate) build: u32,
    /// Number of this writing.
    pub(crate) writing: u32,
    /// Number of the camera's start, from 1, since its memory was last without supply.
    pub(crate) boot: u32,
    /// Number of the last flight, counted in the same way.
    pub(crate) flight: u32,
    /// Resets in a row of the prepared camera, each soon after the one before.
    pub(crate) resumed: u8,
    /// A round of the control loop has come since the start, or since a pause for the store.
    pub(crate) has_round: bool,
    /// The flight; `None` while the camera is not prepared.
    pub(crate) prepared: Option<KeptFlight>,
}

/// The flight that the camera is prepared for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptFlight {
    pub(crate) calibration: CalibrationId,
    /// Those of records from before it was put into use.
    pub(crate) earlier: EarlierList,
    /// The calibration has residual grids, which are not kept.
    pub(crate) has_grids: bool,
    /// CRC-32 of the settings.
    pub(crate) settings: u32,
    pub(crate) state: FlightState,
}

/// A record of the flight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptRecord {
    /// Number of its flight.
    pub(crate) flight: u32,
    /// Number of the head's writing that follows: the newest of two copies is the later one.
    pub(crate) writing: u32,
    /// The frame is in flight.
    pub(crate) is_pending: bool,
    /// Number of the start in which the trigger came.
    pub(crate) boot: u32,
    pub(crate) record: Entry,
}
