//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

mod calibration;
mod camera;
mod mesh;
mod mission;
mod number;
mod simulation;

pub use calibration::{CalibrateArgs, CalibrationMethod, FiveArgs, RegressOn, StaticP2};
pub use camera::{CameraAction, CameraArgs, ExposureTimeArgs, PrepareArgs, StatusArgs, VhArgs};
pub use mesh::{ImagePart, MeshArgs, MeshFormatName};
pub use mission::{MissionArgs, RecordsArgs};
pub use simulation::{BudgetArgs, FlightArgs, SmearArgs, StrategyName, SweepArgs};

use fmc_camera_file::number::finite;

use self::number::exposure_time;
use crate::device::DeviceName;
use crate::formats::points::PointFormat;

/// Geometry of an airborne mapping camera with forward motion compensation: strict reference,
/// verification, and the client of the camera.
#[derive(Debug, Parser)]
#[command(version, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 the check that was asked for failed; 2 bad input; \
                          3 device or I/O failure.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Check every coordinate of real cameras against the strict reference solver.
    ///
    /// 10 V/H x 6 exposures x both run-up strategies x 21 x 21 points over the sensor, for each of
    /// five published cameras or for the one given; in QEMU several cameras side by side. Fails (exit 1) when dx or dy is off by more
    /// than 1.5 nm or a coordinate by more than 5 nm, or when the firmware does not compute, bit
    /// for bit, what its code computes on this PC.
    Verify(VerifyArgs),
    /// Remove distortion: measured points -> ideal points.
    Correct(PointsArgs),
    /// Apply distortion: ideal points -> measured points, the inverse of `correct`.
    Distort(PointsArgs),
    /// As `correct`, but by quadrature in double precision: the strict reference solver.
    Reference(ReferenceArgs),
    /// Interior orientation of one frame, without points.
    Frame(FrameArgs),
    /// Write the mesh with which a warp engine or a graphics processor corrects a frame.
    ///
    /// For warp engines: for vertices of the corrected image, every so many pixels, the places in the recorded image they
    /// come from, as the engine stores them. Where a source lies off the sensor the distortion of its edge counts.
    ///
    /// For graphics processors (gpu) the other way round: for vertices of the recorded image the way to their places in the
    /// corrected one, corrected minus recorded. The recorded image is the texture, and is drawn as triangles between the
    /// moved vertices, with linear interpolation between: the largest error of that is in mesh.json, and grows with the square
    /// of --spacing. Vertices beyond the image, which end the last cells, continue the distortion.
    ///
    /// The corrected image has the pixels of the sensor; its principal point is the frame's. The camera computes the rows,
    /// on whichever device, and the files have the same bytes. mesh.json says what the numbers are.
    ///
    /// For example: host-sim mesh --camera host-sim/cameras/rc30-5324.toml --vh 0.1 --exposure 1/200 --format ti-ldc
    /// --out mesh
    Mesh(MeshArgs),
    /// Determine coefficients from observations.
    Calibrate(CalibrateArgs),
    /// Residual smear of an exposure: what the compensation leaves, term by term.
    ///
    /// Each disturbance alone and all together: the largest smear over the sensor, where it is, and
    /// the mean, in µm and pixels, as the camera predicts it; beside it the largest of a simulated
    /// exposure. All angles are right-handed: pitch nose up, roll right side down, yaw nose to the
    /// left, at the exposure's centroid.
    Smear(SmearArgs),
    /// Simulate a calibration of the five-coefficient model: Yuan et al. 2012, section 4.1.
    ///
    /// What is it worth to correct the motion by five fitted coefficients? The strict solver makes
    /// distortions of 21 x 21 points in 60 exposures (10 V/H from 0.05 to 0.17 1/s, 1/100 to
    /// 1/700 s), seeded noise is added, and the coefficients are found by least
    /// squares: exposure by exposure, and from all together. The report sets the static, the
    /// five-coefficient and the exact model beside each other, with the paper's divisor n - 5 and
    /// with the honest one, and says which part of the gain is the focus shift's and which the
    /// motion's.
    ///
    /// The paper reports 1.2 and 2.3 µm; this repeats it with 1.2 and 2.4 µm:
    /// host-sim sweep --camera host-sim/cameras/paper-0.03-percent.toml --out sweep
    Sweep(SweepArgs),
    /// Is it worth it for this camera? What each source of error costs, on one page.
    ///
    /// Largest effect of every term over the exposures of the paper and over those that the camera's
    /// limits allow: principal point and time of different instants, the distortion that the motion
    /// changes, the principal distance, and what no correction removes: V/H, relief, drift, encoder,
    /// clock and attitude rates. In micrometres and pixels on the sensor and in centimetres on the
    /// ground, the largest first, with a sentence of advice.
    Budget(BudgetArgs),
    /// Simulate a flight over ground control: Yuan et al. 2012, section 4.2, and beyond.
    ///
    /// Which correction puts points where they are on the ground? A strip of frames is recorded with
    /// the true exposure mean of the lens; image points, position and attitude on board and surveyed
    /// control points get seeded errors; every frame is oriented by space resection, the five
    /// coefficients are calibrated from all frames; and the ground errors of no correction, the
    /// static, the printed, the five-coefficient and the exact model are compared at the control
    /// points and at check points that took no part, over many flights, with confidence intervals.
    ///
    /// To repeat the paper's 0.29 m and 0.18 m:
    /// host-sim flight --scenario host-sim/scenarios/yuan-2012.toml --out flight
    Flight(FlightArgs),
    /// Fly a mission in simulated time with the camera in the loop.
    ///
    /// Aircraft, V/H sensors, shutter and the mechanics of the stage are simulated; the camera's own code plans every
    /// exposure, moves the stage, releases the shutter and records the interior orientation, a thousand rounds of its
    /// control loop per simulated second. Every record is held against the physical exposure: where the principal point
    /// really was, how far the image really moved. Fails (exit 1) when a trigger has no record, a limit of the scenario
    /// is exceeded, or a fault does not lead to what the scenario expects of it.
    ///
    /// The nominal mission of 1000 exposures: host-sim mission --out mission
    Mission(MissionArgs),
    /// Take what a camera has recorded: records.csv and records.json.
    ///
    /// Every trigger has a record: the exposure's interior orientation and time, or why there was none. The camera
    /// keeps them until they are safe on this PC's disk.
    Records(RecordsArgs),
    /// Prepare, arm and watch a camera on a board: one with a mechanism, a shutter and a trigger line of its own.
    ///
    /// First `prepare --camera FILE`, then, with the stage at its calibrated position, `referenced`, then `arm`. V/H
    /// comes from the aircraft or, on a bench, from `vh`. Whatever it has recorded, `host-sim records` fetches.
    Camera(CameraArgs),
}

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Where the camera runs.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// A camera file; without it the five published cameras.
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// Folder for report.html, summary.json and frames.csv; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// The camera's code in this program stands in for QEMU, for this reason: what the workspace's own command found
    /// out when it set QEMU up.
    #[arg(long, value_name = "REASON", hide = true, conflicts_with_all = ["device", "firmware"])]
    pub not_in_qemu: Option<String>,
}

/// Where the camera runs.
#[derive(Debug, Args)]
pub struct DeviceArgs {
    /// Where the camera's code runs.
    ///
    /// `sil`: in this program (software in the loop). `qemu` or `qemu:an386`: the firmware, on a
    /// Cortex-M4F in the emulator QEMU. `qemu:an500`: on a Cortex-M7. `serial:PATH`: a camera on a
    /// serial port, such as `serial:/dev/ttyACM0`. Without this option `verify` takes `qemu`, or
    /// `sil` where there is no QEMU; the other commands take `sil`.
    #[arg(long, value_name = "DEVICE")]
    pub device: Option<DeviceName>,
    /// The firmware's image for QEMU, an ELF file. Without it the variable `FMC_FIRMWARE`, else what
    /// `cargo xtask firmware` has built; that is done where it has not been yet.
    #[arg(long, value_name = "FILE")]
    pub firmware: Option<PathBuf>,
    /// Show the log of the firmware in QEMU on the error stream.
    #[arg(long)]
    pub log: bool,
}

/// The exposure and its correction.
#[derive(Debug, Args)]
pub struct ExposureArgs {
    /// Camera file (TOML).
    #[arg(long, value_name = "FILE")]
    pub camera: PathBuf,
    /// V/H, ground speed over height above ground, 1/s.
    #[arg(long, value_name = "PER_S", value_parser = finite, allow_negative_numbers = true)]
    pub vh: f64,
    /// Which way the camera flies; V/H is positive either way.
    #[arg(long, value_name = "DIRECTION", default_value = "forward")]
    pub direction: DirectionName,
    /// Exposure time, first light to last: seconds or a fraction such as 1/200.
    #[arg(long, value_name = "S", value_parser = exposure_time, allow_hyphen_values = true)]
    pub exposure: f64,
    /// Offset of the principal point from its calibrated place when the shutter opens, along the
    /// FMC axis, mm; overrides the planned run-up.
    #[arg(long, value_name = "MM", value_parser = finite, allow_negative_numbers = true)]
    pub opening_offset_mm: Option<f64>,
    /// Detector out of its calibrated plane, positive away from the lens, µm; adds to the stage's
    /// run-out.
    #[arg(long, value_name = "UM", default_value = "0", value_parser = finite, allow_negative_numbers = true)]
    pub focus_shift_um: f64,
    /// Which formula turns a focus shift into distortion.
    #[arg(long, value_name = "SIGN", default_value = "physical")]
    pub focus_sign: FocusSignName,
    /// Which model corrects.
    #[arg(long, value_name = "MODEL", default_value = "exact")]
    pub model: ModelName,
}

/// Arguments of `correct` and `distort`.
#[derive(Debug, Args)]
pub struct PointsArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// Where the camera runs.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// The points and where the answer goes.
    #[command(flatten)]
    pub files: PointFiles,
}

/// The points and where the answer goes.
#[derive(Debug, Args)]
pub struct PointFiles {
    /// CSV with a header, columns in any order: `id,x_mm,y_mm` (sensor frame) or `id,col_px,row_px`. Or an array of
    /// NumPy (.npy), N rows of `x_mm`, `y_mm`, answered by N rows of `x_mm`, `y_mm`, `dx_um`, `dy_um`. `-` reads
    /// standard input.
    #[arg(value_name = "POINTS.csv")]
    pub points: PathBuf,
    /// Answer file; it appears only when it is complete. Without it standard output, where a wrong point of a long file
    /// may come after answers to those before it: the exit code tells.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// How points and answers are written, where a file's name does not say so by `.csv` or `.npy`; without it CSV, and
    /// the answer as the points.
    #[arg(long, value_name = "FORMAT")]
    pub format: Option<PointFormat>,
}

/// Arguments of `reference`.
#[derive(Debug, Args)]
pub struct ReferenceArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// What weights the mean over the exposure: the light, or the arc length of the distortion
    /// hodograph as printed in eqs. 10-11.
    #[arg(long, value_name = "WEIGHT", default_value = "exposure")]
    pub weight: WeightName,
    /// How eqs. 12-13 are read: as changes (consistent), or literally, which counts the static
    /// distortion twice.
    #[arg(long, value_name = "READING", default_value = "consistent")]
    pub reading: ReadingName,
    /// The points and where the answer goes.
    #[command(flatten)]
    pub files: PointFiles,
}

/// Arguments of `frame`.
#[derive(Debug, Args)]
pub struct FrameArgs {
    /// The exposure.
    #[command(flatten)]
    pub exposure: ExposureArgs,
    /// Where the camera runs.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// For machines.
    #[arg(long)]
    pub json: bool,
    /// Answer file; without it standard output.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Which way the camera flies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DirectionName {
    /// Along the FMC axis.
    Forward,
    /// Against the FMC axis: a strip flown back, the camera not turned; travel and speed of the stage are negative.
    Reverse,
}

impl DirectionName {
    /// As on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Reverse => "reverse",
        }
    }
}

/// Which formula turns a focus shift into distortion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FocusSignName {
    /// A detector moved away from the lens enlarges the image by Δz/L: what ray tracing shows.
    Physical,
    /// Yuan et al. 2012, eqs. 14-17, as printed: k0' = -Δf/f.
    Printed,
}

/// Which model corrects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ModelName {
    /// Exposure mean of the calibration about the moving principal point.
    Exact,
    /// The five coefficients of the camera file's table `fitted`.
    Fitted,
    /// Static calibration; motion and focus shift are ignored.
    Static,
}

/// What weights the mean over the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WeightName {
    /// The light: what the sensor integrates.
    Exposure,
    /// Arc length of the distortion hodograph, eqs. 10-11.
    ArcLength,
}

/// How eqs. 12-13 are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReadingName {
    /// The two terms are changes of the distortion.
    Consistent,
    /// The two terms are totals, as printed.
    Literal,
}
