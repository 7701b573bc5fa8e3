//! Simulated flight: round after round of the control loop, in simulated time.

mod in_progress;

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event, Supply};
use fmc_camera::flight::frame_record::{FrameRecord, Outcome};
use fmc_camera::flight::rig::{RigAnswer, RigStep};
use fmc_camera::flight::stage::Setpoint;
use fmc_camera::flight::time::Time;

use super::aircraft::Aircraft;
use super::camera_clock::CameraClock;
use super::clock::{ROUND_US, jittered, microseconds, seconds};
use super::device::FlyingDevice;
use super::fault::line::{SerialLine, Traffic};
use super::fault::stage::mechanical;
use super::fault::trigger::with_overlaps;
use super::fault::{InjectedFault, Injection, active};
use super::flown::{Flown, FlownFrame};
use super::lens::Thermometer;
use super::light::Light;
use super::operator::Operator;
use super::oracle::Oracle;
use super::row_clock::RowClock;
use super::scenario::MissionScenario;
use super::sensors::Sensors;
use super::shutter::{ShutterSimulator, ShutterTiming};
use super::trace::Round;
use super::tracer::Tracer;
use super::wire::WireTraffic;
use super::wiring::Wiring;
use crate::mechanics::Mechanics;
use crate::noise::Noise;

/// Time from the computer's request for records to its acknowledgement, µs.
const ACKNOWLEDGED_AFTER_US: u64 = 500;
/// Least and greatest time for which the flight goes on after its last trigger, µs.
const AFTER_US: [u64; 2] = [1_000_000, 20_000_000];

/// Options of a flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlightOptions {
    /// Seed of turbulence, noise and jitter.
    pub seed: u64,
    /// Frame whose rounds are kept; without it, the first frame with a fault, or else the one with
    /// the largest errors. 0 is no frame: then no rounds are kept.
    pub frame: Option<u32>,
}

/// Progress of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Status {
    /// Simulated time, s.
    pub time_s: f64,
    /// Number of records so far.
    pub frames: usize,
    /// State of the camera.
    pub state: State,
    /// V/H according to the first source, 1/s.
    pub told_vh_per_s: f64,
    /// Smear of the last exposure, mm.
    pub last_smear_mm: Option<f64>,
}

/// Flies a scenario.
///
/// # Errors
/// An error if the connection to the camera fails.
pub fn fly<D: FlyingDevice + ?Sized>(
    scenario: &MissionScenario,
    options: FlightOptions,
    mechanics: Mechanics,
    device: &mut D,
    status: impl FnMut(&Status),
) -> Result<Flown, D::Error> {
    let description = device.description();
    Flight::new(scenario, options, mechanics, device).run(description, status)
}

/// A flight in progress. A copy of it flies on as the flight itself does, so that flights with
/// different faults need not repeat what comes before.
#[derive(Debug, Clone)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a state of the world of its own"
)]
pub struct Flight<D> {
    device: D,
    /// Time of the last round, µs on the camera's clock.
    now_us: u64,
    /// Readings and events of the last round.
    told: Told,
    injections: Vec<Injection>,
    wiring: Wiring,
    clock: CameraClock,
    /// σ of the stamps of the shutter's edges, µs.
    stamp_jitter_us: f64,
    stamp_noise: Noise,
    aircraft: Aircraft,
    sensors: Sensors,
    shutter: ShutterSimulator,
    mechanics: Mechanics,
    light: Light,
    line: SerialLine,
    operator: Operator,
    thermometer: Thermometer,
    tracer: Tracer,
    /// Triggers without those that a fault adds, µs of true time.
    regular_us: Vec<u64>,
    next_trigger: usize,
    last_trigger_us: u64,
    limit_was_closed: bool,
    is_supply_low: bool,
    /// Events that did not fit into the last round.
    waiting: Vec<(Time, Event)>,
    setpoint: Option<Setpoint>,
    next_sequence: u32,
    record_waits: bool,
    has_wires: bool,
    flown: Flown,
}

/// Readings and events that the camera is told in a round.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// Readings and events.
    pub step: RigStep,
    /// Bytes on the wires; `None` without wires.
    pub traffic: Option<WireTraffic>,
}

impl<D: FlyingDevice> Flight<D> {
    /// Creates the flight of a camera that has been prepared, before its first round.
    pub fn new(
        scenario: &MissionScenario,
        options: FlightOptions,
        mut mechanics: Mechanics,
        device: D,
    ) -> Self {
        let injections = scenario.injections();
        for injection in mechanical(&injections) {
            mechanics.inject(injection);
        }
        let regular_us: Vec<u64> = scenario.triggers_s().map(microseconds).collect();
        let clock = CameraClock::of(&scenario.written.clock, options.seed);
        let triggers_us: Vec<u64> = with_overlaps(&regular_us, &injections)
            .into_iter()
            .map(|time_us| clock.stamp_us(time_us))
            .collect();
        let aircraft = Aircraft::of(scenario, options.seed);
        let shutter = &scenario.written.shutter;
        let timing = ShutterTiming {
            latency_s: shutter.latency_ms / 1000.0,
            jitter_s: shutter.jitter_us * 1e-6,
        };
        let line = SerialLine::new(scenario.carried(), &injections);
        let clear_after_us = scenario.written.flight.clear_faults_after_s;
        Self {
            wiring: Wiring::of(scenario),
            stamp_jitter_us: shutter.stamp_jitter_us,
            stamp_noise: Noise::new(options.seed, 101),
            sensors: Sensors::of(scenario, &line, &injections, options.seed),
            shutter: ShutterSimulator::new(timing, &injections, options.seed),
            light: Light::new(
                Oracle::new(
                    &scenario.camera,
                    &aircraft,
                    &scenario.written.detector.run_out_um,
                ),
                RowClock::of(&scenario.camera),
            ),
            line,
            operator: Operator::new(clear_after_us.map(microseconds)),
            thermometer: Thermometer::of(scenario),
            aircraft,
            mechanics,
            tracer: Tracer::new(options.frame),
            last_trigger_us: triggers_us.last().copied().unwrap_or(0),
            regular_us,
            next_trigger: 0,
            limit_was_closed: false,
            is_supply_low: false,
            waiting: Vec::new(),
            setpoint: None,
            next_sequence: 1,
            record_waits: false,
            has_wires: false,
            flown: Flown::before(clock.clone(), triggers_us, injections.len()),
            clock,
            injections,
            now_us: 0,
            told: Told::default(),
            device,
        }
    }

    /// Performs the next round of the control loop.
    ///
    /// # Errors
    /// An error if the connection to the camera fails.
    pub fn advance(&mut self) -> Result<RigAnswer, D::Error> {
        self.now_us = self.next_round_us();
        self.round(self.now_us)
    }

    /// Returns the time of the next round, µs, which a fault makes late.
    fn next_round_us(&self) -> u64 {
        let now_s = self.true_s(self.now_us);
        let late = active(&self.injections, InjectedFault::LateRounds, now_s);
        let late_us = late.map_or(0, |late| microseconds(late.size / 1000.0));
        self.now_us + ROUND_US + late_us
    }

    fn run(
        mut self,
        description: String,
        mut status: impl FnMut(&Status),
    ) -> Result<Flown, D::Error> {
        let mut last_frames = 0;
        loop {
            let answer = self.advance()?;
            let now_us = self.now_us;
            let is_new = self.flown.frames.len() != last_frames;
            if is_new || now_us.is_multiple_of(100 * ROUND_US) {
                last_frames = self.flown.frames.len();
                status(&self.status(now_us, answer.state));
            }
            if self.is_over(now_us, answer.state, AFTER_US) {
                return self.into_flown(description);
            }
        }
    }

    fn into_flown(mut self, description: String) -> Result<Flown, D::Error> {
        self.flown.trace = self.tracer.into_trace(&self.aircraft);
        self.flown.unrecorded = self.light.into_rest();
        self.flown.sentences = self.sensors.sentence_counts();
        if self.has_wires {
            self.flown.instruments = Some(self.device.instruments()?);
        }
        self.flown.duration_s = seconds(self.now_us);
        self.flown.device = description;
        Ok(self.flown)
    }

    /// Performs one round: passes the events since the last one to the camera and does what it
    /// answers.
    fn round(&mut self, now_us: u64) -> Result<RigAnswer, D::Error> {
        let idle = now_us == ROUND_US;
        if idle {
            self.mechanics
                .advance(0.0, false, self.true_s(now_us) - self.mechanics.time_s());
        }
        let step = self.step(now_us);
        let traffic = self.sensors.traffic();
        let answer = match &traffic {
            Some(traffic) => {
                self.has_wires = true;
                self.device.step_with_wires(&step, traffic)?
            }
            None => self.device.step(&step)?,
        };
        let round_s = self.mechanics.time_s();
        let steps = self.wiring.steps(f64::from(answer.duty));
        self.mechanics
            .add_steps(steps.map(|(after_s, step)| (round_s + after_s, step)));
        self.setpoint = self.device.setpoint(Time::from_us(now_us));
        self.obey(now_us, &answer);
        self.feel(now_us, &answer);
        let true_mm = self.mechanics.position_mm();
        self.flown.farthest_mm = self.flown.farthest_mm.max(true_mm.abs());
        self.tracer.push(Round {
            time_us: now_us,
            setpoint: self.setpoint,
            true_mm,
            encoder_mm: self.wiring.encoder_mm(step.encoder_count),
            duty: if answer.powered {
                f64::from(answer.duty)
            } else {
                0.0
            },
            told_vh_per_s: self.sensors.told_vh_per_s(),
            is_open: self.shutter.is_open(self.clock.true_us(now_us)),
            state: answer.state,
        });
        let next_us = self.next_round_us();
        let until_next_s = self.true_s(next_us) - self.mechanics.time_s();
        let duty = self.wiring.duty(f64::from(answer.duty));
        self.mechanics.advance(duty, answer.powered, until_next_s);
        let next_true_us = self.clock.true_us(next_us);
        self.light
            .take(&mut self.shutter, &self.mechanics, next_true_us);
        self.fetch(now_us)?;
        self.tracer.look(now_us, &self.aircraft);
        self.told = Told { step, traffic };
        Ok(answer)
    }

    /// Collects the events since the last round, in order of time.
    fn step(&mut self, now_us: u64) -> RigStep {
        let true_us = self.clock.true_us(now_us);
        let stamp = |time_us: u64| Time::from_us(self.clock.stamp_us(time_us).min(now_us));
        let mut events: Vec<(Time, Event)> = self
            .sensors
            .arrivals(&self.aircraft, true_us)
            .into_iter()
            .map(|(time, event)| (stamp(time.us()), event))
            .collect();
        for (time_us, edge) in self.shutter.edges(true_us) {
            let [jitter_us] = self.stamp_noise.next([self.stamp_jitter_us]);
            let stamped_us = jittered(self.clock.stamp_us(time_us), jitter_us).min(now_us);
            events.push((Time::from_us(stamped_us), Event::Shutter(edge)));
        }
        while let Some(trigger_us) = self.flown.triggers_us.get(self.next_trigger).copied()
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
        let is_low = active(
            &self.injections,
            InjectedFault::SupplyLow,
            self.true_s(now_us),
        )
        .is_some();
        if is_low != self.is_supply_low {
            self.is_supply_low = is_low;
            let supply = if is_low { Supply::Low } else { Supply::Good };
            events.push((Time::from_us(now_us), Event::Supply(supply)));
        }
        for command in self.operator.commands(now_us) {
            events.push((Time::from_us(now_us), Event::Command(command)));
        }
        if let Some(celsius) = self.thermometer.told(true_us) {
            let told = Event::Command(Command::Temperature(celsius));
            events.push((Time::from_us(now_us), told));
        }
        // Events that the camera did not take in the last round come first.
        let mut waiting = std::mem::take(&mut self.waiting);
        events.sort_by_key(|(time, _)| *time);
        waiting.append(&mut events);
        let mut step = RigStep {
            time: Time::from_us(now_us),
            encoder_count: self.wiring.count(self.mechanics.encoder_count()),
            index_count: self
                .mechanics
                .take_index()
                .map(|along_axis| self.wiring.count(along_axis)),
            ..RigStep::default()
        };
        for event in waiting {
            if let Err(event) = step.events.push(event) {
                self.waiting.push(event);
            }
        }
        step
    }

    fn obey(&mut self, now_us: u64, answer: &RigAnswer) {
        for action in &answer.actions {
            match action {
                // The camera's drive has done this.
                Action::MoveStage(_) | Action::ReleaseStage => {}
                Action::ClockRows { speed_mm_s, .. } => {
                    self.light.clock_rows(f64::from(*speed_mm_s));
                }
                Action::OpenShutter { at, exposure_s } => {
                    let at_us = self.clock.true_us(at.us().max(now_us));
                    self.shutter.open(at_us, f64::from(*exposure_s));
                }
                Action::CloseShutter => self.shutter.close(self.clock.true_us(now_us)),
                Action::FrameReady(_) => self.record_waits = true,
                Action::Fault(fault) => self.flown.announced.push((now_us, *fault)),
                Action::InDoubt(exposures) => self.flown.doubt(*exposures),
            }
        }
        let last = self.flown.states.last().map(|(_, state)| *state);
        if last != Some(answer.state) {
            self.flown.states.push((now_us, answer.state));
            self.operator.see(now_us, answer.state);
        }
    }

    /// Notes when a fault can first be felt; some faults of the stage can only be felt while it is
    /// to move.
    fn feel(&mut self, now_us: u64, answer: &RigAnswer) {
        let time_s = self.true_s(now_us);
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

    /// Fetches the waiting records and acknowledges them to the camera.
    fn fetch(&mut self, now_us: u64) -> Result<(), D::Error> {
        if !self.record_waits || self.light.is_passing() || self.shutter.is_busy() {
            return Ok(());
        }
        if self.line.loses(Traffic::Records, now_us) {
            self.flown.lost_requests += 1;
            return Ok(());
        }
        while let Some(record) = self.device.frame_record(self.next_sequence)? {
            self.next_sequence = record.sequence + 1;
            self.keep(now_us, record);
        }
        // If the line is cut before the acknowledgement, the camera keeps records that the computer
        // already has.
        if self
            .line
            .loses(Traffic::Records, now_us + ACKNOWLEDGED_AFTER_US)
        {
            self.flown.lost_requests += 1;
            return Ok(());
        }
        self.device.acknowledge(self.next_sequence - 1)?;
        self.record_waits = false;
        Ok(())
    }

    fn keep(&mut self, now_us: u64, record: FrameRecord) {
        let truth = match &record.outcome {
            Outcome::Exposed(exposed) => {
                let opened_us = self.clock.true_us(exposed.opened.us());
                self.light.truth_of(opened_us)
            }
            Outcome::Refused(_) => None,
        };
        let frame = FlownFrame {
            fetched_faults: record.faults,
            record,
            truth,
            fetched_us: now_us,
        };
        self.tracer.consider(now_us, &frame, &self.aircraft);
        self.flown.frames.push(frame);
    }

    /// Returns the true time at which the camera's clock shows a time, s.
    fn true_s(&self, shown_us: u64) -> f64 {
        seconds(self.clock.true_us(shown_us))
    }

    fn is_over(&self, now_us: u64, state: State, [least_us, most_us]: [u64; 2]) -> bool {
        let is_busy = matches!(state, State::RunUp | State::Tracking | State::Exposing);
        let all_there = self.flown.frames.len() >= self.flown.triggers_us.len();
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
