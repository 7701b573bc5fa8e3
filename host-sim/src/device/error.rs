//! Errors of a device.

use std::fmt;

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::mesh::vertex::{MeshError, VertexRow};
use fmc_camera::geometry::range::OutOfRange;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::GridRefusal;
use fmc_reference::verification::device::CorrectionFailure;

use super::link_error::LinkError;

/// A failure of a device to do what it was asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeviceError {
    /// The device refuses the calibration.
    #[error("the camera refuses the calibration: {0}")]
    Calibration(CalibrationError),
    /// The device refuses the exposure.
    #[error("the camera refuses the exposure: {0}")]
    Frame(FrameError),
    /// A point of a batch has no measured point.
    #[error("point {index} of the batch: {error}")]
    Distort {
        /// Index in the batch.
        index: usize,
        /// Reason.
        error: DistortError,
    },
    /// A measured point of a batch is off the sensor.
    #[error("point {index} of the batch is off the sensor")]
    OffSensor {
        /// Index in the batch.
        index: usize,
    },
    /// A vertex of a mesh is off the image, has no source, or one that the format does not hold.
    #[error(transparent)]
    Mesh(MeshError),
    /// The device answered more or fewer points than it was asked for.
    #[error("the camera was asked for {asked} points and answered {answered}")]
    Count {
        /// Points asked for.
        asked: usize,
        /// Points answered.
        answered: usize,
    },
    /// Residual grids were given to a camera that does not hold any.
    #[error(
        "[grid]: this camera does not hold residual grids, and without them it corrects otherwise"
    )]
    NoGrids,
    /// A mesh that pushes was asked of a camera with residual grids.
    #[error(
        "[grid]: a mesh of corrections goes by the differences of the polynomial and has no residual grids; take a format of sources"
    )]
    PolynomialMesh,
    /// A residual grid is damaged, or does not fit the camera.
    #[error("[grid]: {0}")]
    Grids(GridRefusal),
    /// A residual grid that the camera states has not been given.
    #[error("[grid]: the camera needs the residual grid of the {carrier} with CRC-32 {crc32:08x}")]
    MissingGrid {
        /// Part of the grid.
        carrier: GridCarrier,
        /// CRC-32 with which its file ends.
        crc32: u32,
    },
    /// Points were given before the first exposure.
    #[error("the camera has not been exposed yet")]
    NoFrame,
    /// A flight was begun before the camera was prepared.
    #[error("the camera has not been prepared for flight")]
    NotPrepared,
    /// The device refuses the settings of the flight.
    #[error("the camera refuses the flight's settings: {0}")]
    Settings(OutOfRange),
    /// Records of an earlier flight would be lost.
    #[error(
        "the camera still has {0} records of an earlier flight; fetch them with `host-sim records`"
    )]
    RecordsKept(u32),
    /// No wires of receiver and autopilot lead to the device.
    #[error(
        "the scenario has a receiver or an autopilot on a wire, and no wires lead to the device: fly it in this process or in QEMU"
    )]
    NoWires,
    /// The link to the device has failed.
    #[error("{device}: {error}")]
    Link {
        /// Device, as the command line names it.
        device: String,
        /// Reason.
        error: LinkError,
    },
    /// The machine on which the device runs has ended or stopped.
    #[error("{0}")]
    Machine(String),
    /// A result of the device differs from that of its own code on this PC.
    #[error(transparent)]
    Different(Box<Difference>),
}

impl From<GridMemoryError> for DeviceError {
    fn from(error: GridMemoryError) -> Self {
        match error {
            GridMemoryError::Missing { carrier, crc32 } => Self::MissingGrid { carrier, crc32 },
            GridMemoryError::Unfit(error) => Self::Grids(GridRefusal::Camera(error)),
        }
    }
}

impl DeviceError {
    /// Checks that every point has its answer.
    ///
    /// # Errors
    /// [`DeviceError::Count`] where one has none.
    pub const fn check_count(asked: usize, answered: usize) -> Result<(), Self> {
        if asked == answered {
            Ok(())
        } else {
            Err(Self::Count { asked, answered })
        }
    }
}

impl CorrectionFailure for DeviceError {
    fn of_count(asked: usize, answered: usize) -> Self {
        Self::Count { asked, answered }
    }

    fn of_grids() -> Self {
        Self::NoGrids
    }

    fn is_difference(&self) -> bool {
        matches!(self, Self::Different(_))
    }
}

/// A difference between a camera and its twin, the same code on this PC.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The exposure; `None` while a calibration is loaded.
    pub exposure: Option<Exposure>,
    /// The result that differs.
    pub result: DifferentResult,
}

/// Two results, the camera's and its twin's, that should have the same bits.
#[derive(Debug, Clone, PartialEq)]
pub enum DifferentResult {
    /// Identities of the calibration in use.
    Calibration {
        /// Identity of the one in use at the camera.
        camera: CalibrationId,
        /// Identity of the one that was sent.
        twin: CalibrationId,
    },
    /// Refusals: one side refuses what the other accepts, or for another reason; `None` where it
    /// accepts.
    Refusal {
        /// The camera's reason.
        camera: Option<String>,
        /// The twin's.
        twin: Option<String>,
    },
    /// Frame records.
    InteriorOrientation {
        /// The camera's.
        camera: InteriorOrientation,
        /// The twin's.
        twin: InteriorOrientation,
    },
    /// The first point that differs.
    Point {
        /// Index in the batch or grid.
        index: usize,
        /// The point that was given.
        given: SensorPoint,
        /// Result of the camera.
        camera: Corrected,
        /// Result of the twin.
        twin: Corrected,
    },
    /// Actions of a round of the control loop, or frame records.
    Round {
        /// The camera's.
        camera: String,
        /// The twin's.
        twin: String,
    },
    /// A row of a mesh.
    Mesh {
        /// The row.
        row: VertexRow,
    },
    /// Digests of a grid whose points are all equal.
    Digest {
        /// The camera's.
        camera: u32,
        /// The twin's.
        twin: u32,
    },
}

impl std::error::Error for Difference {}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the camera does not compute what its own code computes on this PC; ")?;
        if let Some(exposure) = &self.exposure {
            let Exposure {
                vh_per_s,
                exposure_s,
                ..
            } = exposure;
            write!(f, "V/H {vh_per_s} 1/s, exposure {exposure_s} s: ")?;
        }
        match &self.result {
            DifferentResult::Calibration { camera, twin } => write!(
                f,
                "the calibration in use ({camera}) is not the one that was sent ({twin})"
            ),
            DifferentResult::Refusal { camera, twin } => {
                let outcome = |reason: &Option<String>| match reason {
                    Some(reason) => format!("refuses ({reason})"),
                    None => "accepts".to_owned(),
                };
                write!(
                    f,
                    "the camera {}, this PC {}",
                    outcome(camera),
                    outcome(twin)
                )
            }
            DifferentResult::InteriorOrientation { camera, twin } => write!(
                f,
                "the camera's frame record is {camera:?}, this PC's {twin:?}"
            ),
            DifferentResult::Round { camera, twin } => {
                write!(f, "in flight the camera answers {camera}, this PC {twin}")
            }
            DifferentResult::Point {
                index,
                given,
                camera,
                twin,
            } => write!(
                f,
                "point {index} at x {} mm, y {} mm: the camera answers {}, this PC {}",
                given.x_mm,
                given.y_mm,
                Bits(camera),
                Bits(twin)
            ),
            DifferentResult::Mesh { row } => write!(
                f,
                "the mesh differs between columns {} and {} of row {}",
                row.first_col_px,
                row.first_col_px + u32::from(row.spacing_px) * u32::from(row.count),
                row.row_px
            ),
            DifferentResult::Digest { camera, twin } => write!(
                f,
                "the camera's digest of the grid is {camera:08x}, this PC's {twin:08x}, and every point by itself is the same"
            ),
        }
    }
}

/// A corrected point with every bit of it.
struct Bits<'a>(&'a Corrected);

impl fmt::Display for Bits<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Corrected { point, distortion } = self.0;
        // Rust prints the shortest decimal that reads back as the same number.
        write!(
            f,
            "x {} mm, y {} mm, dx {} mm, dy {} mm",
            point.x_mm, point.y_mm, distortion.dx_mm, distortion.dy_mm
        )
    }
}
