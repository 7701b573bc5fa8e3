//! From the ideal point to the measured one.

use core::fmt;

use super::evaluation_form::Displacement;
use super::frame_correction::{Corrected, FrameCorrection};
use super::sensor::SensorPoint;

/// Most Newton steps. The published calibrations need two.
pub const MAX_STEPS: u8 = 12;

/// The iteration ends after a step of at most this length, nm: half a unit in the last place of a
/// coordinate of 114 mm. The step after it would be below rounding, as Newton's steps shrink
/// quadratically.
pub const LAST_STEP_NM: f32 = 4.0;

/// How far beyond the edge a measured point may come out by rounding alone; it is then put on the
/// edge.
const EDGE_ULPS: f32 = 4.0;

/// No measured point belongs to the ideal one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DistortError {
    /// The measured point would lie off the sensor, at this place.
    OffSensor(SensorPoint),
    /// The last step was still this long after [`MAX_STEPS`] steps, nm; a NaN for an ideal point
    /// that is not finite.
    NotConverged {
        /// Length of the last step, nm.
        step_nm: f32,
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
            Self::NotConverged { step_nm } => write!(
                f,
                "no measured point found: the last of {MAX_STEPS} Newton steps was {step_nm} nm long"
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
    /// [`MAX_STEPS`] steps, ended by a step of at most [`LAST_STEP_NM`]. Iterating the displacement,
    /// not the coordinate, keeps its finer resolution until the one addition at the end. The
    /// calibration has been shown to be one-to-one over the sensor, so that a solution on the
    /// sensor is the only one.
    ///
    /// # Units and frames
    /// Sensor frame, mm. The ideal point may lie off the sensor; the measured one must lie on it,
    /// edges included.
    ///
    /// # Accuracy
    /// `distort(correct(p))` is within two units in the last place of p (of the larger of p and
    /// its ideal point where the distortion carries p across zero; `tests/round_trip.rs`).
    ///
    /// # Errors
    /// [`DistortError`]; never a finite point that does not belong to `ideal`.
    pub fn distort(&self, ideal: SensorPoint) -> Result<Corrected, DistortError> {
        let mut d = self.distortion(ideal);
        let mut step_nm = f32::NAN;
        for _ in 0..MAX_STEPS {
            let step = self.newton_step(ideal, d);
            d = Displacement {
                dx_mm: d.dx_mm - step.dx_mm,
                dy_mm: d.dy_mm - step.dy_mm,
            };
            step_nm = 1e6 * step.dx_mm.abs().max(step.dy_mm.abs());
            if (step.dx_mm + step.dy_mm).is_nan() {
                step_nm = f32::NAN;
                break;
            }
            if step_nm <= LAST_STEP_NM {
                let measured = on_edge(shifted(ideal, d), self.half_width_mm, self.half_height_mm);
                return if measured.x_mm.abs() <= self.half_width_mm
                    && measured.y_mm.abs() <= self.half_height_mm
                {
                    Ok(Corrected {
                        point: measured,
                        distortion: d,
                    })
                } else {
                    Err(DistortError::OffSensor(measured))
                };
            }
        }
        Err(DistortError::NotConverged { step_nm })
    }

    /// `(I - J)⁻¹ (d - D(ideal + d))`; not a number where I - J is singular.
    fn newton_step(&self, ideal: SensorPoint, d: Displacement) -> Displacement {
        let measured = shifted(ideal, d);
        let distortion = self.distortion(measured);
        let j = self.jacobian(measured);
        let residual_x = d.dx_mm - distortion.dx_mm;
        let residual_y = d.dy_mm - distortion.dy_mm;
        let scale_x = 1.0 - j.dx_by_x;
        let scale_y = 1.0 - j.dy_by_y;
        let determinant = scale_x * scale_y - j.dx_by_y * j.dy_by_x;
        Displacement {
            dx_mm: (scale_y * residual_x + j.dx_by_y * residual_y) / determinant,
            dy_mm: (j.dy_by_x * residual_x + scale_x * residual_y) / determinant,
        }
    }
}

fn shifted(point: SensorPoint, by: Displacement) -> SensorPoint {
    SensorPoint::new(point.x_mm + by.dx_mm, point.y_mm + by.dy_mm)
}

/// A point that rounding has put a few units in the last place beyond an edge, put on the edge.
fn on_edge(point: SensorPoint, half_width_mm: f32, half_height_mm: f32) -> SensorPoint {
    let onto = |value: f32, half: f32| {
        let beyond = value.abs() - half;
        if beyond > 0.0 && beyond <= EDGE_ULPS * f32::EPSILON * half {
            half.copysign(value)
        } else {
            value
        }
    };
    SensorPoint::new(
        onto(point.x_mm, half_width_mm),
        onto(point.y_mm, half_height_mm),
    )
}
