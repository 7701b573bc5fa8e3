//! The camera's state machine: one frame from trigger to record.
//!
//! Events come in with their time, in order; actions go out. Nothing waits, nothing is read from outside, so that
//! firmware, simulator and tests run the same code. Per round of the control loop (1 kHz): what has happened since the
//! last round, then [`Event::Stage`], then [`Event::Tick`].
//!
//! ```text
//! standby ──arm──► fly-back ──► armed ──trigger──► run-up ──at speed──► tracking ──first light──► exposing
//!                     ▲                                                     │                        │
//!                     └─────────────────────────────────────────────────────┴────── last light ──────┘
//! armed ◄──► degraded(V/H lost, overload)      any ──► fault ──stage stands──► degraded(its fault)
//! ```

mod commands;
mod faults;
mod frame;
mod motion;
mod recording;
mod rounds;
mod shutter;
mod stage_readings;
pub mod state;
mod ticks;
pub mod timing;
mod trigger;

use core::fmt;

use heapless::Vec;

use self::frame::FrameInFlight;
use self::motion::Motion;
use self::rounds::Rounds;
use self::state::State;
use super::camera::{self, Camera, CameraRecord, FrameError};
use super::event::{Action, AttitudeSample, Event};
use super::fault::{Fault, Faults};
use super::following_error::FollowingError;
use super::frame_record::FrameRecord;
use super::record_log::RecordLog;
use super::settings::FlightSettings;
use super::slope::Slope;
use super::smear_prediction::SmearPrediction;
use super::stage::Setpoint;
use super::stage_track::StageTrack;
use super::stage_watch::StageWatch;
use super::time::Time;
use super::utc::UtcClock;
use super::vh::VhMonitor;
use crate::geometry::calibration::CalibrationError;
use crate::geometry::range::OutOfRange;

/// Most actions that one event leads to.
pub const MAX_ACTIONS: usize = 6;

/// What an event leads to, in order.
pub type Actions = Vec<Action, MAX_ACTIONS>;

/// The camera's state machine.
#[derive(Debug, Clone)]
pub struct Controller {
    camera: Camera,
    calibration_crc: u32,
    settings: FlightSettings,
    smear: SmearPrediction,
    vh: VhMonitor,
    utc: UtcClock,
    attitude: Option<(Time, AttitudeSample)>,
    state: State,
    /// `None`: no force on the stage.
    motion: Option<Motion>,
    track: StageTrack,
    watch: StageWatch,
    /// Following error of the stage; without force, its place.
    following: Slope,
    following_error: FollowingError,
    /// While arming: ways of the exercise that are left.
    arming: Option<u8>,
    /// What went wrong with the stage, until it is cleared: it is left alone.
    stage_fault: Option<Fault>,
    /// The encoder has lost its place, until somebody has found it again.
    is_place_lost: bool,
    /// When the stage was read last, or the readings began to be waited for.
    last_reading: Time,
    /// Where it stands without force, and since when.
    standing_since: Option<(Time, f32)>,
    frame: Option<FrameInFlight>,
    latest: Option<(u32, camera::Frame)>,
    records: RecordLog,
    /// What happened with no frame in flight; goes into the next record.
    faults: Faults,
    is_supply_good: bool,
    /// A disarm waits for the exposure to end.
    is_disarming: bool,
    exposure_s: f32,
    last_event: Option<Time>,
    rounds: Rounds,
    counts: Counts,
}

/// What has happened since the controller was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counts {
    /// Triggers.
    pub triggers: u32,
    /// Records with an exposure.
    pub exposed: u32,
    /// Records without.
    pub refused: u32,
    /// Wrong encoder readings that were left out.
    pub glitches: u32,
    /// Rounds of the control loop that came late.
    pub late_ticks: u32,
    /// Edges of the shutter that nobody had asked for.
    pub unexpected_edges: u32,
    /// Events that could not be kept until the control loop came round.
    pub lost_events: u32,
}

impl Controller {
    /// The controller of a camera, in standby. After a bite of the watchdog it begins with that fault.
    ///
    /// # Errors
    /// [`ControllerError`] naming what is not believable.
    pub fn new(
        record: &CameraRecord,
        calibration_crc: u32,
        settings: &FlightSettings,
        start: Start,
    ) -> Result<Self, ControllerError> {
        let camera = Camera::new(*record).map_err(ControllerError::Calibration)?;
        let settings = settings.checked().map_err(ControllerError::Settings)?;
        camera
            .check_exposure_time(settings.exposure_s)
            .map_err(|error| ControllerError::Travel(error.into()))?;
        let mut faults = Faults::NONE;
        let state = match start {
            Start::Orderly | Start::Unreferenced => State::Standby,
            Start::AfterWatchdog => {
                faults.insert(Fault::Watchdog);
                State::Fault(Fault::Watchdog)
            }
        };
        trigger::check_interval(&camera, &settings)?;
        // Made where it is to be: it is large, and a copy on the way takes as much of the stack.
        Ok(Self {
            smear: SmearPrediction::new(camera.calibration(), settings.direction),
            vh: VhMonitor::new(settings.vh),
            utc: UtcClock::new(settings.time_pulse_sigma_s),
            attitude: None,
            state,
            motion: None,
            track: StageTrack::new(),
            watch: StageWatch::new(),
            following: Slope::new(),
            following_error: FollowingError::default(),
            arming: None,
            stage_fault: (start != Start::Orderly && camera.has_stage()).then_some(Fault::Encoder),
            // What an encoder counts is gone with the processor.
            is_place_lost: start != Start::Orderly && camera.has_stage(),
            last_reading: Time::START,
            standing_since: None,
            frame: None,
            latest: None,
            records: RecordLog::new(),
            faults,
            is_supply_good: true,
            is_disarming: false,
            exposure_s: settings.exposure_s,
            last_event: None,
            rounds: Rounds::default(),
            counts: Counts::default(),
            camera,
            calibration_crc,
            settings,
        })
    }

    /// What happens, and what is to be done about it. Events come in order of their times; one that is older than the
    /// one before by more than [`timing::LATE_EVENT_S`], or later by more than [`timing::CLOCK_JUMP_S`], is a
    /// [`Fault::Clock`].
    pub fn handle(&mut self, time: Time, event: Event) -> Actions {
        let mut actions = Actions::new();
        self.check_clock(time, &mut actions);
        match event {
            Event::Command(command) => self.obey(time, command, &mut actions),
            Event::Vh(sample) => {
                self.vh.observe(time, sample);
            }
            Event::Attitude(sample) => self.attitude = Some((time, sample)),
            Event::TimePulse => {
                self.utc.pulse(time);
            }
            Event::GnssTime(unix_us) => {
                self.utc.receiver_time(time, unix_us);
            }
            Event::Trigger => self.trigger(time, &mut actions),
            Event::Shutter(edge) => self.shutter_edge(time, edge, &mut actions),
            Event::Stage(reading) => self.stage_reading(time, reading, &mut actions),
            Event::LimitSwitch => self.fail(Fault::LimitSwitch, &mut actions),
            Event::Drive(fault) => self.fail(fault, &mut actions),
            Event::Supply(supply) => self.supply(supply, &mut actions),
            Event::Tick => self.tick(time, &mut actions),
            Event::Lost(events) => self.lose(events, &mut actions),
        }
        actions
    }

    /// What the camera is doing.
    #[must_use]
    pub const fn state(&self) -> State {
        self.state
    }

    /// The validated camera.
    #[must_use]
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &FlightSettings {
        &self.settings
    }

    /// The sources of V/H.
    #[must_use]
    pub const fn vh(&self) -> &VhMonitor {
        &self.vh
    }

    /// What has happened so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Whether the encoder has lost its place.
    #[must_use]
    pub const fn is_place_lost(&self) -> bool {
        self.is_place_lost
    }

    /// How the controller must begin that takes the place of this one: what nobody has cleared is not forgotten.
    #[must_use]
    pub fn next_start(&self) -> Start {
        match self.state {
            State::Fault(Fault::Watchdog) => Start::AfterWatchdog,
            _ if self.is_place_lost => Start::Unreferenced,
            _ => Start::Orderly,
        }
    }

    /// Root mean square of the stage's following error over about a second, µm, within 6 %.
    #[must_use]
    pub fn following_rms_um(&self) -> f32 {
        self.following_error.rms_um()
    }

    /// Whether it is armed, with compensation or without, or a frame is in flight: calibration and settings must stay.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.frame.is_some() || !matches!(self.state, State::Standby | State::Fault(_))
    }

    /// Number and frame of the exposure recorded last, for the correction of its points.
    #[must_use]
    pub const fn latest(&self) -> Option<&(u32, camera::Frame)> {
        self.latest.as_ref()
    }

    /// The oldest record with this number or a higher one.
    #[must_use]
    pub fn record(&self, from_sequence: u32) -> Option<FrameRecord> {
        self.records.from(from_sequence)
    }

    /// Records that have not been acknowledged.
    #[must_use]
    pub fn kept(&self) -> u32 {
        self.records.kept()
    }

    /// The PC has all records up to this number. Says how many are left.
    pub fn acknowledge(&mut self, through: u32) -> u32 {
        self.records.acknowledge(through)
    }

    /// Where the stage should be at a time; `None` where it is released.
    #[must_use]
    pub fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.motion.as_ref().map(|motion| motion.setpoint(now))
    }
}

/// How the camera has come to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Start {
    /// Switched on, or asked to start again.
    Orderly,
    /// Its watchdog was not fed, or the processor failed.
    AfterWatchdog,
    /// As [`Self::Orderly`], but the encoder has lost its place.
    Unreferenced,
}

/// A camera cannot be flown so.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ControllerError {
    /// The calibration is not usable.
    Calibration(CalibrationError),
    /// A setting is not believable.
    Settings(OutOfRange),
    /// The mechanism cannot make any travel within the camera's limits, or not between two triggers.
    Travel(FrameError),
}

impl fmt::Display for ControllerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Calibration(error) => error.fmt(f),
            Self::Settings(error) => error.fmt(f),
            Self::Travel(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ControllerError {}

/// Adds an action; there is room for those of one event.
fn act(actions: &mut Actions, action: Action) {
    let _ = actions.push(action);
}
