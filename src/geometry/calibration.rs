//! The calibration of one camera: as loaded, and validated.

use core::fmt;

use super::brown::Brown;
use super::five_coefficient::FiveCoefficients;
use super::interval::lesser;
use super::invertibility::{Folds, MIN_SCALE, Region, least_scale};
use super::principal_distance::Flatness;
use super::range::{MAX_FOCUS_FRACTION, OutOfRange, Quantity};
use super::sensor::{FmcAxis, Sensor, SensorPoint};

/// Numbers of a calibration certificate and of the mechanism's drawing, not yet validated.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CalibrationParameters {
    /// f, mm.
    pub principal_distance_mm: f32,
    /// L, from the exit pupil to the image, mm; f where it is not known.
    pub exit_pupil_mm: f32,
    /// Calibrated principal point (x0, y0).
    pub principal_point: SensorPoint,
    /// Pixels along x.
    pub width_px: u32,
    /// Pixels along y.
    pub height_px: u32,
    /// Pixel pitch, µm.
    pub pixel_um: f32,
    /// Static distortion, measured - ideal.
    pub distortion: Brown,
    /// Five-coefficient model, once fitted.
    pub fitted: Option<FiveCoefficients>,
    /// Direction in which the principal point moves.
    pub axis: FmcAxis,
    /// Total travel of the principal point, ± half of it about the calibrated position, mm.
    pub stroke_mm: f32,
    /// Out-of-plane run-out of the stage.
    pub flatness: Flatness,
}

/// Total travel of the principal point where none is given, mm.
pub(crate) const DEFAULT_STROKE_MM: f32 = 4.0;

impl CalibrationParameters {
    /// Returns a lens without distortion at `principal_distance_mm` before [columns, rows] of
    /// pixels of `pixel_um`; all other numbers are the defaults of the camera file.
    #[must_use]
    pub const fn new(principal_distance_mm: f32, size_px: [u32; 2], pixel_um: f32) -> Self {
        let [width_px, height_px] = size_px;
        Self {
            principal_distance_mm,
            exit_pupil_mm: principal_distance_mm,
            principal_point: SensorPoint::new(0.0, 0.0),
            width_px,
            height_px,
            pixel_um,
            distortion: Brown::NONE,
            fitted: None,
            axis: FmcAxis::PlusY,
            stroke_mm: DEFAULT_STROKE_MM,
            flatness: Flatness::FLAT,
        }
    }

    /// Returns the pixel array if every number is finite and in its range.
    fn sensor(&self) -> Result<Sensor, OutOfRange> {
        let sensor = Sensor::new(self.width_px, self.height_px, self.pixel_um)?;
        let pp = self.principal_point;
        let (half_width, half_height) = (sensor.half_width_mm(), sensor.half_height_mm());
        Quantity::PrincipalDistanceMm.check(self.principal_distance_mm)?;
        Quantity::ExitPupilMm.check(self.exit_pupil_mm)?;
        Quantity::PrincipalPointX.check_within(pp.x_mm, -half_width, half_width)?;
        Quantity::PrincipalPointY.check_within(pp.y_mm, -half_height, half_height)?;
        Quantity::StrokeMm.check(self.stroke_mm)?;
        self.flatness.check(0.5 * self.stroke_mm)?;
        self.distortion.check()?;
        if let Some(fitted) = &self.fitted {
            fitted.check()?;
        }
        Ok(sensor)
    }

    /// Returns [`Calibration::region`].
    fn region(&self, sensor: &Sensor) -> Region {
        let reach = |half: f32, pp: f32, along: bool| {
            let travel = if along { 0.5 * self.stroke_mm } else { 0.0 };
            (half + pp.abs() + travel) / (1.0 - MAX_FOCUS_FRACTION)
        };
        let pp = self.principal_point;
        let along_x = self.axis.is_x();
        Region {
            reach_x: reach(sensor.half_width_mm(), pp.x_mm, along_x),
            reach_y: reach(sensor.half_height_mm(), pp.y_mm, !along_x),
        }
    }

    /// Returns the lower bound of the scale over a region if a grid adds `added_slope` to the
    /// polynomials.
    fn least_scale(&self, region: Region, added_slope: f32) -> Result<f32, Folding> {
        let lens = self.distortion.evaluation_form();
        let moving = exposure_slope(&self.distortion, region, self.stroke_mm);
        let of_lens = least_scale(&lens, region, moving + added_slope)
            .map_err(|folds| self.folds(Polynomial::Static, folds))?;
        let Some(fitted) = self.fitted else {
            return Ok(of_lens);
        };
        let still = fitted.folded(lens, 0.0, self.axis);
        let radius_mm = region.radius_mm();
        let moving = 2.0 * (fitted.kd1.abs() + fitted.pm1.abs()) * self.stroke_mm * radius_mm;
        let of_fitted = least_scale(&still, region, moving + added_slope)
            .map_err(|folds| self.folds(Polynomial::Fitted, folds))?;
        Ok(lesser(of_lens, of_fitted))
    }

    fn folds(&self, polynomial: Polynomial, folds: Folds) -> Folding {
        let pp = self.principal_point;
        Folding {
            polynomial,
            scale: folds.scale,
            at: SensorPoint::new(pp.x_mm + folds.x, pp.y_mm + folds.y),
        }
    }
}

/// Calibration that has been shown to be usable: finite, in range, one-to-one over the sensor
/// wherever the principal point may be within the stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    parameters: CalibrationParameters,
    sensor: Sensor,
    /// The distance of the corner of [`Self::region`], mm.
    radius_mm: f32,
    least_scale: f32,
}

/// One of the two polynomials of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Polynomial {
    /// The static distortion, with what the exposure and the focus may add to it.
    Static,
    /// The five-coefficient model.
    Fitted,
}

/// A calibration is not usable.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CalibrationError {
    /// A number is not finite or outside its range.
    OutOfRange(OutOfRange),
    /// The polynomial folds the image inside the sensor, or comes close to it.
    Folds {
        /// The polynomial that folds.
        polynomial: Polynomial,
        /// Lower bound of the scale `∂(ideal)/∂(measured)`; [`MIN_SCALE`] is required.
        scale: f32,
        /// Place of the smallest scale.
        at: SensorPoint,
    },
}

impl From<OutOfRange> for CalibrationError {
    fn from(error: OutOfRange) -> Self {
        Self::OutOfRange(error)
    }
}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange(error) => error.fmt(f),
            Self::Folds {
                polynomial,
                scale,
                at,
            } => {
                let which = match polynomial {
                    Polynomial::Static => "the distortion polynomial",
                    Polynomial::Fitted => "the five-coefficient model",
                };
                write!(
                    f,
                    "{which} folds the image or comes too near to it: the scale d(ideal)/d(measured) \
                     may fall to {scale:.3} near ({:.2}, {:.2}) mm; at least {MIN_SCALE} is required \
                     over the sensor enlarged by half the stroke",
                    at.x_mm, at.y_mm
                )
            }
        }
    }
}

impl core::error::Error for CalibrationError {}

impl Calibration {
    /// Validates parameters.
    ///
    /// # Model
    /// Checks that every number is finite and in its range, and that both polynomials are
    /// one-to-one over the sensor enlarged by half the stroke along the FMC axis. The slope that
    /// the focus shift (up to [`MAX_FOCUS_FRACTION`]), the μ₂ terms and the fitted δ terms may add
    /// is included ([`least_scale`]).
    ///
    /// # Errors
    /// [`CalibrationError`], which names the quantity, its value and the allowed range.
    pub fn new(parameters: CalibrationParameters) -> Result<Self, CalibrationError> {
        let sensor = parameters.sensor()?;
        let region = parameters.region(&sensor);
        let least_scale =
            parameters
                .least_scale(region, 0.0)
                .map_err(|folding| CalibrationError::Folds {
                    polynomial: folding.polynomial,
                    scale: folding.scale,
                    at: folding.at,
                })?;
        Ok(Self {
            parameters,
            sensor,
            radius_mm: region.radius_mm(),
            least_scale,
        })
    }

    /// Returns the lower bound of the scale if a grid adds `added_slope` to the polynomials.
    ///
    /// # Errors
    /// [`Folding`] with the polynomial that folds the image with it.
    pub(super) fn least_scale_with(&self, added_slope: f32) -> Result<f32, Folding> {
        self.parameters.least_scale(self.region(), added_slope)
    }

    /// The parameters as they were given.
    #[must_use]
    pub const fn parameters(&self) -> &CalibrationParameters {
        &self.parameters
    }

    /// The pixel array.
    #[must_use]
    pub const fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Lower bound of the scale `∂(ideal)/∂(measured)` over the sensor.
    #[must_use]
    pub const fn least_scale(&self) -> f32 {
        self.least_scale
    }

    /// The distance of the corner of [`Self::region`], mm.
    pub(super) const fn radius_mm(&self) -> f32 {
        self.radius_mm
    }

    /// The sensor enlarged by half the stroke along the FMC axis, and by the largest focus shift,
    /// as seen from the principal point.
    #[must_use]
    pub(crate) fn region(&self) -> Region {
        self.parameters.region(&self.sensor)
    }
}

/// Polynomial that folds the image, with the smallest scale and its place on the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Folding {
    pub(super) polynomial: Polynomial,
    pub(super) scale: f32,
    pub(super) at: SensorPoint,
}

/// Returns the slope that a frame may add to the static polynomial: that of the largest focus shift
/// and of the μ₂ terms of the largest travel (the variance of a path within ±s/2 is at most s²/4).
fn exposure_slope(lens: &Brown, region: Region, stroke_mm: f32) -> f32 {
    let variance = 0.25 * stroke_mm * stroke_mm;
    let radius = region.radius_mm();
    let r2 = radius * radius;
    let moments = variance
        * (5.0 * lens.k1.abs() + r2 * (18.0 * lens.k2.abs() + r2 * (60.0 * lens.k3.abs())));
    MAX_FOCUS_FRACTION / (1.0 - MAX_FOCUS_FRACTION) + moments
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the parameters of a camera of 80 mm x 40 mm and f = 100 mm, whose K1 folds the image
    /// at `radius` mm from the principal point: 3·K1·r² = 1.
    fn folding_at(radius: f32) -> CalibrationParameters {
        let mut parameters = CalibrationParameters::new(100.0, [8000, 4000], 10.0);
        parameters.stroke_mm = 0.1;
        parameters.distortion.k1 = 1.0 / (3.0 * radius * radius);
        parameters
    }

    fn is_usable(parameters: CalibrationParameters) -> bool {
        Calibration::new(parameters).is_ok()
    }

    /// The corner is at 44.7 mm; with a fold at 50 mm the scale there is 0.2.
    #[test]
    fn sensor_is_enlarged_by_half_the_stroke_along_the_axis_alone() {
        assert!(is_usable(folding_at(50.0)));
        for (axis, usable) in [(FmcAxis::PlusX, false), (FmcAxis::MinusX, false)] {
            let parameters = CalibrationParameters {
                stroke_mm: 14.0,
                axis,
                ..folding_at(50.0)
            };
            assert_eq!(is_usable(parameters), usable, "{axis:?}");
        }
        // Along the short side the corner moves out by a third as much.
        let parameters = CalibrationParameters {
            stroke_mm: 6.0,
            axis: FmcAxis::PlusY,
            ..folding_at(51.0)
        };
        assert!(is_usable(parameters));
        assert!(!is_usable(CalibrationParameters {
            axis: FmcAxis::PlusX,
            ..parameters
        }));
    }

    #[test]
    fn principal_point_off_the_centre_brings_a_corner_nearer_to_the_fold() {
        for pp in [SensorPoint::new(6.0, 0.0), SensorPoint::new(0.0, -9.0)] {
            assert!(!is_usable(CalibrationParameters {
                principal_point: pp,
                ..folding_at(50.0)
            }));
        }
    }

    #[test]
    fn what_exposure_and_focus_add_is_part_of_the_proof() {
        let calibration = Calibration::new(folding_at(52.0)).unwrap();
        let region = calibration.region();
        let form = folding_at(52.0).distortion.evaluation_form();
        let alone = least_scale(&form, region, 0.0).unwrap();
        // 1 % of focus shift enlarges by 1.01 %.
        assert!(calibration.least_scale() < alone - 0.009);
        assert!(region.reach_x > 40.0 * 1.01 && region.reach_y > 20.05 * 1.01);
        let mut long_stroke = CalibrationParameters::new(100.0, [800, 400], 10.0);
        long_stroke.stroke_mm = 100.0;
        long_stroke.distortion.k1 = 2e-5;
        let still = CalibrationParameters {
            stroke_mm: 0.1,
            ..long_stroke
        };
        assert!(is_usable(still));
        // μ₂ of up to 2500 mm² would add 5·K1·μ₂ = 0.25 to the slope of 0.15.
        let scale = Calibration::new(long_stroke).unwrap().least_scale();
        assert!(scale < 0.65, "{scale}");
    }

    #[test]
    fn fitted_model_is_judged_with_its_motion() {
        let mut parameters = CalibrationParameters::new(100.0, [8000, 4000], 10.0);
        parameters.fitted = Some(FiveCoefficients::default());
        assert!(is_usable(parameters));
        let refused = |fitted| {
            let parameters = CalibrationParameters {
                fitted: Some(fitted),
                ..parameters
            };
            matches!(
                Calibration::new(parameters),
                Err(CalibrationError::Folds {
                    polynomial: Polynomial::Fitted,
                    ..
                })
            )
        };
        // 2·(Kd1 + Pm1)·δ·r = 2·2.6e-3·4·45 = 0.94.
        let dynamic = FiveCoefficients {
            kd1: 1.3e-3,
            pm1: -1.3e-3,
            ..FiveCoefficients::default()
        };
        assert!(refused(dynamic));
        assert!(refused(FiveCoefficients {
            km1: 2e-4,
            ..FiveCoefficients::default()
        }));
        let strong = FiveCoefficients {
            km1: 5e-5,
            ..FiveCoefficients::default()
        };
        parameters.fitted = Some(strong);
        assert!(Calibration::new(parameters).unwrap().least_scale() < 0.75);
    }
}
