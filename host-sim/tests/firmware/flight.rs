//! Flights of the camera in QEMU: its stage, shutter and sensors are simulated, round by round of
//! its control loop. The device compares every round and every record with its twin on this PC, bit
//! by bit.

use std::env;

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome, Reason};
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::link::after_reset::FlightAfterReset;
use fmc_camera::io::link::message::Refusal;
use fmc_camera::{CalibrationParameters, CameraParameters};
use fmc_camera_file::number::single;
use fmc_simulation::mechanics::{Mechanics, MechanicsSettings, PositionStage};
use host_sim::device::link_error::LinkError;
use host_sim::device::qemu::{Qemu, QemuOptions};
use host_sim::device::{CorrectingDevice as _, DeviceError, FlyingDevice, Machine};

use crate::firmware::drills::{Drill, OVERFLOW, WATCHDOG, restart_by};

const MACHINES: [Machine; 2] = [Machine::An386, Machine::An500];

/// V/H, 1/s, for which the image moves at 10 mm/s.
const VH_PER_S: f32 = 0.1;

/// Number of rounds from one V/H to the next.
const VH_ROUNDS: u64 = 50;

/// Returns a camera of 100 mm, 9216 x 9216 pixels of 8.75 µm.
fn camera() -> CameraParameters {
    CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75))
}

/// A camera and its simulated surroundings.
struct Flight {
    device: Qemu,
    mechanics: Mechanics,
    settings: FlightSettings,
    answer: Option<RigAnswer>,
    round: u64,
    edges: Vec<(Time, Event)>,
}

impl Flight {
    fn new(device: Qemu) -> Self {
        Self {
            device,
            mechanics: Mechanics::new(MechanicsSettings::default()).unwrap(),
            settings: FlightSettings::default(),
            answer: None,
            round: 0,
            edges: Vec::new(),
        }
    }

    fn prepared(device: Qemu) -> Self {
        let mut flight = Self::new(device);
        flight.prepare().unwrap();
        flight
    }

    /// Takes a stage that follows a position command, with an absolute sensor.
    fn move_by_command(&mut self) {
        let stage = PositionStage::default();
        self.mechanics = Mechanics::new(MechanicsSettings {
            position_stage: Some(stage),
            ..MechanicsSettings::default()
        })
        .unwrap();
        let drive = &mut self.settings.drive;
        drive.kind = DriveKind::PositionCommand;
        drive.position_command.lag_s = single(stage.lag_s());
        drive.position_command.acceleration_lag_s2 = single(stage.acceleration_lag_s2());
    }

    fn prepare(&mut self) -> Result<(), DeviceError> {
        self.device.prepare(&camera(), &self.settings)
    }

    /// Simulates a millisecond, with an event at its end if one is given.
    fn round(&mut self, happens: Option<Event>) -> Vec<Action> {
        self.round += 1;
        let (duty, powered) = self
            .answer
            .as_ref()
            .map_or((0.0, false), |answer| (answer.duty, answer.powered));
        self.mechanics.advance(f64::from(duty), powered, 1e-3);
        let time = Time::from_us(1000 * self.round);
        let is_past = |(edge, _): &(Time, Event)| *edge <= time;
        let mut step = RigStep {
            time,
            encoder_count: self.mechanics.encoder_count(),
            index_count: self.mechanics.take_index(),
            events: self.edges.iter().copied().filter(is_past).collect(),
        };
        self.edges.retain(|edge| !is_past(edge));
        if self.round.is_multiple_of(VH_ROUNDS) {
            // A source whose value never changes counts as frozen.
            let wobble = if self.round.is_multiple_of(2 * VH_ROUNDS) {
                1.0002
            } else {
                1.0
            };
            let vh = Event::Vh(VhSample::Direct(VH_PER_S * wobble));
            step.events.push((time, vh)).unwrap();
        }
        if let Some(event) = happens {
            step.events.push((time, event)).unwrap();
        }
        let answer = self.device.step(&step).unwrap();
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

    fn until(&mut self, state: State) {
        for _ in 0..3000 {
            if self.state() == state {
                return;
            }
            self.round(None);
        }
        panic!("{:?} instead of {state:?}", self.state());
    }

    fn arm(&mut self) {
        for _ in 0..VH_ROUNDS {
            self.round(None);
        }
        self.round(Some(Event::Command(Command::Arm)));
        self.until(State::Armed);
    }

    /// Triggers a frame and waits until the next is possible; returns the number of its record.
    fn expose(&mut self) -> u32 {
        let mut actions = self.round(Some(Event::Trigger));
        while self.state() != State::Armed {
            actions.extend(self.round(None));
        }
        let ready = actions.iter().find_map(|action| match action {
            Action::FrameReady(sequence) => Some(*sequence),
            _ => None,
        });
        ready.unwrap()
    }

    fn fetched(&mut self, sequence: u32) -> FrameRecord {
        let record = FlyingDevice::frame_record(&mut self.device, sequence)
            .unwrap()
            .unwrap();
        assert_eq!(record.sequence, sequence);
        record
    }
}

/// Checks a motion of 10 mm/s for 1/300 s about the calibrated principal point.
fn assert_compensated(record: &FrameRecord) {
    assert_eq!(record.faults, Faults::NONE, "{record:?}");
    // There is no index mark.
    assert!(record.flags.iter().eq([Flag::Unreferenced]), "{record:?}");
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    let motion = frame.interior.motion;
    // The limit is the smear of the stage after learning, 0.92 µm, and two steps of the encoder.
    assert!((motion.travel_mm - 0.03333).abs() < 1.1e-3, "{motion:?}");
    // The shutter's edges are on a grid of 1 ms, and the centroid is where the stage was then, to
    // its following error.
    assert!(motion.centroid_mm.abs() < 2e-3, "{motion:?}");
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn flown_frames_have_the_twins_records() {
    for machine in MACHINES {
        let mut flight = Flight::prepared(Qemu::start(machine, &QemuOptions::default()).unwrap());
        flight.arm();
        for sequence in 1..=4 {
            assert_eq!(flight.expose(), sequence);
            let record = flight.fetched(sequence);
            assert_compensated(&record);
            assert_eq!(flight.device.acknowledge(sequence), Ok(0));
        }
        let counters = flight.device.remote().counters().unwrap().unwrap();
        assert_eq!(counters.overrun_bytes, 0);
        assert_eq!(
            counters.truncated + counters.wrong_crc + counters.oversized,
            0
        );
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn stage_with_an_absolute_sensor_has_its_place_after_a_reset() {
    let options = QemuOptions {
        firmware: Some(env::var_os("FMC_FIRMWARE_WITH_DRILLS").unwrap().into()),
        flash: None,
        print_log: false,
    };
    let mut flight = Flight::new(Qemu::start(MACHINES[0], &options).unwrap());
    flight.move_by_command();
    flight.settings.flies_on_after_reset = false;
    flight.prepare().unwrap();
    flight.arm();
    assert_eq!(flight.expose(), 1);
    assert_measured(&flight.fetched(1), Faults::NONE);
    restart_by(&mut flight.device, &WATCHDOG[0]);
    let remote = flight.device.remote();
    remote.reconnect().unwrap();
    assert_measured(&remote.fetch_record(0).unwrap().unwrap(), Faults::NONE);
    assert_eq!(remote.acknowledge_records(1).unwrap(), 0);
    let mut flight = Flight::new(flight.device);
    flight.move_by_command();
    flight.prepare().unwrap();
    flight.round(None);
    assert_eq!(flight.state(), State::Fault(Fault::Watchdog));
    flight.round(Some(Event::Command(Command::ClearFault)));
    // Nobody refers it.
    flight.arm();
    assert_eq!(flight.expose(), 1);
    // The fault since the last record is in it, and takes nothing from it.
    let mut restarted = Faults::NONE;
    restarted.insert(Fault::Watchdog);
    assert_measured(&flight.fetched(1), restarted);
}

/// Checks a record with these faults and without flags, with the σ of a sensor.
fn assert_measured(record: &FrameRecord, faults: Faults) {
    assert_eq!(record.faults, faults, "{record:?}");
    assert!(record.flags.iter().next().is_none(), "{record:?}");
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    let sigma = frame.principal_point_sigma;
    assert!(sigma.total_mm() < 1e-4, "{sigma:?}");
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn calibration_in_the_middle_of_an_exposure_is_refused_and_changes_nothing() {
    let mut flight = Flight::prepared(Qemu::start(MACHINES[0], &QemuOptions::default()).unwrap());
    flight.arm();
    flight.round(Some(Event::Trigger));
    flight.until(State::Exposing);
    let mut other = camera();
    other.calibration.principal_distance_mm = 90.0;
    let refused = |result| {
        matches!(
            result,
            Err(DeviceError::Link {
                error: LinkError::Refused {
                    refusal: Refusal::FrameInFlight,
                    ..
                },
                ..
            })
        )
    };
    assert!(refused(flight.device.load(&other)));
    flight.until(State::Armed);
    let record = flight.fetched(1);
    assert_compensated(&record);
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    assert!((frame.interior.principal_distance_mm - 100.0).abs() < 1e-6);
    // An armed stage has force on it, so the calibration is refused. In standby it is refused while
    // the record would be lost, and the flight goes on with the old one.
    assert!(refused(flight.device.load(&other)));
    flight.round(Some(Event::Command(Command::Disarm)));
    let kept = Err(DeviceError::RecordsKept(1));
    assert_eq!(flight.device.load(&other), kept);
    flight.arm();
    assert_eq!(flight.expose(), 2);
    assert_eq!(flight.fetched(2).calibration, record.calibration);
    flight.round(Some(Event::Command(Command::Disarm)));
    assert_eq!(flight.device.acknowledge(2), Ok(0));
    // Then it ends the flight.
    flight.device.load(&other).unwrap();
    assert_eq!(
        FlyingDevice::frame_record(&mut flight.device, 0),
        Err(DeviceError::NotPrepared)
    );
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn camera_is_not_prepared_again_before_its_records_are_fetched() {
    let mut flight = Flight::prepared(Qemu::start(MACHINES[1], &QemuOptions::default()).unwrap());
    flight.round(None);
    flight.round(Some(Event::Trigger));
    let record = flight.fetched(1);
    assert_eq!(record.outcome, Outcome::Refused(Reason::NotArmed));
    assert_eq!(flight.prepare(), Err(DeviceError::RecordsKept(1)));
    assert_eq!(flight.fetched(1), record);
    assert_eq!(flight.device.acknowledge(1), Ok(0));
    flight.prepare().unwrap();
    assert_eq!(FlyingDevice::frame_record(&mut flight.device, 0), Ok(None));
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn after_the_watchdog_the_camera_is_in_that_fault_until_it_is_cleared() {
    is_in_its_fault_until_it_is_cleared(&WATCHDOG[0]);
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn after_an_overflow_of_the_stack_the_camera_is_in_its_fault_and_records_are_whole() {
    for drill in &OVERFLOW {
        is_in_its_fault_until_it_is_cleared(drill);
    }
}

/// Flies before a restart and after it. The records on either side are whole: the link's digest of
/// each is compared.
fn is_in_its_fault_until_it_is_cleared(drill: &Drill) {
    let options = QemuOptions {
        firmware: Some(env::var_os("FMC_FIRMWARE_WITH_DRILLS").unwrap().into()),
        flash: None,
        print_log: false,
    };
    let mut flight = Flight::new(Qemu::start(MACHINES[0], &options).unwrap());
    flight.settings.flies_on_after_reset = false;
    flight.prepare().unwrap();
    flight.arm();
    assert_eq!(flight.expose(), 1);
    let before = flight.fetched(1);
    assert!(matches!(before.outcome, Outcome::Exposed(_)));
    restart_by(&mut flight.device, drill);
    let remote = flight.device.remote();
    remote.reconnect().unwrap();
    let identity = remote.identity();
    assert_eq!(identity.reset_cause, drill.cause);
    let outcome = identity.after_reset.outcome;
    assert_eq!(outcome, FlightAfterReset::SwitchedOff);
    assert_eq!(remote.fetch_record(0).unwrap(), Some(before));
    assert_eq!(remote.acknowledge_records(1).unwrap(), 0);
    let mut flight = Flight::prepared(flight.device);
    assert_eq!(FlyingDevice::frame_record(&mut flight.device, 0), Ok(None));
    flight.round(None);
    assert_eq!(flight.state(), State::Fault(Fault::Watchdog));
    flight.round(Some(Event::Trigger));
    let record = flight.fetched(1);
    assert_eq!(
        record.outcome,
        Outcome::Refused(Reason::Fault(Fault::Watchdog))
    );
    flight.round(Some(Event::Command(Command::ClearFault)));
    assert_eq!(flight.state(), State::Standby);
    // The restart has lost the encoder's count.
    flight.round(Some(Event::Command(Command::Referenced)));
    flight.arm();
    assert_eq!(flight.expose(), 2);
    flight.round(Some(Event::Command(Command::Disarm)));
    // The fault is reported once, so the next flight begins in standby.
    flight.fetched(2);
    assert_eq!(flight.device.acknowledge(2), Ok(0));
    let mut flight = Flight::prepared(flight.device);
    flight.round(None);
    assert_eq!(flight.state(), State::Standby);
}
