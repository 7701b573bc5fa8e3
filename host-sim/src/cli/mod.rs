//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

mod block;
mod calibration;
mod camera;
mod camera_file;
mod campaign;
mod certificate;
mod composition;
mod examples;
mod exchange;
mod exposure;
mod frames;
mod images;
mod mesh;
mod mission;
mod network;
mod number;
mod points;
mod rectify;
mod serve;
mod sign;
mod simulation;
mod statistics;
mod trajectory;
mod vh;

pub use block::SimulatedBlockArgs;
pub use calibration::{
    AlongAxis, AnglesArgs, CalibrateArgs, CalibrationArgs, CalibrationFiles, CalibrationMethod,
    Coefficients, Dlt2dArgs, Dlt3dArgs, FiveArgs, GridArgs, GridPart, OneGridPart, RegressOn,
    StaticP2,
};
pub use camera::{
    CameraAction, CameraArgs, DutyArgs, ExposureTimeArgs, FocusShiftArgs, JogArgs, PrepareArgs,
    RecalibrateArgs, ShutterArgs, StatusArgs, StoreArgs, TemperatureArgs, VhArgs,
};
pub use camera_file::{CameraFileAction, CameraFileArgs};
pub use campaign::CampaignArgs;
pub use certificate::{
    CertificateAction, CertificateArgs, CertificateFolderArgs, MakeCertificateArgs,
};
pub use composition::{
    DmzArgs, DmzSceneArgs, HeightsName, OrderName, RadiometryArgs, RadiometryMethod, RigArgs,
    SceneArgs, SceneCamera, SceneOptions, StereoArgs, VirtualArgs,
};
pub use exchange::{ContainerName, ExportArgs, ImportArgs, SignName};
pub use exposure::{DirectionName, ExposureArgs, FocusSignName, ModelName};
pub use frames::{AnswerName, FrameAnswerArgs, FramesArgs, OffSensorName};
pub use images::{CompareArgs, RenderArgs};
pub use mesh::{ImagePart, MeshArgs, MeshFormatName};
pub use mission::{MissionArgs, RecordsArgs};
pub use network::{BundleArgs, DatumName, HandOverFormat, NetworkArgs, ResectionArgs};
pub use points::{FrameArgs, PointFiles, PointsArgs, ReadingName, ReferenceArgs, WeightName};
pub use rectify::{
    BlockArgs, CentreName, CompressionName, ImageFileArgs, RectifiedImageArgs, RectifyArgs,
    ResamplingName, Shard, WindowArgument,
};
pub use serve::ServeArgs;
pub use sign::{SignAction, SignArgs, SignCalibrationArgs, SignKeyArgs};
pub use simulation::{BudgetArgs, SmearArgs, StrategyName, StripArgs, SweepArgs};
pub use statistics::{FaultNumber, StatisticsArgs};
pub use trajectory::{OffTrajectoryName, TimeScaleName, TrajectoryArgs};
pub use vh::{VhArgument, VhOption};

use crate::device::DeviceName;

/// Geometry of an airborne mapping camera with forward motion compensation: strict reference,
/// verification, and the client of the camera.
#[derive(Debug, Parser)]
#[command(version, after_help = EXIT_CODES)]
pub struct Cli {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 the check that was asked for failed; 2 bad input; \
                          3 device or I/O failure.";

/// Heading of the options that a first call does not need.
const ADVANCED: &str = "Advanced";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Check every coordinate of real cameras against the strict reference solver.
    ///
    /// 10 V/H x 6 exposures x both run-up strategies x 21 x 21 points over the sensor, for each of
    /// five published cameras or for the one given; in QEMU several cameras side by side. Fails
    /// (exit 1) when dx or dy is off by more than 1.5 nm or a coordinate by more than 5 nm, or when
    /// a result of the firmware differs in any bit from that of the same code on this PC.
    #[command(after_help = examples::VERIFY)]
    Verify(VerifyArgs),
    /// Remove distortion: measured points -> ideal points.
    ///
    /// Of one exposure, or with --records or --frames of all frames of a flight at once: POINTS
    /// then have a column sequence, frame or image. Other columns stay as they are.
    #[command(after_help = examples::CORRECT)]
    Correct(PointsArgs),
    /// Apply distortion: ideal points -> measured points, the inverse of `correct`.
    ///
    /// With --records or --frames the points are those that `correct` answers with the same
    /// --answer.
    #[command(after_help = examples::DISTORT)]
    Distort(PointsArgs),
    /// As `correct`, but by quadrature in double precision: the strict reference solver.
    #[command(after_help = examples::REFERENCE)]
    Reference(ReferenceArgs),
    /// Interior orientation of one frame, without points.
    ///
    /// With --records or --frames of all frames of a flight, a row of CSV each, or with --json a
    /// line of JSON.
    #[command(after_help = examples::FRAME)]
    Frame(FrameArgs),
    /// Write the mesh with which a warp engine or a graphics processor corrects a frame.
    ///
    /// For warp engines: for vertices of the corrected image, every so many pixels, the sources in
    /// the recorded image, in the number format of the engine. A source off the sensor is computed
    /// with the distortion of the sensor's edge.
    ///
    /// For graphics processors (gpu) the other way round: for vertices of the recorded image the
    /// displacement to their places in the corrected one, corrected minus recorded. The recorded
    /// image is the texture and is drawn as triangles between the moved vertices, with linear
    /// interpolation between; mesh.json has the largest error of that interpolation, which grows
    /// with the square of --spacing. Vertices beyond the image, which end the last cells, continue
    /// the distortion.
    ///
    /// The corrected image has the pixels of the sensor; its principal point is the frame's. The
    /// camera computes the rows, and the files have the same bytes on every device. mesh.json
    /// describes the numbers.
    #[command(after_help = examples::MESH)]
    Mesh(MeshArgs),
    /// Turn recorded frames into images of one camera without distortion.
    ///
    /// Every frame is resampled once, with the principal point and the distortion of its own
    /// exposure, from the records of the flight. All rectified frames have one camera,
    /// rectified-camera.toml: the principal distance and the pixel of the calibration, the
    /// principal point in the centre, no distortion. EXIF, GPS and other tags of the TIFF are kept.
    ///
    /// Beside each NAME.tif there is NAME.json with its interior orientation, record, options and
    /// the CRC-32 of its pixels; manifest.csv has a row for every frame. A file appears only when
    /// it is complete, and its bytes depend on frame, record, camera, options and version alone.
    #[command(after_help = examples::RECTIFY)]
    Rectify(RectifyArgs),
    /// Make a frame as a camera records it, and its exactly rectified answer.
    ///
    /// The camera sees a pattern that is known everywhere: waves, or an image. What it records is
    /// computed pixel by pixel by the strict solver, in double precision; the answer is the pattern
    /// itself, about the principal point of the exposure. `rectify` of the frame with the same
    /// exposure should give the answer; `compare` tells how well it does.
    #[command(after_help = examples::RENDER)]
    Render(RenderArgs),
    /// Compare two images: grey values, and by blocks of 64 pixels the shift of their content.
    ///
    /// Shifts are found by least-squares matching, of the mean of the bands. Pixels that are 0 in
    /// all bands of either image have no content.
    #[command(after_help = examples::COMPARE)]
    Compare(CompareArgs),
    /// Make what a synthetic camera of several detectors records, with its truth.
    Scene(SceneArgs),
    /// Compose the sub-images of an exposure to one virtual image, without distortion.
    ///
    /// Each sub-image is resampled once, by the polynomial of `calibrate rig`; neighbours are
    /// joined at the seam of least cost and mixed within 5 px of it. The report has the steps at
    /// the seams by least-squares matching, in pixels and grey values, and the registration to
    /// green. With a rig of `--heights ignore` the virtual image is made by that registration, as
    /// Zhao et al. 2013 do.
    #[command(after_help = examples::VIRTUAL)]
    Virtual(VirtualArgs),
    /// Adjust two virtual images of one ground over control and check points.
    ///
    /// Ties are matched by least squares; interior orientations are held. Layouts of Zhao et al.
    /// 2013: a control point in each corner, two in each corner and in the middle, and all, which
    /// leaves no check.
    #[command(after_help = examples::STEREO)]
    Stereo(StereoArgs),
    /// Repeat Zhao et al. 2013 with a synthetic camera: its way beside ours, against truth.
    ///
    /// Scene, radiometry, rig, both virtual images, relief of 0 to 30 m, stereo check with 40
    /// repetitions; one page. Fails (exit 1) where a number is beyond its limit.
    #[command(after_help = examples::DMZ)]
    Dmz(DmzArgs),
    /// Calibrate a camera: parameters from observations.
    Calibrate(CalibrateArgs),
    /// Residual smear of an exposure: what the compensation leaves, term by term.
    ///
    /// Each disturbance alone and all together: the largest smear over the sensor, where it is, and
    /// the mean, in µm and pixels, as the camera predicts it; beside it the largest of a simulated
    /// exposure. V/H is the true one, over the reference plane. All angles are right-handed: pitch
    /// nose up, roll right side down, yaw nose to the left, at the exposure's centroid.
    #[command(after_help = examples::SMEAR)]
    Smear(SmearArgs),
    /// Simulate a calibration of the five-coefficient model: Yuan et al. 2012, section 4.1.
    ///
    /// The experiment shows how much five fitted coefficients gain as a correction of the motion.
    /// The strict solver makes distortions of 21 x 21 points in 60 exposures (10 V/H from 0.05 to
    /// 0.17 1/s, 1/100 to 1/700 s), seeded noise is added, and the coefficients are found by least
    /// squares: exposure by exposure, and from all together. The report compares the static, the
    /// five-coefficient and the exact model, with the paper's divisor n - 5 and with the correct
    /// one, and separates the gain by the focus shift from the gain by the motion.
    ///
    /// The paper reports 1.2 and 2.3 µm; the example repeats it with 1.2 and 2.4 µm.
    #[command(after_help = examples::SWEEP)]
    Sweep(SweepArgs),
    /// Compute what each source of error costs this camera, on one page.
    ///
    /// Largest effect of every term over the exposures of the paper and over those that the
    /// camera's limits allow: principal point and time of different instants, the distortion that
    /// the motion changes, the principal distance, and the terms that no correction removes: V/H,
    /// relief, drift, encoder, clock and attitude rates. In micrometres and pixels on the sensor
    /// and in centimetres on the ground, the largest first, with a sentence of advice.
    #[command(after_help = examples::BUDGET)]
    Budget(BudgetArgs),
    /// Simulate a strip of frames over ground control: Yuan et al. 2012, section 4.2, and beyond.
    ///
    /// The experiment shows which correction puts points at their places on the ground. A strip of
    /// frames is recorded with the true exposure mean of the lens; image points, position and
    /// attitude on board and surveyed control points get seeded errors; every frame is oriented by
    /// space resection, the five coefficients are calibrated from all frames; and the ground errors
    /// of no correction, the static, the printed, the five-coefficient and the exact model are
    /// compared at the control points and at check points that took no part, over many repetitions
    /// with other errors, with confidence intervals.
    ///
    /// The second example repeats the paper's 0.29 m and 0.18 m.
    #[command(visible_alias = "flight", after_help = examples::STRIP)]
    Strip(StripArgs),
    /// Fly and adjust a block of aerial images, with and without the records of its flight.
    ///
    /// Strips to and fro, and cross strips, are exposed physically: the detector moves from rest or
    /// centred as the camera's own code plans it, in wind, over relief, with the light's exposure
    /// times. Every run has errors of its own in image points, positions, attitudes and control.
    /// The bundle is adjusted with one principal point for all frames, with a shift of the
    /// positions per strip, and with the records, distortion recentred or not; check points along
    /// the strips, across and in height and σ0 are compared over all runs, with confidence
    /// intervals. Fails (exit 1) where a limit of the scenario is exceeded, a good record is named,
    /// or a wrong one is not.
    #[command(after_help = examples::BLOCK)]
    Block(SimulatedBlockArgs),
    /// Fly a mission in simulated time with the camera in the loop.
    ///
    /// Aircraft, V/H sensors, shutter and the mechanics of the stage are simulated; the camera's
    /// own code plans every exposure, moves the stage, releases the shutter and records the
    /// interior orientation, a thousand rounds of its control loop per simulated second. Every
    /// record is compared with the physical exposure: the true principal point and the true motion
    /// of the image. Fails (exit 1) when a trigger has no record, a limit of the scenario is
    /// exceeded, or a fault does not lead to what the scenario expects of it.
    ///
    /// Not simulated: a shutter that exposes the rows one after the other; vibration of the camera
    /// beyond its attitude rates; changes of temperature during a flight; noise and dead pixels of
    /// the detector; terrain between the heights that V/H is measured over other than waves; a
    /// supply that fails; errors of the calibration. Camera time, V/H and attitude reach the camera
    /// as values with noise, latency and faults, those of a satellite receiver as its sentences
    /// where the scenario says so.
    ///
    /// The first example flies the nominal mission of 1000 exposures.
    #[command(after_help = examples::MISSION)]
    Mission(MissionArgs),
    /// Fly random missions, and compare every error with the σ that the records state.
    ///
    /// Cameras, mechanisms, settings, sensors and flights are drawn from the seed and flown in this
    /// program, on all cores. Over all of them error/σ of the principal point, of V/H and of UTC
    /// has a root mean square of 1, the true smear is below the predicted one in 95 % of the
    /// frames, no fault comes without a cause, every trigger has its record, and no frame is wrong
    /// without a flag. Fails (exit 1) where a limit is exceeded. The folder holds the scenario of
    /// each of the worst cases, for `host-sim mission --scenario`.
    #[command(after_help = examples::STATISTICS)]
    Statistics(StatisticsArgs),
    /// Try every fault in every millisecond of a frame cycle, and pairs of faults.
    ///
    /// A flight is copied where it is, each copy is given a fault, or two that the seed draws, and
    /// the frames after it are compared with the physical truth. No exposure may be wrong by more
    /// than its record allows without a fault or a flag that says so, every trigger has its record,
    /// and every fault changes what the camera is told in 95 % of its runs at least. Fails (exit 1)
    /// where a limit is exceeded. A campaign that was ended goes on with the same command: complete
    /// blocks are kept in progress.txt.
    #[command(after_help = examples::CAMPAIGN)]
    Campaign(CampaignArgs),
    /// Fetch the records of a camera: records.csv and records.json.
    ///
    /// Every trigger has a record: the exposure's interior orientation and time, or the reason why
    /// there was no exposure. The camera keeps the records until they are on this PC's disk.
    #[command(after_help = examples::RECORDS)]
    Records(RecordsArgs),
    /// Write the calibration as the camera file of another program.
    ///
    /// Programs that correct measured points (opentrackio, micmac, australis, photomodeler) hold
    /// the calibration exactly. The others distort rays: a least-squares fit over the whole sensor,
    /// with the smallest model that leaves less than 0.01 px, or else the one that leaves least.
    /// The file is read back before it is called written. The terminal and export.json state what
    /// is left and where, which terms have no place, direction, sign, unit and origin, and the
    /// calibration's SHA-256 and CRC-32.
    ///
    /// A frame of a flight has another principal point than the calibration. Without --records the
    /// camera is written at its calibrated position; with the records of a flight, a camera per
    /// image, for the programs that take one. It says what one camera for all frames would cost
    /// (docs/formats.md).
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Make a camera file of another program's.
    ///
    /// A calibration of measured points is converted exactly. One of rays is fitted: K0 to K3, P1,
    /// P2, B1, B2 by least squares over the whole sensor; the comments of the file and --report say
    /// what that leaves. Mechanism, shutter and limits come from --base.
    #[command(after_help = examples::IMPORT)]
    Import(ImportArgs),
    /// Make the certificate of a calibrated camera, which an engineer signs.
    ///
    /// A4 pages as PDF, the same as HTML, the numbers as certificate.json, and the camera file,
    /// which is attached to the PDF, too: identity, parameters with σ, static distortion, motion,
    /// proof against the strict solver, residual in other programs. The same input gives the same
    /// bytes. SHA256SUMS has the hashes; --sign signs them. docs/certificate.md says what each
    /// number means.
    #[command(after_help = examples::CERTIFICATE)]
    Certificate(CertificateArgs),
    /// Sign a calibration, so that a camera stores it; or make the key.
    ///
    /// A camera uses what is loaded over its link until the next start, whoever has made it. Into
    /// its flash it stores only what is signed by the key whose public half its firmware has: the
    /// numbers of the camera file with their residual grids, lens, laboratory and date.
    /// docs/store.md has what is signed, and what a signature does not protect from.
    #[command(after_help = examples::SIGN)]
    Sign(SignArgs),
    /// Prepare, arm and watch a camera on a board, with its own mechanism, shutter and trigger
    /// line.
    ///
    /// First `prepare --camera FILE`, then, with the stage at its calibrated position,
    /// `referenced`, then `arm`. V/H comes from the aircraft or, on a bench, from `vh`.
    /// `host-sim records` fetches the records.
    #[command(after_help = examples::CAMERA)]
    Camera(CameraArgs),
    /// Serve the link of a camera on a TCP port.
    ///
    /// Programs in other languages and on other computers reach it there, host-sim by
    /// `--device tcp:HOST:PORT`: one after the other; while one is connected, others are closed at
    /// once, unless it has been silent for 10 s. The camera is that of --device: this program's own
    /// code on a test rig (sil), the firmware in QEMU, or a camera on a serial port. It stays as it
    /// is between two programs. The first line on standard output is its device. Ends with Ctrl-C,
    /// and QEMU with it.
    #[command(after_help = examples::SERVE)]
    Serve(ServeArgs),
    /// Check a camera file.
    CameraFile(CameraFileArgs),
}

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Device on which the camera runs.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Camera file; without it the five published cameras.
    #[arg(long, value_name = "FILE")]
    pub camera: Option<PathBuf>,
    /// Folder for report.html, summary.json and frames.csv; made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Check images in place of coordinates: frames of waves as each camera records them, rectified
    /// by every kernel and compared with the exact answer. Fails (exit 1) if the content of a block
    /// of 64 pixels lies farther off than the kernel's limit.
    #[arg(long, conflicts_with_all = ["device", "firmware", "log"], help_heading = ADVANCED)]
    pub images: bool,
    /// Reason why the camera's code in this program stands in for QEMU, as the workspace's own
    /// command found it when it set QEMU up.
    #[arg(long, value_name = "REASON", hide = true, conflicts_with_all = ["device", "firmware"])]
    pub not_in_qemu: Option<String>,
}

/// Device on which the camera runs.
#[derive(Debug, Args)]
pub struct DeviceArgs {
    /// Device on which the camera's code runs.
    ///
    /// `sil`: in this program (software in the loop). `qemu` or `qemu:an386`: the firmware, on a
    /// Cortex-M4F in the emulator QEMU. `qemu:an500`: on a Cortex-M7. `serial:PATH`: a camera on a
    /// serial port, such as `serial:/dev/ttyACM0`, at 921,600 baud; `serial:PATH:BAUD` at another
    /// speed, for which its firmware was built (`FMC_LINK_BAUD`). `tcp:HOST:PORT`: a camera whose
    /// link another program or a converter forwards. Without this option `verify` takes `qemu`, or
    /// `sil` where there is no QEMU; the other commands take `sil`.
    #[arg(long, value_name = "DEVICE")]
    pub device: Option<DeviceName>,
    /// Image of the firmware for QEMU, an ELF file. Without it the variable `FMC_FIRMWARE`, else
    /// what `cargo xtask firmware` has built; if it has not been built yet, it is built now.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub firmware: Option<PathBuf>,
    /// File of the flash of the firmware in QEMU, in which the camera stores its calibration; made
    /// if it does not exist. Without it the flash is blank at every start.
    #[arg(long, value_name = "FILE", help_heading = ADVANCED)]
    pub flash: Option<PathBuf>,
    /// Show the log of the firmware in QEMU on the error stream.
    #[arg(long, help_heading = ADVANCED)]
    pub log: bool,
}
