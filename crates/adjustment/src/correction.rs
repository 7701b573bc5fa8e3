//! Correction of measured points by each model, linear in the estimated coefficients.

use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_reference::fitted::FittedModel;
use fmc_reference::lens::Lens;

use crate::interior_orientation::InteriorOrientation;
use crate::model::Model;

/// Largest number of coefficients that self-calibration estimates.
pub const COEFFICIENTS: usize = 5;

/// Symbols of the coefficients.
pub const COEFFICIENT_NAMES: [&str; COEFFICIENTS] = ["K_m0", "K_m1", "K_m2", "K_d1", "P_m1"];

/// A measured point after correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectedPoint {
    /// Point from the principal point of the exposure centroid, mm, with all coefficients zero.
    pub point_mm: [f64; 2],
    /// Distortion by each coefficient, coordinates divided by the format radius, mm per mm.
    pub columns: [[f64; 2]; COEFFICIENTS],
}

impl CorrectedPoint {
    /// Returns the ideal point with the given coefficients, from the principal point of the
    /// exposure centroid, mm.
    #[must_use]
    pub fn ideal(&self, coefficients: &[f64; COEFFICIENTS]) -> [f64; 2] {
        self.columns
            .iter()
            .zip(coefficients)
            .fold(self.point_mm, |[x, y], ([dx, dy], coefficient)| {
                [x - coefficient * dx, y - coefficient * dy]
            })
    }
}

/// Corrections of one exposure.
#[derive(Debug, Clone, Copy)]
pub struct Corrections {
    interior: InteriorOrientation,
    lens: Lens,
    printed: FittedModel,
    exact: FrameCorrection,
    enlargement: f64,
}

impl Corrections {
    /// Creates the corrections of an exposure: the static calibration, eqs. 20-21, the camera's own
    /// frame, and the enlargement κ by the focus shift that the camera is told.
    #[must_use]
    pub const fn new(
        interior: InteriorOrientation,
        lens: Lens,
        printed: FittedModel,
        exact: FrameCorrection,
        enlargement: f64,
    ) -> Self {
        Self {
            interior,
            lens,
            printed,
            exact,
            enlargement,
        }
    }

    /// Interior orientation of the exposure.
    #[must_use]
    pub const fn interior(&self) -> &InteriorOrientation {
        &self.interior
    }

    /// Corrects a measured point of the sensor frame, mm, by a model.
    #[must_use]
    pub fn correct(&self, model: Model, measured_mm: [f64; 2]) -> CorrectedPoint {
        let [x, y] = measured_mm;
        let [x0, y0] = self.interior.calibrated_point_mm;
        let about_calibrated = [x - x0, y - y0];
        let [dx, dy] = match model {
            Model::Uncorrected => [0.0, 0.0],
            Model::Static | Model::Scale | Model::FiveCoefficient => {
                self.lens.displacement(about_calibrated)
            }
            Model::Focus => self.enlarged(about_calibrated),
            Model::Printed => self.printed.distortion(measured_mm),
            // The camera's own correction, in single precision.
            Model::Exact => {
                let answer = self
                    .exact
                    .distortion(SensorPoint::new(single(x), single(y)));
                [f64::from(answer.dx_mm), f64::from(answer.dy_mm)]
            }
        };
        let columns = if model.coefficients() > 0 {
            self.columns(about_calibrated)
        } else {
            [[0.0; 2]; COEFFICIENTS]
        };
        CorrectedPoint {
            point_mm: self.interior.about_centroid([x - dx, y - dy]),
            columns,
        }
    }

    /// Returns the static distortion of an image enlarged by 1 + κ: `κr/(1+κ) + D(r/(1+κ))`.
    fn enlarged(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let shrink = 1.0 / (1.0 + self.enlargement);
        let (x, y) = (shrink * x, shrink * y);
        let [dx, dy] = self.lens.displacement([x, y]);
        [self.enlargement * x + dx, self.enlargement * y + dy]
    }

    /// Returns the terms of Yuan et al. 2012, eq. 22, in coordinates (u, w) from the calibrated
    /// principal point divided by the format radius, q = u² + w²: `(u, w)`, `(u, w)q`, `(u, w)q²`,
    /// `(u, w)((u, w)·e)`, `q·e`.
    fn columns(&self, [x, y]: [f64; 2]) -> [[f64; 2]; COEFFICIENTS] {
        let radius = self.interior.radius_mm();
        let (u, w) = (x / radius, y / radius);
        let [ex, ey] = self.interior.axis;
        let square = u * u + w * w;
        let along = u * ex + w * ey;
        [
            [u, w],
            [u * square, w * square],
            [u * square * square, w * square * square],
            [along * u, along * w],
            [square * ex, square * ey],
        ]
    }

    /// Returns the factors by which coefficients in powers of mm become those of
    /// [`CorrectedPoint`].
    #[must_use]
    pub fn scales(&self) -> [f64; COEFFICIENTS] {
        let radius = self.interior.radius_mm();
        let dynamic = self.interior.travel_mm * radius.powi(2);
        [radius, radius.powi(3), radius.powi(5), dynamic, dynamic]
    }

    /// Returns the values of the five coefficients before the adjustment, as [`CorrectedPoint`]
    /// counts them.
    ///
    /// # Model
    /// The corrected linear terms: `K_d1 = -2K1·c̄/δ`, `P_m1 = -K1·c̄/δ`; those of K0 to K2 are
    /// counted from the static calibration and start at zero.
    #[must_use]
    pub fn initial(&self, model: Model) -> [f64; COEFFICIENTS] {
        let [_, k1, _, _] = self.lens.k;
        let dynamic = -k1 * self.interior.centroid_mm * self.interior.radius_mm().powi(2);
        match model {
            Model::FiveCoefficient => [0.0, 0.0, 0.0, 2.0 * dynamic, dynamic],
            _ => [0.0; COEFFICIENTS],
        }
    }

    /// Converts coefficients into powers of mm, as the camera file's table `fitted` has them:
    /// `K_m0` to `K_m2` replace K0 to K2.
    #[must_use]
    pub fn in_mm(&self, normalised: &[f64; COEFFICIENTS]) -> [f64; COEFFICIENTS] {
        let [k0, k1, k2, _] = self.lens.k;
        let mut coefficients = [k0, k1, k2, 0.0, 0.0];
        for ((coefficient, value), scale) in
            coefficients.iter_mut().zip(normalised).zip(self.scales())
        {
            *coefficient += value / scale;
        }
        coefficients
    }
}
