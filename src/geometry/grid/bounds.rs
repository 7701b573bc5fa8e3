//! Bounds of the slope and of the curvature of a residual grid, from its coefficients.

use super::header::GridHeader;
use super::node::{NODE_BYTES, components};
use crate::geometry::hypotenuse::hypotenuse;

/// Largest slope and curvature of a residual grid, anywhere.
///
/// # Model
/// ∂G/∂x at a point is a convex combination of the first differences of neighbouring coefficients
/// along x, over the pitch; ∂²G/∂x² one of the second differences, over its square. The largest
/// differences are therefore bounds, and the grid need not be evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridBounds {
    /// Largest |∂G/∂x| and |∂G/∂y|.
    slopes: [f32; 2],
    /// Largest magnitude of a component of ∂²G/∂x² and of ∂²G/∂y², mm⁻¹.
    curvatures: [f32; 2],
}

/// Rounding of the bounds, outwards.
const OUTWARDS: f32 = 1.0 + 8.0 * f32::EPSILON;

impl GridBounds {
    pub(super) fn new(header: &GridHeader, nodes: &[[u8; NODE_BYTES]]) -> Self {
        let columns = usize::from(header.columns).max(1);
        let rows = || nodes.chunks_exact(columns);
        let mut along_x = Differences::default();
        for row in rows() {
            for (left, right) in row.iter().zip(row.iter().skip(1)) {
                along_x.first(*left, *right);
            }
            for ((left, node), right) in row.iter().zip(row.iter().skip(1)).zip(row.iter().skip(2))
            {
                along_x.second(*left, *node, *right);
            }
        }
        let mut along_y = Differences::default();
        for (below, above) in rows().zip(rows().skip(1)) {
            for (below, above) in below.iter().zip(above) {
                along_y.first(*below, *above);
            }
        }
        for ((below, row), above) in rows().zip(rows().skip(1)).zip(rows().skip(2)) {
            for ((below, node), above) in below.iter().zip(row).zip(above) {
                along_y.second(*below, *node, *above);
            }
        }
        let per_mm = header.scale_mm / header.pitch_mm * OUTWARDS;
        let per_mm2 = per_mm / header.pitch_mm * OUTWARDS;
        Self {
            slopes: [along_x, along_y].map(|along| along.slope() * per_mm),
            curvatures: [along_x, along_y].map(|along| along.curvature() * per_mm2),
        }
    }

    /// Returns a bound of the norm of the Jacobian: of |G(p) - G(q)|/|p - q| for all points.
    #[must_use]
    pub fn slope(&self) -> f32 {
        let [x, y] = self.slopes;
        hypotenuse(x, y) * OUTWARDS
    }

    /// Returns a bound of the mean over the exposure less the value at the centroid, mm: per
    /// component, of a grid that moves along x or y with the variance μ₂.
    ///
    /// # Model
    /// `½·μ₂·max|second difference|/pitch²`, CALIBRATIONS section 9.
    #[must_use]
    pub fn second_moment_mm(&self, variance_mm2: f32, along_x: bool) -> f32 {
        0.5 * variance_mm2 * self.curvature(along_x)
    }

    /// Largest magnitude of a component of ∂²G/∂x² or of ∂²G/∂y², mm⁻¹.
    pub(crate) const fn curvature(&self, along_x: bool) -> f32 {
        let [x, y] = self.curvatures;
        if along_x { x } else { y }
    }
}

/// Largest differences of neighbouring coefficients along one axis.
#[derive(Debug, Clone, Copy, Default)]
struct Differences {
    /// Square of the longest first difference.
    first2: u64,
    /// Largest component of a second difference.
    second: u32,
}

impl Differences {
    fn first(&mut self, from: [u8; NODE_BYTES], to: [u8; NODE_BYTES]) {
        let [x, y] = difference(from, to).map(|component| u64::from(component.unsigned_abs()));
        self.first2 = self.first2.max(x * x + y * y);
    }

    fn second(&mut self, from: [u8; NODE_BYTES], node: [u8; NODE_BYTES], to: [u8; NODE_BYTES]) {
        let [x0, y0] = difference(from, node);
        let [x1, y1] = difference(node, to);
        let largest = x1.abs_diff(x0).max(y1.abs_diff(y0));
        self.second = self.second.max(largest);
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "rounded by half a unit, which OUTWARDS makes good"
    )]
    fn slope(self) -> f32 {
        fmc_camera_kernel::sqrt(self.first2 as f32)
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "exact: second differences of 16-bit numbers are less than 2^18"
    )]
    const fn curvature(self) -> f32 {
        self.second as f32
    }
}

/// Returns the difference of two nodes, by component.
fn difference(from: [u8; NODE_BYTES], to: [u8; NODE_BYTES]) -> [i32; 2] {
    let [from_x, from_y] = components(from).map(i32::from);
    let [to_x, to_y] = components(to).map(i32::from);
    [to_x - from_x, to_y - from_y]
}
