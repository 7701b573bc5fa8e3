//! Drive and controller in one round.

use fmc_camera::flight::control_loop::{ControlLoop, Events};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::{FmcDrive, Latches, StageReading};
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::{CalibrationParameters, Camera, CameraParameters};

/// Names of the calls to the drive in a round.
#[derive(Debug, Default)]
struct Asked(Vec<&'static str>);

impl FmcDrive for Asked {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        self.0.push("position");
        Ok(StageReading {
            time: now,
            offset_mm: 0.0,
        })
    }

    fn follow(&mut self, _: Time, _: Setpoint) -> Result<(), Fault> {
        self.0.push("follow");
        Ok(())
    }

    fn release(&mut self) {
        self.0.push("release");
    }
}

#[test]
fn stage_is_read_when_the_round_begins_and_not_after_its_events() {
    let camera = CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
    let camera = Camera::new(camera).unwrap();
    let camera = PreparedCamera::new(camera, &FlightSettings::default(), Start::Orderly).unwrap();
    let mut control = ControlLoop::new(camera, Asked::default());
    let mut round = |at_us, event| {
        let now = Time::from_us(at_us);
        control.round(now, &Events::from_iter([(now, event)]));
        core::mem::take(&mut control.drive_mut().0)
    };
    let arm = Event::Command(Command::Arm);
    assert_eq!(round(1000, arm), ["position", "follow"]);
    // The stage is read first, because the handling of an event may take so long that the stage
    // moves meanwhile.
    assert_eq!(round(2000, Event::LimitSwitch), ["position", "release"]);
}

/// Places that hardware latches of a stage that follows exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Captured {
    Nothing,
    /// Places at the edges of the shutter, beyond the stage's by this, mm.
    Edges(f32),
    /// Places a quarter, half and three quarters of a round after the last reading, beyond the
    /// stage's by this, mm.
    Between(f32),
    /// Places of earlier rounds alone.
    Old,
}

/// Drive that is where it has been told to be, with a mark at the calibrated position.
#[derive(Debug)]
struct Exact {
    captured: Captured,
    told: Option<(Time, Setpoint)>,
    read: [StageReading; 2],
    has_mark: bool,
    fails: Option<Fault>,
    is_silent: bool,
}

impl Exact {
    fn new(captured: Captured) -> Self {
        let start = StageReading {
            time: Time::START,
            offset_mm: 0.0,
        };
        Self {
            captured,
            told: None,
            read: [start; 2],
            has_mark: true,
            fails: None,
            is_silent: false,
        }
    }

    fn place_mm(&self, time: Time) -> f32 {
        self.told.map_or(0.0, |(told, setpoint)| {
            let after_s = time.seconds_since(told);
            setpoint.offset_mm
                + after_s * (setpoint.speed_mm_s + 0.5 * setpoint.acceleration_mm_s2 * after_s)
        })
    }
}

impl FmcDrive for Exact {
    fn position(&mut self, now: Time) -> Result<StageReading, Fault> {
        if self.is_silent {
            return Err(Fault::Encoder);
        }
        let reading = StageReading {
            time: now,
            offset_mm: self.place_mm(now),
        };
        self.read = [self.read[1], reading];
        Ok(reading)
    }

    fn take_index(&mut self) -> Option<f32> {
        let [before, after] = self.read.map(|it| it.offset_mm);
        let is_crossed = self.has_mark && (before < 0.0) != (after < 0.0);
        is_crossed.then_some(0.0)
    }

    fn take_latched(&mut self, _: ShutterEdge, at: Time) -> Option<StageReading> {
        let Captured::Edges(added_mm) = self.captured else {
            return None;
        };
        Some(StageReading {
            time: at,
            offset_mm: self.place_mm(at) + added_mm,
        })
    }

    fn take_latches(&mut self) -> Latches {
        let [before, _] = self.read;
        let latched = |after_s: f32, added_mm| {
            let time = before.time.plus_s(after_s);
            StageReading {
                time,
                offset_mm: self.place_mm(time) + added_mm,
            }
        };
        match self.captured {
            Captured::Between(added_mm) => [-0.25e-3, 0.25e-3, 0.5e-3, 0.75e-3]
                .map(|after_s| latched(after_s, added_mm))
                .into_iter()
                .collect(),
            Captured::Old => [-0.75e-3, -0.5e-3, -0.25e-3]
                .map(|after_s| latched(after_s, 0.0005))
                .into_iter()
                .collect(),
            Captured::Nothing | Captured::Edges(_) => Latches::new(),
        }
    }

    fn follow(&mut self, now: Time, setpoint: Setpoint) -> Result<(), Fault> {
        self.told = Some((now, setpoint));
        self.fails.take().map_or(Ok(()), Err)
    }

    fn release(&mut self) {
        self.told = None;
    }
}

/// A control loop, with a shutter that follows its commands.
struct Flight {
    control: ControlLoop<Exact>,
    now: Time,
    edges: Vec<(Time, ShutterEdge)>,
    actions: Vec<Action>,
}

impl Flight {
    fn new(drive: Exact) -> Self {
        let camera = CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
        let mut settings = FlightSettings::default();
        settings.drive.index_mm = Some(0.0);
        settings.drive.play_um = 0.0;
        settings.drive.velocity_loop.reading_age_s = 0.0;
        let camera = Camera::new(camera).unwrap();
        let camera = PreparedCamera::new(camera, &settings, Start::Orderly).unwrap();
        let mut flight = Self {
            control: ControlLoop::new(camera, drive),
            now: Time::from_us(1_000_000),
            edges: Vec::new(),
            actions: Vec::new(),
        };
        flight.round(None);
        flight
    }

    fn round(&mut self, event: Option<Event>) -> State {
        self.now = self.now.plus_s(1e-3);
        let now = self.now;
        let due = self.edges.extract_if(.., |(time, _)| *time <= now);
        let mut events: Vec<_> = due.map(|(time, it)| (time, Event::Shutter(it))).collect();
        events.push((now, Event::Vh(VhSample::Direct(0.1))));
        events.extend(event.map(|event| (now, event)));
        for action in self.control.round(now, &events.into_iter().collect()) {
            if let Action::OpenShutter { at, exposure_s } = action {
                let opened = at.plus_s(self.control.settings().shutter_latency_s);
                self.edges.push((opened, ShutterEdge::Opened));
                let closed = opened.plus_s(exposure_s);
                self.edges.push((closed, ShutterEdge::Closed));
            }
            self.actions.push(action);
        }
        self.control.controller().state()
    }

    fn run_until(&mut self, state: State) {
        for _ in 0..3000 {
            if self.round(None) == state {
                return;
            }
        }
        panic!("still {}", self.control.controller().state());
    }

    fn arm(&mut self) {
        self.round(Some(Event::Command(Command::Arm)));
        self.run_until(State::Armed);
    }

    /// Flies a frame, and acknowledges its record.
    fn frame(&mut self) -> FrameRecord {
        self.round(Some(Event::Trigger));
        self.run_until(State::Armed);
        let record = self.control.controller().record(0).unwrap();
        self.control.controller_mut().acknowledge(record.sequence);
        assert_eq!(self.control.controller().record(0), None);
        record
    }
}

fn exposed(record: &FrameRecord) -> ExposedFrame {
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    frame
}

#[test]
fn places_that_hardware_latches_are_in_the_motion_of_their_exposure() {
    let centroid_mm = |captured| {
        let mut flight = Flight::new(Exact::new(captured));
        flight.arm();
        assert_eq!(flight.control.drive().captured, captured);
        let record = flight.frame();
        assert!(!record.flags.contains(Flag::PlannedMotion));
        exposed(&record).interior.motion.centroid_mm
    };
    let alone_mm = centroid_mm(Captured::Nothing);
    // Three of four places in a round are off by 0.4 µm, or two of the ends.
    let between_mm = centroid_mm(Captured::Between(0.0004)) - alone_mm;
    assert!((2e-4..4e-4).contains(&between_mm), "{between_mm}");
    let edges_mm = centroid_mm(Captured::Edges(0.0004)) - alone_mm;
    assert!((1e-5..1e-4).contains(&edges_mm), "{edges_mm}");
    // Those of earlier rounds are left out.
    let old_mm = centroid_mm(Captured::Old);
    assert!((old_mm - alone_mm).abs() <= 0.0, "{old_mm}, {alone_mm}");
}

#[test]
fn crossings_of_the_mark_refer_the_records() {
    for has_mark in [true, false] {
        let mut flight = Flight::new(Exact {
            has_mark,
            ..Exact::new(Captured::Nothing)
        });
        if has_mark {
            flight.arm();
            assert!(!flight.frame().flags.contains(Flag::Unreferenced));
        } else {
            flight.round(Some(Event::Command(Command::Arm)));
            flight.run_until(State::Standby);
            assert!(flight.actions.contains(&Action::Fault(Fault::IndexMark)));
        }
    }
}

#[test]
fn drive_that_does_not_follow_is_released_in_the_same_round() {
    for fault in [Fault::Drive, Fault::LimitSwitch] {
        let mut flight = Flight::new(Exact::new(Captured::Nothing));
        flight.arm();
        flight.control.drive_mut().fails = Some(fault);
        assert_eq!(flight.round(None), State::Fault(fault));
        assert_eq!(flight.control.drive().told, None, "released");
        assert_eq!(flight.actions.last(), Some(&Action::Fault(fault)));
    }
}

#[test]
fn drive_without_a_reading_is_released() {
    let mut flight = Flight::new(Exact::new(Captured::Nothing));
    flight.arm();
    flight.control.drive_mut().is_silent = true;
    assert_eq!(flight.round(None), State::Fault(Fault::Encoder));
    assert_eq!(flight.control.drive().told, None);
    assert!(flight.actions.contains(&Action::Fault(Fault::Encoder)));
}
