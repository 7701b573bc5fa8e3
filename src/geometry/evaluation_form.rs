//! The evaluation form: the polynomial into which every model is folded once per frame.

use super::interval::greater;

/// A displacement in the sensor frame, mm: distortion is *measured - ideal*.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Displacement {
    /// To the right, mm.
    pub dx_mm: f32,
    /// Upwards, mm.
    pub dy_mm: f32,
}

/// Partial derivatives of a displacement by the point, dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobian {
    /// ∂Dx/∂x.
    pub dx_by_x: f32,
    /// ∂Dx/∂y.
    pub dx_by_y: f32,
    /// ∂Dy/∂x.
    pub dy_by_x: f32,
    /// ∂Dy/∂y.
    pub dy_by_y: f32,
}

/// The evaluation form about a centre, X and Y counted from it, R = X² + Y²:
///
/// `G = k₀ + R(k₁ + R(k₂ + R·k₃)) + hx·X + hy·Y`,
/// `Dx = X·G + gx·R + b₁·X + b₂·Y + tx`,
/// `Dy = Y·G + gy·R + ty`.
///
/// Static, exact dynamic and five-coefficient models differ only in the coefficients, so that the
/// cost per point is the same for all of them. Coefficients are in powers of mm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EvaluationForm {
    /// k₀, mm⁰.
    pub k0: f32,
    /// k₁, mm⁻².
    pub k1: f32,
    /// k₂, mm⁻⁴.
    pub k2: f32,
    /// k₃, mm⁻⁶.
    pub k3: f32,
    /// hx, mm⁻¹.
    pub hx: f32,
    /// hy, mm⁻¹.
    pub hy: f32,
    /// gx, mm⁻¹.
    pub gx: f32,
    /// gy, mm⁻¹.
    pub gy: f32,
    /// b₁, mm⁰.
    pub b1: f32,
    /// b₂, mm⁰.
    pub b2: f32,
    /// tx, mm.
    pub tx: f32,
    /// ty, mm.
    pub ty: f32,
}

impl EvaluationForm {
    /// Returns the displacement at (`x`, `y`) mm from the centre in 25 floating-point operations:
    /// 29 with two that centre the point and two that subtract the result.
    #[inline]
    #[must_use]
    pub fn displacement(&self, x: f32, y: f32) -> Displacement {
        let r2 = x * x + y * y;
        let g = self.gain(x, y, r2);
        Displacement {
            dx_mm: x * g + self.gx * r2 + self.b1 * x + self.b2 * y + self.tx,
            dy_mm: y * g + self.gy * r2 + self.ty,
        }
    }

    /// Returns the displacement without b₁, b₂, tx and ty, in six operations fewer.
    #[inline]
    #[must_use]
    pub fn short_displacement(&self, x: f32, y: f32) -> Displacement {
        let r2 = x * x + y * y;
        let g = self.gain(x, y, r2);
        Displacement {
            dx_mm: x * g + self.gx * r2,
            dy_mm: y * g + self.gy * r2,
        }
    }

    /// Returns the derivatives of [`Self::displacement`] at (`x`, `y`) mm from the centre.
    #[must_use]
    pub fn jacobian(&self, x: f32, y: f32) -> Jacobian {
        let r2 = x * x + y * y;
        let g = self.gain(x, y, r2);
        let slope2 = 2.0 * (self.k1 + r2 * (2.0 * self.k2 + r2 * (3.0 * self.k3)));
        let g_by_x = slope2 * x + self.hx;
        let g_by_y = slope2 * y + self.hy;
        Jacobian {
            dx_by_x: g + x * g_by_x + 2.0 * self.gx * x + self.b1,
            dx_by_y: x * g_by_y + 2.0 * self.gx * y + self.b2,
            dy_by_x: y * g_by_x + 2.0 * self.gy * x,
            dy_by_y: g + y * g_by_y + 2.0 * self.gy * y,
        }
    }

    /// Returns the largest displacement, mm per axis, that [`Self::short_displacement`] leaves out
    /// over |X| ≤ `reach_x`, |Y| ≤ `reach_y`.
    #[must_use]
    pub(crate) fn dropped_by_short(&self, reach_x: f32, reach_y: f32) -> f32 {
        let along_x = self.b1.abs() * reach_x + self.b2.abs() * reach_y + self.tx.abs();
        greater(along_x, self.ty.abs())
    }

    /// Returns the largest change of [`Self::jacobian`] per mm, in any direction, within `radius`
    /// mm of the centre, mm⁻¹.
    ///
    /// The second derivative of `(X, Y)·Rⁿ` is at most `2n(2n+1)r²ⁿ⁻¹`, so that the result is
    /// `6|k₁|r + 20|k₂|r³ + 42|k₃|r⁵ + 2(|hx| + |hy| + |gx| + |gy|)`.
    pub(super) fn largest_curvature(&self, radius: f32) -> f32 {
        let r2 = radius * radius;
        let radial = radius
            * (6.0 * self.k1.abs() + r2 * (20.0 * self.k2.abs() + r2 * (42.0 * self.k3.abs())));
        let decentring = self.hx.abs() + self.hy.abs() + self.gx.abs() + self.gy.abs();
        radial + 2.0 * decentring
    }

    #[inline]
    fn gain(&self, x: f32, y: f32, r2: f32) -> f32 {
        self.k0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3)) + self.hx * x + self.hy * y
    }
}
