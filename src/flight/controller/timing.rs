//! Times by which the camera judges.

/// Ways that the stage goes to and fro when the camera is armed: two strokes, by which a velocity loop learns the
/// stage's friction and mass ([`LoopSettings::LEARNED`](crate::flight::drive::loop_settings::LoopSettings::LEARNED)).
pub const EXERCISE_WAYS: u8 = 4;

/// Their ends, as a part of the stroke from the calibrated position.
pub const EXERCISE_REACH: f32 = 0.25;

/// Until then the stage may be off its set point by so many times more.
pub const UNLEARNED_TOLERANCE: f32 = 1.5;

/// Period of the control loop, s.
pub const TICK_S: f32 = 1e-3;

/// How much older than the one before an event may be, s: what an interrupt has stamped waits for the control loop.
pub const LATE_EVENT_S: f32 = 0.01;

/// From one round of the control loop to the next, s: what is longer is late.
pub const LATE_TICK_S: f32 = 1.5 * TICK_S;

/// From one event to the next, s: what is longer is a jump of the clock.
pub const CLOCK_JUMP_S: f32 = 1.0;

/// So many late rounds within [`OVERLOAD_WINDOW_S`] are an overload.
pub const OVERLOAD_ROUNDS: u8 = 3;

/// How long rounds must be punctual for an overload to be over, s.
pub const OVERLOAD_WINDOW_S: f32 = 1.0;

/// After so long without first light, s, beyond the shutter's tolerance, it is missing.
pub const SHUTTER_MISSING_S: f32 = 0.005;

/// A shutter that has been told to close and does not is given up after so long, s.
pub const SHUTTER_GIVEN_UP_S: f32 = 0.05;

/// How long a stage without force must have stood before it is believed to stand, s.
pub const STANDING_S: f32 = 0.05;

/// How long the last light waits for a reading of the stage, s.
pub const READING_WITHIN_S: f32 = 0.003;

/// σ of the times at which stage and shutter are read, s: half of the clock's step, with what an interrupt may wait.
pub const STAMP_SIGMA_S: f32 = 1e-6;

/// How old an attitude may be to be taken for a frame's, s.
pub const ATTITUDE_WITHIN_S: f32 = 0.25;

/// How long before it must leave the shutter's command is given at most, s: the stage's speed is looked at in the last
/// round before it.
pub const LEAD_S: f32 = TICK_S;

/// After so long without a reading of a stage that has force on it, s, its encoder has failed.
pub const READINGS_CEASE_S: f32 = 0.005;

/// A gap between two readings in an exposure that is longer, s, and a larger part of it than [`READING_GAP_PART`], is
/// flagged.
pub const READING_GAP_S: f32 = 0.0025;

/// See [`READING_GAP_S`].
pub const READING_GAP_PART: f32 = 1.0 / 16.0;

/// A gap so many times longer than one that is flagged leaves no measured motion.
pub const LONGEST_GAP: f32 = 4.0;
