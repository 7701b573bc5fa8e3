//! The PC's end of an ideal link: every request arrives, and so does the answer.

use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::io::link::deck::{FlightDeck, RigDeck};
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::link::message::{Answer, FetchedRecord, Header, Identity, Request, ResetCause};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};
use fmc_camera::io::link::station::{LinkEvent, Station};

pub(crate) const SESSION: u32 = 0x5e55_1011;

/// Bytes that the camera under test reports as used of its stack.
pub(crate) const STACK_USED: u32 = 1234;

/// A station, and the number of the next request.
pub(crate) struct Pc<Deck = RigDeck> {
    pub(crate) station: Station<Deck>,
    pub(crate) next: u16,
    pub(crate) event: Option<LinkEvent>,
}

impl Pc {
    /// Returns a PC without a session.
    pub(crate) fn unconnected() -> Self {
        let identity = Identity::new("test build", "test board", true, ResetCause::Watchdog);
        Self::of(Station::new(identity, || STACK_USED))
    }

    pub(crate) fn connected() -> Self {
        let mut pc = Self::unconnected();
        assert!(matches!(pc.ask(&Request::Connect), Answer::Connected(_)));
        pc
    }

    /// Returns a PC whose camera has a calibration.
    pub(crate) fn loaded() -> Self {
        let mut pc = Self::connected();
        let answer = pc.load(&camera_parameters());
        assert!(matches!(answer, Answer::Loaded(_)), "{answer:?}");
        pc
    }
}

impl<Deck: FlightDeck> Pc<Deck> {
    /// Returns a PC without a session for a station.
    pub(crate) const fn of(station: Station<Deck>) -> Self {
        Self {
            station,
            next: 0,
            event: None,
        }
    }

    /// Loads a calibration in all its parts: the answer to the last, or the first refusal.
    pub(crate) fn load(&mut self, record: &CameraParameters) -> Answer {
        let upload = Upload::of(record).unwrap();
        self.ask_all(upload.requests())
    }

    /// As [`Self::load`], for the flight that is under way.
    pub(crate) fn exchange(&mut self, record: &CameraParameters) -> Answer {
        let upload = Upload::of(record).unwrap();
        self.ask_all(upload.requests_in_flight())
    }

    fn ask_all(&mut self, requests: impl Iterator<Item = Request>) -> Answer {
        let mut last = None;
        for request in requests {
            let answer = self.ask(&request);
            if let Answer::Refused(_) = answer {
                return answer;
            }
            last = Some(answer);
        }
        last.unwrap()
    }

    /// Fetches a record, and acknowledges the records up to it as they are.
    pub(crate) fn acknowledge(&mut self, sequence: u32) -> Answer {
        let crc = match self.ask(&Request::FrameRecord(sequence)) {
            Answer::FrameRecord(Some((_, crc))) => crc,
            _ => 0,
        };
        self.ask(&Request::Acknowledge(FetchedRecord { sequence, crc }))
    }

    /// Asks the next request of the session.
    pub(crate) fn ask(&mut self, request: &Request) -> Answer {
        let header = Header {
            session: SESSION,
            sequence: self.next,
        };
        self.next = self.next.wrapping_add(1);
        self.ask_as(header, request)
    }

    /// Asks a request under any header.
    pub(crate) fn ask_as(&mut self, header: Header, request: &Request) -> Answer {
        let answers = self.send(packet(header, request).bytes());
        let [(answered, answer)] = &answers[..] else {
            panic!("{answers:?}");
        };
        assert_eq!(*answered, header);
        answer.clone()
    }

    /// Sends bytes and reads the answers to them.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> Vec<(Header, Answer)> {
        let mut answers = Vec::new();
        for byte in bytes {
            if let Some(event) = self.station.receive(*byte) {
                self.event = Some(event);
            }
            self.station.keep_flight();
            answers.extend(answers_in(&self.collect()));
        }
        answers
    }

    /// Returns the bytes that the station has to send, taken in pieces of 7.
    pub(crate) fn collect(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        while !self.station.to_send().is_empty() {
            let piece = self.station.to_send();
            let piece = &piece[..piece.len().min(7)];
            bytes.extend(piece);
            let sent = piece.len();
            self.station.sent(sent);
        }
        bytes
    }
}

pub(crate) fn packet(header: Header, request: &Request) -> Packet {
    let mut packet = Packet::EMPTY;
    request.write(header, &mut packet).unwrap();
    packet
}

/// Returns every answer in bytes from the camera, all of them whole.
fn answers_in(bytes: &[u8]) -> Vec<(Header, Answer)> {
    let mut receiver = PacketReceiver::new();
    let mut answers = Vec::new();
    for byte in bytes {
        if let Some(payload) = receiver.receive(*byte) {
            let (header, answer) = Answer::read(payload.unwrap()).unwrap();
            answers.push((header, answer.unwrap()));
        }
    }
    answers
}

/// The request that announces the calibration of a record.
pub(crate) fn begin_load(record: &CameraParameters) -> Request {
    Upload::of(record).unwrap().requests().next().unwrap()
}

/// Returns the 50 mm camera of the README.
pub(crate) fn camera_parameters() -> CameraParameters {
    let mut lens = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    lens.distortion = Brown {
        k1: -1.6056e-5,
        k2: 6.18966e-9,
        k3: -1.31329e-12,
        ..Brown::default()
    };
    CameraParameters::new(lens)
}
