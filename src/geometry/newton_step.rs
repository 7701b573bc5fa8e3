//! One step of Newton's method towards the measured point, and how far it may be the last.

use super::calibration::Calibration;
use super::evaluation_form::{Displacement, EvaluationForm};
use super::sensor::SensorPoint;

/// What one Newton step may leave of the displacement where `distort` takes no other, nm: a
/// fifth of the rounding of the distortion.
pub const LEFT_BY_ONE_STEP_NM: f32 = 0.01;

/// Longest last step, as a fraction of half the shorter side of the sensor: nearer to the edge
/// than the calibration has been shown to be one-to-one beyond it.
pub const MAX_LAST_STEP_FRACTION: f32 = 1e-3;

/// The square of the longest step that may be the last towards a point of the sensor, mm².
///
/// # Model
/// Newton and Kantorovich: after a step of length η from where (I - J)⁻¹ is no larger than 1/m and, around,
/// J changes by no more than C per mm, the solution is no farther than hη with `h = Cη/m ≤ 1/2`. Hence
/// `η² ≤ m·e/C` for an error e of [`LEFT_BY_ONE_STEP_NM`]. m is the least scale of the calibration. As the second
/// derivative of `(X, Y)·Rⁿ` is no larger than `2n(2n+1)r²ⁿ⁻¹`, on a disc of radius r
/// `C = 6|k₁|r + 20|k₂|r³ + 42|k₃|r⁵ + 2(|hx| + |hy| + |gx| + |gy|)`.
pub(super) fn longest_last_step2(
    calibration: &Calibration,
    form: &EvaluationForm,
    centre: SensorPoint,
) -> f32 {
    let sensor = calibration.sensor();
    let (half_width, half_height) = (sensor.half_width_mm(), sensor.half_height_mm());
    let radius = longer_than_diagonal(
        half_width + centre.x_mm.abs(),
        half_height + centre.y_mm.abs(),
    );
    let r2 = radius * radius;
    let radial =
        radius * (6.0 * form.k1.abs() + r2 * (20.0 * form.k2.abs() + r2 * (42.0 * form.k3.abs())));
    let decentring = form.hx.abs() + form.hy.abs() + form.gx.abs() + form.gy.abs();
    let curvature = radial + 2.0 * decentring;
    let longest = MAX_LAST_STEP_FRACTION * half_width.min(half_height);
    (1e-6 * LEFT_BY_ONE_STEP_NM * calibration.least_scale().min(1.0) / curvature)
        .min(longest * longest)
}

/// At least the diagonal of a rectangle, at most 8 % more, without a root.
fn longer_than_diagonal(width: f32, height: f32) -> f32 {
    width.max(height) + (core::f32::consts::SQRT_2 - 1.0) * width.min(height)
}

/// What displacement and derivatives have in common at a point.
struct Local {
    r2: f32,
    gain: f32,
    /// 2G'(R) of the radial terms.
    slope2: f32,
}

impl EvaluationForm {
    /// Newton's step from `start` to the displacement of the ideal point (`x`, `y`), with the square of its
    /// length, mm².
    #[inline]
    pub(super) fn stepped<const FULL: bool>(
        &self,
        x: f32,
        y: f32,
        start: Displacement,
    ) -> (Displacement, f32) {
        let (x, y) = (x + start.dx_mm, y + start.dy_mm);
        let local = self.local(x, y);
        let d = self.local_displacement::<FULL>(x, y, &local);
        let residual_x = start.dx_mm - d.dx_mm;
        let residual_y = start.dy_mm - d.dy_mm;
        let (twice_gx, twice_gy) = (self.gx + self.gx, self.gy + self.gy);
        let gain_by_x = local.slope2 * x + self.hx;
        let gain_by_y = local.slope2 * y + self.hy;
        let mut scale_x = 1.0 - local.gain - x * (gain_by_x + twice_gx);
        let scale_y = 1.0 - local.gain - y * (gain_by_y + twice_gy);
        let mut dx_by_y = x * gain_by_y + twice_gx * y;
        let dy_by_x = y * gain_by_x + twice_gy * x;
        if FULL {
            scale_x -= self.b1;
            dx_by_y += self.b2;
        }
        let inverse = 1.0 / (scale_x * scale_y - dx_by_y * dy_by_x);
        let step_x = inverse * (scale_y * residual_x + dx_by_y * residual_y);
        let step_y = inverse * (dy_by_x * residual_x + scale_x * residual_y);
        let next = Displacement {
            dx_mm: start.dx_mm - step_x,
            dy_mm: start.dy_mm - step_y,
        };
        (next, step_x * step_x + step_y * step_y)
    }

    /// Where the radial terms lead from the ideal point (`x`, `y`): Newton's step along the radius, with
    /// `1 + s + s²` for the inverse of 1 - s.
    #[inline]
    pub(super) fn start<const FULL: bool>(&self, x: f32, y: f32) -> Displacement {
        let local = self.local(x, y);
        let d = self.local_displacement::<FULL>(x, y, &local);
        let slope = local.gain + local.r2 * local.slope2;
        let stretch = 1.0 + (slope + slope * slope);
        Displacement {
            dx_mm: stretch * d.dx_mm,
            dy_mm: stretch * d.dy_mm,
        }
    }

    /// Derivative and value by one Horner scheme.
    #[inline]
    fn local(&self, x: f32, y: f32) -> Local {
        let r2 = x * x + y * y;
        let cubic = r2 * self.k3;
        let square = self.k2 + cubic;
        let linear = self.k1 + r2 * square;
        let slope = linear + r2 * (square + cubic);
        Local {
            r2,
            gain: self.k0 + r2 * linear + self.hx * x + self.hy * y,
            slope2: slope + slope,
        }
    }

    #[inline]
    fn local_displacement<const FULL: bool>(&self, x: f32, y: f32, local: &Local) -> Displacement {
        let Local { r2, gain, .. } = *local;
        let (dx_mm, dy_mm) = (x * gain + self.gx * r2, y * gain + self.gy * r2);
        if FULL {
            Displacement {
                dx_mm: dx_mm + self.b1 * x + self.b2 * y + self.tx,
                dy_mm: dy_mm + self.ty,
            }
        } else {
            Displacement { dx_mm, dy_mm }
        }
    }
}
