//! From sources at the nodes of a block to their forward differences.

use core::ops::{Add, Mul, Sub};

/// Nodes of a block, in eighths of its length: both ends are among them.
pub(super) const NODES: [u16; 6] = [0, 1, 3, 5, 7, 8];

/// Largest product of the distances from a place of the block to its nodes, over the sixth power of
/// the block's length.
pub(super) const NODE_POLYNOMIAL: f32 = 6.93e-4;

/// Largest sum of the absolute values of Lagrange's polynomials over a block: the share of the
/// nodes' errors that reaches a vertex.
pub(super) const LEBESGUE: f32 = 1.79;

/// The matrix for blocks of one length.
///
/// # Model
/// With t from 0 to 1 over the block and s = t - 1/2 the polynomial of degree 5 through the nodes
/// is `f₀ + t·(f₅ - f₀) + t(1 - t)·(a + c·s + b·s² + e·s³)`. In this form each coefficient is as
/// accurate as its own size allows: the residuals from the chord are small, and their sums and
/// differences about the middle separate even from odd terms. The matrix has the forward
/// differences of 1, 2, … 5th order of each of the five terms at the block's first vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BlockMatrix {
    /// Vertices from one end of the block to the other.
    pub(super) length: u16,
    chord: f32,
    a: [f32; 2],
    c: [f32; 3],
    b: [f32; 4],
    e: [f32; 5],
}

impl BlockMatrix {
    /// The matrices of all lengths, the longest first.
    pub(super) const ALL: [Self; 7] = [
        Self::new(64),
        Self::new(56),
        Self::new(48),
        Self::new(40),
        Self::new(32),
        Self::new(24),
        Self::new(16),
    ];

    /// Returns the matrix, each number rounded once: `Δᵏtᵐ = k!·S(m, k)·hᵐ` with Stirling's numbers
    /// of the second kind and the step h.
    const fn new(length: u16) -> Self {
        let h = 1.0 / length as f64;
        let (h2, h3) = (h * h, h * h * h);
        let (h4, h5) = (h2 * h2, h2 * h3);
        Self {
            length,
            chord: rounded(h),
            a: [rounded(h - h2), rounded(-2.0 * h2)],
            c: [
                rounded(-0.5 * h + 1.5 * h2 - h3),
                rounded(3.0 * h2 - 6.0 * h3),
                rounded(-6.0 * h3),
            ],
            b: [
                rounded(0.25 * h - 1.25 * h2 + 2.0 * h3 - h4),
                rounded(-2.5 * h2 + 12.0 * h3 - 14.0 * h4),
                rounded(12.0 * h3 - 36.0 * h4),
                rounded(-24.0 * h4),
            ],
            e: [
                rounded(-0.125 * h + 0.875 * h2 - 2.25 * h3 + 2.5 * h4 - h5),
                rounded(1.75 * h2 - 13.5 * h3 + 35.0 * h4 - 30.0 * h5),
                rounded(-13.5 * h3 + 90.0 * h4 - 150.0 * h5),
                rounded(60.0 * h4 - 240.0 * h5),
                rounded(-120.0 * h5),
            ],
        }
    }

    /// Returns value and differences of one axis at the block's first vertex, from the values at
    /// its nodes; or of several axes and blocks of this length.
    #[inline]
    pub(super) fn differences<T>(&self, [f0, f1, f2, f3, f4, f5]: [T; 6]) -> [T; 6]
    where
        T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
    {
        let chord = f5 - f0;
        let residual = |value: T, share: f32| (value - f0) - chord * share;
        let [r1, r2] = [residual(f1, 0.125), residual(f2, 0.375)];
        let [r3, r4] = [residual(f3, 0.625), residual(f4, 0.875)];
        // Means of both sides over t(1 - t), and half their differences over t(1 - t)·|s|.
        let (outer, inner) = ((r1 + r4) * (32.0 / 7.0), (r2 + r3) * (32.0 / 15.0));
        let b = (outer - inner) * 8.0;
        let a = inner - b * (1.0 / 64.0);
        let (outer, inner) = ((r4 - r1) * (256.0 / 21.0), (r3 - r2) * (256.0 / 15.0));
        let e = (outer - inner) * 8.0;
        let c = inner - e * (1.0 / 64.0);
        let [a1, a2] = self.a;
        let [c1, c2, c3] = self.c;
        let [b1, b2, b3, b4] = self.b;
        let [e1, e2, e3, e4, e5] = self.e;
        [
            f0,
            chord * self.chord + a * a1 + c * c1 + b * b1 + e * e1,
            a * a2 + c * c2 + b * b2 + e * e2,
            c * c3 + b * b3 + e * e3,
            b * b4 + e * e4,
            e * e5,
        ]
    }
}

#[expect(clippy::cast_possible_truncation, reason = "that is the rounding")]
const fn rounded(number: f64) -> f32 {
    number as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes() -> [f64; 6] {
        NODES.map(|eighths| f64::from(eighths) / 8.0)
    }

    #[test]
    fn powers_of_t_up_to_the_fifth_are_reproduced_in_every_length() {
        for matrix in BlockMatrix::ALL {
            for power in 0..6_i32 {
                let at_nodes = nodes().map(|t| rounded(t.powi(power)));
                let mut differences = matrix.differences(at_nodes).map(f64::from);
                for index in 0..=matrix.length {
                    let t = f64::from(index) / f64::from(matrix.length);
                    // Roundings of numbers up to one, of which those of e count most.
                    let error = (differences[0] - t.powi(power)).abs();
                    assert!(error < 2e-6, "t^{power}, {}: {error}", matrix.length);
                    for order in 1..6 {
                        differences[order - 1] += differences[order];
                    }
                }
            }
        }
    }

    #[test]
    fn constants_of_the_nodes_are_those_of_their_polynomials() {
        let nodes = nodes();
        let (mut product, mut sum) = (0.0_f64, 0.0_f64);
        for step in 0..=10_000 {
            let t = f64::from(step) / 10_000.0;
            product = product.max(nodes.iter().map(|node| (t - node).abs()).product());
            let lagrange = |own: usize| {
                let others = (0..nodes.len()).filter(|other| *other != own);
                let factor = |other: usize| (t - nodes[other]) / (nodes[own] - nodes[other]);
                others.map(factor).product::<f64>().abs()
            };
            sum = sum.max((0..nodes.len()).map(lagrange).sum());
        }
        assert!(
            (0.99..1.0).contains(&(product / f64::from(NODE_POLYNOMIAL))),
            "{product}"
        );
        assert!((0.99..1.0).contains(&(sum / f64::from(LEBESGUE))), "{sum}");
    }
}
