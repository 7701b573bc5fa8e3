//! Requests for a frame: calibration, exposure, points, meshes, and the fit of coefficients.

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::estimation::fit::Fit;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::io::link::loading::{self, Upload};
use fmc_camera::io::link::message::{Answer, Grid, Observations, Points, Request};

use super::client::{Client, LOAD, LOAD_GRID};
use super::link_error::LinkError;
use super::port::Port;

impl<P: Port> Client<P> {
    /// Replaces the camera's calibration, mechanism, shutter and limits, in parts; the one before
    /// stays until the last part has come. A flight that it was prepared for ends.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where the calibration is not usable.
    pub fn load(&mut self, parameters: &CameraParameters) -> Result<CalibrationId, LinkError> {
        let upload = Self::upload(parameters)?;
        self.load_by(upload.requests(), &upload)
    }

    /// As [`Self::load`], but a flight goes on.
    ///
    /// # Errors
    /// [`LinkError::Refused`] also where the flight cannot go on with it.
    pub fn exchange(&mut self, parameters: &CameraParameters) -> Result<CalibrationId, LinkError> {
        let upload = Self::upload(parameters)?;
        self.load_by(upload.requests_in_flight(), &upload)
    }

    fn upload(parameters: &CameraParameters) -> Result<Upload, LinkError> {
        Upload::of(parameters).ok_or(LinkError::Unexpected { request: LOAD })
    }

    fn load_by(
        &mut self,
        requests: impl Iterator<Item = Request>,
        upload: &Upload,
    ) -> Result<CalibrationId, LinkError> {
        for request in requests {
            match self.ask(&request)? {
                Answer::Loading(_) => {}
                Answer::Loaded(calibration) => return Ok(calibration),
                _ => return Err(self.unexpected(&request)),
            }
        }
        // All parts have been taken, and the camera waits for more.
        Err(self.unexpected(&Request::BeginLoad {
            length: 0,
            crc: upload.crc(),
            keeps_flight: false,
        }))
    }

    /// Loads the file of a residual grid, in parts, for parameters that state it. The grids in use
    /// stay.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where the camera has no memory for grids, and for a damaged file.
    pub fn load_grid(&mut self, file: &[u8]) -> Result<(), LinkError> {
        let no_grid = LinkError::Unexpected { request: LOAD_GRID };
        let mut requests = loading::grid_requests(file).ok_or(no_grid)?.peekable();
        while let Some(request) = requests.next() {
            match (self.ask(&request)?, requests.peek()) {
                (Answer::Loading(_), Some(_)) | (Answer::GridLoaded(_), None) => {}
                _ => return Err(self.unexpected(&request)),
            }
        }
        Ok(())
    }

    /// Predicts a frame.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where the exposure cannot be taken.
    pub fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, LinkError> {
        self.predicted(&Request::Expose(*exposure))
    }

    /// Returns the interior orientation of the current frame.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where there is none.
    pub fn interior_orientation(&mut self) -> Result<InteriorOrientation, LinkError> {
        self.predicted(&Request::InteriorOrientation)
    }

    fn predicted(&mut self, request: &Request) -> Result<InteriorOrientation, LinkError> {
        match self.ask(request)? {
            Answer::InteriorOrientation(interior) => Ok(interior),
            _ => Err(self.unexpected(request)),
        }
    }

    /// Corrects a batch of measured points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a point off the sensor.
    pub fn correct(&mut self, measured: Points) -> Result<Vec<Corrected>, LinkError> {
        let asked = measured.len();
        self.points(&Request::Correct(measured), asked)
    }

    /// Distorts a batch of ideal points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a point that has no measured one.
    pub fn distort(&mut self, ideal: Points) -> Result<Vec<Corrected>, LinkError> {
        let asked = ideal.len();
        self.points(&Request::Distort(ideal), asked)
    }

    fn points(&mut self, request: &Request, asked: usize) -> Result<Vec<Corrected>, LinkError> {
        match self.ask(request)? {
            Answer::Points(points) if points.len() == asked => Ok(points.to_vec()),
            _ => Err(self.unexpected(request)),
        }
    }

    /// Returns the digest of a grid of corrected points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a grid that leaves the sensor.
    pub fn digest(&mut self, grid: &Grid) -> Result<u32, LinkError> {
        let request = Request::Digest(grid.clone());
        match self.ask(&request)? {
            Answer::Digest(digest) => Ok(digest),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Starts an adjustment of the five coefficients.
    ///
    /// # Errors
    /// [`LinkError::Refused`] without a calibration.
    pub fn start_fit(&mut self, options: FitOptions) -> Result<(), LinkError> {
        let request = Request::StartFit(options);
        match self.ask(&request)? {
            Answer::Observed(0) => Ok(()),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Adds observations to the adjustment and returns its number of points.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for an observation that is not believable.
    pub fn observe(&mut self, observations: Observations) -> Result<u32, LinkError> {
        let request = Request::Observe(observations);
        match self.ask(&request)? {
            Answer::Observed(points) => Ok(points),
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the coefficients of all observations so far.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where they do not determine them.
    pub fn fit(&mut self) -> Result<Fit<f32>, LinkError> {
        match self.ask(&Request::Fit)? {
            Answer::Fitted(fit) => Ok(fit),
            _ => Err(self.unexpected(&Request::Fit)),
        }
    }

    /// Returns a row of a warp engine's mesh, as the engine stores it.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a vertex without a source, or with one that the format does not
    /// hold.
    pub fn mesh(&mut self, row: VertexRow, format: MeshFormat) -> Result<Vec<u8>, LinkError> {
        let request = Request::Mesh(row, format);
        match self.ask(&request)? {
            Answer::Mesh(bytes) if bytes.len() == usize::from(row.count) * format.bytes() => {
                Ok(bytes.to_vec())
            }
            _ => Err(self.unexpected(&request)),
        }
    }

    /// Returns the displacements with which the vertices of a row of the recorded image are to be
    /// drawn, corrected - recorded.
    ///
    /// # Errors
    /// [`LinkError::Refused`] for a vertex off the image.
    pub fn corrections(&mut self, row: VertexRow) -> Result<Vec<PixelCorrection>, LinkError> {
        let request = Request::Corrections(row);
        match self.ask(&request)? {
            Answer::Corrections(corrections) if corrections.len() == usize::from(row.count) => {
                Ok(corrections.to_vec())
            }
            _ => Err(self.unexpected(&request)),
        }
    }
}
