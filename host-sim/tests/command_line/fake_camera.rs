//! Cameras at the other end of a wire, working or faulty.

use std::io::{ErrorKind, Read, Write};

use fmc_camera::io::link::deck::{FlightDeck, RigDeck};
use fmc_camera::io::link::message::{Answer, Identity, ResetCause};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};
use fmc_camera::io::link::station::{LinkEvent, Station};

/// A camera that works correctly until told otherwise.
pub(crate) struct FakeCamera<Deck = RigDeck> {
    station: Station<Deck>,
    /// Changes an answer before it is sent.
    pub(crate) change: fn(&mut Answer),
    /// Called with the number of answers given so far; `false` ends the service.
    pub(crate) goes_on: Box<dyn FnMut(usize) -> bool + Send>,
    /// Called before the camera looks at what has arrived.
    pub(crate) before: Box<dyn FnMut(&mut Deck) + Send>,
}

impl FakeCamera {
    /// Returns a camera that works correctly.
    pub(crate) fn new() -> Self {
        Self::with(RigDeck::after(ResetCause::PowerOn))
    }
}

impl<Deck: FlightDeck> FakeCamera<Deck> {
    /// Returns a camera that works correctly, with this deck.
    pub(crate) fn with(deck: Deck) -> Self {
        let identity = Identity::new("of the test", "fake", true, ResetCause::PowerOn);
        Self {
            station: Station::with(identity, || 0, deck),
            change: |_| {},
            goes_on: Box::new(|_| true),
            before: Box::new(|_| ()),
        }
    }

    /// Answers until the wire ends, the camera is switched off, or `goes_on` returns false.
    pub(crate) fn serve(&mut self, wire: &mut (impl Read + Write)) {
        let mut answers = 0;
        let mut buffer = [0; 4096];
        while (self.goes_on)(answers) {
            let count = match wire.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::TimedOut => continue,
                Err(_) => return,
            };
            (self.before)(self.station.deck_mut());
            for byte in &buffer[..count] {
                let event = self.station.receive(*byte);
                let frame = self.station.to_send().to_vec();
                if frame.is_empty() {
                    continue;
                }
                self.station.sent(frame.len());
                if wire.write_all(&self.changed(&frame)).is_err() {
                    return;
                }
                answers += 1;
                if event == Some(LinkEvent::PowerOff) {
                    return;
                }
            }
        }
    }

    fn changed(&self, frame: &[u8]) -> Vec<u8> {
        let mut receiver = PacketReceiver::new();
        for byte in frame {
            if let Some(payload) = receiver.receive(*byte) {
                let (header, answer) = Answer::read(payload.unwrap()).unwrap();
                let mut answer = answer.unwrap();
                (self.change)(&mut answer);
                let mut frame = Packet::EMPTY;
                answer.write(header, &mut frame).unwrap();
                return frame.bytes().to_vec();
            }
        }
        panic!("the camera sent no frame");
    }
}
