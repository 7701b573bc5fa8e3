//! The record of a trigger: the exposure and its interior orientation, or the reason for its
//! refusal.

use core::fmt;

use super::calibration_id::CalibrationId;
#[cfg(doc)]
use super::camera::Camera;
use super::camera::FrameError;
use super::fault::{Fault, Faults};
pub use super::flag::{Flag, Flags};
use super::in_doubt::InDoubt;
use super::interior_orientation::InteriorOrientation;
use super::principal_point_sigma::PrincipalPointSigma;
use super::time::Time;
use super::utc::UtcTime;
use super::vh::VhEstimate;

/// The record of one trigger.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrameRecord {
    /// Number of the trigger since the camera was prepared, from 1, without gaps.
    pub sequence: u32,
    /// Time of the trigger, camera time; of triggers refused as [`Reason::RecordsFull`], all but
    /// the last have that of the first.
    pub trigger: Time,
    /// Outcome of the trigger.
    pub outcome: Outcome,
    /// Faults from the end of the last frame to the end of this one; none if the trigger was
    /// refused at once, since they go into the next record of a frame that was begun.
    pub faults: Faults,
    /// Properties of the frame that its user should know.
    pub flags: Flags,
    /// The calibration in use; `None` if it has no identity ([`Camera::identified`]).
    pub calibration: Option<CalibrationId>,
    /// Number of the camera's start in which the trigger came, from 1: a reset begins another, and
    /// camera time with it. It is counted in memory and in the records in flash, anew where both
    /// are lost. Of triggers refused as [`Reason::RecordsFull`], that of the last.
    pub boot: u32,
    /// Number of the flight, from 1, counted in the same way: each preparation begins another.
    pub flight: u32,
}

/// Outcome of a trigger.
#[allow(clippy::large_enum_variant, reason = "no heap")]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Outcome {
    /// The shutter opened.
    Exposed(ExposedFrame),
    /// There is no exposure that can be used.
    Refused(Reason),
}

/// An exposure as it was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExposedFrame {
    /// First light, camera time.
    pub opened: Time,
    /// Last light, camera time; if the closing edge was not seen, its planned time.
    pub closed: Time,
    /// Centroid of the exposure, which goes with the centroid principal point; camera time.
    pub centroid: Time,
    /// The centroid in UTC, if the receiver's time pulse has set the clock.
    pub centroid_utc: Option<UtcTime>,
    /// V/H used, with its σ, age and source; `None` if the frame was not compensated for want of
    /// it.
    pub vh: Option<VhEstimate>,
    /// Δδ of the plan, mm along the FMC axis.
    pub planned_opening_mm: f32,
    /// δ of the plan, mm.
    pub planned_travel_mm: f32,
    /// Interior orientation from the measured motion.
    pub interior: InteriorOrientation,
    /// σ of the centroid principal point along the FMC axis.
    pub principal_point_sigma: PrincipalPointSigma,
    /// Predicted residual smear, the largest on the sensor, µm: with
    /// [`COVERAGE`](super::smear_prediction::COVERAGE) σ of all its causes.
    pub smear_um: f32,
    /// The same in pixels.
    pub smear_px: f32,
}

impl FrameRecord {
    /// Marks the record if its exposure is in doubt: flag, a fault if it is one, and a σ that
    /// covers the difference. The camera does it with the records that it still has; for others see
    /// [`InDoubt`].
    pub fn doubt(&mut self, exposures: &InDoubt) {
        if exposures.contains(self.sequence) {
            self.outcome
                .doubt(exposures, &mut self.flags, &mut self.faults);
        }
    }
}

impl Outcome {
    /// Marks an exposure that is in doubt, with its flags and faults.
    pub(crate) fn doubt(&mut self, exposures: &InDoubt, flags: &mut Flags, faults: &mut Faults) {
        if let Self::Exposed(frame) = self {
            frame.principal_point_sigma = frame.principal_point_sigma.in_doubt_by(exposures.off_mm);
            flags.insert(Flag::Unreferenced);
            if exposures.is_fault {
                faults.insert(Fault::Encoder);
            }
        }
    }
}

/// The reason why a trigger was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Reason {
    /// The camera was not armed.
    NotArmed,
    /// The previous frame was not finished.
    Overlap,
    /// V/H or exposure is outside the camera's limits.
    OutsideLimits,
    /// The travel does not fit the stroke, even off centre.
    Stroke,
    /// The speed is beyond the mechanism's.
    Speed,
    /// The stage did not reach its speed in time.
    NotAtSpeed,
    /// The shutter did not open.
    ShutterMissing,
    /// A fault ended it before the shutter opened.
    Fault(Fault),
    /// It was disarmed before the shutter opened.
    Disarmed,
    /// Too many records had not been acknowledged.
    RecordsFull,
    /// The shutter opened, but no interior orientation can be given.
    Unusable,
}

impl Reason {
    /// The name in documents and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotArmed => "not armed",
            Self::Overlap => "overlap",
            Self::OutsideLimits => "outside limits",
            Self::Stroke => "stroke",
            Self::Speed => "speed",
            Self::NotAtSpeed => "not at speed",
            Self::ShutterMissing => "shutter missing",
            Self::Fault(fault) => fault.name(),
            Self::Disarmed => "disarmed",
            Self::RecordsFull => "records full",
            Self::Unusable => "unusable",
        }
    }
}

impl From<FrameError> for Reason {
    /// Returns the reason for the refusal of a frame that cannot be planned.
    fn from(error: FrameError) -> Self {
        match error {
            FrameError::Stroke(_) => Self::Stroke,
            FrameError::Speed { .. } => Self::Speed,
            FrameError::OutOfRange(_) | FrameError::NotFitted | FrameError::Time { .. } => {
                Self::OutsideLimits
            }
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
