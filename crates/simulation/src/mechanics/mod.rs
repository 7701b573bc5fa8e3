//! Mechanics of the stage: a motor that pushes a mass through friction and play, the encoder and
//! the limit switches that read it, and their faults.

mod fault;
mod history;
mod hysteresis;
mod index_mark;
mod motion;
mod position_stage;
mod settings;

use std::collections::VecDeque;

pub use fault::{Injection, MechanicalFault};
pub use history::Instant;
pub use position_stage::PositionStage;
pub use settings::{EncoderSide, LONGEST_SUBSTEP_S, MechanicsSettings, Stepper};

use history::History;
use hysteresis::Hysteresis;
use index_mark::IndexMark;
use motion::{Forces, Motion};

use crate::noise::Noise;

/// Command to the bridge.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Order {
    at_s: f64,
    duty: f64,
    powered: bool,
}

/// The moving stage.
///
/// Offsets are counted along the FMC axis; positive duty pushes in that direction. The screw moves
/// under force and the stage follows it with play: while the screw pushes along the axis the two
/// offsets are equal; while it pushes against the axis the stage is ahead by the play. The stage's
/// friction keeps it on its flank. This holds while that friction is larger than the stage's mass
/// times the deceleration.
#[derive(Debug, Clone)]
pub struct Mechanics {
    settings: MechanicsSettings,
    injections: Vec<Injection>,
    time_s: f64,
    motion: Motion,
    stage_mm: f64,
    order: Order,
    /// Commands on their way to the bridge.
    orders: VecDeque<Order>,
    /// Steps to come: times, s, and directions.
    steps: VecDeque<(f64, i8)>,
    /// Steps that a stepper's field has made.
    field_steps: i64,
    /// Hysteresis and creep of a stage that follows a position command.
    hysteresis: Hysteresis,
    history: History,
    /// The count about which a reversed encoder counts backwards.
    pivot: Option<i64>,
    /// Lasting offset of the count after a reversal.
    shift: i64,
    /// The count about which an encoder of another scale counts.
    scale_pivot: Option<i64>,
    /// Counts by which it was ahead when the scale changed, and is now.
    ahead_since: i64,
    ahead_now: i64,
    /// Position of the middle of count 0, µm.
    phase_um: f64,
    /// Error of the newest reading of an absolute sensor, µm.
    noise_um: f64,
    /// Source of the encoder's jitter.
    noise: Noise,
    index: IndexMark,
    /// Count that the last edge of the index mark has latched.
    latched: Option<i32>,
}

/// Stream of a seed from which the mechanics draw.
const STREAM: u64 = 200;

/// Position of the middle of count 0 of a stage without a seed, µm.
const PHASE_UM: f64 = 0.03;

impl Mechanics {
    /// Creates a stage at rest at the calibrated position.
    ///
    /// # Errors
    /// A message that names the field, its value and what is allowed.
    pub fn new(settings: MechanicsSettings) -> Result<Self, String> {
        Self::with(&settings, PHASE_UM, Noise::new(0, STREAM))
    }

    /// Creates a stage whose encoder has its phase, unless the settings give it, and its jitter
    /// from a seed.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn seeded(settings: MechanicsSettings, seed: u64) -> Result<Self, String> {
        let mut noise = Noise::new(seed, STREAM);
        let half_um = 0.5 * settings.encoder_step_um;
        let phase_um = noise.between(-half_um, half_um);
        Self::with(&settings, phase_um, noise)
    }

    fn with(settings: &MechanicsSettings, phase_um: f64, noise: Noise) -> Result<Self, String> {
        let settings = settings.checked()?;
        let start = Instant {
            time_s: 0.0,
            screw_mm: 0.0,
            stage_mm: 0.0,
        };
        Ok(Self {
            settings,
            injections: Vec::new(),
            time_s: 0.0,
            motion: Motion::default(),
            stage_mm: 0.0,
            order: Order {
                at_s: 0.0,
                duty: 0.0,
                powered: false,
            },
            orders: VecDeque::new(),
            steps: VecDeque::new(),
            field_steps: 0,
            hysteresis: Hysteresis::default(),
            history: History::new(start, settings.history_s),
            pivot: None,
            shift: 0,
            scale_pivot: None,
            ahead_since: 0,
            ahead_now: 0,
            phase_um: settings.encoder_phase_um.unwrap_or(phase_um),
            noise_um: 0.0,
            noise,
            index: IndexMark::new(),
            latched: None,
        })
    }

    /// Adds a fault.
    pub fn inject(&mut self, injection: Injection) {
        self.injections.push(injection);
    }

    /// Time since the start, s.
    #[must_use]
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// True position of the stage, mm along the FMC axis from the calibrated position.
    #[must_use]
    pub const fn position_mm(&self) -> f64 {
        self.stage_mm
    }

    /// True speed of the screw, mm/s.
    #[must_use]
    pub const fn speed_mm_s(&self) -> f64 {
        self.motion.speed_mm_s
    }

    /// Returns the true positions of screw and stage from a time on, one instant per substep, at
    /// most as far back as the settings remember.
    pub fn history(&self, since_s: f64) -> impl Iterator<Item = Instant> {
        self.history.since(since_s)
    }

    /// Returns the true position of the stage at a time, mm; outside of what is remembered, the
    /// nearest position.
    #[must_use]
    pub fn position_at_mm(&self, time_s: f64) -> f64 {
        self.history
            .at(time_s)
            .map_or(self.stage_mm, |instant| instant.stage_mm)
    }

    /// Advances the time by `dt_s`, with a new duty (-1 to 1) and the bridge on or off.
    pub fn advance(&mut self, duty: f64, powered: bool, dt_s: f64) {
        self.orders.push_back(Order {
            at_s: self.time_s + self.settings.duty_latency_s,
            duty: duty.clamp(-1.0, 1.0),
            powered,
        });
        let end_s = self.time_s + dt_s;
        while self.time_s < end_s {
            while let Some(order) = self.orders.pop_front_if(|order| order.at_s <= self.time_s) {
                self.order = order;
            }
            let mut next_s = end_s.min(self.time_s + self.settings.substep_s);
            if let Some(order) = self.orders.front() {
                next_s = next_s.min(order.at_s);
            }
            while let Some((_, step)) = self.steps.pop_front_if(|(at_s, _)| *at_s <= self.time_s) {
                self.field_steps += i64::from(step);
            }
            self.substep(next_s);
        }
    }

    /// Adds steps of a stepper, in order of their times since the start, s: 1 along the FMC axis,
    /// -1 against it.
    pub fn add_steps(&mut self, steps: impl IntoIterator<Item = (f64, i8)>) {
        self.steps.extend(steps);
    }

    /// Returns the encoder's count as the camera would read it now.
    pub fn encoder_count(&mut self) -> i32 {
        let [jitter_s] = self.noise.next([self.settings.encoder_jitter_s]);
        if let Some(stage) = &self.settings.position_stage {
            [self.noise_um] = self.noise.next([stage.sensor_noise_um]);
        }
        self.count_at(self.time_s - jitter_s)
    }

    /// Returns the count that the index mark has latched since the last call, if the stage has come
    /// to it.
    pub const fn take_index(&mut self) -> Option<i32> {
        self.latched.take()
    }

    /// Returns the count that a reading at a time gives.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a counter of 32 bits wraps"
    )]
    fn count_at(&mut self, time_s: f64) -> i32 {
        let raw = self.raw_count(time_s);
        let reversed = self.has(|fault| matches!(fault, MechanicalFault::EncoderReversed));
        match (reversed, self.pivot) {
            (true, None) => self.pivot = Some(raw),
            (false, Some(pivot)) => {
                // The count goes on from where the reversed count ended.
                self.shift += 2 * (pivot - raw);
                self.pivot = None;
            }
            _ => {}
        }
        let counted = self.pivot.map_or(raw, |pivot| 2 * pivot - raw) + self.shift;
        let glitch: i64 = self
            .active()
            .filter_map(|fault| match fault {
                MechanicalFault::EncoderGlitch { counts } => Some(i64::from(counts)),
                _ => None,
            })
            .sum();
        let ahead = self.counts_of_scale(raw);
        (counted + glitch + ahead - self.lost_counts(time_s)) as i32
    }

    /// Returns the play at a time, µm.
    fn play_um(&self, time_s: f64) -> f64 {
        if self.settings.position_stage.is_some() {
            // There is no screw.
            return 0.0;
        }
        let grown_um = self
            .injections
            .iter()
            .map(|injection| match injection.fault {
                MechanicalFault::PlayGrows { um } => um * injection.part(time_s),
                _ => 0.0,
            });
        self.settings.backlash_um + grown_um.sum::<f64>()
    }

    /// Returns the counts by which an encoder of another scale is ahead.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "some millions of counts"
    )]
    fn counts_of_scale(&mut self, raw: i64) -> i64 {
        let percents = self.active().filter_map(|fault| match fault {
            MechanicalFault::EncoderScale { percent } => Some(percent),
            _ => None,
        });
        let percent: f64 = percents.sum();
        if percent == 0.0 {
            // Counts that are too many stay.
            self.ahead_since = self.ahead_now;
            self.scale_pivot = None;
        } else {
            let pivot = *self.scale_pivot.get_or_insert(raw);
            let more = 0.01 * percent * (raw - pivot) as f64;
            self.ahead_now = self.ahead_since + more.round() as i64;
        }
        self.ahead_now
    }

    /// Returns the counts lost until a time.
    #[expect(clippy::cast_possible_truncation, reason = "some millions of counts")]
    fn lost_counts(&self, time_s: f64) -> i64 {
        (self.lost_um(time_s) / self.settings.encoder_step_um).round() as i64
    }

    /// Returns what the counts lost until a time are, µm.
    fn lost_um(&self, time_s: f64) -> f64 {
        let lost_um = self
            .injections
            .iter()
            .map(|injection| match injection.fault {
                MechanicalFault::CountsLost { um } => um * injection.part(time_s),
                _ => 0.0,
            });
        lost_um.sum()
    }

    /// Returns the state of the low and of the high limit switch; `true` if closed.
    #[must_use]
    pub fn limits_closed(&self) -> [bool; 2] {
        let stuck = self.has(|fault| matches!(fault, MechanicalFault::LimitStuck));
        let [low, high] = self.settings.limits_mm;
        [
            stuck || self.stage_mm <= low,
            stuck || self.stage_mm >= high,
        ]
    }

    /// Returns true if either limit switch is closed.
    #[must_use]
    pub fn limit_closed(&self) -> bool {
        self.limits_closed().contains(&true)
    }

    fn active(&self) -> impl Iterator<Item = MechanicalFault> {
        self.injections
            .iter()
            .filter(|injection| injection.is_active(self.time_s))
            .map(|injection| injection.fault)
    }

    fn has(&self, is_it: impl Fn(MechanicalFault) -> bool) -> bool {
        self.active().any(is_it)
    }

    /// Returns duty, power and jam, N, at this time, with what faults make of them.
    fn drive(&self) -> (f64, bool, f64) {
        let Order {
            mut duty,
            mut powered,
            ..
        } = self.order;
        let (mut sign, mut jam_n) = (1.0, 0.0);
        for fault in self.active() {
            match fault {
                MechanicalFault::Stall { force_n } => jam_n += force_n,
                MechanicalFault::MotorReversed => sign = -1.0,
                MechanicalFault::Runaway { duty: own } => (duty, powered) = (own, true),
                MechanicalFault::BridgeOff => powered = false,
                MechanicalFault::EncoderGlitch { .. }
                | MechanicalFault::CountsLost { .. }
                | MechanicalFault::IndexMissing
                | MechanicalFault::EncoderReversed
                | MechanicalFault::EncoderScale { .. }
                | MechanicalFault::PlayGrows { .. }
                | MechanicalFault::LimitStuck => {}
            }
        }
        (sign * duty, powered, jam_n)
    }

    /// Returns the forces of the motor and of friction at this time.
    fn forces(&self) -> Forces {
        let (duty, powered, jam_n) = self.drive();
        let settings = &self.settings;
        if let Some(stepper) = &settings.stepper {
            return self.forces_of_stepper(stepper, jam_n);
        }
        Forces {
            motor_n: if powered {
                duty * settings.force_n
            } else {
                0.0
            },
            damping_n_s_m: settings.viscous_n_s_m
                + if powered {
                    settings.back_emf_n_s_m
                } else {
                    0.0
                },
            jam_n,
        }
    }

    /// Returns the forces of a stepper, whose field holds the rotor, and of friction.
    #[expect(
        clippy::cast_precision_loss,
        reason = "a stroke has less than 2^53 steps"
    )]
    fn forces_of_stepper(&self, stepper: &Stepper, jam_n: f64) -> Forces {
        let made_mm = self.field_steps as f64 / stepper.steps_per_mm;
        // Steps that are lost are counted as made, as lost counts are those of an encoder.
        let field_mm = made_mm - 1e-3 * self.lost_um(self.time_s);
        let pull_n = stepper.stiffness_n_mm * (field_mm - self.motion.position_mm);
        Forces {
            motor_n: pull_n.clamp(-self.settings.force_n, self.settings.force_n),
            damping_n_s_m: self.settings.viscous_n_s_m + stepper.damping_n_s_m,
            jam_n,
        }
    }

    /// Returns the motion of a stage that follows a position command, a step in time later. Without
    /// power its flexures bring it to command 0; one that is jammed stands.
    fn followed(&mut self, stage: &PositionStage, step_s: f64) -> Motion {
        let (command, powered, jam_n) = self.drive();
        let command = if powered { command } else { 0.0 };
        let moved = self.hysteresis.after(stage, self.motion, command, step_s);
        let [low, high] = self.settings.end_stops_mm;
        let position_mm = moved.position_mm.clamp(low, high);
        if jam_n > 0.0 || (moved.position_mm - position_mm).abs() > 0.0 {
            return Motion {
                position_mm: if jam_n > 0.0 {
                    self.motion.position_mm
                } else {
                    position_mm
                },
                speed_mm_s: 0.0,
            };
        }
        moved
    }

    fn substep(&mut self, until_s: f64) {
        let step_s = until_s - self.time_s;
        self.motion = if let Some(stage) = self.settings.position_stage {
            self.followed(&stage, step_s)
        } else {
            self.motion.after(&self.settings, self.forces(), step_s)
        };
        let screw_mm = self.motion.position_mm;
        let ahead_mm = 1e-3 * self.play_um(until_s);
        let [from_s, from_mm] = [self.time_s, self.stage_mm];
        self.stage_mm = self.stage_mm.clamp(screw_mm, screw_mm + ahead_mm);
        self.time_s = until_s;
        self.history.push(Instant {
            time_s: until_s,
            screw_mm,
            stage_mm: self.stage_mm,
        });
        let way = [(from_s, from_mm), (until_s, self.stage_mm)];
        let edge_s = self.index.edge_s(&self.settings, way);
        if let Some(edge_s) = edge_s
            && !self.has(|fault| matches!(fault, MechanicalFault::IndexMissing))
        {
            // A timer latches the count, without the jitter of a reading.
            self.latched = Some(self.count_at(edge_s));
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "some thousands of counts")]
    fn raw_count(&self, time_s: f64) -> i64 {
        let settings = &self.settings;
        let age_s = settings.encoder_latency_s + settings.encoder_latency_error_s;
        let read = self.history.at(time_s - age_s);
        let offset_mm = read.map_or(0.0, |instant| match settings.encoder_side {
            EncoderSide::Screw => instant.screw_mm,
            EncoderSide::Stage => instant.stage_mm,
        });
        let step_um = settings.encoder_step_um * (1.0 + 1e-6 * settings.encoder_scale_ppm);
        ((1e3 * offset_mm - self.phase_um + self.noise_um) / step_um).round() as i64
    }
}
