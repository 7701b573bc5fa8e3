//! Control loop: its parts, each of its events, and whole rounds.

use core::hint::black_box;

use fmc_camera::flight::calibration_id::Storage;
use fmc_camera::flight::control_loop::{ControlLoop, Events};
use fmc_camera::flight::controller::{Start, state::State};
use fmc_camera::flight::drive::StageReading;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::velocity_loop::VelocityLoop;
use fmc_camera::flight::event::{Action, Command, Event, ShutterEdge};
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::prepared_camera::PreparedCamera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::smear_prediction::{AircraftMotion, Compensation, SmearPrediction};
use fmc_camera::flight::stage_track::{PlaceReading, StagePlace, StageTrack};
use fmc_camera::flight::time::{Clock, Time};
use fmc_camera::flight::vh::{VhEstimate, VhSource};
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::{Camera, CameraParameters};

use crate::counter::Counter;
use crate::sensors;
use crate::specimen::{EXPOSURE, flown};

/// Repetitions of cheap work that does not change its state.
const REPETITIONS: u32 = 100;
/// Rounds from one frame to the next, at 2 frames/s.
const CYCLE_ROUNDS: u32 = 500;
/// Frames of the flight in which every event occurs.
const FRAMES: u32 = 8;
/// The longest exposure within the camera's limits, s.
const LONGEST_EXPOSURE_S: f32 = 0.02;
/// Times for which a stuck shutter stays open, s: so long that the track of the stage becomes full.
const STUCK_S: [f32; 4] = [0.0605, 0.0615, 0.0625, 0.0635];
const PER_FRAME: (u32, &str) = (1, "frame");
const CALIBRATION_CRC: u32 = 1;

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    parts(counter)?;
    events(counter)?;
    rounds(counter)
}

/// Counts the parts of a round that have a name.
fn parts(counter: &mut Counter) -> Option<()> {
    let settings = FlightSettings::default();
    let camera = Camera::new(flown()).ok()?;
    let place_mm = camera.waiting_place_mm(&EXPOSURE, 0.003).ok()?;
    counter.count("stage_travel_plan", (REPETITIONS, "plan"), || {
        for _ in 0..REPETITIONS {
            black_box(camera.travel(black_box(place_mm), &EXPOSURE, 0.003).ok()?);
        }
        Some(())
    })?;
    let travel = camera.travel(place_mm, &EXPOSURE, 0.003).ok()?;
    let mut velocity_loop = VelocityLoop::new(settings.drive.velocity_loop);
    let times = || (0_u16..100).map(|tick| 1e-3 * f32::from(tick));
    counter.count("stage_setpoint", (REPETITIONS, "set point"), || {
        for time_s in times() {
            black_box(black_box(&travel).setpoint(black_box(time_s)));
        }
        Some(())
    })?;
    let setpoints: heapless::Vec<_, 100> = times().map(|time_s| travel.setpoint(time_s)).collect();
    counter.count("velocity_loop", (REPETITIONS, "tick"), || {
        for setpoint in black_box(&setpoints) {
            black_box(velocity_loop.duty(*setpoint, setpoint.offset_mm - 1e-4, 1e-3));
        }
        Some(())
    })?;
    let mut clock = Clock::new();
    counter.count("clock_extend", (REPETITIONS, "stamp"), || {
        for stamp in 0..REPETITIONS {
            black_box(clock.extend(black_box(1000 * stamp)));
        }
        Some(())
    })?;
    record_parts(counter, &camera)?;
    let mut camera = prepared()?;
    let mut now = Time::from_us(1000);
    for index in 0..70 {
        now = now.plus_s(0.014);
        camera.handle(now, Event::Vh(sensors::sample(index)));
    }
    camera.controller().vh().estimate(now)?;
    counter.count("vh_estimate", (REPETITIONS, "estimate"), || {
        for _ in 0..REPETITIONS {
            black_box(black_box(camera.controller().vh()).estimate(black_box(now)));
        }
        Some(())
    })
}

/// Counts the parts of the record of an exposure: 64 places of the stage during it, and the smear
/// with an attitude.
fn record_parts(counter: &mut Counter, camera: &Camera) -> Option<()> {
    let mut track = StageTrack::new();
    for tick in 0..64_u16 {
        track.push(StagePlace {
            time: Time::from_us(1000 * u64::from(tick)),
            offset_mm: 0.01 * f32::from(tick),
            reading: PlaceReading::of_round(0.0),
        });
    }
    let [opened, closed] = [500, 62_500].map(Time::from_us);
    counter.count("stage_path_64", PER_FRAME, || {
        Some(track.path(black_box(opened), closed))
    })?;
    let path = track.path(opened, closed);
    let exposure_s = closed.seconds_since(opened);
    counter.count("stage_moments_64", PER_FRAME, || {
        PrincipalPointMotion::from_samples(black_box(&path.samples), exposure_s, camera.shutter())
            .ok()
    })?;
    let smear = SmearPrediction::new(camera.calibration(), FlightDirection::Forward);
    let vh = VhEstimate {
        vh_per_s: 0.1,
        sigma_per_s: 0.001,
        age_s: 0.01,
        source: VhSource::Direct,
        extrapolated: false,
    };
    let compensation = Compensation {
        wander_mm: 1e-4,
        travel_sigma_mm: 4e-5,
        exposure_s,
        travel_mm: 0.1 * 51.3712 * exposure_s,
        principal_point: SensorPoint::default(),
    };
    let aircraft = AircraftMotion {
        attitude: Some(sensors::ATTITUDE),
        attitude_sigma_deg: 0.0,
        rate_sigma_deg_s: 0.02,
        vh_relative_variance: 1e-4,
    };
    counter.count("smear_prediction", PER_FRAME, || {
        Some(black_box(&smear).of(&vh, &aircraft, &compensation))
    })
}

fn settings() -> FlightSettings {
    FlightSettings {
        exposure_s: LONGEST_EXPOSURE_S,
        ..FlightSettings::default()
    }
}

/// Returns a camera with an identity.
fn camera(record: &CameraParameters) -> Option<Camera> {
    Camera::identified(record, CALIBRATION_CRC, Storage::Volatile).ok()
}

fn prepared() -> Option<PreparedCamera> {
    PreparedCamera::new(camera(&flown())?, &settings(), Start::Orderly).ok()
}

/// Kind of an event; the most expensive event of a kind is printed.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Kind(&'static str);

/// Returns the kind of an event, from the states before and after it.
fn kind(event: Event, [before, after]: [State; 2]) -> Option<Kind> {
    let name = match event {
        Event::Vh(_) => "control_event_vh",
        Event::Attitude(_) => "control_event_attitude",
        Event::TimePulse => "control_event_time_pulse",
        Event::GnssTime(_) => "control_event_gnss_time",
        Event::Trigger if before == State::Armed => "control_event_trigger",
        Event::Trigger => "control_event_trigger_refused",
        Event::Shutter(ShutterEdge::Opened) => "control_event_shutter_opened",
        Event::Shutter(ShutterEdge::Closed) => "control_event_shutter_closed",
        Event::Stage(_) => "control_event_stage",
        Event::Tick => match (before, after) {
            (State::Armed, _) => "control_tick_armed",
            (State::RunUp, _) => "control_tick_run_up",
            (State::Tracking, _) => "control_tick_tracking",
            (State::Exposing, State::Exposing) => "control_tick_exposing",
            (State::Exposing, _) => "control_tick_record",
            (State::FlyBack, State::FlyBack) => "control_tick_fly_back",
            _ => "control_tick_arrival",
        },
        _ => return None,
    };
    Some(Kind(name))
}

/// A shutter that obeys its commands, and stays open for a set time.
struct Shutter {
    latency_s: f32,
    open_s: f32,
    edges: heapless::Vec<(Time, ShutterEdge), 2>,
}

impl Shutter {
    fn obey(&mut self, action: Action) {
        if let Action::OpenShutter { at, .. } = action {
            let opened = at.plus_s(self.latency_s);
            let closed = opened.plus_s(self.open_s);
            self.edges.clear();
            let _ = self.edges.push((opened, ShutterEdge::Opened));
            let _ = self.edges.push((closed, ShutterEdge::Closed));
        }
    }

    /// Removes and returns the edges until now.
    fn until(&mut self, now: Time) -> impl Iterator<Item = (Time, Event)> {
        let edges = self.edges.clone();
        self.edges.retain(|(time, _)| *time > now);
        let event = |(time, edge)| (time, Event::Shutter(edge));
        edges
            .into_iter()
            .filter(move |(time, _)| *time <= now)
            .map(event)
    }
}

/// Adds the events of a round of a flight at 2 frames/s, without those of the shutter.
fn happening(round: u32, now: Time, events: &mut Events) {
    for event in sensors::events(round).into_iter().flatten() {
        let _ = events.push((now, event));
    }
    // Arming takes a second.
    let since = round % CYCLE_ROUNDS;
    if round == 0 {
        let _ = events.push((now, Event::Command(Command::Arm)));
    } else if round >= 2 * CYCLE_ROUNDS && (since == 0 || since == 20) {
        // The second trigger is refused, because the frame before is not finished.
        let _ = events.push((now, Event::Trigger));
    }
}

/// Counts every event of a flight with all sensors, in which the stage follows exactly.
fn events(counter: &mut Counter) -> Option<()> {
    let mut camera = prepared()?;
    let mut dearest: heapless::Vec<(Kind, u32), 24> = heapless::Vec::new();
    let mut now = Time::from_us(1_000_000);
    let mut shutter = Shutter {
        latency_s: settings().shutter_latency_s,
        open_s: LONGEST_EXPOSURE_S,
        edges: heapless::Vec::new(),
    };
    for round in 0..CYCLE_ROUNDS * (FRAMES + 2) {
        now = now.plus_s(1e-3);
        let mut events: Events = shutter.until(now).collect();
        happening(round, now, &mut events);
        let offset_mm = camera
            .controller()
            .setpoint(now)
            .map_or(0.0, |it| it.offset_mm);
        let stage = Event::Stage(StageReading {
            time: now,
            offset_mm,
        });
        for (time, event) in events.into_iter().chain([(now, stage), (now, Event::Tick)]) {
            let before = camera.controller().state();
            let (instructions, actions) =
                counter.measure(|| camera.handle(black_box(time), black_box(event)))?;
            for action in actions {
                shutter.obey(action);
            }
            if let Some(kind) = kind(event, [before, camera.controller().state()]) {
                match dearest.iter_mut().find(|(known, _)| *known == kind) {
                    Some((_, most)) => *most = instructions.max(*most),
                    None => dearest.push((kind, instructions)).ok()?,
                }
            }
        }
        camera.controller_mut().acknowledge(u32::MAX);
    }
    // Every frame was recorded, and every kind of event occurred.
    if camera.controller().counts().exposed != FRAMES || dearest.len() != 16 {
        return None;
    }
    for (Kind(name), instructions) in dearest {
        let unit = if name.contains("tick") {
            "tick"
        } else {
            "event"
        };
        Counter::print(name, (1, unit), instructions);
    }
    Some(())
}

/// Counts whole rounds of the camera with its drive and velocity loop: the mean of a frame cycle,
/// and the most expensive one.
fn rounds(counter: &mut Counter) -> Option<()> {
    let (sum, _) = fly(counter, &[1.0 / 300.0], &flown())?;
    let rounds = CYCLE_ROUNDS * FRAMES;
    Counter::print("control_round", (rounds, "round"), sum);
    let (_, most) = fly(counter, &[LONGEST_EXPOSURE_S], &flown())?;
    Counter::print("control_round_worst", (1, "round"), most);
    let (_, most) = fly(counter, &STUCK_S, &flown())?;
    Counter::print("control_round_stuck_shutter", (1, "round"), most);
    Some(())
}

/// Flies, and returns the cost of all rounds of all frame cycles and that of the most expensive
/// round.
fn fly(counter: &mut Counter, open_s: &[f32], record: &CameraParameters) -> Option<(u32, u32)> {
    let settings = FlightSettings {
        exposure_s: open_s.first()?.min(LONGEST_EXPOSURE_S),
        ..settings()
    };
    let camera = PreparedCamera::new(camera(record)?, &settings, Start::Orderly).ok()?;
    let drive = RigDrive::new(settings.drive).ok()?;
    let mut control = ControlLoop::new(camera, drive);
    let mut open_s = open_s.iter().cycle();
    let mut shutter = Shutter {
        latency_s: settings.shutter_latency_s,
        open_s: 0.0,
        edges: heapless::Vec::new(),
    };
    let mut now = Time::from_us(1_000_000);
    let (mut sum, mut most) = (0, 0);
    for round in 0..CYCLE_ROUNDS * (FRAMES + 2) {
        now = now.plus_s(1e-3);
        if round.is_multiple_of(CYCLE_ROUNDS) {
            shutter.open_s = *open_s.next()?;
        }
        let mut events: Events = shutter.until(now).collect();
        happening(round, now, &mut events);
        let read = now.plus_s(-settings.drive.velocity_loop.reading_age_s);
        let place = control.controller().setpoint(read);
        let place_um = 1000.0 * place.map_or(0.0, |it| it.offset_mm);
        #[expect(clippy::cast_possible_truncation, reason = "20,000 counts at most")]
        let count = (place_um / settings.drive.encoder_step_um) as i32;
        control.drive_mut().set_count(count);
        let (instructions, actions) = counter.measure(|| control.round(now, black_box(&events)))?;
        for action in &actions {
            shutter.obey(*action);
        }
        if round >= 2 * CYCLE_ROUNDS {
            sum += instructions;
        }
        most = instructions.max(most);
        control.controller_mut().acknowledge(u32::MAX);
    }
    (control.controller().counts().exposed == FRAMES).then_some((sum, most))
}
