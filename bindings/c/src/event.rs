//! Events of a camera in flight, and its actions, with their fields in fixed places.

use fmc::flight::drive::StageReading;
use fmc::flight::event::{Action, AttitudeSample, Command, Event, ShutterEdge, Supply};
use fmc::flight::time::Time;
use fmc::flight::vh::VhSample;

use crate::code::{self, fmc_code, unknown};
use crate::refusal::Refusal;

/// Obey triggers.
pub const FMC_EVENT_ARM: fmc_code = 0;
/// Refuse triggers, and release the stage.
pub const FMC_EVENT_DISARM: fmc_code = 1;
/// Acknowledge a fault: the camera goes to standby.
pub const FMC_EVENT_CLEAR_FAULT: fmc_code = 2;
/// The encoder's count has been referred to the calibrated position again.
pub const FMC_EVENT_REFERENCED: fmc_code = 3;
/// Exposure time of the frames to come: `values[0]`, s.
pub const FMC_EVENT_EXPOSURE: fmc_code = 4;
/// V/H of a sensor: `values[0]`, 1/s.
pub const FMC_EVENT_VH: fmc_code = 5;
/// Ground speed of the satellite receiver: `values[0]`, m/s.
pub const FMC_EVENT_GROUND_SPEED: fmc_code = 6;
/// Height above ground of a radar altimeter: `values[0]`, m.
pub const FMC_EVENT_HEIGHT_ABOVE_GROUND: fmc_code = 7;
/// Altitude: `values[0]`, m.
pub const FMC_EVENT_ALTITUDE: fmc_code = 8;
/// Height of the terrain: `values[0]`, m.
pub const FMC_EVENT_TERRAIN_HEIGHT: fmc_code = 9;
/// Ground speed of an inertial unit: `values[0]`, m/s.
pub const FMC_EVENT_INERTIAL_SPEED: fmc_code = 10;
/// Height of a laser altimeter: `values[0]`, m.
pub const FMC_EVENT_LASER_HEIGHT: fmc_code = 11;
/// Pitch, roll, drift, degrees, and rates about right, forward and up, degrees/s: `values[0..6]`.
pub const FMC_EVENT_ATTITUDE: fmc_code = 12;
/// The satellite receiver's pulse: a second begins.
pub const FMC_EVENT_TIME_PULSE: fmc_code = 13;
/// UTC of the last pulse: number, µs since 1970.
pub const FMC_EVENT_GNSS_TIME: fmc_code = 14;
/// A request for an exposure.
pub const FMC_EVENT_TRIGGER: fmc_code = 15;
/// First light.
pub const FMC_EVENT_SHUTTER_OPENED: fmc_code = 16;
/// Last light.
pub const FMC_EVENT_SHUTTER_CLOSED: fmc_code = 17;
/// Offset of the stage along the FMC axis: `values[0]`, mm, read at the time in number, µs.
pub const FMC_EVENT_STAGE: fmc_code = 18;
/// A limit switch has closed.
pub const FMC_EVENT_LIMIT_SWITCH: fmc_code = 19;
/// The drive cannot carry out its command: number is the code of its fault.
pub const FMC_EVENT_DRIVE: fmc_code = 20;
/// The supply voltage is too low to move the stage.
pub const FMC_EVENT_SUPPLY_LOW: fmc_code = 21;
/// The supply voltage is good.
pub const FMC_EVENT_SUPPLY_GOOD: fmc_code = 22;
/// A round of the control loop.
pub const FMC_EVENT_TICK: fmc_code = 23;
/// Events that could not be kept until the round: number of them.
pub const FMC_EVENT_LOST: fmc_code = 24;
/// The index mark was crossed at the reading `values[0]`, mm along the FMC axis.
pub const FMC_EVENT_INDEX_MARK: fmc_code = 25;
/// Offset of the stage that hardware latched between two readings, at an edge of the shutter's sensor
/// (after the edge's event) or in an exposure: `values[0]`, mm along the FMC axis, at the time in
/// number, µs.
pub const FMC_EVENT_LATCHED: fmc_code = 26;
/// Focus shift of the frames to come beyond the run-out of the stage: `values[0]`, µm, positive away
/// from the lens. That of the calibration's focus table is added to it.
pub const FMC_EVENT_FOCUS_SHIFT: fmc_code = 27;
/// Temperature of the lens for the calibration's focus table: `values[0]`, °C, -100 to 100. What is
/// no such number is not taken, and the last temperature stays.
pub const FMC_EVENT_TEMPERATURE: fmc_code = 28;

/// Numbers of an event.
pub const FMC_EVENT_VALUES: usize = 6;

/// An event. What `number` and `values` hold stands at the code of its kind; the others are not
/// read.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fmc_event {
    /// Time of the event, µs since the camera started.
    pub time_us: u64,
    /// Number of the kind.
    pub number: u64,
    /// `FMC_EVENT_...`
    pub kind: fmc_code,
    /// Values of the kind.
    pub values: [f32; FMC_EVENT_VALUES],
}

/// The stage is to follow the set point `values[0]` mm, `values[1]` mm/s, `values[2]` mm/s², now.
pub const FMC_ACTION_MOVE_STAGE: fmc_code = 0;
/// The stage is to be without force.
pub const FMC_ACTION_RELEASE_STAGE: fmc_code = 1;
/// The shutter's command is to leave at `time_us`, for an exposure of `values[0]` s.
pub const FMC_ACTION_OPEN_SHUTTER: fmc_code = 2;
/// The rows of a TDI sensor are to be clocked, from first light of the command at `time_us` on, with
/// `values[0]` mm/s.
pub const FMC_ACTION_CLOCK_ROWS: fmc_code = 3;
/// The shutter is to close at once, or stay closed.
pub const FMC_ACTION_CLOSE_SHUTTER: fmc_code = 4;
/// The record with this number is available.
pub const FMC_ACTION_FRAME_READY: fmc_code = 5;
/// A fault has occurred: number is its code.
pub const FMC_ACTION_FAULT: fmc_code = 6;
/// Principal points from record number on are in doubt by `values[0]` mm, for count triggers.
pub const FMC_ACTION_IN_DOUBT: fmc_code = 7;

/// Numbers of an action.
pub const FMC_ACTION_VALUES: usize = 3;

/// An action. What the fields hold stands at the code of its kind; the others are 0.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct fmc_action {
    /// Time at which the action is due, µs since the camera started.
    pub time_us: u64,
    /// `FMC_ACTION_...`
    pub kind: fmc_code,
    /// Number of the kind.
    pub number: u32,
    /// Triggers of `FMC_ACTION_IN_DOUBT`.
    pub count: u32,
    /// Values of the kind.
    pub values: [f32; FMC_ACTION_VALUES],
}

impl fmc_event {
    /// Returns time and event.
    pub(crate) fn event(&self) -> Result<(Time, Event), Refusal> {
        let [value, ..] = self.values;
        let few = |number: u64| i32::try_from(number).unwrap_or(i32::MAX);
        let event = match self.kind {
            FMC_EVENT_ARM => Event::Command(Command::Arm),
            FMC_EVENT_DISARM => Event::Command(Command::Disarm),
            FMC_EVENT_CLEAR_FAULT => Event::Command(Command::ClearFault),
            FMC_EVENT_REFERENCED => Event::Command(Command::Referenced),
            FMC_EVENT_EXPOSURE => Event::Command(Command::Exposure(value)),
            FMC_EVENT_VH => Event::Vh(VhSample::Direct(value)),
            FMC_EVENT_GROUND_SPEED => Event::Vh(VhSample::GroundSpeed(value)),
            FMC_EVENT_HEIGHT_ABOVE_GROUND => Event::Vh(VhSample::HeightAboveGround(value)),
            FMC_EVENT_ALTITUDE => Event::Vh(VhSample::Altitude(value)),
            FMC_EVENT_TERRAIN_HEIGHT => Event::Vh(VhSample::TerrainHeight(value)),
            FMC_EVENT_INERTIAL_SPEED => Event::Vh(VhSample::InertialSpeed(value)),
            FMC_EVENT_LASER_HEIGHT => Event::Vh(VhSample::LaserHeight(value)),
            FMC_EVENT_ATTITUDE => {
                let [pitch_deg, roll_deg, drift_deg, rates_deg_s @ ..] = self.values;
                Event::Attitude(AttitudeSample {
                    pitch_deg,
                    roll_deg,
                    drift_deg,
                    rates_deg_s,
                })
            }
            FMC_EVENT_TIME_PULSE => Event::TimePulse,
            FMC_EVENT_GNSS_TIME => Event::GnssTime(self.number),
            FMC_EVENT_TRIGGER => Event::Trigger,
            FMC_EVENT_SHUTTER_OPENED => Event::Shutter(ShutterEdge::Opened),
            FMC_EVENT_SHUTTER_CLOSED => Event::Shutter(ShutterEdge::Closed),
            FMC_EVENT_STAGE => Event::Stage(StageReading {
                time: Time::from_us(self.number),
                offset_mm: value,
            }),
            FMC_EVENT_LIMIT_SWITCH => Event::LimitSwitch,
            FMC_EVENT_DRIVE => Event::Drive(code::fault(few(self.number))?),
            FMC_EVENT_SUPPLY_LOW => Event::Supply(Supply::Low),
            FMC_EVENT_SUPPLY_GOOD => Event::Supply(Supply::Good),
            FMC_EVENT_TICK => Event::Tick,
            FMC_EVENT_LOST => Event::Lost(u32::try_from(self.number).unwrap_or(u32::MAX)),
            FMC_EVENT_INDEX_MARK => Event::IndexMark(value),
            FMC_EVENT_LATCHED => Event::Latched(StageReading {
                time: Time::from_us(self.number),
                offset_mm: value,
            }),
            FMC_EVENT_FOCUS_SHIFT => Event::Command(Command::FocusShift(value)),
            FMC_EVENT_TEMPERATURE => Event::Command(Command::Temperature(value)),
            kind => return Err(unknown(kind)),
        };
        Ok((Time::from_us(self.time_us), event))
    }
}

impl From<&Action> for fmc_action {
    fn from(action: &Action) -> Self {
        let blank = |kind| Self {
            kind,
            ..Self::default()
        };
        match *action {
            Action::MoveStage(setpoint) => Self {
                values: [
                    setpoint.offset_mm,
                    setpoint.speed_mm_s,
                    setpoint.acceleration_mm_s2,
                ],
                ..blank(FMC_ACTION_MOVE_STAGE)
            },
            Action::ReleaseStage => blank(FMC_ACTION_RELEASE_STAGE),
            Action::OpenShutter { at, exposure_s } => Self {
                time_us: at.us(),
                values: [exposure_s, 0.0, 0.0],
                ..blank(FMC_ACTION_OPEN_SHUTTER)
            },
            Action::ClockRows { at, speed_mm_s } => Self {
                time_us: at.us(),
                values: [speed_mm_s, 0.0, 0.0],
                ..blank(FMC_ACTION_CLOCK_ROWS)
            },
            Action::CloseShutter => blank(FMC_ACTION_CLOSE_SHUTTER),
            Action::FrameReady(number) => Self {
                number,
                ..blank(FMC_ACTION_FRAME_READY)
            },
            Action::Fault(fault) => Self {
                number: u32::from(fault.code()),
                ..blank(FMC_ACTION_FAULT)
            },
            Action::InDoubt(exposures) => Self {
                number: exposures.from_sequence,
                count: u32::from(exposures.triggers),
                values: [exposures.off_mm, 0.0, 0.0],
                ..blank(FMC_ACTION_IN_DOUBT)
            },
        }
    }
}
