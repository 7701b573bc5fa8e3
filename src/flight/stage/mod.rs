//! The stage's travel for one exposure: run-up, settling, tracking, stop, fly-back, with limited
//! acceleration and jerk. This module is the only planner of that motion.

mod error;
mod fly_back;
mod plan;
mod profile;
mod ramp;
mod setpoint;
mod travel;

pub use error::{PlanError, StrokeTooShort};
pub use plan::{MechanismLimits, RunUp, Stage, StagePlan, Tracking};
pub use profile::{MAX_SEGMENTS, POSITION_NM, Profile, Segment};
pub use setpoint::Setpoint;
pub use travel::{RUN_UP_RESERVE, Travel};
