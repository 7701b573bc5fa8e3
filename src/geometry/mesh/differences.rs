//! Forward differences: a polynomial at equidistant points.

/// Value and forward differences of a polynomial of N coefficients at a point: N - 1 additions lead
/// to the next point.
///
/// # Model
/// With the nodes `xₖ = x + k·h`, Newton's form of the polynomial is `Σ fₖ·(X - x₀)…(X - xₖ₋₁)`,
/// and the differences are `Δᵏ = k!·hᵏ·fₖ`. They are computed from it, not as differences of
/// values, so that each has the relative accuracy of the coefficients.
///
/// # Accuracy
/// See [`super::displacement_rows`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Differences<const N: usize>([f32; N]);

impl<const N: usize> Differences<N> {
    /// Returns the differences at the first node of Newton's form.
    #[inline]
    pub(super) fn of_newton_form(mut newton_form: [f32; N], stride: &Stride) -> Self {
        for (difference, scale) in newton_form.iter_mut().zip(stride.scales) {
            *difference *= scale;
        }
        Self(newton_form)
    }

    /// Returns the differences with these values, the value itself first.
    #[inline]
    pub(super) const fn of_values(values: [f32; N]) -> Self {
        Self(values)
    }

    /// Returns the value here and moves the differences to the next point.
    #[inline]
    pub(super) fn take(&mut self) -> f32 {
        let mut value = 0.0;
        if let Some((highest, lower)) = self.0.split_last_mut() {
            let mut above = *highest;
            for difference in lower.iter_mut().rev() {
                value = *difference;
                *difference += above;
                above = value;
            }
        }
        value
    }
}

/// Step from point to point, with the factors that it brings into the differences.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stride {
    step: f32,
    /// `k!·stepᵏ`.
    scales: [f32; 8],
}

impl Stride {
    pub(super) fn new(step: f32) -> Self {
        let mut scale = 1.0;
        let mut order = 0.0;
        let scales = [(); 8].map(|()| {
            let this = scale;
            order += 1.0;
            scale *= order * step;
            this
        });
        Self { step, scales }
    }

    /// Returns the distance from one point to the next, mm.
    pub(super) const fn step(&self) -> f32 {
        self.step
    }

    /// Returns eight nodes from `x` on.
    #[inline]
    pub(super) fn nodes(&self, x: f32) -> [f32; 8] {
        let mut node = x;
        [(); 8].map(|()| {
            let this = node;
            node += self.step;
            this
        })
    }
}

/// Returns the coefficients fₖ of Newton's form, by repeated synthetic division by `(X - x₀)`,
/// `(X - x₁)`, …, from a polynomial's coefficients, lowest power first.
#[inline]
pub(super) fn newton_form<const N: usize>(
    mut coefficients: [f32; N],
    nodes: &[f32; 8],
) -> [f32; N] {
    let mut left = coefficients.as_mut_slice();
    for node in nodes {
        if let Some((highest, lower)) = left.split_last_mut() {
            let mut above = *highest;
            for coefficient in lower.iter_mut().rev() {
                *coefficient += node * above;
                above = *coefficient;
            }
        }
        left = left.split_first_mut().map_or(&mut [], |(_, rest)| rest);
    }
    coefficients
}

/// Returns Newton's form, of M = N + 1 coefficients, of X times a polynomial given in Newton's
/// form: `xₖ·fₖ + fₖ₋₁`.
#[inline]
pub(super) fn times_x<const N: usize, const M: usize>(
    newton_form: [f32; N],
    nodes: &[f32; 8],
) -> [f32; M] {
    let mut product = [0.0; M];
    let mut below = ABSENT;
    let mut own = newton_form.into_iter();
    for (coefficient, node) in product.iter_mut().zip(nodes) {
        *coefficient = match own.next() {
            Some(this) => {
                let sum = node * this + below;
                below = this;
                sum
            }
            None => below,
        };
    }
    product
}

/// Coefficient of an absent term: the zero whose addition changes no number, so that no addition is
/// compiled.
pub(super) const ABSENT: f32 = -0.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_restarts_rounding_grows_beyond_four_nanometres() {
        // K1 alone, 0.5 mm at the end of 104 mm, every pixel of 8 µm.
        let (k1, step) = (3.556e-6, 0.008);
        let cubic = [0.0, 0.0, 0.0, k1];
        let error_nm =
            |value: f32, x: f64| 1e6 * (f64::from(value) - f64::from(k1) * x.powi(3)).abs();
        let stride = Stride::new(step);
        let newton_form = newton_form(cubic, &stride.nodes(-52.0));
        let mut once = Differences::of_newton_form(newton_form, &stride);
        let mut largest_nm = 0.0_f64;
        for index in 0..13_000 {
            let x = -52.0 + f64::from(index) * f64::from(step);
            largest_nm = largest_nm.max(error_nm(once.take(), x));
        }
        assert!(largest_nm > 100.0, "{largest_nm} nm");
    }

    #[test]
    fn differences_of_a_cube_are_exact() {
        // x³ from 2 in steps of 1: 8, 27, 64, 125, 216: whole numbers throughout.
        let stride = Stride::new(1.0);
        let newton_form = newton_form([0.0, 0.0, 0.0, 1.0], &stride.nodes(2.0));
        let mut cube = Differences::of_newton_form(newton_form, &stride);
        assert_eq!(cube, Differences([8.0, 19.0, 18.0, 6.0]));
        let values = [(); 5].map(|()| cube.take());
        assert_eq!(
            values.map(f32::to_bits),
            [8.0_f32, 27.0, 64.0, 125.0, 216.0].map(f32::to_bits)
        );
    }

    #[test]
    fn times_x_of_a_square_is_the_cube() {
        let nodes = Stride::new(-1.5).nodes(4.0);
        let square = newton_form([0.0, 0.0, 1.0], &nodes);
        assert_eq!(
            times_x::<3, 4>(square, &nodes).map(f32::to_bits),
            newton_form([0.0, 0.0, 0.0, 1.0], &nodes).map(f32::to_bits)
        );
    }
}
