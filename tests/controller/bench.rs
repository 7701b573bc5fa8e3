//! A controller with an ideal stage and a shutter that follows its commands.

use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::drive::settings::EncoderSide;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::frame_record::{ExposedFrame, FrameRecord, Outcome};
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::{CalibrationParameters, Camera, CameraParameters};

/// Returns a camera of 100 mm, with 9216 x 9216 pixels of 8.75 µm and a stage of 4 mm.
pub(crate) fn camera() -> CameraParameters {
    CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75))
}

/// The same, validated, with an identity.
pub(crate) fn identified(camera: &CameraParameters) -> Camera {
    Camera::identified(camera, 0xca1, Storage::Volatile).unwrap()
}

/// Width of the index mark, mm.
const INDEX_WIDTH_MM: f32 = 0.05;

/// Returns the default settings, with an index mark at the calibrated position.
pub(crate) fn settings() -> FlightSettings {
    let mut settings = FlightSettings::default();
    settings.drive.index_mm = Some(0.0);
    settings
}

/// Controller with the devices around it.
#[expect(clippy::struct_excessive_bools, reason = "one for each device")]
pub(crate) struct Bench {
    pub(crate) camera: PreparedCamera,
    pub(crate) now: Time,
    /// Set point that the stage has reached.
    pub(crate) stage: Setpoint,
    /// `true` if the stage follows its set points.
    pub(crate) stage_follows: bool,
    /// `true` if the encoder is read.
    pub(crate) is_read: bool,
    /// Counts that the encoder has added unseen, mm: the drive has moved the stage back by as much.
    pub(crate) added_mm: f32,
    /// Place of a stage that shakes, mm beyond its set point.
    pub(crate) shake_mm: Option<fn(Time) -> f32>,
    /// Set point in the last round, mm.
    set_mm: f32,
    /// `true` if the index mark is seen.
    pub(crate) index_is_seen: bool,
    /// Growth of the play between screw and stage, mm.
    pub(crate) play_grown_mm: f32,
    /// `true` if the shutter obeys.
    pub(crate) shutter_obeys: bool,
    pub(crate) shutter_late_s: f32,
    /// V/H that arrives with every round.
    pub(crate) vh_per_s: Option<f32>,
    pub(crate) edges: Vec<(Time, ShutterEdge)>,
    /// All actions so far, except the stage's motion.
    pub(crate) actions: Vec<(Time, Action)>,
}

impl Bench {
    pub(crate) fn new(settings: FlightSettings) -> Self {
        Self::with(&camera(), settings, Start::Orderly)
    }

    pub(crate) fn with(camera: &CameraParameters, settings: FlightSettings, start: Start) -> Self {
        Self {
            camera: PreparedCamera::new(identified(camera), &settings, start).unwrap(),
            now: Time::from_us(1_000_000),
            stage: Setpoint::default(),
            stage_follows: true,
            is_read: true,
            added_mm: 0.0,
            shake_mm: None,
            set_mm: 0.0,
            index_is_seen: true,
            play_grown_mm: 0.0,
            shutter_obeys: true,
            shutter_late_s: 0.0,
            vh_per_s: Some(0.1),
            edges: Vec::new(),
            actions: Vec::new(),
        }
    }

    /// Returns an armed camera with an index mark, its stage at the waiting place.
    pub(crate) fn armed() -> Self {
        let mut bench = Self::new(settings());
        bench.arm();
        bench
    }

    pub(crate) fn arm(&mut self) {
        self.run(2);
        self.send(Event::Command(Command::Arm));
        self.run_until(2000, |state| state == State::Armed);
    }

    /// Sends an event at the present time.
    pub(crate) fn send(&mut self, event: Event) {
        self.send_at(self.now, event);
    }

    pub(crate) fn send_at(&mut self, time: Time, event: Event) {
        let before = self.actions.len();
        let actions = self.camera.handle(time, event);
        for action in actions {
            match action {
                Action::MoveStage(setpoint) if self.stage_follows => self.stage = setpoint,
                Action::MoveStage(_) => {}
                other => self.actions.push((time, other)),
            }
        }
        let new: Vec<_> = self.actions[before..].to_vec();
        for (_, action) in new {
            match action {
                Action::OpenShutter { at, exposure_s } if self.shutter_obeys => {
                    let latency_s = self.camera.settings().shutter_latency_s;
                    let opened = at.plus_s(latency_s + self.shutter_late_s);
                    self.edges.push((opened, ShutterEdge::Opened));
                    self.edges
                        .push((opened.plus_s(exposure_s), ShutterEdge::Closed));
                }
                Action::CloseShutter => {
                    // A blade that has not moved stays closed; one that has continues to its
                    // planned end.
                    let now = self.now;
                    if self
                        .edges
                        .first()
                        .is_some_and(|(time, edge)| *edge == ShutterEdge::Opened && *time > now)
                    {
                        self.edges.clear();
                    }
                }
                _ => {}
            }
        }
    }

    /// Runs a round of the control loop, a millisecond later.
    pub(crate) fn round(&mut self) {
        self.now = self.now.plus_s(1e-3);
        if let Some(vh_per_s) = self.vh_per_s {
            self.send(Event::Vh(VhSample::Direct(vh_per_s)));
        }
        while let Some((time, edge)) = self.edges.first().copied()
            && time <= self.now
        {
            self.edges.remove(0);
            self.send_at(time, Event::Shutter(edge));
        }
        self.cross_index();
        if self.is_read {
            let shake_mm = self.shake_mm.map_or(0.0, |shake_mm| shake_mm(self.now));
            let reading = StageReading {
                time: self.now,
                offset_mm: self.place_mm() + shake_mm,
            };
            self.send(Event::Stage(reading));
        }
        self.send(Event::Tick);
    }

    /// Sends the crossing of the index mark, if the stage has come to it since the last round: to
    /// its lower edge along the axis, or to its upper edge against it, pushed by the screw.
    fn cross_index(&mut self) {
        let set_mm = self.place_mm();
        let before_mm = core::mem::replace(&mut self.set_mm, set_mm) - self.added_mm;
        let after_mm = set_mm - self.added_mm;
        let drive = self.camera.settings().drive;
        let Some(index_mm) = drive.index_mm.filter(|_| self.index_is_seen) else {
            return;
        };
        let play_mm = match drive.encoder_side {
            EncoderSide::Screw => 1e-3 * drive.play_um + self.play_grown_mm,
            EncoderSide::Stage => 0.0,
        };
        let upper_mm = index_mm + INDEX_WIDTH_MM - play_mm;
        let edge_mm = if before_mm < index_mm && index_mm <= after_mm {
            Some(index_mm)
        } else {
            (before_mm > upper_mm && upper_mm >= after_mm).then_some(upper_mm)
        };
        if let Some(edge_mm) = edge_mm {
            let part = (edge_mm - before_mm) / (after_mm - before_mm);
            let crossed = self.now.plus_s(1e-3 * (part - 1.0));
            let setpoint = self.camera.controller().setpoint(crossed);
            let speed_mm_s = setpoint.map_or((after_mm - before_mm) / 1e-3, |setpoint| {
                setpoint.speed_mm_s
            });
            // The latched reading is as old as all others.
            let old_mm = speed_mm_s * drive.velocity_loop.reading_age_s;
            self.send(Event::IndexMark(edge_mm + self.added_mm - old_mm));
        }
    }

    /// Returns the stage's present place, which follows from the last set point and its speed.
    pub(crate) fn place_mm(&self) -> f32 {
        if self.stage_follows {
            self.camera
                .controller()
                .setpoint(self.now)
                .unwrap_or(self.stage)
                .offset_mm
        } else {
            self.stage.offset_mm
        }
    }

    pub(crate) fn run(&mut self, rounds: u32) {
        for _ in 0..rounds {
            self.round();
        }
    }

    /// Runs until a state is reached, and returns the number of rounds.
    pub(crate) fn run_until(&mut self, most: u32, reached: impl Fn(State) -> bool) -> u32 {
        for rounds in 0..most {
            if reached(self.camera.controller().state()) {
                return rounds;
            }
            self.round();
        }
        panic!(
            "still {} after {most} rounds",
            self.camera.controller().state()
        );
    }

    /// Returns the records from a number on.
    pub(crate) fn records(&self) -> Vec<FrameRecord> {
        let mut records: Vec<FrameRecord> = Vec::new();
        let mut next = 0;
        while let Some(record) = self.camera.controller().record(next) {
            next = record.sequence + 1;
            records.push(record);
        }
        records
    }
}

/// Returns a camera in a state after a trigger.
pub(crate) fn in_state(state: State) -> Bench {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == state);
    bench
}

pub(crate) fn only(bench: &Bench) -> FrameRecord {
    let [record] = bench.records()[..] else {
        panic!("{:?}", bench.records());
    };
    record
}

pub(crate) fn exposed(record: &FrameRecord) -> ExposedFrame {
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    frame
}

pub(crate) fn acted(bench: &Bench, action: Action) -> bool {
    bench.actions.iter().any(|(_, it)| *it == action)
}
