//! A polynomial at equidistant points, by forward differences.

/// Value and forward differences of a polynomial of N coefficients at a point: N - 1 additions lead to
/// the next point.
///
/// # Model
/// With the nodes `xₖ = x + k·h`, repeated synthetic division by `(X - x₀)`, `(X - x₁)`, … turns the coefficients
/// into those of Newton's form `Σ fₖ·(X - x₀)…(X - xₖ₋₁)`; the differences are `Δᵏ = k!·hᵏ·fₖ`. They are computed
/// so, not as differences of values: each has the relative accuracy of the coefficients.
///
/// # Accuracy
/// See [`super::displacement_rows`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Differences<const N: usize>([f32; N]);

impl<const N: usize> Differences<N> {
    /// At `x`, for steps of `step`; `scales` has `k!·stepᵏ`.
    #[inline]
    pub(super) fn at(mut coefficients: [f32; N], x: f32, step: f32, scales: &[f32]) -> Self {
        let mut node = x;
        let mut left = coefficients.as_mut_slice();
        while let Some((highest, lower)) = left.split_last_mut() {
            let mut above = *highest;
            for coefficient in lower.iter_mut().rev() {
                *coefficient += node * above;
                above = *coefficient;
            }
            node += step;
            left = left.split_first_mut().map_or(&mut [], |(_, rest)| rest);
        }
        for (difference, scale) in coefficients.iter_mut().zip(scales) {
            *difference *= scale;
        }
        Self(coefficients)
    }

    /// The value here; afterwards the differences are those of the next point.
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

/// `k!·stepᵏ` for k = 0 to 7.
pub(super) fn scales(step: f32) -> [f32; 8] {
    let mut scale = 1.0;
    let mut order = 0.0;
    [(); 8].map(|()| {
        let this = scale;
        order += 1.0;
        scale *= order * step;
        this
    })
}

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
        let mut once = Differences::at(cubic, -52.0, step, &scales(step));
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
        let mut cube = Differences::at([0.0, 0.0, 0.0, 1.0], 2.0, 1.0, &scales(1.0));
        assert_eq!(cube, Differences([8.0, 19.0, 18.0, 6.0]));
        let values = [(); 5].map(|()| cube.take());
        assert_eq!(
            values.map(f32::to_bits),
            [8.0_f32, 27.0, 64.0, 125.0, 216.0].map(f32::to_bits)
        );
    }
}
