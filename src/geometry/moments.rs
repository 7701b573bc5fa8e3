//! Central moments of a path weighted by the shutter, and the quadrature that gives them exactly.

/// Central moments μ₂, μ₃, μ₄ of a position while the shutter is open, weighted by transmission.
///
/// The unit is the position's: mm², mm³, mm⁴ for a path in millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CentralMoments {
    /// μ₂, the variance.
    pub second: f32,
    /// μ₃; changes sign with the direction of motion.
    pub third: f32,
    /// μ₄.
    pub fourth: f32,
}

impl CentralMoments {
    /// Returns the moments of `scale` times the position.
    #[must_use]
    pub(crate) fn scaled(self, scale: f32) -> Self {
        let square = scale * scale;
        Self {
            second: self.second * square,
            third: self.third * square * scale,
            fourth: self.fourth * square * square,
        }
    }

    /// Adds `weight` at `deviation` from the mean.
    pub(crate) fn add(&mut self, weight: f32, deviation: f32) {
        let square = deviation * deviation;
        self.second += weight * square;
        self.third += weight * square * deviation;
        self.fourth += weight * square * square;
    }
}

/// Abscissae and weights of the three-point Gauss-Legendre rule on [-1, 1]: √(3/5), 5/9, 8/9
/// (Abramowitz & Stegun, table 25.4). The rule is exact up to degree 5, hence for a piecewise
/// linear transmission times the fourth power of a piecewise linear path.
const GAUSS_LEGENDRE_3: [(f32, f32); 3] = [
    (-0.774_596_7, 0.555_555_6),
    (0.0, 0.888_888_9),
    (0.774_596_7, 0.555_555_6),
];

/// Returns the nodes of the interval `[from, to]` and their weights.
pub(crate) fn gauss_nodes(from: f32, to: f32) -> [(f32, f32); 3] {
    let half = 0.5 * (to - from);
    let middle = 0.5 * (to + from);
    GAUSS_LEGENDRE_3.map(|(node, weight)| (middle + half * node, half * weight))
}
