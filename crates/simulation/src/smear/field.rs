//! Smear over the sensor.

use fmc_camera::geometry::image_motion::{ImageMotion, ImageMotionError, View};
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::verification::grid;

use super::term::{Disturbances, Term};
use crate::scene::Scene;
use crate::scene::terrain::Terrain;

/// Height of the simulated flight above the reference plane, m; the smear does not depend on it.
const HEIGHT_M: f64 = 1000.0;

/// The smear at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSmear {
    /// Point, mm of the sensor frame.
    pub point_mm: [f64; 2],
    /// Smear that the camera predicts from first light to last, µm of the sensor frame.
    pub smear_um: [f64; 2],
}

impl PointSmear {
    /// Length of the smear, µm.
    #[must_use]
    pub fn length_um(&self) -> f64 {
        let [x, y] = self.smear_um;
        x.hypot(y)
    }
}

/// The smear of one or of all terms over 21 x 21 points of the sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SmearField {
    /// The term; `None` for all together.
    pub term: Option<Term>,
    /// Smear at every point.
    pub points: Vec<PointSmear>,
    /// Bound that no point of the sensor exceeds, µm.
    pub bound_um: f64,
    /// Largest smear in the simulated exposure through the lens of the camera file, µm.
    pub simulated_max_um: f64,
}

impl SmearField {
    /// Returns the point with the largest smear.
    #[must_use]
    pub fn largest(&self) -> Option<&PointSmear> {
        self.points
            .iter()
            .max_by(|a, b| a.length_um().total_cmp(&b.length_um()))
    }

    /// Returns the mean length over the points, µm.
    #[must_use]
    pub fn mean_um(&self) -> f64 {
        let (sum, count) = self.points.iter().fold((0.0, 0.0), |(sum, count), point| {
            (sum + point.length_um(), count + 1.0)
        });
        sum / f64::max(count, 1.0)
    }
}

/// Request for the smear of an exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct SmearRequest {
    /// True V/H above the reference plane, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
    /// Causes of the image motion.
    pub disturbances: Disturbances,
}

impl SmearRequest {
    /// Returns the smear of every term that is not 0 alone, then of all together.
    ///
    /// # Errors
    /// [`ImageMotionError`] if a corner of the sensor does not see the ground.
    pub fn fields(
        &self,
        camera: &CameraFile,
        view: &View,
    ) -> Result<Vec<SmearField>, ImageMotionError> {
        let mut fields = Vec::new();
        for term in self.disturbances.terms() {
            let alone = self.disturbances.alone(term);
            fields.push(self.field(camera, view, Some(term), &alone)?);
        }
        fields.push(self.field(camera, view, None, &self.disturbances)?);
        Ok(fields)
    }

    fn field(
        &self,
        camera: &CameraFile,
        view: &View,
        term: Option<Term>,
        disturbances: &Disturbances,
    ) -> Result<SmearField, ImageMotionError> {
        let motion = ImageMotion::new(view, &disturbances.flight_state(self.vh_per_s))?;
        let exposure_s = single(self.exposure_s);
        let points: Vec<PointSmear> = grid::points(camera.half_format_mm())
            .points()
            .map(|point: SensorPoint| {
                let smear = motion.smear(point, exposure_s);
                PointSmear {
                    point_mm: [point.x_mm, point.y_mm].map(f64::from),
                    smear_um: [smear.x_um, smear.y_um].map(f64::from),
                }
            })
            .collect();
        Ok(SmearField {
            term,
            bound_um: motion.largest_smear(exposure_s).bound_um.into(),
            simulated_max_um: self.simulated_max_um(camera, disturbances),
            points,
        })
    }

    /// Returns the largest smear, µm, that the lens of the camera file leaves without any
    /// disturbance: δ times the gradient of its distortion along the FMC axis.
    #[must_use]
    pub fn lens_alone_um(&self, camera: &CameraFile) -> f64 {
        self.simulated_max_um(camera, &Disturbances::default())
    }

    /// Creates the scene of the disturbances: a stage that is flat and smooth, and the lens of the
    /// camera file.
    #[must_use]
    pub fn scene(&self, camera: &CameraFile, disturbances: &Disturbances) -> Scene {
        let told = disturbances.told_vh_per_s(self.vh_per_s);
        let request = ExposureRequest::planned(told, self.exposure_s);
        let mut scene = Scene::still(camera, &request, HEIGHT_M);
        scene.stage.rows = None;
        scene.stage.flatness_um = Vec::new();
        let value = |term| disturbances.value(term);
        let (sin, cos) = value(Term::Drift).to_radians().sin_cos();
        let speed_m_s = self.vh_per_s * HEIGHT_M;
        scene.trajectory.velocity_m_s = [speed_m_s * sin, speed_m_s * cos, 0.0];
        scene.terrain = Terrain::Plane {
            height_m: HEIGHT_M * value(Term::Relief) / 100.0,
        };
        scene.attitude.pitch_deg = value(Term::Pitch);
        scene.attitude.roll_deg = value(Term::Roll);
        scene.attitude.rates_deg_s = [Term::PitchRate, Term::RollRate, Term::YawRate].map(value);
        scene.attitude.reference_s = scene.expose(0.0).centroid_s();
        scene
    }

    fn simulated_max_um(&self, camera: &CameraFile, disturbances: &Disturbances) -> f64 {
        let scene = self.scene(camera, disturbances);
        let frame = scene.expose(0.0);
        grid::points(camera.half_format_mm())
            .points()
            .filter_map(|point| {
                let ground = frame.ground_point([point.x_mm, point.y_mm].map(f64::from))?;
                let [first_x, first_y] = frame.place_at(ground, 0.0)?;
                let [last_x, last_y] = frame.place_at(ground, self.exposure_s)?;
                Some(1e3 * (last_x - first_x).hypot(last_y - first_y))
            })
            .fold(0.0, f64::max)
    }
}
