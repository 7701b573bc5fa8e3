//! The camera that frames are checked against.

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::io::link::digest;
use fmc_camera_file::{CameraFile, GridFiles, GridRefusal, InputError};

/// A camera file as records refer to it: the validated camera, and the CRC-32 that they carry.
#[derive(Debug, Clone)]
pub struct FrameCamera {
    name: String,
    camera: Camera,
    grids: GridFiles,
    /// CRC-32 of the parameters as the file has them, and as the camera is given them for a flight
    /// with the default settings: a largest V/H that the file does not state follows from those.
    crcs: [u32; 2],
}

impl FrameCamera {
    /// Creates the camera of a file without residual grids; `name` is the file's in messages.
    ///
    /// # Errors
    /// [`InputError`] for a calibration that the camera does not accept.
    pub fn new(name: &str, file: &CameraFile) -> Result<Self, InputError> {
        let parameters = file.parameters();
        let camera = Camera::new(parameters)
            .map_err(|error| InputError::invalid(format!("{name}: {error}")))?;
        let flown = file.flown(&FlightSettings::default());
        Ok(Self {
            name: name.to_owned(),
            camera,
            grids: GridFiles::default(),
            crcs: [flown, parameters].map(|one| digest::of_camera(&one)),
        })
    }

    /// Creates the camera of a file with the residual grids that it names; its frames state what
    /// those leave out.
    ///
    /// # Errors
    /// As [`Self::new`], also for grids that do not fit the camera.
    pub fn with_grids(name: &str, file: &CameraFile, grids: GridFiles) -> Result<Self, InputError> {
        let without = Self::new(name, file)?;
        let refused = |error: GridRefusal| InputError::invalid(format!("{name}: {error}"));
        let camera = {
            let fitting = grids.grids(without.calibration()).map_err(refused)?;
            without.camera.bounded_by(&fitting)
        };
        Ok(Self {
            camera,
            grids,
            ..without
        })
    }

    /// Returns the residual grids; a camera without has empty ones.
    ///
    /// # Errors
    /// [`InputError`] for grids that do not fit the camera, which [`Self::with_grids`] refuses.
    pub fn grids(&self) -> Result<CameraGrids<'_>, InputError> {
        self.grids
            .grids(self.calibration())
            .map_err(|error| InputError::invalid(format!("{}: {error}", self.name)))
    }

    /// Files of the residual grids.
    #[must_use]
    pub const fn grid_files(&self) -> &GridFiles {
        &self.grids
    }

    /// The validated camera.
    #[must_use]
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The validated calibration.
    #[must_use]
    pub const fn calibration(&self) -> &Calibration {
        self.camera.calibration()
    }

    /// CRC-32 that the records of this camera carry.
    #[must_use]
    pub const fn crc(&self) -> u32 {
        let [flown, _] = self.crcs;
        flown
    }

    /// Name of the camera file in messages.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Returns `true` if records with this CRC-32 belong to this camera.
    pub(crate) fn has_crc(&self, crc: u32) -> bool {
        self.crcs.contains(&crc)
    }
}
