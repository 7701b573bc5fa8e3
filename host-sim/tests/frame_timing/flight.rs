//! The frame: default camera and settings, an ideal stage, and a shutter that obeys.

use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::{CalibrationParameters, Camera, CameraParameters};

/// Time of the trigger, between the rounds of 1.000 s and 1.001 s.
const TRIGGER: Time = Time::from_us(1_000_600);
const END: Time = Time::from_us(1_080_000);
/// Step of the drawn path of the stage, µm.
const STEP_US: u64 = 100;
const ROUND_US: u64 = 1000;

/// Set point of the stage at an instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    pub(crate) ms: f64,
    pub(crate) offset_mm: f64,
    pub(crate) speed_mm_s: f64,
}

/// The frame, in ms after its trigger.
#[derive(Debug, Default)]
pub(crate) struct Flight {
    pub(crate) stage: Vec<Instant>,
    /// States with the times of their beginnings.
    pub(crate) states: Vec<(f64, State)>,
    pub(crate) end_ms: f64,
    pub(crate) handed_over_ms: f64,
    pub(crate) command_ms: f64,
    pub(crate) opened_ms: f64,
    pub(crate) closed_ms: f64,
    pub(crate) recorded_ms: f64,
    pub(crate) armed_ms: f64,
}

/// The simulated surroundings of the controller.
struct Bench {
    camera: PreparedCamera,
    edges: Vec<(Time, ShutterEdge)>,
    flight: Flight,
}

impl Bench {
    fn send(&mut self, time: Time, event: Event) {
        let before = self.camera.controller().state();
        for action in self.camera.handle(time, event) {
            match action {
                Action::OpenShutter { at, exposure_s } => {
                    let opened = at.plus_s(self.camera.settings().shutter_latency_s);
                    let closed = opened.plus_s(exposure_s);
                    self.edges = vec![(opened, ShutterEdge::Opened), (closed, ShutterEdge::Closed)];
                    self.flight.handed_over_ms = after_trigger_ms(time);
                    self.flight.command_ms = after_trigger_ms(at);
                    self.flight.opened_ms = after_trigger_ms(opened);
                    self.flight.closed_ms = after_trigger_ms(closed);
                }
                Action::FrameReady(_) => self.flight.recorded_ms = after_trigger_ms(time),
                Action::MoveStage(_) => {}
                other => panic!("{other:?}"),
            }
        }
        let state = self.camera.controller().state();
        if state != before && time >= TRIGGER {
            self.flight.states.push((after_trigger_ms(time), state));
            if state == State::Armed {
                self.flight.armed_ms = after_trigger_ms(time);
            }
        }
    }

    fn round(&mut self, now: Time) {
        let edges: Vec<_> = self
            .edges
            .extract_if(.., |(time, _)| *time <= now)
            .collect();
        for (time, edge) in edges {
            self.send(time, Event::Shutter(edge));
        }
        self.send(now, Event::Vh(VhSample::Direct(0.1)));
        let setpoint = self.camera.controller().setpoint(now).unwrap_or_default();
        let reading = StageReading {
            time: now,
            offset_mm: setpoint.offset_mm,
        };
        self.send(now, Event::Stage(reading));
        self.send(now, Event::Tick);
    }
}

/// Arms the camera and flies one frame.
pub(crate) fn fly() -> Flight {
    let camera = CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
    let settings = FlightSettings::default();
    let mut bench = Bench {
        camera: PreparedCamera::new(Camera::new(camera).unwrap(), &settings, Start::Orderly)
            .unwrap(),
        edges: Vec::new(),
        flight: Flight::default(),
    };
    bench.send(Time::START, Event::Command(Command::Arm));
    for us in (0..=END.us()).step_by(usize::try_from(STEP_US).unwrap()) {
        let now = Time::from_us(us);
        if now == TRIGGER {
            bench.send(now, Event::Trigger);
        }
        if us % ROUND_US == 0 {
            bench.round(now);
        }
        if let Some(setpoint) = bench.camera.controller().setpoint(now)
            && us + 2 * ROUND_US >= TRIGGER.us()
        {
            bench.flight.stage.push(Instant {
                ms: after_trigger_ms(now),
                offset_mm: f64::from(setpoint.offset_mm),
                speed_mm_s: f64::from(setpoint.speed_mm_s),
            });
        }
    }
    let start_ms = bench.flight.stage[0].ms;
    bench.flight.states.insert(0, (start_ms, State::Armed));
    bench.flight.end_ms = after_trigger_ms(END);
    bench.flight
}

fn after_trigger_ms(time: Time) -> f64 {
    1e3 * f64::from(time.seconds_since(TRIGGER))
}
