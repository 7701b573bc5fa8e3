//! From the ideal point to the measured one.

use core::fmt;

use super::evaluation_form::{Displacement, Jacobian};
use super::frame_correction::{Corrected, FrameCorrection};
use super::sensor::SensorPoint;

/// Most Newton steps.
pub const MAX_STEPS: u8 = 12;

/// The step taken from a residual of at most this length, nm, is the last one: Newton's steps
/// shrink quadratically, and the next would be far below rounding.
pub const LAST_RESIDUAL_NM: f32 = 20.0;

/// No measured point belongs to the ideal one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub enum DistortError {
    /// The measured point lies off the sensor as far as Newton's method leads: at this place.
    OffSensor(SensorPoint),
    /// The residual was still this long after [`MAX_STEPS`] steps, nm; a NaN for an ideal point
    /// that is not finite.
    NotConverged {
        /// Length of the residual, nm.
        residual_nm: f32,
    },
}

impl fmt::Display for DistortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OffSensor(point) => write!(
                f,
                "its measured point ({:.4}, {:.4}) mm is off the sensor",
                point.x_mm, point.y_mm
            ),
            Self::NotConverged { residual_nm } => write!(
                f,
                "no measured point found: {residual_nm} nm are left after {MAX_STEPS} Newton steps"
            ),
        }
    }
}

impl core::error::Error for DistortError {}

impl FrameCorrection {
    /// The measured point of an ideal one: the inverse of [`Self::correct`].
    ///
    /// # Model
    /// Newton's method on the displacement d: `d - D(ideal + d) = 0`, from `d = D(ideal)`, at most
    /// [`MAX_STEPS`] steps, the last from a residual of at most [`LAST_RESIDUAL_NM`]. Iterating the
    /// displacement, not the coordinate, keeps its finer resolution until the one addition at the
    /// end. The calibration has been shown to be one-to-one over the sensor, so that a solution on
    /// the sensor is the only one.
    ///
    /// # Units and frames
    /// Sensor frame, mm. The ideal point may lie off the sensor; the measured one must lie on it,
    /// edges included.
    ///
    /// # Accuracy
    /// `distort(correct(p))` is within two units in the last place of p, or of its ideal point
    /// where that is larger, divided by the scale `∂(ideal)/∂(measured)` where that is below 0.7,
    /// and within 0.02 nm where all this is less (`tests/geometry/round_trip.rs`).
    ///
    /// # Errors
    /// [`DistortError`]; never a finite point that does not belong to `ideal`. A lens of tens of
    /// per cent of distortion may hold Newton's method at an edge or cycling: then an error, though
    /// there is a measured point.
    pub fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        // Every iterate stays on the sensor, where the map is one-to-one: beyond it the polynomial
        // may have other roots.
        let mut d = self.on_sensor(ideal, self.distortion(self.clamped(ideal)));
        let mut residual_nm = f32::NAN;
        for _ in 0..MAX_STEPS {
            let measured = shifted(ideal, d);
            let distortion = self.distortion(measured);
            let residual = Displacement {
                dx_mm: d.dx_mm - distortion.dx_mm,
                dy_mm: d.dy_mm - distortion.dy_mm,
            };
            let step = newton_step(self.jacobian(measured), residual);
            let next = Displacement {
                dx_mm: d.dx_mm - step.dx_mm,
                dy_mm: d.dy_mm - step.dy_mm,
            };
            residual_nm = 1e6 * (residual.dx_mm.abs() + residual.dy_mm.abs());
            if !(next.dx_mm + next.dy_mm).is_finite() {
                break;
            }
            let point = shifted(ideal, next);
            if residual_nm <= LAST_RESIDUAL_NM {
                return if self.contains(point) {
                    Ok(Corrected {
                        point,
                        distortion: next,
                    })
                } else {
                    Err(DistortError::OffSensor(point))
                };
            }
            let kept = self.on_sensor(ideal, next);
            if kept == d {
                // The edge holds it back: the measured point is beyond.
                return Err(DistortError::OffSensor(point));
            }
            d = kept;
        }
        Err(DistortError::NotConverged { residual_nm })
    }

    /// The displacement cut where it would leave the sensor.
    fn on_sensor(&self, ideal: SensorPoint, d: Displacement) -> Displacement {
        let point = shifted(ideal, d);
        let clamped = self.clamped(point);
        let cut = |d: f32, point: f32, clamped: f32| {
            let beyond = point - clamped;
            if beyond.abs() > 0.0 { d - beyond } else { d }
        };
        Displacement {
            dx_mm: cut(d.dx_mm, point.x_mm, clamped.x_mm),
            dy_mm: cut(d.dy_mm, point.y_mm, clamped.y_mm),
        }
    }
}

/// `(I - J)⁻¹` times the residual; not finite where I - J is singular.
fn newton_step(j: Jacobian, residual: Displacement) -> Displacement {
    let scale_x = 1.0 - j.dx_by_x;
    let scale_y = 1.0 - j.dy_by_y;
    let determinant = scale_x * scale_y - j.dx_by_y * j.dy_by_x;
    Displacement {
        dx_mm: (scale_y * residual.dx_mm + j.dx_by_y * residual.dy_mm) / determinant,
        dy_mm: (j.dy_by_x * residual.dx_mm + scale_x * residual.dy_mm) / determinant,
    }
}

fn shifted(point: SensorPoint, by: Displacement) -> SensorPoint {
    SensorPoint::new(point.x_mm + by.dx_mm, point.y_mm + by.dy_mm)
}
