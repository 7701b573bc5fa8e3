//! Simulation of a sweep.

use fmc_adjustment::calibration::measurement::known_lens;
use fmc_camera::flight::camera::{Camera, Frame, FrameError};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::calibration::CalibrationError;
use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::range::OutOfRange;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, MechanismName, Per};
use fmc_reference::exposure::{ExposurePath, ExposureRequest, FocusFormula};
use fmc_reference::lens::Lens;
use fmc_reference::strict::StrictSolver;
use fmc_reference::verification::grid::{self, GridExposure};

use super::options::{Case, SweepOptions};
use super::result::{CaseResult, FrameFit, ModelResiduals, Sweep};
use crate::noise::Noise;

/// Standard deviation that the observations are given, so that σ0 is in µm.
const UNIT_MM: f64 = 1e-3;

/// Error of a sweep.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SweepError {
    /// The camera's calibration is not valid.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The camera refuses an exposure of the grid.
    #[error("V/H {} 1/s, {} s: {error}", exposure.vh_per_s, exposure.exposure_s)]
    Frame {
        /// The exposure.
        exposure: GridExposure,
        /// The refusal.
        error: FrameError,
    },
    /// A simulated distortion is outside of its allowed range.
    #[error("simulated observation: {0}")]
    Observation(#[from] OutOfRange),
}

/// Returns the number of exposures that [`Plan::sweep`] simulates.
#[must_use]
pub fn steps() -> usize {
    Case::ALL.len() * grid::of_the_paper(None).len()
}

/// A sweep that the camera accepts, with the data that all cases share.
#[derive(Debug, Clone)]
pub struct Plan<'a> {
    camera: &'a CameraFile,
    options: SweepOptions,
    exposures: Vec<PlannedExposure>,
    points: Vec<SensorPoint>,
    /// Deviates with standard deviation 1, exposure by exposure.
    noise: Vec<[f64; 2]>,
    lens: KnownLens<f64>,
}

/// An exposure that the camera accepts.
#[derive(Debug, Clone)]
struct PlannedExposure {
    exposure: GridExposure,
    path: ExposurePath,
    regressor_mm: f64,
    /// Exposure mean of Δz with the run-out, mm.
    focus_shift_mm: f64,
}

impl<'a> Plan<'a> {
    /// Checks every exposure.
    ///
    /// # Errors
    /// [`SweepError`] that names the exposure the camera refuses.
    pub fn new(camera: &'a CameraFile, options: SweepOptions) -> Result<Self, SweepError> {
        let checked = Camera::new(camera.parameters())?;
        let strategy = match camera.fmc.mechanism {
            MechanismName::Tdi => None,
            MechanismName::Stage => Some(camera.fmc.strategy.unwrap_or_default()),
        };
        let exposures = grid::of_the_paper(strategy)
            .into_iter()
            .map(|exposure| {
                let request = ExposureRequest::planned(exposure.vh_per_s, exposure.exposure_s);
                let frame = frame(&checked, exposure, &request, &options)?;
                let path = ExposurePath::new(camera, &request);
                Ok(PlannedExposure {
                    exposure,
                    regressor_mm: match options.regressor {
                        Per::Travel => path.travel_mm,
                        Per::Centroid => path.centroid_mm(),
                    },
                    focus_shift_mm: options.focus_shift_mm
                        + f64::from(frame.interior.focus_shift_mm),
                    path,
                })
            })
            .collect::<Result<Vec<_>, SweepError>>()?;
        // The camera must accept the exposures with their focus shift, too.
        for planned in &exposures {
            let request = request(planned.exposure, options.focus_shift_mm, &options);
            frame(&checked, planned.exposure, &request, &options)?;
        }
        let points: Vec<SensorPoint> = grid::points(camera.half_format_mm()).points().collect();
        // The noise is the same for every case, so that cases can be compared.
        let mut source = Noise::new(options.seed, 0);
        let noise = (0..exposures.len() * points.len())
            .map(|_| source.next([1.0; 2]))
            .collect();
        Ok(Self {
            camera,
            options,
            lens: known_lens(camera),
            exposures,
            points,
            noise,
        })
    }

    /// Returns K0 with the enlargement by the focus shift, if that is the same in all exposures and
    /// follows from the geometry.
    fn true_km0(&self) -> Option<f64> {
        let is_flat = self.camera.fmc.flatness_um.iter().all(|um| um.abs() <= 0.0);
        let is_physical = self.options.focus_formula == FocusFormula::Physical;
        let enlargement = self.options.focus_shift_mm / self.camera.exit_pupil_mm();
        (is_flat && is_physical).then_some(self.lens.k[0] + enlargement)
    }

    /// Simulates and adjusts all cases; `after_frame` is called after every exposure of each.
    ///
    /// # Errors
    /// [`SweepError`] for an observation that is outside of its allowed range.
    pub fn sweep(&self, mut after_frame: impl FnMut()) -> Result<Sweep, SweepError> {
        let [both, focus, motion] = Case::ALL;
        let mut run = |case| self.run(case, &mut after_frame);
        Ok(Sweep {
            camera: self.camera.name.clone(),
            principal_distance_mm: self.camera.principal_distance_mm,
            k1: self.lens.k[1],
            k2: self.lens.k[2],
            true_km0: self.true_km0(),
            strategy: match self.camera.fmc.mechanism {
                MechanismName::Tdi => "tdi",
                MechanismName::Stage => self.camera.fmc.strategy.unwrap_or_default().name(),
            },
            options: self.options,
            points_per_frame: u32::try_from(self.points.len()).unwrap_or(0),
            cases: [run(both)?, run(focus)?, run(motion)?],
        })
    }

    fn run(&self, case: Case, after_frame: &mut impl FnMut()) -> Result<CaseResult, SweepError> {
        let camera = simulated_camera(self.camera, case);
        let checked = Camera::new(camera.parameters())?;
        let static_lens = Lens::of(&camera);
        let mut whole = Adjustment::new(self.lens, self.fit_options(StaticDecentring::Hold));
        let mut noise_free = whole;
        let mut fixed = ModelResiduals::default();
        let mut exact = ModelResiduals::default();
        let mut frames = Vec::with_capacity(self.exposures.len());
        let noise = self.noise.chunks(self.points.len().max(1));
        for (planned, noise) in self.exposures.iter().zip(noise) {
            let (exposure, focus_shift_mm) = match case {
                Case::Both => (planned.exposure, self.options.focus_shift_mm),
                Case::FocusAlone => (still(planned.exposure), planned.focus_shift_mm),
                Case::MotionAlone => (planned.exposure, 0.0),
            };
            let request = request(exposure, focus_shift_mm, &self.options);
            let solver = StrictSolver::new(&camera, &request, self.options.weight);
            let answer = frame(&checked, exposure, &request, &self.options)?;
            let mut alone = Adjustment::new(self.lens, self.fit_options(StaticDecentring::Known));
            for (point, noise) in self.points.iter().zip(noise) {
                let point_mm = [point.x_mm, point.y_mm].map(f64::from);
                let truth = solver.total(point_mm, self.options.reading).distortion_mm;
                let observed = sum(truth, noise.map(|part| part * self.options.noise_mm));
                let observation = |[dx_mm, dy_mm]: [f64; 2]| Observation {
                    x_mm: point_mm[0],
                    y_mm: point_mm[1],
                    dx_mm,
                    dy_mm,
                    regressor_mm: planned.regressor_mm,
                    sigma_mm: UNIT_MM,
                };
                whole.observe(observation(observed))?;
                alone.observe(observation(observed))?;
                noise_free.observe(observation(truth))?;
                let by_camera = answer.correction.distortion(*point);
                let [x0, y0] = camera.principal_point_mm;
                let [x, y] = point_mm;
                for (model, computed) in [
                    (&mut fixed, static_lens.displacement([x - x0, y - y0])),
                    (
                        &mut exact,
                        [by_camera.dx_mm, by_camera.dy_mm].map(f64::from),
                    ),
                ] {
                    model.noisy.add(difference(observed, computed));
                    model.noise_free.add(difference(truth, computed));
                }
            }
            frames.push(FrameFit {
                exposure: planned.exposure,
                travel_mm: planned.path.travel_mm,
                centroid_mm: planned.path.centroid_mm(),
                regressor_mm: planned.regressor_mm,
                fit: alone.fit(),
            });
            after_frame();
        }
        Ok(CaseResult {
            case,
            frames,
            whole: whole.fit(),
            noise_free: noise_free.fit(),
            fixed,
            exact,
        })
    }

    /// Returns the options of a fit. One exposure cannot separate a static decentring from the
    /// dynamic terms and takes that of the calibration; all exposures together must be able to.
    fn fit_options(&self, decentring: StaticDecentring) -> FitOptions {
        FitOptions {
            regressor: self.options.regressor.into(),
            tied: self.options.tied,
            decentring,
        }
    }
}

/// Returns the camera whose distortions a case simulates.
fn simulated_camera(camera: &CameraFile, case: Case) -> CameraFile {
    let mut camera = camera.clone();
    if case != Case::Both {
        camera.fmc.flatness_um = vec![0.0];
    }
    if case == Case::FocusAlone {
        camera.limits.vh_per_s[0] = 0.0;
    }
    camera
}

/// Returns the same exposure over ground that does not move.
const fn still(exposure: GridExposure) -> GridExposure {
    GridExposure {
        vh_per_s: 0.0,
        ..exposure
    }
}

const fn request(
    exposure: GridExposure,
    focus_shift_mm: f64,
    options: &SweepOptions,
) -> ExposureRequest {
    ExposureRequest {
        focus_shift_mm,
        focus_formula: options.focus_formula,
        ..ExposureRequest::planned(exposure.vh_per_s, exposure.exposure_s)
    }
}

/// Asks the camera for its frame of an exposure.
fn frame(
    camera: &Camera,
    exposure: GridExposure,
    request: &ExposureRequest,
    options: &SweepOptions,
) -> Result<Frame, SweepError> {
    let asked = Exposure {
        focus_shift_um: single(1e3 * request.focus_shift_mm),
        focus_sign: match options.focus_formula {
            FocusFormula::Physical => FocusSign::Physical,
            FocusFormula::Printed => FocusSign::Printed,
        },
        ..Exposure::new(single(request.vh_per_s), single(request.exposure_s))
    };
    camera
        .frame(&asked)
        .map_err(|error| SweepError::Frame { exposure, error })
}

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}

fn difference([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax - bx, ay - by]
}
