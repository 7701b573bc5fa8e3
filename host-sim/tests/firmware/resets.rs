//! Flights of the firmware in QEMU over resets of the machine, with nobody's help.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command as Program;
use std::thread;
use std::time::Instant;

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome, Reason};
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::link::after_reset::{
    AfterReset, FlightAfterReset, RESETS_IN_A_ROW, WithoutEyes,
};
use fmc_camera::io::link::message::{Ending, ResetCause};
use fmc_camera::{CalibrationParameters, CameraParameters};
use fmc_simulation::mechanics::{Mechanics, MechanicsSettings};
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{FlyingDevice as _, Machine};

use crate::firmware::drills::{
    Drill, LOOK_EVERY, OVERFLOW, RESTARTED_WITHIN, WATCHDOG, restart_by,
};

/// Rounds within which triggers are to be answered again: one second of the camera's clock.
const ANSWERED_WITHIN: u64 = 1000;

/// Longest time from the camera's start to the word that its flight goes on, µs of its clock.
const TAKEN_UP_WITHIN_US: u64 = 100_000;

/// Manner of a reset.
#[derive(Clone, Copy)]
enum Reset<'a> {
    By(&'a Drill),
    /// A message, against which the camera is armed.
    Forced,
}

impl Reset<'_> {
    fn cause(self) -> ResetCause {
        match self {
            Self::By(drill) => drill.cause,
            Self::Forced => ResetCause::Requested,
        }
    }
}

/// A camera on a rig whose stage, shutter and V/H are simulated, without its twin.
struct Flight {
    device: Qemu,
    mechanics: Mechanics,
    settings: FlightSettings,
    answer: Option<RigAnswer>,
    round: u64,
    edges: Vec<(Time, Event)>,
}

impl Flight {
    fn armed(machine: Machine) -> Self {
        Self::armed_with(machine, None)
    }

    /// With a file of the flash, if one is given.
    fn armed_with(machine: Machine, flash: Option<&Path>) -> Self {
        let mut device = started(machine, flash);
        let calibration = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
        let settings = FlightSettings::default();
        device
            .prepare(&CameraParameters::new(calibration), &settings)
            .unwrap();
        let mut flight = Self {
            device,
            mechanics: Mechanics::new(MechanicsSettings::default()).unwrap(),
            settings,
            answer: None,
            round: 0,
            edges: Vec::new(),
        };
        for _ in 0..100 {
            flight.round(None);
        }
        flight.round(Some(Event::Command(Command::Arm)));
        flight.until(State::Armed);
        flight
    }

    /// Simulates a millisecond, with an event at its end if one is given.
    fn round(&mut self, happens: Option<Event>) -> Vec<Action> {
        self.round += 1;
        let before = self.answer.as_ref();
        let (duty, powered) = before.map_or((0.0, false), |it| (it.duty, it.powered));
        self.mechanics.advance(f64::from(duty), powered, 1e-3);
        let time = Time::from_us(1000 * self.round);
        let mut step = RigStep {
            time,
            encoder_count: self.mechanics.encoder_count(),
            index_count: self.mechanics.take_index(),
            ..RigStep::default()
        };
        let due = self.edges.extract_if(.., |(edge, _)| *edge <= time);
        step.events.extend(due);
        if self.round.is_multiple_of(50) {
            // A source whose value never changes counts as frozen.
            let wobble = if self.round.is_multiple_of(100) {
                2e-5
            } else {
                0.0
            };
            let vh = Event::Vh(VhSample::Direct(0.1 + wobble));
            step.events.push((time, vh)).unwrap();
        }
        step.events.extend(happens.map(|event| (time, event)));
        let answer = self.device.remote().step_by_itself(&step).unwrap();
        for action in &answer.actions {
            if let Action::OpenShutter { at, exposure_s } = *action {
                let opened = at.plus_s(self.settings.shutter_latency_s);
                let closed = opened.plus_s(exposure_s);
                self.edges = vec![
                    (opened, Event::Shutter(ShutterEdge::Opened)),
                    (closed, Event::Shutter(ShutterEdge::Closed)),
                ];
            }
        }
        let actions = answer.actions.to_vec();
        self.answer = Some(answer);
        actions
    }

    fn state(&self) -> State {
        self.answer.as_ref().unwrap().state
    }

    fn until(&mut self, state: State) -> u64 {
        let from = self.round;
        while self
            .answer
            .as_ref()
            .is_none_or(|answer| answer.state != state)
        {
            assert!(self.round < from + 3000, "no {state}: {:?}", self.state());
            self.round(None);
        }
        self.round - from
    }

    /// Takes a frame; the camera is ready again.
    fn expose(&mut self) {
        let ready = self.state();
        self.round(Some(Event::Trigger));
        self.until(State::Exposing);
        self.until(ready);
    }

    /// Fetches all records, and acknowledges none.
    fn records(&mut self) -> Vec<FrameRecord> {
        records_of(&mut self.device)
    }

    /// Resets the machine; the plant goes on without the camera for half a second.
    fn reset(&mut self, reset: Reset<'_>) -> AfterReset {
        match reset {
            Reset::By(drill) => {
                restart_by(&mut self.device, drill);
                self.device.remote().reconnect().unwrap();
            }
            Reset::Forced => self.device.remote().reset_as(Ending::Forced).unwrap(),
        }
        self.answer = None;
        self.edges.clear();
        self.round += 500;
        let identity = self.device.remote().identity();
        assert_eq!(identity.reset_cause, reset.cause());
        identity.after_reset
    }
}

/// A machine with a file of the flash, if one is given.
fn started(machine: Machine, flash: Option<&Path>) -> Qemu {
    let options = QemuOptions {
        firmware: env::var_os("FMC_FIRMWARE_WITH_DRILLS").map(PathBuf::from),
        flash: flash.map(Path::to_owned),
        ..QemuOptions::default()
    };
    assert!(options.firmware.is_some());
    Qemu::start(machine, &options).unwrap()
}

/// Fetches all records, and acknowledges none.
fn records_of(device: &mut Qemu) -> Vec<FrameRecord> {
    let (mut records, mut next) = (Vec::new(), 0);
    while let Some(record) = device.remote().fetch_record(next).unwrap() {
        next = record.sequence + 1;
        records.push(record);
    }
    records
}

/// Time of the last log line with these words, µs. The log has a wire of its own, on which the line
/// may come after the answer to a request that followed it.
fn logged_at_us(device: &Qemu, words: &str) -> u64 {
    let start = Instant::now();
    let line = loop {
        let log = device.log();
        if let Some(line) = log.iter().rfind(|line| line.contains(words)) {
            break line.clone();
        }
        assert!(start.elapsed() < RESTARTED_WITHIN, "{log:#?}");
        thread::sleep(LOOK_EVERY);
    };
    let seconds = line.split_whitespace().next().unwrap();
    let seconds: f64 = seconds.parse().unwrap_or_else(|_| panic!("{line}"));
    format!("{:.0}", 1e6 * seconds).parse().unwrap()
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn flight_goes_on_after_a_reset_within_a_second_with_all_its_records() {
    let resets = [
        Reset::By(&WATCHDOG[0]),
        Reset::By(&OVERFLOW[0]),
        Reset::Forced,
    ];
    for machine in [Machine::An386, Machine::An500] {
        for reset in resets {
            let mut flight = Flight::armed(machine);
            for _ in 0..3 {
                flight.expose();
            }
            // The frame in flight is ended by the reset.
            flight.round(Some(Event::Trigger));
            flight.until(State::Exposing);
            let before = flight.device.remote().fetch_record(0).unwrap().unwrap();
            let last_round = Time::from_us(1000 * flight.round);
            let found = flight.reset(reset);
            // The clock of the log goes on over the reset of this machine.
            let at_us = |words| logged_at_us(&flight.device, words);
            let taken_up_us = at_us("the flight goes on") - at_us("starts after");
            assert!(taken_up_us < TAKEN_UP_WITHIN_US, "{taken_up_us} µs");
            assert_eq!(found.outcome, FlightAfterReset::FliesOn);
            assert_eq!((found.boot, found.flight, found.records), (2, 1, 4));
            assert_eq!((found.unfinished, found.damaged), (1, 0));
            assert_eq!(found.last_round, Some(last_round));

            // Nobody tells the camera anything but the rounds of its rig.
            let rounds = flight.until(State::Degraded(Fault::Encoder));
            assert!(rounds < ANSWERED_WITHIN, "{rounds}");
            flight.expose();
            let records = flight.records();
            assert_eq!(records.len(), 5, "{records:#?}");
            assert_eq!(records[0], before);
            for (record, sequence) in records.iter().zip(1..) {
                assert_eq!(record.sequence, sequence);
                assert_eq!(record.calibration, before.calibration);
            }
            for record in &records[..3] {
                assert!(matches!(record.outcome, Outcome::Exposed(_)), "{record:?}");
                assert!(!record.flags.contains(Flag::NoCompensation));
            }
            assert_eq!(records[3].outcome, Outcome::Refused(Reason::Unusable));
            let after = &records[4];
            assert!(matches!(after.outcome, Outcome::Exposed(_)), "{after:?}");
            assert!(after.flags.contains(Flag::NoCompensation), "{after:?}");
            assert!(after.flags.contains(Flag::PlannedMotion), "{after:?}");
            assert!(after.faults.contains(Fault::Watchdog), "{after:?}");
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn resets_in_a_row_end_in_a_camera_that_is_disarmed_and_says_so() {
    let mut flight = Flight::armed(Machine::An386);
    flight.expose();
    for _ in 0..RESETS_IN_A_ROW {
        let found = flight.reset(Reset::By(&WATCHDOG[0]));
        assert_eq!(found.outcome, FlightAfterReset::FliesOn);
        flight.until(State::Degraded(Fault::Encoder));
    }
    let found = flight.reset(Reset::By(&WATCHDOG[0]));
    assert_eq!(found.outcome, FlightAfterReset::ResetAgain);
    for _ in 0..200 {
        flight.round(None);
        assert_eq!(flight.state(), State::Fault(Fault::Watchdog));
    }
    assert_eq!(flight.records().len(), 1);
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn machine_that_is_killed_in_flight_has_all_its_records_but_that_of_the_frame_in_flight() {
    let folder = tempfile::tempdir().unwrap();
    for machine in [Machine::An386, Machine::An500] {
        let flash = folder.path().join(format!("flash of {machine}"));
        let mut flight = Flight::armed_with(machine, Some(&flash));
        for _ in 0..5 {
            flight.expose();
        }
        let before = flight.records();
        assert_eq!(before.len(), 5);
        // The two oldest are on the PC; the next record tells it.
        flight.device.remote().acknowledge_records(2).unwrap();
        flight.expose();
        let last = flight.records().pop().unwrap();
        flight.round(Some(Event::Trigger));
        flight.until(State::Exposing);
        let id = flight.device.process_id().to_string();
        let killed = Program::new("kill").args(["-9", &id]).status().unwrap();
        assert!(killed.success());
        // The file is free again.
        drop(flight);

        // Twice: the first start leaves them as they are.
        for boot in [2, 3] {
            let mut device = started(machine, Some(&flash));
            let found = device.remote().identity().after_reset;
            assert_eq!(found.outcome, FlightAfterReset::FromFlash, "{found:?}");
            assert_eq!((found.boot, found.flight, found.records), (boot, 1, 4));
            assert_eq!((found.unfinished, found.damaged), (0, 0));
            assert_eq!(found.last_round, Some(last.trigger));
            assert_eq!(found.without_eyes, WithoutEyes::Unknown);
            let records = records_of(&mut device);
            assert!(records[..3] == before[2..], "{records:#?}");
            assert!(records[3..] == [last], "{records:#?}");
            assert!(records.iter().all(|it| (it.boot, it.flight) == (1, 1)));
            if boot == 3 {
                device.remote().acknowledge_records(6).unwrap();
                let left = records_of(&mut device);
                assert!(left.is_empty(), "{left:#?}");
            }
        }
    }
}
