//! Arguments of a camera on a board, controlled from the PC.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use fmc_camera::flight::bring_up::MAX_JOG_UM;

use super::number::{between, exposure_time};
use super::{DeviceArgs, DirectionName, VhArgument, examples};

/// Arguments of `camera`.
#[derive(Debug, Args)]
pub struct CameraArgs {
    /// Device that is the camera.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Action asked of it.
    #[command(subcommand)]
    pub action: CameraAction,
}

/// Actions that a camera on a board can be asked for.
#[derive(Debug, Subcommand)]
pub enum CameraAction {
    /// Send calibration and settings; the camera is in standby afterwards.
    ///
    /// The camera refuses while it keeps records of an earlier flight, so that none is lost: fetch
    /// them first with `host-sim records`.
    #[command(after_help = examples::CAMERA_PREPARE)]
    Prepare(PrepareArgs),
    /// Obey triggers: the stage makes its strokes to and fro, then the camera is ready. Waits until
    /// it is.
    #[command(after_help = examples::CAMERA_ARM)]
    Arm,
    /// Refuse triggers and leave the stage alone. An exposure under way is finished.
    #[command(after_help = examples::CAMERA_DISARM)]
    Disarm,
    /// Return to standby after a fault has been looked at.
    #[command(after_help = examples::CAMERA_CLEAR_FAULT)]
    ClearFault,
    /// Tell the camera that the stage stands at its calibrated position, from which the encoder
    /// then counts. In standby alone.
    #[command(after_help = examples::CAMERA_REFERENCED)]
    Referenced,
    /// Set the exposure time of the following frames.
    #[command(after_help = examples::CAMERA_EXPOSURE)]
    Exposure(ExposureTimeArgs),
    /// Set the focus shift of the following frames, as temperature or pressure make it: it is added
    /// to the run-out of the stage, corrected, and in `focus_shift_mm` of the records. The next
    /// `prepare` begins with 0.
    #[command(after_help = examples::CAMERA_FOCUS_SHIFT)]
    FocusShift(FocusShiftArgs),
    /// Tell the camera the temperature of its lens, °C, for the focus table of its calibration: the
    /// focus shift of the following frames is that of the table, added to that of `focus-shift`.
    ///
    /// The camera takes it for the present one for 600 s; then its records have the flag
    /// `temperature unknown`, and the last one holds.
    #[command(after_help = examples::CAMERA_TEMPERATURE)]
    Temperature(TemperatureArgs),
    /// Put another calibration into use between two frames. The flight that the camera is prepared
    /// for goes on: UTC, V/H, counts and records stay, and each record names the calibration that
    /// it was made with.
    ///
    /// In standby, or in a fault. A calibration whose mechanism or limits do not fit the settings
    /// of the flight is refused, and the one before stays.
    #[command(after_help = examples::CAMERA_RECALIBRATE)]
    Recalibrate(RecalibrateArgs),
    /// Tell the camera V/H, ground speed over height above ground.
    ///
    /// The camera uses the value for 5 s; with --for it is repeated until that time is over.
    #[command(after_help = examples::CAMERA_VH)]
    Vh(VhArgs),
    /// Store a calibration in the camera's flash; the camera starts with it from then on.
    ///
    /// In standby alone, with the supply good. A flight that the camera is prepared for goes on.
    /// The calibration before stays in its slot until the new one has been written and read back.
    /// A camera stores what the owner of its key has signed with `host-sim sign`, for its own
    /// serial number, and of a higher version than all before or with a permission.
    #[command(after_help = examples::CAMERA_STORE)]
    Store(StoreArgs),
    /// Show which calibration the camera has stored, or what is wrong with either slot.
    #[command(after_help = examples::CAMERA_STORED)]
    Stored(StatusArgs),
    /// Show what the camera is doing.
    #[command(after_help = examples::CAMERA_STATUS)]
    Status(StatusArgs),
    /// Show the lines of a board: levels, counts of their edges since the start, position of the
    /// stage, drift of the clock by the time pulses, last trial. No camera need be loaded.
    #[command(after_help = examples::CAMERA_INPUTS)]
    Inputs(StatusArgs),
    /// Move the stage by some micrometres along the FMC axis, with the default gains, and release
    /// it.
    ///
    /// A trial of a board whose camera is not prepared, as are `duty` and `shutter`. It takes 0.3 s
    /// at most, with a duty of 0.2 at most, and ends where the stage does not follow, its encoder
    /// is silent, a limit switch closes or the supply falls. A way of less than 20 µm may end so by
    /// friction alone.
    ///
    /// The drive has its default settings, whatever was prepared before: a step of the encoder of
    /// 0.1 µm, nothing reversed. Switches and brake have the settings of the last flight that was
    /// prepared since the board was switched on. Before the first the brake is not used, and
    /// switches that close to ground count as closed, so that `jog` and `duty` are refused.
    #[command(after_help = examples::CAMERA_JOG)]
    Jog(JogArgs),
    /// Drive the motor with a small duty for a short time, and release it.
    ///
    /// It ends earlier where the encoder is silent, and then fails. `jog --help` has the settings.
    #[command(after_help = examples::CAMERA_DUTY)]
    Duty(DutyArgs),
    /// Open the shutter once, and count the edges of its sensor.
    #[command(after_help = examples::CAMERA_SHUTTER)]
    Shutter(ShutterArgs),
}

/// Arguments of `camera jog`.
#[derive(Debug, Args)]
pub struct JogArgs {
    /// Way along the FMC axis, µm, -200 to 200.
    #[arg(value_name = "UM", value_parser = between(-f64::from(MAX_JOG_UM), f64::from(MAX_JOG_UM)), allow_hyphen_values = true)]
    pub way_um: f64,
}

/// Arguments of `camera duty`.
#[derive(Debug, Args)]
pub struct DutyArgs {
    /// Pulse width of the motor, -0.2 to 0.2; positive is along the FMC axis.
    #[arg(value_name = "DUTY", value_parser = between(-MOST_DUTY, MOST_DUTY), allow_hyphen_values = true)]
    pub duty: f64,
    /// Time, s, up to 0.2; it ends earlier where the stage has moved by 0.5 mm.
    #[arg(long = "for", value_name = "S", value_parser = between(0.0, MOST_DUTY_S), default_value = "0.05", allow_negative_numbers = true)]
    pub for_s: f64,
}

/// Arguments of `camera shutter`.
#[derive(Debug, Args)]
pub struct ShutterArgs {
    /// Time from the command to open to the command to close: seconds or a fraction such as 1/200,
    /// 1/10000 to 1/10.
    #[arg(value_name = "S", value_parser = exposure_time, allow_hyphen_values = true)]
    pub exposure: f64,
}

/// Largest focus shift of any camera, µm: `Quantity::FocusShiftUm`.
const MOST_FOCUS_SHIFT_UM: f64 = 100_000.0;
/// Largest temperature of a lens, °C: `Quantity::TemperatureC`.
const MOST_TEMPERATURE_C: f64 = 100.0;
/// [`MAX_DUTY`](fmc_camera::flight::bring_up::MAX_DUTY), in decimals.
const MOST_DUTY: f64 = 0.2;
/// [`MAX_DUTY_S`](fmc_camera::flight::bring_up::MAX_DUTY_S), in decimals.
const MOST_DUTY_S: f64 = 0.2;

/// Arguments of `camera prepare`.
#[derive(Debug, Args)]
pub struct PrepareArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Settings of the flight (TOML): those of docs/integration.md, section 3, by their names
    /// there; the others keep their defaults.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    /// Direction of flight; without it the one of the settings, or forward.
    #[arg(long, value_name = "DIRECTION")]
    pub direction: Option<DirectionName>,
}

/// Arguments of `camera focus-shift`.
#[derive(Debug, Args)]
pub struct FocusShiftArgs {
    /// Distance of the detector from its calibrated plane, µm, positive away from the lens; with
    /// the run-out of the stage up to a hundredth of principal distance and exit pupil. Beyond, the
    /// camera refuses triggers.
    #[arg(value_name = "UM", value_parser = between(-MOST_FOCUS_SHIFT_UM, MOST_FOCUS_SHIFT_UM), allow_hyphen_values = true)]
    pub shift_um: f64,
}

/// Arguments of `camera temperature`.
#[derive(Debug, Args)]
pub struct TemperatureArgs {
    /// Temperature of the lens, °C.
    #[arg(value_name = "C", value_parser = between(-MOST_TEMPERATURE_C, MOST_TEMPERATURE_C), allow_hyphen_values = true)]
    pub celsius: f64,
}

/// Arguments of `camera recalibrate`.
#[derive(Debug, Args)]
pub struct RecalibrateArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// Settings of the flight (TOML), as for `camera prepare`: of a camera file without limits of
    /// V/H they tell what its mechanism can fly.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
}

/// Arguments of `camera exposure`.
#[derive(Debug, Args)]
pub struct ExposureTimeArgs {
    /// First light to last: seconds or a fraction such as 1/200, within the limits of the camera
    /// file.
    #[arg(value_name = "S", value_parser = exposure_time, allow_hyphen_values = true)]
    pub exposure: f64,
}

/// Arguments of `camera vh`.
#[derive(Debug, Args)]
pub struct VhArgs {
    /// V/H, or ground speed and height.
    #[command(flatten)]
    pub vh: VhArgument,
    /// Time for which V/H is told, s; without it once.
    #[arg(long = "for", value_name = "S", value_parser = between(0.0, 86_400.0), default_value = "0", allow_negative_numbers = true)]
    pub for_s: f64,
}

/// Arguments of `camera store`.
#[derive(Debug, Args)]
pub struct StoreArgs {
    /// Camera file (TOML) that is sent first; without it the calibration in use is stored.
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// Signature of the calibration, which `host-sim sign` writes.
    #[arg(long, value_name = "FILE")]
    pub signature: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `camera status`, `camera stored` and `camera inputs`.
#[derive(Debug, Args)]
pub struct StatusArgs {
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}
