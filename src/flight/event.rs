//! What happens to a camera in flight, and what it does.

use super::drive::StageReading;
use super::fault::Fault;
use super::stage::Setpoint;
use super::time::Time;
use super::vh::VhSample;

/// Something that happens, at a time that comes with it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Event {
    /// Somebody wants something.
    Command(Command),
    /// A sensor of the aircraft says something about V/H.
    Vh(VhSample),
    /// Attitude and its rates.
    Attitude(AttitudeSample),
    /// The satellite receiver's pulse: a second begins.
    TimePulse,
    /// The UTC that the receiver gives for its last pulse, µs since 1970.
    GnssTime(u64),
    /// An exposure is wanted.
    Trigger,
    /// The shutter's sensor.
    Shutter(ShutterEdge),
    /// The stage is somewhere.
    Stage(StageReading),
    /// A limit switch has closed.
    LimitSwitch,
    /// The drive cannot do what it was told to, or the stage's position cannot be read.
    Drive(Fault),
    /// The supply voltage has fallen too low, or is good again.
    Supply(Supply),
    /// The control loop comes round.
    Tick,
    /// So many events could not be kept until the control loop came round.
    Lost(u32),
}

impl Event {
    /// Whether somebody may say so in a message: commands, and what other instruments measure. Everything else comes
    /// from the camera's own inputs, with the time at which they changed.
    #[must_use]
    pub const fn is_told(&self) -> bool {
        matches!(
            self,
            Self::Command(_) | Self::Vh(_) | Self::Attitude(_) | Self::GnssTime(_)
        )
    }
}

/// What somebody wants.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Triggers are to be obeyed.
    Arm,
    /// Triggers are to be refused, and the stage left alone.
    Disarm,
    /// A fault has been looked at: the camera goes to standby.
    ClearFault,
    /// The encoder's count has been referred to the calibrated position again, as after [`Fault::Encoder`] it must be.
    /// In standby alone; elsewhere it is ignored.
    Referenced,
    /// Exposure time of the frames to come, s.
    Exposure(f32),
}

/// An edge of the shutter's sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShutterEdge {
    /// First light.
    Opened,
    /// Last light.
    Closed,
}

/// The supply voltage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Supply {
    /// Too low to move the stage.
    Low,
    /// Good.
    Good,
}

/// Attitude of the camera, as the aircraft's inertial unit has it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AttitudeSample {
    /// Pitch, roll, drift, °; signs of [`crate::geometry::image_motion::Attitude`].
    pub pitch_deg: f32,
    /// Roll, °.
    pub roll_deg: f32,
    /// Drift, °.
    pub drift_deg: f32,
    /// Rates about right, forward and up, °/s.
    pub rates_deg_s: [f32; 3],
}

/// What the camera does about it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Action {
    /// The stage is to be there, and move so, now.
    MoveStage(Setpoint),
    /// No force on the stage.
    ReleaseStage,
    /// The shutter is to open at a time, so that first light is one latency later, for an exposure, s.
    OpenShutter {
        /// When the command must leave.
        at: Time,
        /// Exposure time, s.
        exposure_s: f32,
    },
    /// The rows of a TDI sensor are to be clocked from a time on.
    ClockRows {
        /// When the shutter's command leaves.
        at: Time,
        /// Speed of the charge along the FMC axis, mm/s.
        speed_mm_s: f32,
    },
    /// The shutter is to close at once, or stay closed.
    CloseShutter,
    /// A record is there: its sequence number.
    FrameReady(u32),
    /// Something went wrong.
    Fault(Fault),
}
