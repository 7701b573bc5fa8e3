//! Calibrations that come during a flight, and the camera that is prepared after them.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{FrameRecord, Outcome};
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::link::after_reset::AfterReset;
use fmc_camera::io::link::deck::FlightDeck;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{
    Answer, FetchedRecord, Identity, Refusal, Request, ResetCause, Status,
};
use fmc_camera::io::link::station::Station;

use crate::link::pc::{Pc, STACK_USED, camera_parameters};

/// A test rig with an ideal stage.
pub(crate) struct Flight {
    pub(crate) pc: Pc,
    now: Time,
    edges: Vec<(Time, Event)>,
    /// `true` if there is an index mark at the calibrated position.
    pub(crate) has_index: bool,
    /// Set point in the last round, mm.
    set_mm: f32,
    pub(crate) after_reset: AfterReset,
}

/// Upper edge of the mark as the encoder counts it against the axis, mm: with 5 µm of play.
const UPPER_EDGE_MM: f32 = 0.045;

/// Longest time from the last round until the clock of the rig runs again, ms.
pub(crate) const RESET_MS: u32 = 600;

impl Flight {
    /// Returns a rig with a calibration.
    pub(crate) fn loaded() -> Self {
        Self {
            pc: Pc::loaded(),
            now: Time::START,
            edges: Vec::new(),
            has_index: false,
            set_mm: 0.0,
            after_reset: AfterReset::FIRST,
        }
    }

    /// Returns a rig whose camera has started again with what is in memory.
    pub(crate) fn after_reset(cause: ResetCause, memory: &'static FlightMemory) -> Self {
        Self::of_build("test build", cause, memory)
    }

    /// As [`Self::after_reset`], with a build of the firmware.
    pub(crate) fn of_build(build: &str, cause: ResetCause, memory: &'static FlightMemory) -> Self {
        let identity = Identity::new(build, "test board", true, cause);
        let mut station = Station::new(identity, || STACK_USED);
        station.bound_reset((cause != ResetCause::PowerOn).then_some(RESET_MS));
        Self::of(station, memory)
    }

    /// Returns a rig whose camera has started again.
    pub(crate) fn of(mut station: Station, memory: &'static FlightMemory) -> Self {
        let after_reset = station.keep_flight_in(memory);
        let mut pc = Pc::of(station);
        let Answer::Connected(identity) = pc.ask(&Request::Connect) else {
            panic!("no session");
        };
        assert_eq!(identity.after_reset, after_reset);
        Self {
            pc,
            now: Time::START,
            edges: Vec::new(),
            has_index: false,
            set_mm: 0.0,
            after_reset,
        }
    }

    /// Arms the prepared camera.
    pub(crate) fn arm(&mut self) {
        for command in [Command::ClearFault, Command::Referenced, Command::Arm] {
            self.round(Some(Event::Command(command)));
        }
        self.run_until(State::Armed);
    }

    pub(crate) fn round(&mut self, event: Option<Event>) -> RigAnswer {
        self.now = self.now.plus_s(1e-3);
        let now = self.now;
        let controller = self.pc.station.deck_mut().controller().unwrap();
        let offset_mm = controller.setpoint(now).map_or(0.0, |it| it.offset_mm);
        let before_mm = core::mem::replace(&mut self.set_mm, offset_mm);
        let edge_mm = if before_mm < 0.0 && offset_mm >= 0.0 {
            Some(0.0)
        } else {
            let is_against = before_mm > UPPER_EDGE_MM && offset_mm <= UPPER_EDGE_MM;
            is_against.then_some(UPPER_EDGE_MM)
        };
        let latched_mm = edge_mm.filter(|_| self.has_index).map(|edge_mm| {
            let part = (edge_mm - before_mm) / (offset_mm - before_mm);
            let crossed = now.plus_s(1e-3 * (part - 1.0));
            let setpoint = controller.setpoint(crossed);
            // A latched count is as old as a reading.
            let age_s = FlightSettings::default().drive.velocity_loop.reading_age_s;
            edge_mm - setpoint.map_or(0.0, |it| it.speed_mm_s) * age_s
        });
        let counts = |place_mm: f32| format!("{:.0}", place_mm * 1e4).parse().unwrap();
        let mut step = RigStep {
            time: now,
            encoder_count: counts(offset_mm),
            index_count: latched_mm.map(counts),
            ..RigStep::default()
        };
        let due = self.edges.extract_if(.., |(time, _)| *time <= now);
        step.events.extend(due);
        step.events
            .extend(event.into_iter().map(|event| (now, event)));
        let Answer::Rig(answer) = self.pc.ask(&Request::Rig(step)) else {
            panic!("no round");
        };
        for action in &answer.actions {
            if let Action::OpenShutter { at, exposure_s } = action {
                let opened = at.plus_s(0.002);
                let closed = opened.plus_s(*exposure_s);
                self.edges
                    .push((opened, Event::Shutter(ShutterEdge::Opened)));
                self.edges
                    .push((closed, Event::Shutter(ShutterEdge::Closed)));
            }
        }
        answer
    }

    pub(crate) fn run_until(&mut self, state: State) {
        for _ in 0..2000 {
            let vh = Event::Vh(VhSample::Direct(0.1));
            if self.round(Some(vh)).state == state {
                return;
            }
        }
        panic!("never {state}");
    }

    fn load(&mut self, pixel_um: f32) -> Answer {
        let mut camera = camera_parameters();
        camera.calibration.pixel_um = pixel_um;
        self.pc.load(&camera)
    }

    pub(crate) fn prepare(&mut self) -> Answer {
        self.pc.ask(&Request::Prepare(FlightSettings::default()))
    }

    /// Brings the pulses of ten seconds, each with its name.
    pub(crate) fn know_utc(&mut self) {
        for second in 0..10 {
            for ms in 0..1000 {
                self.round(match ms {
                    0 => Some(Event::TimePulse),
                    200 => Some(Event::GnssTime((FIRST_SECOND + second) * 1_000_000)),
                    _ => Some(Event::Vh(VhSample::Direct(0.1))),
                });
            }
        }
    }

    /// Makes no rounds for a time, s.
    pub(crate) fn pause(&mut self, pause_s: f32) {
        self.now = self.now.plus_s(pause_s);
    }

    /// Exposes a frame of the armed camera.
    pub(crate) fn expose(&mut self) {
        self.round(Some(Event::Trigger));
        self.run_until(State::Exposing);
        self.run_until(State::Armed);
    }

    pub(crate) fn status(&mut self) -> Status {
        match self.pc.ask(&Request::Status) {
            Answer::Status(status) => status,
            other => panic!("{other:?}"),
        }
    }

    /// The records that are left.
    pub(crate) fn records(&mut self) -> Vec<FrameRecord> {
        let (mut records, mut next) = (Vec::new(), 0);
        while let Answer::FrameRecord(Some((record, _))) = self.pc.ask(&Request::FrameRecord(next))
        {
            next = record.sequence + 1;
            records.push(record);
        }
        records
    }
}

/// Second of the first pulse of [`Flight::know_utc`], since 1970.
const FIRST_SECOND: u64 = 1_800_000_000;

/// UTC of an exposure less camera time, µs; `None` without UTC.
pub(crate) fn utc_less_time_us(record: &FrameRecord) -> Option<u64> {
    let Outcome::Exposed(frame) = record.outcome else {
        return None;
    };
    Some(frame.centroid_utc?.unix_us - frame.centroid.us())
}

#[test]
fn calibration_waits_for_the_exposure_and_for_the_records_and_ends_the_flight() {
    let mut flight = Flight {
        pc: Pc::connected(),
        ..Flight::loaded()
    };
    let Answer::Loaded(first) = flight.load(3.76) else {
        panic!("not loaded");
    };
    assert_eq!(flight.prepare(), Answer::Prepared);
    flight.round(Some(Event::Command(Command::ClearFault)));
    flight.round(Some(Event::Command(Command::Referenced)));
    flight.round(Some(Event::Command(Command::Arm)));
    flight.run_until(State::Armed);
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Exposing);
    assert_eq!(flight.load(3.9), Answer::Refused(Refusal::FrameInFlight));
    assert_eq!(flight.prepare(), Answer::Refused(Refusal::FrameInFlight));
    flight.run_until(State::Armed);
    assert_eq!(flight.load(3.9), Answer::Refused(Refusal::FrameInFlight));

    // Idle, but the record would be lost with the flight, which goes on.
    flight.round(Some(Event::Command(Command::Disarm)));
    let kept = |count| Answer::Refused(Refusal::RecordsKept(count));
    assert_eq!(flight.load(3.9), kept(1));
    flight.round(Some(Event::Command(Command::Arm)));
    flight.run_until(State::Armed);
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Armed);
    flight.round(Some(Event::Command(Command::Disarm)));
    for sequence in [1, 2] {
        let Answer::FrameRecord(Some((record, _))) = flight.pc.ask(&Request::FrameRecord(sequence))
        else {
            panic!("no record");
        };
        assert_eq!(
            (record.sequence, record.calibration),
            (sequence, Some(first))
        );
        assert!(matches!(record.outcome, Outcome::Exposed(_)), "{record:?}");
    }

    assert_eq!(flight.prepare(), kept(2));
    assert_eq!(flight.load(3.9), kept(2));
    assert_eq!(flight.pc.acknowledge(2), Answer::Kept(0));
    let Answer::Loaded(second) = flight.load(3.9) else {
        panic!("not loaded");
    };
    assert_ne!(second.crc, first.crc);
    // The flight has ended with the calibration that it was prepared with.
    let not_prepared = Answer::Refused(Refusal::NotPrepared);
    for request in [
        Request::Rig(RigStep::default()),
        Request::Status,
        Request::FrameRecord(0),
        Request::Acknowledge(FetchedRecord {
            sequence: 2,
            crc: 0,
        }),
    ] {
        assert_eq!(flight.pc.ask(&request), not_prepared, "{request:?}");
    }
    assert_eq!(flight.prepare(), Answer::Prepared);
    let Answer::Status(status) = flight.pc.ask(&Request::Status) else {
        panic!("no status");
    };
    assert_eq!(status.calibration, Some(second));
    // The camera is in standby, under the new calibration, and counts from 1.
    flight.round(Some(Event::Trigger));
    let Answer::FrameRecord(Some((record, _))) = flight.pc.ask(&Request::FrameRecord(0)) else {
        panic!("no record");
    };
    assert_eq!((record.sequence, record.calibration), (1, Some(second)));
}

#[test]
fn what_nobody_has_cleared_outlasts_another_calibration() {
    let mut flight = Flight {
        // After a bite of the watchdog.
        pc: Pc::loaded(),
        ..Flight::loaded()
    };
    assert_eq!(flight.prepare(), Answer::Prepared);
    let watchdog = State::Fault(Fault::Watchdog);
    assert_eq!(flight.round(None).state, watchdog);
    for _ in 0..2 {
        assert!(matches!(flight.load(3.9), Answer::Loaded(_)));
    }
    assert_eq!(flight.prepare(), Answer::Prepared);
    assert_eq!(flight.round(None).state, watchdog);
    flight.round(Some(Event::Command(Command::ClearFault)));
    // The place of the stage is still lost.
    assert!(matches!(flight.load(3.76), Answer::Loaded(_)));
    assert_eq!(flight.prepare(), Answer::Prepared);
    let Answer::Status(status) = flight.pc.ask(&Request::Status) else {
        panic!("no status");
    };
    assert_eq!((status.state, status.is_place_lost), (State::Standby, true));
}
