//! Times and counts by which the camera judges.

/// Number of ways that the stage goes to and fro when the camera is armed: two strokes, by which a
/// velocity loop learns the stage's friction and mass
/// ([`LoopSettings::LEARNED`](crate::flight::drive::loop_settings::LoopSettings::LEARNED)).
pub const EXERCISE_WAYS: u8 = 4;

/// Ends of those ways, as a part of the stroke from the calibrated position.
pub const EXERCISE_REACH: f32 = 0.25;

/// Factor by which the following tolerance is wider until the velocity loop has learned.
pub const UNLEARNED_TOLERANCE: f32 = 1.5;

/// Period of the control loop, s.
pub const TICK_S: f32 = 1e-3;

/// Largest age of an event relative to the one before, s: an event that an interrupt has stamped
/// waits for the control loop.
pub const LATE_EVENT_S: f32 = 0.01;

/// Time between two rounds of the control loop beyond which the later one is late, s.
pub const LATE_TICK_S: f32 = 1.5 * TICK_S;

/// Time between two events beyond which the clock has jumped, s.
pub const CLOCK_JUMP_S: f32 = 1.0;

/// Longest pause of the rounds in standby, s, after which the clock has not jumped, if the board
/// says that it has made one: the erasure of a sector of its store takes up to 4 s.
pub const PAUSE_S: f32 = 10.0;

/// Number of late rounds within [`OVERLOAD_WINDOW_S`] that is an overload.
pub const OVERLOAD_ROUNDS: u8 = 3;

/// Time for which rounds must be punctual to end an overload, s.
pub const OVERLOAD_WINDOW_S: f32 = 1.0;

/// Time without first light, beyond the shutter's tolerance, after which first light is missing, s.
pub const SHUTTER_MISSING_S: f32 = 0.005;

/// Time after which a shutter that does not close when told to is given up, s.
pub const SHUTTER_GIVEN_UP_S: f32 = 0.05;

/// Time for which a released stage must have stood still to count as standing, s.
pub const STANDING_S: f32 = 0.05;

/// Rounds of the stage at rest, under force, from which on a step of its reading is bounded by the
/// play that an undriven screw may pass in as many.
pub const SETTLED_ROUNDS: u8 = 4;

/// Rounds of the stage at rest, under force, after which its place is remembered: σ holds how far
/// its reading goes from there.
pub const REMEMBERED_ROUNDS: u8 = 20;

/// Time for which the last light waits for a reading of the stage, s.
pub const READING_WITHIN_S: f32 = 0.003;

/// σ of the times at which stage and shutter are read, s: half of the clock's step, with the time
/// an interrupt may wait.
pub const STAMP_SIGMA_S: f32 = 1e-6;

/// Largest age of an attitude that is used for a frame, s.
pub const ATTITUDE_WITHIN_S: f32 = 0.25;

/// Longest time by which the shutter's command is given before it must leave, s: the stage's speed
/// is checked in the last round before it.
pub const LEAD_S: f32 = TICK_S;

/// Time without a reading of a stage under force after which its encoder has failed, s.
pub const READINGS_CEASE_S: f32 = 0.005;

/// Longest gap between two readings in an exposure, s, that is not flagged; a longer one is flagged
/// if it is also a larger part of the exposure than [`READING_GAP_PART`].
pub const READING_GAP_S: f32 = 0.0025;

/// Largest part of the exposure of a gap that is not flagged; see [`READING_GAP_S`].
pub const READING_GAP_PART: f32 = 1.0 / 16.0;

/// Length of a gap, as a multiple of the longest that is not flagged, beyond which no motion is
/// measured.
pub const LONGEST_GAP: f32 = 4.0;
