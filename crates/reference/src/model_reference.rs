//! The model of a frame in double precision: what the camera computes, without its rounding.

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera_file::CameraFile;

use crate::exposure::ExposureRequest;
use crate::fitted::FittedModel;
use crate::lens::Lens;
use crate::residual_splines::ResidualSplines;
use crate::strict::{Reading, StrictMean, StrictSolver, Weight};

/// The model of one exposure, whichever it is.
#[derive(Debug, Clone)]
pub struct ModelReference {
    solver: StrictSolver,
    model: Model,
    splines: ResidualSplines,
    /// e, the FMC axis.
    axis: [f64; 2],
}

#[derive(Debug, Clone)]
enum Model {
    Exact,
    Fitted(FittedModel),
    Static {
        lens: Lens,
        principal_point_mm: [f64; 2],
    },
}

impl ModelReference {
    /// Creates the model of an exposure. The fitted model of a camera without one is the exact one.
    #[must_use]
    pub fn new(
        camera: &CameraFile,
        request: &ExposureRequest,
        model: CorrectionModel,
        weight: Weight,
        splines: ResidualSplines,
    ) -> Self {
        let solver = StrictSolver::new(camera, request, weight).with_splines(splines.clone());
        let model = match (model, FittedModel::new(camera, solver.path())) {
            (CorrectionModel::Fitted, Some(fitted)) => Model::Fitted(fitted),
            (CorrectionModel::Static, _) => Model::Static {
                lens: Lens::of(camera),
                principal_point_mm: camera.principal_point_mm,
            },
            _ => Model::Exact,
        };
        Self {
            solver,
            model,
            splines,
            axis: camera.fmc.axis.unit(),
        }
    }

    /// Returns the distortion of a measured point, averaged over the exposure where the model does.
    ///
    /// # Model
    /// [`StrictSolver::total`]; [`FittedModel::distortion`], whose enlargement is part of the
    /// model, with the grid of the lens at the centroid; or the static calibration.
    ///
    /// # Units and frames
    /// Sensor frame, mm; measured - ideal.
    #[must_use]
    pub fn total(&self, point_mm: [f64; 2], reading: Reading) -> StrictMean {
        let [x, y] = point_mm;
        match &self.model {
            Model::Exact => self.solver.total(point_mm, reading),
            Model::Fitted(fitted) => {
                let centroid_mm = self.solver.path().centroid_mm();
                let [ex, ey] = self.axis;
                let lens_mm = [x - centroid_mm * ex, y - centroid_mm * ey];
                let residual = sum(
                    self.splines.of_lens(lens_mm),
                    self.splines.of_sensor(point_mm),
                );
                exactly(sum(fitted.distortion(point_mm), residual))
            }
            Model::Static {
                lens,
                principal_point_mm: [x0, y0],
            } => {
                let polynomial = lens.displacement([x - x0, y - y0]);
                exactly(sum(polynomial, self.splines.calibrated(point_mm)))
            }
        }
    }
}

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}

const fn exactly(distortion_mm: [f64; 2]) -> StrictMean {
    StrictMean {
        distortion_mm,
        error_mm: 0.0,
    }
}
