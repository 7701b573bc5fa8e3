//! A wire in memory with a camera at its end, and with the faults of real wires.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use fmc_camera::io::link::message::{Answer, Identity, ResetCause};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};
use fmc_camera::io::link::station::{LinkEvent, Station};

use super::port::Port;

/// Fault of a packet on its way, in either direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// No fault.
    None,
    /// The packet is lost.
    Lost,
    /// The byte at this index, modulo the length of the packet, has these bits inverted.
    Corrupted { at: usize, bits: u8 },
    /// Only the first bytes arrive: this share of 256.
    Truncated(u8),
    /// The packet arrives twice.
    Duplicated,
    /// The packet arrives after so many time limits.
    Delayed(u8),
    /// The packet arrives twice, the second time after so many time limits.
    Echoed(u8),
    /// The camera restarts before the packet arrives.
    Restart,
}

/// Camera, wire and the PCs on it; every PC receives every answer.
#[derive(Debug)]
struct Wire {
    station: Station,
    faults: VecDeque<Fault>,
    now: u32,
    to_camera: Vec<(u32, Vec<u8>)>,
    to_host: Vec<(u32, Vec<u8>)>,
    inboxes: Vec<VecDeque<u8>>,
    closed: bool,
    change: fn(&mut Answer),
}

/// A PC's port to the wire.
#[derive(Debug, Clone)]
pub(super) struct FaultyPort {
    wire: Arc<Mutex<Wire>>,
    host: usize,
}

fn station(start: ResetCause) -> Station {
    Station::new(Identity::new("test", "memory", true, start), || 0)
}

impl FaultyPort {
    /// Returns a port to a camera that has just been switched on. The faults apply to one packet
    /// each; all later packets are undisturbed.
    pub(super) fn new(faults: impl IntoIterator<Item = Fault>) -> Self {
        let wire = Wire {
            station: station(ResetCause::PowerOn),
            faults: faults.into_iter().collect(),
            now: 0,
            to_camera: Vec::new(),
            to_host: Vec::new(),
            inboxes: vec![VecDeque::new()],
            closed: false,
            change: |_| {},
        };
        Self {
            wire: Arc::new(Mutex::new(wire)),
            host: 0,
        }
    }

    /// Returns the port of another PC on the same wire.
    pub(super) fn another(&self) -> Self {
        let mut wire = self.wire.lock().unwrap();
        wire.inboxes.push(VecDeque::new());
        Self {
            wire: Arc::clone(&self.wire),
            host: wire.inboxes.len() - 1,
        }
    }

    /// Replaces the faults of the packets to come.
    pub(super) fn set_faults(&self, faults: impl IntoIterator<Item = Fault>) {
        self.wire.lock().unwrap().faults = faults.into_iter().collect();
    }

    /// Closes the port from the other end.
    pub(super) fn close(&self) {
        self.wire.lock().unwrap().closed = true;
    }

    /// Restarts the camera.
    pub(super) fn restart(&self) {
        self.wire.lock().unwrap().station = station(ResetCause::Watchdog);
    }

    /// Applies this change to the camera's answers before they are put into packets.
    pub(super) fn tamper(&self, change: fn(&mut Answer)) {
        self.wire.lock().unwrap().change = change;
    }

    /// Sends bytes to the camera, as another program on the wire would.
    pub(super) fn inject(&self, bytes: &[u8]) {
        self.wire.lock().unwrap().camera_receives(bytes);
    }
}

impl Wire {
    /// Puts a packet on its way; returns what arrives, and when.
    fn on_the_way(&mut self, mut bytes: Vec<u8>) -> Vec<(u32, Vec<u8>)> {
        let now = self.now;
        match self.faults.pop_front().unwrap_or(Fault::None) {
            Fault::None => vec![(now, bytes)],
            Fault::Lost => Vec::new(),
            Fault::Corrupted { at, bits } => {
                let at = at % bytes.len();
                bytes[at] ^= bits;
                vec![(now, bytes)]
            }
            Fault::Truncated(share) => {
                bytes.truncate(bytes.len() * usize::from(share) / 256);
                vec![(now, bytes)]
            }
            Fault::Duplicated => vec![(now, bytes.clone()), (now, bytes)],
            Fault::Delayed(by) => vec![(now + u32::from(by), bytes)],
            Fault::Echoed(by) => vec![(now, bytes.clone()), (now + u32::from(by), bytes)],
            Fault::Restart => {
                self.station = station(ResetCause::Watchdog);
                vec![(now, bytes)]
            }
        }
    }

    fn camera_receives(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let event = self.station.receive(*byte);
            let answer = self.station.to_send().to_vec();
            if answer.is_empty() {
                continue;
            }
            self.station.sent(answer.len());
            let arriving = self.on_the_way(changed(&answer, self.change));
            self.to_host.extend(arriving);
            if event == Some(LinkEvent::Reset) {
                self.station = station(ResetCause::Requested);
            }
        }
    }

    /// Delivers the bytes that are due.
    fn deliver(&mut self) {
        let now = self.now;
        let due = |queue: &mut Vec<(u32, Vec<u8>)>| -> Vec<Vec<u8>> {
            let (due, later) = queue.drain(..).partition(|(time, _)| *time <= now);
            *queue = later;
            Vec::into_iter(due).map(|(_, bytes)| bytes).collect()
        };
        for bytes in due(&mut self.to_camera) {
            self.camera_receives(&bytes);
        }
        for bytes in due(&mut self.to_host) {
            for inbox in &mut self.inboxes {
                inbox.extend(&bytes);
            }
        }
    }
}

/// Returns a packet whose answer has been changed.
fn changed(packet: &[u8], change: fn(&mut Answer)) -> Vec<u8> {
    let mut receiver = PacketReceiver::new();
    for byte in packet {
        if let Some(payload) = receiver.receive(*byte) {
            let (header, answer) = Answer::read(payload.unwrap()).unwrap();
            let mut answer = answer.unwrap();
            change(&mut answer);
            let mut packet = Packet::EMPTY;
            answer.write(header, &mut packet).unwrap();
            return packet.bytes().to_vec();
        }
    }
    panic!("the camera sent no packet");
}

impl Port for FaultyPort {
    fn receive(&mut self, buffer: &mut [u8], _: Instant) -> io::Result<usize> {
        let mut wire = self.wire.lock().unwrap();
        if wire.closed {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        wire.deliver();
        let inbox = &mut wire.inboxes[self.host];
        let count = inbox.len().min(buffer.len());
        for (to, from) in buffer.iter_mut().zip(inbox.drain(..count)) {
            *to = from;
        }
        if count == 0 {
            // The time limit has passed.
            wire.now += 1;
        }
        Ok(count)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut wire = self.wire.lock().unwrap();
        if wire.closed {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let arriving = wire.on_the_way(bytes.to_vec());
        wire.to_camera.extend(arriving);
        Ok(())
    }
}
