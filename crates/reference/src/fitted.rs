//! Five-coefficient model and printed feed-forward terms, in double precision.

use fmc_camera_file::{CameraFile, Per};

use super::exposure::ExposurePath;
use super::lens::Lens;

/// The five-coefficient model of one exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedModel {
    lens: Lens,
    principal_point_mm: [f64; 2],
    axis: [f64; 2],
    radial: f64,
    tangential: f64,
}

impl FittedModel {
    /// Creates the model of an exposure; `None` for a camera without `[fitted]`.
    ///
    /// # Model
    /// Yuan et al. 2012, eq. 22: `K_m0..K_m2` replace K0..K2, and along the FMC axis e the terms
    /// `s·Kd1·(x̄·e)·x̄ + s·Pm1·r²·e` are added, where s is δ, or c̄ for coefficients per mm of c̄.
    #[must_use]
    pub fn new(camera: &CameraFile, path: &ExposurePath) -> Option<Self> {
        let fitted = camera.fitted.as_ref()?;
        let regressor_mm = match fitted.per {
            Per::Travel => path.travel_mm,
            Per::Centroid => path.centroid_mm(),
        };
        let static_lens = Lens::of(camera);
        let [_, _, _, k3] = static_lens.k;
        Some(Self {
            lens: Lens {
                k: [fitted.km0, fitted.km1, fitted.km2, k3],
                ..static_lens
            },
            principal_point_mm: camera.principal_point_mm,
            axis: camera.fmc.axis.unit(),
            radial: fitted.kd1 * regressor_mm,
            tangential: fitted.pm1 * regressor_mm,
        })
    }

    /// Creates the static calibration with the dynamic terms as printed, eqs. 20-21: `K_d1` = 2K1
    /// and `P_m1` = K1. Their sign is wrong; the model is for comparison only.
    #[must_use]
    pub fn printed(camera: &CameraFile, travel_mm: f64) -> Self {
        let lens = Lens::of(camera);
        let [_, k1, _, _] = lens.k;
        Self {
            lens,
            principal_point_mm: camera.principal_point_mm,
            axis: camera.fmc.axis.unit(),
            radial: 2.0 * k1 * travel_mm,
            tangential: k1 * travel_mm,
        }
    }

    /// Returns the distortion at a measured point of the sensor frame, measured - ideal, mm.
    #[must_use]
    pub fn distortion(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [x0, y0] = self.principal_point_mm;
        let [ex, ey] = self.axis;
        let (x, y) = (x - x0, y - y0);
        let along = self.radial * (x * ex + y * ey);
        let decentring = self.tangential * (x * x + y * y);
        let [dx, dy] = self.lens.displacement([x, y]);
        [
            dx + along * x + decentring * ex,
            dy + along * y + decentring * ey,
        ]
    }
}
