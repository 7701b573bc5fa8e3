//! A camera at the other end of a link, checked against its twin in this process.

use std::collections::BTreeMap;

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::mesh::format::MeshFormat;
use fmc_camera::geometry::mesh::pixel_correction::PixelCorrection;
use fmc_camera::geometry::mesh::vertex::VertexRow;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::MAX_POINTS;
use fmc_camera::io::link::message::{
    Counters, Ending, Grid, Identity, Points, Refusal, ResetCause,
};
use fmc_camera_file::{GridFiles, GridRefusal};
use serde::Serialize;

use super::client::Client;
use super::error::{DeviceError, Difference, DifferentResult};
use super::link_error::LinkError;
use super::port::Port;
use super::wires::Wires;
use super::{CorrectingDevice, Device, Evidence, InProcess};

/// Step from one point of a grid that is compared by value to the next.
pub const SAMPLE_STEP: usize = 8;

/// Session with a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Session {
    /// Every request; an earlier session ends.
    Whole,
    /// Status, records and what is stored alone; another session may fly the camera, and goes on.
    Reading,
}

/// A camera over a link, with its twin: the same code in this process. Every answer of the camera
/// must have the twin's bits.
#[derive(Debug)]
pub struct Remote<P> {
    name: String,
    pub(super) client: Client<P>,
    identity: Identity,
    pub(super) twin: InProcess,
    pub(super) wires: Option<Wires<P>>,
    exposure: Option<Exposure>,
    /// Residual grids of the camera that is loaded next.
    grids: GridFiles,
    /// CRC-32 of the records that were fetched and are not acknowledged, by their numbers.
    pub(super) fetched: BTreeMap<u32, u32>,
    evidence: Evidence,
}

impl<P: Port> Remote<P> {
    /// Adds the far ends of the camera's wires of receiver and autopilot.
    #[must_use]
    pub(super) fn with_wires(self, receiver: P, autopilot: P) -> Self {
        Self {
            wires: Some(Wires::new(receiver, autopilot)),
            ..self
        }
    }

    /// Connects to a camera; errors call it `name`.
    ///
    /// # Errors
    /// [`DeviceError::Link`] where it does not answer as a camera of this protocol.
    pub fn connect(name: &str, port: P, session: Session) -> Result<Self, DeviceError> {
        let mut client = Client::new(port);
        let identity = match session {
            Session::Whole => client.connect(),
            Session::Reading => client.connect_reading(),
        };
        let identity = identity.map_err(|error| DeviceError::Link {
            device: name.to_owned(),
            error,
        })?;
        Ok(Self {
            name: name.to_owned(),
            client,
            identity,
            twin: InProcess::default(),
            wires: None,
            exposure: None,
            grids: GridFiles::default(),
            fetched: BTreeMap::new(),
            evidence: Evidence::default(),
        })
    }

    /// Identity of the camera that answered.
    #[must_use]
    pub const fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Board, version and build of the firmware that answered.
    #[must_use]
    pub fn firmware(&self) -> String {
        let Identity {
            version,
            build,
            board,
            ..
        } = &self.identity;
        format!("board {board}, firmware {version}, build {build}")
    }

    /// Asks again for the record of the current frame.
    ///
    /// # Errors
    /// [`DeviceError::NoFrame`] before the first exposure.
    pub fn interior_orientation(&mut self) -> Result<InteriorOrientation, DeviceError> {
        self.client
            .interior_orientation()
            .map_err(|error| self.failed(error, 0))
    }

    /// Starts the camera again and connects to it; calibration and frame are gone.
    ///
    /// # Errors
    /// [`DeviceError::Link`] where it does not come back, or is armed or in flight;
    /// [`DeviceError::RecordsKept`].
    pub fn reset(&mut self) -> Result<(), DeviceError> {
        self.reset_as(Ending::Orderly)
    }

    /// As [`Self::reset`], in either way: after a forced one a flight may go on.
    ///
    /// # Errors
    /// As [`Self::reset`].
    pub fn reset_as(&mut self, ending: Ending) -> Result<(), DeviceError> {
        self.client
            .reset(ending)
            .map_err(|error| self.failed(error, 0))?;
        self.reconnect()?;
        if self.identity.reset_cause == ResetCause::Requested {
            Ok(())
        } else {
            // Another host has the session, and the camera runs on.
            Err(self.failed(LinkError::SessionEnded, 0))
        }
    }

    /// Opens another session. The calibration stays if the camera has not restarted; the frame does
    /// not.
    ///
    /// # Errors
    /// [`DeviceError::Link`] where the camera does not answer.
    pub fn reconnect(&mut self) -> Result<(), DeviceError> {
        self.identity = self
            .client
            .connect()
            .map_err(|error| self.failed(error, 0))?;
        self.twin = InProcess::default();
        self.exposure = None;
        self.fetched.clear();
        Ok(())
    }

    /// Corrects points with the calibration that the camera has, whatever it is: without a twin.
    ///
    /// # Errors
    /// [`DeviceError`] where the camera has none, or refuses the exposure or a point.
    pub fn correct_by_itself(
        &mut self,
        exposure: &Exposure,
        measured: &[SensorPoint],
    ) -> Result<Vec<Corrected>, DeviceError> {
        let mut corrected = Vec::with_capacity(measured.len());
        let exposed = self.client.expose(exposure);
        exposed.map_err(|error| self.failed(error, 0))?;
        for batch in measured.chunks(MAX_POINTS) {
            let answered = self.client.correct(batch.iter().copied().collect());
            let answered = answered.map_err(|error| self.failed(error, corrected.len()))?;
            corrected.extend(answered);
        }
        Ok(corrected)
    }

    /// Switches the camera off.
    ///
    /// # Errors
    /// [`DeviceError::Link`] where it cannot, and as [`Self::reset`] unless it is forced.
    pub fn power_off(&mut self, ending: Ending) -> Result<(), DeviceError> {
        self.client
            .power_off(ending)
            .map_err(|error| self.failed(error, 0))
    }

    /// Turns an error of the link into one of the device; `before` points of the batch were
    /// answered earlier.
    pub(super) fn failed(&self, error: LinkError, before: usize) -> DeviceError {
        if let LinkError::Refused { refusal, .. } = error {
            match refusal {
                Refusal::Calibration(error) => return DeviceError::Calibration(error),
                Refusal::Exposure(error) => return DeviceError::Frame(error),
                Refusal::NoCalibration | Refusal::NoFrame => return DeviceError::NoFrame,
                Refusal::NotPrepared => return DeviceError::NotPrepared,
                Refusal::RecordsKept(count) => return DeviceError::RecordsKept(count),
                Refusal::Mesh(error) => return DeviceError::Mesh(error),
                Refusal::PolynomialMesh => return DeviceError::PolynomialMesh,
                Refusal::NoGridMemory => return DeviceError::NoGrids,
                Refusal::Grids(error) => return error.into(),
                Refusal::Grid { carrier, error } => {
                    return DeviceError::Grids(GridRefusal::File { carrier, error });
                }
                Refusal::Settings(error) => return DeviceError::Settings(error),
                Refusal::Travel(error) => return DeviceError::Frame(error),
                Refusal::OffSensor { index } => {
                    return DeviceError::OffSensor {
                        index: before + usize::from(index),
                    };
                }
                Refusal::Distort { index, error } => {
                    return DeviceError::Distort {
                        index: before + usize::from(index),
                        error,
                    };
                }
                _ => {}
            }
        }
        self.of_link(error)
    }

    /// Returns an error of the link with the name of the device.
    pub(super) fn of_link(&self, error: LinkError) -> DeviceError {
        DeviceError::Link {
            device: self.name.clone(),
            error,
        }
    }

    pub(super) fn different(&self, result: DifferentResult) -> DeviceError {
        DeviceError::Different(Box::new(Difference {
            exposure: self.exposure,
            result,
        }))
    }

    /// Checks that camera and twin both accept, or both refuse for the same reason.
    fn same_outcome<Camera, Twin>(
        &self,
        camera: Result<Camera, DeviceError>,
        twin: Result<Twin, DeviceError>,
    ) -> Result<(Camera, Twin), DeviceError> {
        let refusal = |error: &DeviceError| match error {
            // Refusals are compared as debug output, as a NaN is not equal to itself.
            DeviceError::Calibration(_)
            | DeviceError::Frame(_)
            | DeviceError::Distort { .. }
            | DeviceError::OffSensor { .. }
            | DeviceError::Mesh(_)
            | DeviceError::PolynomialMesh
            | DeviceError::Grids(_)
            | DeviceError::NoFrame => Some(format!("{error:?}")),
            _ => None,
        };
        let (camera, twin) = match (camera, twin) {
            (Ok(camera), Ok(twin)) => return Ok((camera, twin)),
            (Err(camera), Err(twin)) => {
                if refusal(&camera).is_none() || refusal(&camera) == refusal(&twin) {
                    return Err(camera);
                }
                (Some(camera), Some(twin))
            }
            (Err(camera), Ok(_)) => {
                if refusal(&camera).is_none() {
                    return Err(camera);
                }
                (Some(camera), None)
            }
            (Ok(_), Err(twin)) => (None, Some(twin)),
        };
        let text = |error: Option<DeviceError>| error.map(|error| error.to_string());
        Err(self.different(DifferentResult::Refusal {
            camera: text(camera),
            twin: text(twin),
        }))
    }

    /// Loads a camera, and before it those of its residual grids that it misses.
    fn load_with_grids(
        &mut self,
        camera: &CameraParameters,
        keeps_flight: bool,
    ) -> Result<CalibrationId, LinkError> {
        let mut missed = None;
        loop {
            let loaded = if keeps_flight {
                self.client.exchange(camera)
            } else {
                self.client.load(camera)
            };
            match loaded {
                Err(LinkError::Refused {
                    refusal: Refusal::Grids(GridMemoryError::Missing { carrier, .. }),
                    ..
                }) if missed != Some(carrier)
                    && let Some(file) = self.grids.bytes(carrier) =>
                {
                    missed = Some(carrier);
                    self.client.load_grid(file)?;
                }
                answered => return answered,
            }
        }
    }

    /// Loads a camera and its twin; with `keeps_flight` a flight of the camera goes on.
    pub(super) fn load_in_both(
        &mut self,
        camera: &CameraParameters,
        keeps_flight: bool,
    ) -> Result<(), DeviceError> {
        self.exposure = None;
        let loaded = self.load_with_grids(camera, keeps_flight);
        let loaded = loaded.map_err(|error| self.failed(error, 0));
        if let Err(error) = &loaded
            && !matches!(error, DeviceError::Calibration(_) | DeviceError::Grids(_))
        {
            // The camera goes on with the calibration it has, and so does its twin.
            return loaded.map(drop);
        }
        let twin = self.twin.load_grids(&self.grids);
        let twin = twin.and_then(|()| self.twin.load(camera));
        let (loaded, ()) = self.same_outcome(loaded, twin)?;
        match self.twin.calibration() {
            Some(twin) if twin != loaded => Err(self.different(DifferentResult::Calibration {
                camera: loaded,
                twin,
            })),
            _ => Ok(()),
        }
    }

    /// Sends points through the camera in batches, then through the twin; both must have the same
    /// bits.
    fn through_both(
        &mut self,
        given: &[SensorPoint],
        ask_camera: impl Fn(&mut Client<P>, Points) -> Result<Vec<Corrected>, LinkError>,
        ask_twin: impl Fn(&mut InProcess, &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError>,
    ) -> Result<Vec<Corrected>, DeviceError> {
        let mut points = Vec::with_capacity(given.len());
        let mut camera = Ok(());
        for batch in given.chunks(MAX_POINTS) {
            let batch = batch.iter().copied().collect();
            match ask_camera(&mut self.client, batch) {
                Ok(answered) => points.extend(answered),
                Err(error) => {
                    camera = Err(self.failed(error, points.len()));
                    break;
                }
            }
        }
        let twin = ask_twin(&mut self.twin, given);
        let ((), twin) = self.same_outcome(camera, twin)?;
        DeviceError::check_count(twin.len(), points.len())?;
        let pairs = points.iter().zip(&twin).zip(given);
        for (index, ((camera, twin), given)) in pairs.enumerate() {
            if !same_bits(camera, twin) {
                return Err(self.different(DifferentResult::Point {
                    index,
                    given: *given,
                    camera: *camera,
                    twin: *twin,
                }));
            }
        }
        self.evidence.by_value += points.len() as u64;
        Ok(points)
    }
}

impl<P: Port> CorrectingDevice for Remote<P> {
    type Error = DeviceError;

    fn description(&self) -> String {
        format!("{} ({})", self.name, self.firmware())
    }

    fn load(&mut self, camera: &CameraParameters) -> Result<(), DeviceError> {
        self.load_in_both(camera, false)
    }

    fn load_grids(&mut self, grids: &GridFiles) -> Result<(), DeviceError> {
        self.grids = grids.clone();
        Ok(())
    }

    fn expose(&mut self, exposure: &Exposure) -> Result<InteriorOrientation, DeviceError> {
        self.exposure = Some(*exposure);
        let camera = self
            .client
            .expose(exposure)
            .map_err(|error| self.failed(error, 0));
        let twin = self.twin.expose(exposure);
        let (camera, twin) = self.same_outcome(camera, twin)?;
        if !same_bits(&camera, &twin) {
            return Err(self.different(DifferentResult::InteriorOrientation { camera, twin }));
        }
        Ok(camera)
    }

    fn correct(&mut self, measured: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        self.through_both(measured, Client::correct, InProcess::correct)
    }

    fn correct_grid(&mut self, grid: &Grid) -> Result<Vec<Corrected>, DeviceError> {
        let camera = self
            .client
            .digest(grid)
            .map_err(|error| self.failed(error, 0));
        let twin = self.twin.digest(grid);
        let (camera, twin) = self.same_outcome(camera, twin)?;
        let points: Vec<SensorPoint> = grid.points().collect();
        if camera != twin {
            // The points are compared one by one to find the one that differs; if none does, the
            // digest itself is wrong.
            self.correct(&points)?;
            return Err(self.different(DifferentResult::Digest { camera, twin }));
        }
        self.evidence.by_digest += points.len() as u64;
        let sample: Vec<SensorPoint> = points.iter().step_by(SAMPLE_STEP).copied().collect();
        self.correct(&sample)?;
        self.twin.correct_grid(grid)
    }

    fn evidence(&self) -> Evidence {
        self.evidence
    }

    fn counters(&mut self) -> Result<Option<Counters>, DeviceError> {
        let counters = self.client.counters();
        counters.map(Some).map_err(|error| self.failed(error, 0))
    }
}

impl<P: Port> Device for Remote<P> {
    fn distort(&mut self, ideal: &[SensorPoint]) -> Result<Vec<Corrected>, DeviceError> {
        self.through_both(ideal, Client::distort, InProcess::distort)
    }

    fn mesh(&mut self, row: &VertexRow, format: MeshFormat) -> Result<Vec<u8>, DeviceError> {
        let camera = self.client.mesh(*row, format);
        let camera = camera.map_err(|error| self.failed(error, 0));
        let twin = self.twin.mesh(row, format);
        let (camera, twin) = self.same_outcome(camera, twin)?;
        if camera != twin {
            return Err(self.different(DifferentResult::Mesh { row: *row }));
        }
        Ok(camera)
    }

    fn corrections(&mut self, row: &VertexRow) -> Result<Vec<PixelCorrection>, DeviceError> {
        let camera = self.client.corrections(*row);
        let camera = camera.map_err(|error| self.failed(error, 0));
        let twin = self.twin.corrections(row);
        let (camera, twin) = self.same_outcome(camera, twin)?;
        let bits = |of: &PixelCorrection| [of.cols_px, of.rows_px].map(f32::to_bits);
        if !camera.iter().map(bits).eq(twin.iter().map(bits)) {
            return Err(self.different(DifferentResult::Mesh { row: *row }));
        }
        Ok(camera)
    }
}

/// Returns true if two results are the same bit for bit, NaN and the sign of zero included.
pub(super) fn same_bits<T: Serialize>(a: &T, b: &T) -> bool {
    match (postcard::to_allocvec(a), postcard::to_allocvec(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
