//! The flight: one round of the control loop after the other, in simulated time.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{FrameRecord, Outcome};
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

use super::aircraft::Aircraft;
use super::fault::link::LinkFaults;
use super::fault::stage::mechanical;
use super::fault::trigger::{microseconds, with_overlaps};
use super::fault::{InjectedFault, Injection};
use super::oracle::{FrameTruth, Oracle, TrueExposure};
use super::sensors::{Sensors, seconds};
use super::shutter::{Opening, ShutterSimulator, ShutterTiming};
use super::trace::{Recorder, Round, Trace};
use crate::device::{DeviceError, FlyingDevice};
use crate::formats::mission_scenario::MissionScenario;
use crate::mechanics::Mechanics;
use crate::scene::stage_path::StagePath;

/// Period of the control loop, µs.
pub const ROUND_US: u64 = 1000;
/// When the camera is told to obey triggers.
const ARMED_AT_US: u64 = 200_000;
/// The path of the stage is kept so long before first light and after last light, s.
const PATH_MARGIN_S: f64 = 0.002;
/// Before its trigger a frame's trace begins, µs.
const TRACE_BEFORE_US: u64 = 20_000;
/// After its record it goes on, µs: the fly-back.
const TRACE_AFTER_US: u64 = 70_000;
/// What the edges of a shutter's sensor may differ from the light by, µs.
const SAME_OPENING_US: u64 = 100_000;
/// The flight goes on so long after its last trigger, µs, and at most so long.
const AFTER_US: [u64; 2] = [1_000_000, 20_000_000];

/// How a scenario is flown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlightOptions {
    /// Seed of air, noise and jitter.
    pub seed: u64,
    /// The frame whose rounds are kept; without it the first with a fault, or else the one with the largest errors.
    pub frame: Option<u32>,
}

/// Where a flight is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Status {
    /// Simulated time, s.
    pub time_s: f64,
    /// Records so far.
    pub frames: usize,
    /// What the camera is doing.
    pub state: State,
    /// V/H as the first source has it, 1/s.
    pub told_vh_per_s: f64,
    /// Smear of the last exposure, mm.
    pub last_smear_mm: Option<f64>,
}

/// One trigger's record, and what really happened.
#[derive(Debug, Clone, PartialEq)]
pub struct FlownFrame {
    /// As the camera has it.
    pub record: FrameRecord,
    /// As it was; `None` where no light passed.
    pub truth: Option<FrameTruth>,
}

/// A flight that is over.
#[derive(Debug, Clone, PartialEq)]
pub struct Flown {
    /// What the camera is, in words.
    pub device: String,
    /// Triggers that were given, µs, in order.
    pub triggers_us: Vec<u64>,
    /// Every record, in order of the triggers.
    pub frames: Vec<FlownFrame>,
    /// Light of which no record knows.
    pub unrecorded: Vec<FrameTruth>,
    /// Faults as the camera named them, µs.
    pub announced: Vec<(u64, Fault)>,
    /// Changes of the camera's state, µs.
    pub states: Vec<(u64, State)>,
    /// When each injected fault could first be felt, µs.
    pub felt_us: Vec<Option<u64>>,
    /// Requests that the cut link lost.
    pub lost_requests: u32,
    /// The rounds of one frame.
    pub trace: Option<Trace>,
    /// Simulated time, s.
    pub duration_s: f64,
}

/// Flies a scenario.
///
/// # Errors
/// [`DeviceError`] where the camera cannot be talked to.
pub fn fly(
    scenario: &MissionScenario,
    options: FlightOptions,
    mechanics: Mechanics,
    device: &mut dyn FlyingDevice,
    status: impl FnMut(&Status),
) -> Result<Flown, DeviceError> {
    let description = device.description();
    Flight::new(scenario, options, mechanics, device).run(description, status)
}

/// A frame whose rounds are to be kept.
struct Traced {
    sequence: u32,
    trigger_us: u64,
    until_us: u64,
}

/// A flight under way.
struct Flight<'a> {
    device: &'a mut dyn FlyingDevice,
    options: FlightOptions,
    injections: Vec<Injection>,
    encoder_step_mm: f64,
    clear_after_us: Option<u64>,
    pixel_mm: f64,
    aircraft: Aircraft,
    sensors: Sensors,
    shutter: ShutterSimulator,
    mechanics: Mechanics,
    oracle: Oracle,
    link: LinkFaults,
    recorder: Recorder,
    triggers_us: Vec<u64>,
    next_trigger: usize,
    last_trigger_us: u64,
    limit_was_closed: bool,
    /// Events that the last round had no room for.
    waiting: Vec<(Time, Event)>,
    failed_since_us: Option<u64>,
    setpoint: Option<Setpoint>,
    /// Light that has passed, without its record yet.
    finished: Vec<Opening>,
    truths: Vec<FrameTruth>,
    next_sequence: u32,
    record_waits: bool,
    /// The frame that is shown, as long as its rounds go on.
    traced: Option<Traced>,
    /// How bad the frame of the trace is.
    trace_badness: f64,
    flown: Flown,
}

impl<'a> Flight<'a> {
    fn new(
        scenario: &MissionScenario,
        options: FlightOptions,
        mut mechanics: Mechanics,
        device: &'a mut dyn FlyingDevice,
    ) -> Self {
        let injections = scenario.injections();
        for injection in mechanical(&injections) {
            mechanics.inject(injection);
        }
        let regular: Vec<u64> = scenario.triggers_s().map(microseconds).collect();
        let triggers_us = with_overlaps(&regular, &injections);
        let aircraft = Aircraft::of(scenario, options.seed);
        let shutter = &scenario.written.shutter;
        let timing = ShutterTiming {
            latency_s: shutter.latency_ms / 1000.0,
            jitter_s: shutter.jitter_us * 1e-6,
        };
        Self {
            options,
            encoder_step_mm: scenario.written.mechanics.encoder_step_um / 1000.0,
            clear_after_us: scenario
                .written
                .flight
                .clear_faults_after_s
                .map(microseconds),
            pixel_mm: scenario.camera.sensor.pixel_um / 1000.0,
            sensors: Sensors::of(scenario, &injections, options.seed),
            shutter: ShutterSimulator::new(timing, &injections, options.seed),
            oracle: Oracle::new(&scenario.camera, &aircraft),
            link: LinkFaults::new(&injections),
            aircraft,
            mechanics,
            recorder: Recorder::default(),
            last_trigger_us: triggers_us.last().copied().unwrap_or(0),
            next_trigger: 0,
            limit_was_closed: false,
            waiting: Vec::new(),
            failed_since_us: None,
            setpoint: None,
            finished: Vec::new(),
            truths: Vec::new(),
            next_sequence: 1,
            record_waits: false,
            traced: None,
            trace_badness: f64::NEG_INFINITY,
            flown: Flown {
                device: String::new(),
                triggers_us: triggers_us.clone(),
                frames: Vec::new(),
                unrecorded: Vec::new(),
                announced: Vec::new(),
                states: Vec::new(),
                felt_us: vec![None; injections.len()],
                lost_requests: 0,
                trace: None,
                duration_s: 0.0,
            },
            triggers_us,
            injections,
            device,
        }
    }

    fn run(
        mut self,
        description: String,
        mut status: impl FnMut(&Status),
    ) -> Result<Flown, DeviceError> {
        let mut now_us = 0;
        let mut last_frames = 0;
        loop {
            now_us += ROUND_US;
            let answer = self.round(now_us)?;
            let is_new = self.flown.frames.len() != last_frames;
            if is_new || now_us.is_multiple_of(100 * ROUND_US) {
                last_frames = self.flown.frames.len();
                status(&self.status(now_us, answer.state));
            }
            if self.is_over(now_us, answer.state) {
                break;
            }
        }
        self.finish_trace();
        self.flown.unrecorded = std::mem::take(&mut self.truths);
        self.flown.duration_s = seconds(now_us);
        self.flown.device = description;
        Ok(self.flown)
    }

    /// From the last round to this one, and what the camera does about it.
    fn round(&mut self, now_us: u64) -> Result<RigAnswer, DeviceError> {
        let idle = now_us == ROUND_US;
        if idle {
            self.mechanics
                .advance(0.0, false, seconds(now_us) - self.mechanics.time_s());
        }
        let step = self.step(now_us);
        let answer = self.device.step(&step)?;
        self.setpoint = self.device.setpoint(Time::from_us(now_us));
        self.obey(now_us, &answer);
        self.feel(now_us, &answer);
        self.recorder.push(Round {
            time_us: now_us,
            setpoint: self.setpoint,
            true_mm: self.mechanics.position_mm(),
            encoder_mm: f64::from(step.encoder_count) * self.encoder_step_mm,
            duty: if answer.powered {
                f64::from(answer.duty)
            } else {
                0.0
            },
            told_vh_per_s: self.sensors.told_vh_per_s(),
            is_open: self.shutter.is_open(now_us),
            state: answer.state,
        });
        let next_us = now_us + ROUND_US;
        let until_next_s = seconds(next_us) - self.mechanics.time_s();
        self.mechanics
            .advance(f64::from(answer.duty), answer.powered, until_next_s);
        self.expose(next_us);
        self.fetch(now_us)?;
        if self
            .traced
            .as_ref()
            .is_some_and(|traced| now_us >= traced.until_us)
        {
            self.finish_trace();
        }
        Ok(answer)
    }

    /// What has happened since the last round, in order of time.
    fn step(&mut self, now_us: u64) -> RigStep {
        let mut events = self.sensors.arrivals(&self.aircraft, now_us);
        for (time_us, edge) in self.shutter.edges(now_us) {
            events.push((Time::from_us(time_us), Event::Shutter(edge)));
        }
        while let Some(trigger_us) = self.triggers_us.get(self.next_trigger).copied()
            && trigger_us <= now_us
        {
            events.push((Time::from_us(trigger_us), Event::Trigger));
            self.next_trigger += 1;
        }
        let is_closed = self.mechanics.limit_closed();
        if is_closed && !self.limit_was_closed {
            events.push((Time::from_us(now_us), Event::LimitSwitch));
        }
        self.limit_was_closed = is_closed;
        for command in self.commands(now_us) {
            events.push((Time::from_us(now_us), Event::Command(command)));
        }
        // What the camera did not take in the last round comes first.
        let mut waiting = std::mem::take(&mut self.waiting);
        events.sort_by_key(|(time, _)| *time);
        waiting.append(&mut events);
        let mut step = RigStep {
            time: Time::from_us(now_us),
            encoder_count: self.mechanics.encoder_count(),
            ..RigStep::default()
        };
        for event in waiting {
            if let Err(event) = step.events.push(event) {
                self.waiting.push(event);
            }
        }
        step
    }

    /// What the operator wants.
    fn commands(&mut self, now_us: u64) -> Vec<Command> {
        if now_us == ARMED_AT_US {
            return vec![Command::Arm];
        }
        if let (Some(since_us), Some(after_us)) = (self.failed_since_us, self.clear_after_us)
            && now_us >= since_us + after_us
        {
            self.failed_since_us = None;
            return vec![Command::ClearFault, Command::Arm];
        }
        Vec::new()
    }

    fn obey(&mut self, now_us: u64, answer: &RigAnswer) {
        for action in &answer.actions {
            match action {
                // Done by the camera's own drive.
                Action::MoveStage(_) | Action::ReleaseStage | Action::ClockRows { .. } => {}
                Action::OpenShutter { at, exposure_s } => {
                    self.shutter
                        .open(at.us().max(now_us), f64::from(*exposure_s));
                }
                Action::CloseShutter => self.shutter.close(now_us),
                Action::FrameReady(_) => self.record_waits = true,
                Action::Fault(fault) => self.flown.announced.push((now_us, *fault)),
            }
        }
        let last = self.flown.states.last().map(|(_, state)| *state);
        if last != Some(answer.state) {
            self.flown.states.push((now_us, answer.state));
            let has_failed = matches!(answer.state, State::Fault(_) | State::Degraded(_));
            self.failed_since_us = if has_failed {
                self.failed_since_us.or(Some(now_us))
            } else {
                None
            };
        }
    }

    /// When a fault can first be felt: those of the stage only while it is to move.
    fn feel(&mut self, now_us: u64, answer: &RigAnswer) {
        let time_s = seconds(now_us);
        let moves = [
            State::RunUp,
            State::Tracking,
            State::Exposing,
            State::FlyBack,
        ];
        let is_moving = self.setpoint.map_or_else(
            || answer.powered && moves.contains(&answer.state),
            |setpoint| setpoint.speed_mm_s != 0.0,
        );
        for (injection, felt) in self.injections.iter().zip(&mut self.flown.felt_us) {
            let needs_motion = matches!(
                injection.fault,
                InjectedFault::Stall | InjectedFault::SignError
            );
            if felt.is_none() && injection.is_on(time_s) && (is_moving || !needs_motion) {
                *felt = Some(now_us);
            }
        }
    }

    /// The light that has passed by the next round.
    fn expose(&mut self, next_us: u64) {
        self.finished.extend(self.shutter.finished(next_us));
        let path_until_s = self.mechanics.time_s();
        let (ready, rest): (Vec<Opening>, Vec<Opening>) = self
            .finished
            .iter()
            .partition(|opening| seconds(opening.closed_us) + PATH_MARGIN_S <= path_until_s);
        self.finished = rest;
        for opening in ready {
            let opened_s = seconds(opening.opened_us);
            let until_s = seconds(opening.closed_us) + PATH_MARGIN_S;
            let knots = self
                .mechanics
                .history(opened_s - PATH_MARGIN_S)
                .take_while(|instant| instant.time_s <= until_s)
                .map(|instant| (instant.time_s - opened_s, instant.stage_mm))
                .collect();
            if let Some(path) = StagePath::new(knots) {
                let exposure = TrueExposure { opening, path };
                self.truths.push(self.oracle.truth(&exposure));
            }
        }
    }

    /// Takes the records that wait, and tells the camera that they are safe.
    fn fetch(&mut self, now_us: u64) -> Result<(), DeviceError> {
        if !self.record_waits || !self.finished.is_empty() || self.shutter.is_busy() {
            return Ok(());
        }
        if self.link.loses(seconds(now_us)) {
            self.flown.lost_requests += 1;
            return Ok(());
        }
        while let Some(record) = self.device.record(self.next_sequence)? {
            self.next_sequence = record.sequence + 1;
            self.keep(now_us, record);
        }
        self.device.acknowledge(self.next_sequence - 1)?;
        self.record_waits = false;
        Ok(())
    }

    fn keep(&mut self, now_us: u64, record: FrameRecord) {
        let truth = match &record.outcome {
            Outcome::Exposed(exposed) => self.truth_of(exposed.opened.us()),
            Outcome::Refused(_) => None,
        };
        let frame = FlownFrame { record, truth };
        let badness = self.badness(&frame);
        if badness > self.trace_badness {
            self.trace_badness = badness;
            self.finish_trace();
            self.traced = Some(Traced {
                sequence: frame.record.sequence,
                trigger_us: frame.record.trigger.us(),
                until_us: now_us + TRACE_AFTER_US,
            });
        }
        self.flown.frames.push(frame);
    }

    /// Cuts the rounds of the frame that is shown out of those that are remembered.
    fn finish_trace(&mut self) {
        let Some(traced) = self.traced.take() else {
            return;
        };
        let mut rounds = self
            .recorder
            .since(traced.trigger_us.saturating_sub(TRACE_BEFORE_US));
        rounds.retain(|round| round.time_us <= traced.until_us);
        let true_vh_per_s = rounds
            .iter()
            .map(|round| {
                let there = self.aircraft.speed_and_height(seconds(round.time_us));
                there.vh_per_s()
            })
            .collect();
        self.flown.trace = Some(Trace {
            sequence: traced.sequence,
            trigger_us: traced.trigger_us,
            rounds,
            true_vh_per_s,
        });
    }

    /// The true exposure that a record means: the one that opened at its time.
    fn truth_of(&mut self, opened_us: u64) -> Option<FrameTruth> {
        let apart_us = |truth: &FrameTruth| microseconds(truth.opened_s).abs_diff(opened_us);
        let (index, nearest) = self
            .truths
            .iter()
            .enumerate()
            .min_by_key(|(_, truth)| apart_us(truth))?;
        (apart_us(nearest) <= SAME_OPENING_US).then(|| self.truths.remove(index))
    }

    /// Which frame's rounds are worth keeping.
    fn badness(&self, frame: &FlownFrame) -> f64 {
        if let Some(wanted) = self.options.frame {
            return if frame.record.sequence == wanted {
                0.0
            } else {
                f64::NEG_INFINITY
            };
        }
        let is_first_failure = !frame.record.faults.is_empty()
            && self
                .flown
                .frames
                .iter()
                .all(|earlier| earlier.record.faults.is_empty());
        if is_first_failure {
            return f64::INFINITY;
        }
        frame
            .truth
            .as_ref()
            .map_or(0.0, |truth| truth.smear_mm / self.pixel_mm)
    }

    fn is_over(&self, now_us: u64, state: State) -> bool {
        let [least_us, most_us] = AFTER_US;
        let is_busy = matches!(state, State::RunUp | State::Tracking | State::Exposing);
        let all_there = self.flown.frames.len() >= self.triggers_us.len();
        now_us > self.last_trigger_us + least_us && all_there && !is_busy
            || now_us > self.last_trigger_us + most_us
    }

    fn status(&self, now_us: u64, state: State) -> Status {
        Status {
            time_s: seconds(now_us),
            frames: self.flown.frames.len(),
            state,
            told_vh_per_s: self.sensors.told_vh_per_s(),
            last_smear_mm: self
                .flown
                .frames
                .last()
                .and_then(|frame| frame.truth.map(|truth| truth.smear_mm)),
        }
    }
}
