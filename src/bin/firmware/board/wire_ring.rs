//! Bytes of a receiver or an autopilot on their way from the interrupt to the control loop.

use fmc_camera::flight::ring::Ring;
use fmc_camera::io::instruments::WAITING_BYTES;

/// Written by the interrupt, read once a round or more often.
pub(super) type WireRing = Ring<u8, WAITING_BYTES>;
