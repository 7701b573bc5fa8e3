//! Space resection of every frame, with self-calibration over all frames: a network of images that
//! share no unknown point.

use nalgebra::Vector2;

use crate::bundle::cofactors::Cofactors;
use crate::bundle::error::{BundleError, MOST_ITERATIONS};
use crate::bundle::image::{NetworkImage, ObservedPose};
use crate::bundle::interior::Interior;
use crate::bundle::layout::Layout;
use crate::bundle::network::{ImagePoint, Network, ObjectPoint, PointRole};
use crate::bundle::normals::Normals;
use crate::bundle::parameters::{Parameter, SharedValues};
use crate::bundle::pose::Pose;
use crate::bundle::solution::{DatumChoice, Solution, adjust_watched};
use crate::bundle::state::State;
use crate::correction::COEFFICIENTS;
use crate::exterior_orientation::{ELEMENTS, ExteriorOrientation};
use crate::frame_observation::{FrameObservations, PointSigmas};
use crate::linear::element::element;
use crate::separability::{self, Inseparable};

/// An adjustment problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjustment {
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Standard deviations, which determine the weights.
    pub sigmas: PointSigmas,
    /// `true` for the coefficients that are estimated.
    pub estimated: [bool; COEFFICIENTS],
    /// Initial values of the coefficients, as [`CorrectedPoint`](crate::correction::CorrectedPoint)
    /// counts them; those not estimated keep them.
    pub initial: [f64; COEFFICIENTS],
    /// Observations of the frames.
    pub frames: Vec<FrameObservations>,
}

/// The result of an adjustment.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjusted {
    /// Exterior orientations.
    pub orientations: Vec<ExteriorOrientation>,
    /// Standard deviations of the elements of the orientations, m and rad, for σ0 = 1.
    pub orientation_sigmas: Vec<[f64; ELEMENTS]>,
    /// Coefficients, as [`CorrectedPoint`](crate::correction::CorrectedPoint) counts them.
    pub coefficients: [f64; COEFFICIENTS],
    /// Standard deviations of the coefficients for σ0 = 1; zero for one that is not estimated.
    pub coefficient_sigmas: [f64; COEFFICIENTS],
    /// Root mean square of the image residuals against the surveyed points, Yuan et al. 2012, eq.
    /// 29, before the first and after every iteration, mm.
    pub rms_mm: Vec<f64>,
    /// σ0² = ΣPvv/redundancy.
    pub variance_of_unit_weight: f64,
}

impl Adjusted {
    /// Returns the number of iterations after which the RMS stays within `fraction` of its last
    /// value.
    #[must_use]
    pub fn iterations_to(&self, fraction: f64) -> usize {
        let last = self.rms_mm.last().copied().unwrap_or(0.0);
        self.rms_mm
            .iter()
            .rposition(|rms| (rms - last).abs() > fraction * last)
            .map_or(0, |index| index + 1)
    }
}

/// Error of an adjustment.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AdjustmentError {
    /// The observations cannot separate some unknowns.
    #[error(transparent)]
    Inseparable(#[from] Inseparable),
    /// A control point moved above the lens, or no step lowers the sum of squares.
    #[error("the adjustment does not converge within {MOST_ITERATIONS} iterations")]
    NotConverged,
}

impl From<BundleError> for AdjustmentError {
    fn from(error: BundleError) -> Self {
        match error {
            BundleError::Inseparable { unknowns } => Inseparable { unknowns }.into(),
            _ => Self::NotConverged,
        }
    }
}

impl Adjustment {
    /// Solves with the engine of the [bundle](crate::bundle), from the observed orientations.
    ///
    /// # Model
    /// Image observations: `corrected point - (distortion by the coefficients) - collinearity = v`;
    /// ground points: `surveyed - adjusted = v`; orientations: `observed - element = v`. A ground
    /// point that several frames show has the same error in all of them; here it is another point
    /// in each, as in a resection frame by frame: exterior orientations are not affected, but the
    /// standard deviations of the coefficients come out somewhat small.
    ///
    /// # Errors
    /// [`AdjustmentError`], which names the unknowns that the observations cannot separate.
    pub fn solve(&self) -> Result<Adjusted, AdjustmentError> {
        let network = self.network();
        let start = State::initial(&network);
        self.check_separability(&network, &start)?;
        let mut rms_mm = vec![self.rms_mm(&start).ok_or(AdjustmentError::NotConverged)?];
        let mut is_below = true;
        let solution = adjust_watched(&network, DatumChoice::Held, &start, |state| {
            match self.rms_mm(state) {
                Some(rms) => rms_mm.push(rms),
                None => is_below = false,
            }
        })?;
        if is_below {
            self.adjusted(&network, &solution, rms_mm)
        } else {
            Err(AdjustmentError::NotConverged)
        }
    }

    /// Returns the frames as a network: their corrected points are those of an interior orientation
    /// without distortion, the coefficients additional parameters.
    fn network(&self) -> Network {
        let mut network = Network {
            images: Vec::new(),
            points: Vec::new(),
            image_points: Vec::new(),
            additional: Vec::new(),
            scale_bars: Vec::new(),
            strips: Vec::new(),
            parameters: SharedValues {
                additional: self.initial,
                ..SharedValues::new(self.interior(), 0)
            },
            estimated: (0..COEFFICIENTS)
                .zip(self.estimated)
                .filter_map(|(number, is_free)| is_free.then_some(Parameter::Additional(number)))
                .collect(),
            priors: Vec::new(),
        };
        for (image, frame) in self.frames.iter().enumerate() {
            let pose = Pose::from(frame.pos.orientation);
            network.images.push(NetworkImage {
                name: (image + 1).to_string(),
                pose,
                observed: Some(ObservedPose {
                    pose,
                    sigmas: frame.pos.sigmas,
                    velocity_m_s: None,
                    strip: None,
                }),
                stage: None,
            });
            for control in &frame.control {
                let point = network.points.len();
                network.image_points.push(ImagePoint {
                    image,
                    point,
                    measured_mm: control.corrected.point_mm,
                    by_grids_mm: [0.0; 2],
                    sigma_mm: self.sigmas.image_mm,
                    additional: u32::try_from(point).ok(),
                    accepted: true,
                });
                network.additional.push(control.corrected.columns);
                network.points.push(ObjectPoint {
                    name: (point + 1).to_string(),
                    given_m: control.ground_m.into(),
                    sigmas_m: [Some(self.sigmas.ground_m); 3],
                    role: PointRole::Control,
                });
            }
        }
        network
    }

    const fn interior(&self) -> Interior {
        Interior {
            principal_distance_mm: self.principal_distance_mm,
            principal_point_mm: [0.0; 2],
            k: [0.0; 4],
            p: [0.0; 2],
            b: [0.0; 2],
        }
    }

    /// Checks what the observations can separate, before the first iteration.
    fn check_separability(&self, network: &Network, start: &State) -> Result<(), AdjustmentError> {
        let normals = |network: &Network| {
            let layout = Layout::new(network)?;
            Normals::new(network, &layout, start, 0.0)
        };
        let mut by_image = network.clone();
        for image in &mut by_image.images {
            image.observed = None;
        }
        let failed = |_| AdjustmentError::NotConverged;
        let by_image = normals(&by_image).map_err(failed)?;
        let all = normals(network).map_err(failed)?;
        separability::check(&by_image.matrix, &all.matrix, self.estimated, &start.poses)?;
        Ok(())
    }

    fn adjusted(
        &self,
        network: &Network,
        solution: &Solution,
        rms_mm: Vec<f64>,
    ) -> Result<Adjusted, AdjustmentError> {
        let failed = || AdjustmentError::NotConverged;
        let cofactors = Cofactors::of(network, solution).map_err(|_| failed())?;
        let images = cofactors.images.as_ref().ok_or_else(failed)?;
        let root = |variance: f64| variance.max(0.0).sqrt();
        let mut coefficient_sigmas = [0.0; COEFFICIENTS];
        for (number, sigma) in coefficient_sigmas.iter_mut().enumerate() {
            if let Some(column) = solution.layout.column(Parameter::Additional(number)) {
                *sigma = root(element(&cofactors.border, column, column));
            }
        }
        let orientation_sigmas = solution
            .state
            .poses
            .iter()
            .enumerate()
            .map(|(image, pose)| {
                let by_rotation = pose.angles_by_rotation()?;
                let own = images.block(image, image);
                let rotation = own.fixed_view::<3, 3>(3, 3);
                let attitude = (by_rotation * rotation * by_rotation.transpose()).diagonal();
                let position = own.fixed_view::<3, 3>(0, 0).diagonal();
                let [[x, y, z], [pitch, roll, yaw]] =
                    [position, attitude].map(|part| part.data.0[0]);
                Some([x, y, z, pitch, roll, yaw].map(root))
            });
        Ok(Adjusted {
            orientations: self.orientations(&solution.state),
            orientation_sigmas: orientation_sigmas
                .collect::<Option<_>>()
                .ok_or_else(failed)?,
            coefficients: solution.state.parameters.additional,
            coefficient_sigmas,
            rms_mm,
            variance_of_unit_weight: solution.sigma0().powi(2),
        })
    }

    /// Returns the adjusted orientations, their angles within half a turn of the observed ones.
    fn orientations(&self, state: &State) -> Vec<ExteriorOrientation> {
        let frames = self.frames.iter().zip(&state.poses);
        frames
            .map(|(frame, pose)| {
                let mut orientation = pose.orientation();
                let observed = frame.pos.orientation.attitude;
                for (angle, observed) in orientation.attitude.iter_mut().zip(observed) {
                    let turn = std::f64::consts::TAU;
                    *angle += turn * ((observed - *angle) / turn).round();
                }
                orientation
            })
            .collect()
    }

    /// Returns the RMS of Yuan et al. 2012, eq. 29: image points against the surveyed points.
    fn rms_mm(&self, state: &State) -> Option<f64> {
        let f = self.principal_distance_mm;
        let mut squares = 0.0;
        let mut points = 0.0;
        for (frame, pose) in self.frames.iter().zip(&state.poses) {
            for point in &frame.control {
                let u = pose.in_camera(&point.ground_m.into());
                if u.z >= 0.0 {
                    return None;
                }
                let ideal = Vector2::from(point.corrected.ideal(&state.parameters.additional));
                squares += (ideal + f * u.xy() / u.z).norm_squared();
                points += 1.0;
            }
        }
        Some((squares / points).sqrt())
    }
}
