//! Ring of bytes between the receive interrupt and the main loop.

use fmc_camera::flight::ring::Ring;
use fmc_camera::io::link::LONGEST_PACKET;

/// Largest number of bytes that wait: two of the longest frames and more. The ring needs a power of
/// two.
const CAPACITY: usize = (2 * LONGEST_PACKET).next_power_of_two();

/// Written by the interrupt, read by the main loop.
pub(super) type ReceiveRing = Ring<u8, CAPACITY>;
