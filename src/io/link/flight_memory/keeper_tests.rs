//! Resets while the keeper copies a flight whose records have been acknowledged.

use std::boxed::Box;
use std::vec::Vec;

use super::FlightMemory;
use super::words::reset;
use crate::flight::calibration_id::Storage;
use crate::flight::camera::CameraParameters;
use crate::flight::event::Event;
use crate::flight::frame_record::{FrameRecord, Outcome, Reason};
use crate::flight::record_log::CAPACITY;
use crate::flight::rig::RigStep;
use crate::flight::settings::FlightSettings;
use crate::flight::time::Time;
use crate::geometry::calibration::CalibrationParameters;
use crate::io::link::after_reset::{AfterReset, FlightAfterReset};
use crate::io::link::digest;
use crate::io::link::message::{Answer, FetchedRecord, Header, Identity, Request, ResetCause};
use crate::io::link::packet::{Packet, PacketReceiver};
use crate::io::link::station::Station;

/// A camera on a test rig, with its PC.
struct Camera {
    station: Station,
    next: u16,
    now: Time,
}

impl Camera {
    fn started(cause: ResetCause, memory: &'static FlightMemory) -> (Self, AfterReset) {
        let identity = Identity::new("build", "board", true, cause);
        let mut station = Station::new(identity, || 0);
        let found = station.keep_flight_in(memory);
        let mut camera = Self {
            station,
            next: 0,
            now: Time::START,
        };
        camera.ask(&Request::Connect);
        (camera, found)
    }

    /// Asks, and copies nothing.
    fn ask(&mut self, request: &Request) -> Answer {
        let header = Header {
            session: 1,
            sequence: self.next,
        };
        self.next += 1;
        let mut packet = Packet::EMPTY;
        request.write(header, &mut packet).unwrap();
        for byte in packet.bytes() {
            self.station.receive(*byte);
        }
        let mut receiver = PacketReceiver::new();
        let mut answer = None;
        for byte in self.station.to_send() {
            if let Some(payload) = receiver.receive(*byte) {
                answer = Some(Answer::read(payload.unwrap()).unwrap().1.unwrap());
            }
        }
        let length = self.station.to_send().len();
        self.station.sent(length);
        answer.unwrap()
    }

    /// Makes a round with so many triggers, which a camera in standby refuses.
    fn trigger(&mut self, triggers: usize) {
        self.now = self.now.plus_s(1e-3);
        let mut step = RigStep {
            time: self.now,
            ..RigStep::default()
        };
        for _ in 0..triggers {
            step.events.push((self.now, Event::Trigger)).unwrap();
        }
        let answer = self.ask(&Request::Rig(step));
        assert!(matches!(answer, Answer::Rig(_)), "{answer:?}");
    }

    fn record(&mut self, from: u32) -> Option<FrameRecord> {
        match self.ask(&Request::FrameRecord(from)) {
            Answer::FrameRecord(record) => record.map(|(record, _)| record),
            other => panic!("{other:?}"),
        }
    }

    fn records(&mut self) -> Vec<FrameRecord> {
        let mut records = Vec::new();
        while let Some(record) = self.record(records.last().map_or(0, next_of)) {
            records.push(record);
        }
        records
    }

    fn acknowledge(&mut self, sequence: u32) -> Answer {
        let record = self.record(sequence).unwrap();
        let crc = digest::of_frame_record(&record).unwrap();
        self.ask(&Request::Acknowledge(FetchedRecord { sequence, crc }))
    }
}

fn next_of(record: &FrameRecord) -> u32 {
    record.sequence + 1
}

/// Returns a camera all of whose records are kept, and there is no place for another.
fn full(memory: &'static FlightMemory) -> Camera {
    let (mut camera, _) = Camera::started(ResetCause::PowerOn, memory);
    let lens = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    let parameters = CameraParameters::new(lens);
    camera.station.load(&parameters, Storage::Volatile).unwrap();
    let prepared = camera.ask(&Request::Prepare(FlightSettings::default()));
    assert_eq!(prepared, Answer::Prepared);
    for _ in 0..CAPACITY / 2 {
        camera.trigger(2);
        camera.station.keep_flight();
    }
    camera
}

#[test]
fn acknowledgement_is_kept_before_records_reuse_the_slots_of_acknowledged_ones() {
    let last = u32::try_from(CAPACITY).unwrap();
    let (acknowledged, new) = (4, 3);
    let (mut left, mut told) = (0, 0);
    loop {
        let memory = Box::leak(Box::new(FlightMemory::blank()));
        let mut camera = full(memory);
        let before = camera.records();
        assert_eq!(before.len(), CAPACITY);
        // Both come between two looks of the keeper: more new ones than there are free slots.
        let kept = camera.acknowledge(acknowledged);
        assert_eq!(kept, Answer::Kept(last - acknowledged));
        camera.trigger(new);
        let after = camera.records();
        assert_eq!(after.len(), CAPACITY - 4 + new);
        reset::after(Some(left));
        camera.station.keep_flight();
        let is_whole = reset::left() != Some(0);
        reset::after(None);

        let words = Box::leak(Box::new(FlightMemory::of_words(memory.words())));
        let (mut camera, found) = Camera::started(ResetCause::Watchdog, words);
        assert_eq!(found.outcome, FlightAfterReset::StandsBy, "{left}");
        let records = camera.records();
        // Those before the step, or after it, none of them damaged. Of the new ones there may be
        // the number alone.
        let from = records.first().map(|first| first.sequence);
        assert!(
            from == Some(1) || from == Some(acknowledged + 1),
            "{from:?}"
        );
        told += usize::from(from == Some(1));
        let old = before.iter().filter(|record| Some(record.sequence) >= from);
        let (kept, later) = records.split_at(old.clone().count());
        assert!(old.eq(kept), "{left}");
        let new = after.iter().filter(|record| record.sequence > last);
        let mut damaged = 0;
        for (record, expected) in later.iter().zip(new) {
            assert_eq!(record.sequence, expected.sequence);
            if record != expected {
                assert_eq!(record.outcome, Outcome::Refused(Reason::Unusable));
                damaged += 1;
            }
        }
        assert_eq!((found.damaged, found.unfinished), (damaged, 0), "{left}");
        if is_whole {
            assert_eq!(records, after);
            break;
        }
        left += 1;
    }
    // Some resets come before the acknowledgement is kept, and most behind it.
    assert!(told > 3 && left > 50, "{told} of {left}");
}
