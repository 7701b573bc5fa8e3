//! Wires of receiver and autopilot to a camera.

use std::io;

use fmc_camera::io::instruments::WireBytes;
use fmc_simulation::mission::wire::WireTraffic;

use super::port::Port;

/// The far ends of a camera's wires, and the number of bytes sent on each since the camera was
/// prepared.
#[derive(Debug)]
pub(super) struct Wires<P> {
    receiver: P,
    autopilot: P,
    sent: WireBytes,
}

impl<P: Port> Wires<P> {
    /// Returns wires on which nothing has been sent.
    pub(super) fn new(receiver: P, autopilot: P) -> Self {
        Self {
            receiver,
            autopilot,
            sent: WireBytes::default(),
        }
    }

    /// Counts from 0 again.
    pub(super) fn restart(&mut self) {
        self.sent = WireBytes::default();
    }

    /// Sends bytes; returns the number of all bytes sent.
    ///
    /// # Errors
    /// The system's error of either wire.
    pub(super) fn send(&mut self, traffic: &WireTraffic) -> io::Result<WireBytes> {
        for (port, bytes, sent) in [
            (
                &mut self.receiver,
                &traffic.receiver,
                &mut self.sent.receiver,
            ),
            (
                &mut self.autopilot,
                &traffic.autopilot,
                &mut self.sent.autopilot,
            ),
        ] {
            if !bytes.is_empty() {
                port.send(bytes)?;
                let count = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
                *sent = sent.wrapping_add(count);
            }
        }
        Ok(self.sent)
    }
}
