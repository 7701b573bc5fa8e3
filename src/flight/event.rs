//! Events of a camera in flight, and its actions.

use super::drive::StageReading;
use super::fault::Fault;
use super::in_doubt::InDoubt;
pub use super::shutter_edge::ShutterEdge;
use super::stage::Setpoint;
use super::time::Time;
use super::vh::VhSample;

/// An event, whose time comes with it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Event {
    /// A command to the camera.
    Command(Command),
    /// A sample of V/H from a sensor of the aircraft.
    Vh(VhSample),
    /// Attitude and its rates.
    Attitude(AttitudeSample),
    /// The satellite receiver's pulse: a second begins.
    TimePulse,
    /// The UTC that the receiver gives for its last pulse, µs since 1970.
    GnssTime(u64),
    /// A request for an exposure.
    Trigger,
    /// An edge of the shutter's sensor.
    Shutter(ShutterEdge),
    /// A reading of the stage's position.
    Stage(StageReading),
    /// A limit switch has closed.
    LimitSwitch,
    /// The drive cannot carry out its command, or the stage's position cannot be read.
    Drive(Fault),
    /// The supply voltage has fallen too low, or is good again.
    Supply(Supply),
    /// A round of the control loop.
    Tick,
    /// Number of events that could not be kept until the round.
    Lost(u32),
    /// The index mark was crossed since the last round, at this reading of the encoder, mm along
    /// the FMC axis.
    IndexMark(f32),
    /// A place of the stage that hardware latched between two readings: at an edge of the shutter's
    /// sensor, after the edge itself, or in an exposure.
    Latched(StageReading),
}

impl Event {
    /// Returns `true` for events that may come in a message: commands, and measurements of other
    /// instruments. All others come from the camera's own inputs, with the time at which they
    /// changed.
    #[must_use]
    pub const fn is_told(&self) -> bool {
        matches!(
            self,
            Self::Command(_) | Self::Vh(_) | Self::Attitude(_) | Self::GnssTime(_)
        )
    }
}

/// A command to the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Obey triggers.
    Arm,
    /// Refuse triggers, and release the stage.
    Disarm,
    /// Acknowledge a fault: the camera goes to standby.
    ClearFault,
    /// The encoder's count has been referred to the calibrated position again, as it must be after
    /// [`Fault::Encoder`]. It is obeyed in standby alone; elsewhere it is ignored.
    Referenced,
    /// Exposure time of the frames to come, s.
    Exposure(f32),
    /// Δz of the frames to come beyond the run-out of the stage, µm, positive away from the lens: a
    /// focus that temperature or pressure has shifted. The shift by the focus table of the
    /// calibration is added to it.
    FocusShift(f32),
    /// Temperature of the lens, °C: the focus shift of the frames to come is that of the focus
    /// table at it. It is taken for the present one for
    /// [`TEMPERATURE_VALID_S`](super::lens_temperature::TEMPERATURE_VALID_S). One that is not a
    /// number or out of [`TemperatureC`](crate::geometry::range::Quantity::TemperatureC) is no
    /// temperature, and the last good one stays.
    Temperature(f32),
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

/// Attitude of the camera, as the aircraft's inertial unit reports it.
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

/// An action of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Action {
    /// The stage is to follow this set point, now.
    MoveStage(Setpoint),
    /// The stage is to be without force.
    ReleaseStage,
    /// The shutter is to open at a time, so that first light is one latency later, for an exposure.
    OpenShutter {
        /// Time at which the command must leave.
        at: Time,
        /// Exposure time, s.
        exposure_s: f32,
    },
    /// The rows of a TDI sensor are to be clocked in the next exposure. Their clock starts with
    /// first light, from which the first transfer is counted
    /// ([`Mechanism::Tdi`](super::camera::Mechanism::Tdi)).
    ClockRows {
        /// Time at which the shutter's command leaves; planned first light is one latency later.
        at: Time,
        /// Speed of the charge along the FMC axis, mm/s.
        speed_mm_s: f32,
    },
    /// The shutter is to close at once, or stay closed.
    CloseShutter,
    /// A record is available, with this sequence number.
    FrameReady(u32),
    /// A fault has occurred.
    Fault(Fault),
    /// The encoder may have been wrong since a crossing of the index mark, and with it principal
    /// points.
    InDoubt(InDoubt),
}
