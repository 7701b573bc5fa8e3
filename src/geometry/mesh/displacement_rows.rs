//! Distortion along rows of the measured image, by differences.

use core::num::NonZero;

use super::differences::{Differences, Stride, newton_form, times_x};
use super::rounding_bound::RoundingBound;
use super::row_polynomial::RowPolynomial;
use crate::geometry::evaluation_form::{Displacement, EvaluationForm};
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::sensor::SensorPoint;

/// Number of points from one analytic start of the differences to the next.
pub const RESTART_INTERVAL: NonZero<u16> = points(64);

/// The intervals tried, the longest first.
const INTERVALS: [NonZero<u16>; 8] = [
    RESTART_INTERVAL,
    points(56),
    points(48),
    points(40),
    points(32),
    points(24),
    points(16),
    points(8),
];

const fn points(count: u16) -> NonZero<u16> {
    match NonZero::new(count) {
        Some(count) => count,
        None => NonZero::<u16>::MIN,
    }
}

/// Largest rounding error of a row, nm per axis: where [`RESTART_INTERVAL`] would exceed it, the
/// differences start more often.
pub const ROW_ROUNDING_NM: f32 = 4.0;

/// Distortion along rows with one step, for one frame: prepared once, then computed row by row.
///
/// # Model
/// Along a row the distortion is a polynomial in X, of degree 5 for Dx and 4 for Dy where K3 = 0,
/// of degree 7 and 6 otherwise, whatever other terms the form has. Forward differences lead from
/// point to point with 9 additions, 13 with K3; every [`Self::restart_interval`] points they start
/// anew from the coefficients. They lead away from the centre, to the right of it and to the left.
/// All terms of the form are evaluated, also those that
/// [`Terms::Short`](crate::geometry::frame_correction::Terms::Short) drops.
///
/// # Units and frames
/// Sensor frame, mm: points `first + index·step` of the measured image; measured - ideal.
///
/// # Accuracy
/// [`Self::rounding_bound_nm`] holds for all rows of the sensor. With u = 2⁻²⁴, the reach ρ of X
/// about the centre, `a_m` the coefficients of a row, `Â(X) = Σ|a_m|Xᵐ` at the largest |Y|,
/// `Ẑ(X) = Σ m|a_m|Xᵐ`, and n additions between two starts (or from the centre to the edge), L =
/// n·step:
///
/// `error ≤ u·[ n·(w + Â(ρ) - M) + Â(ρ) + 2Ẑ(ρ) + 2(Ẑ(ρ) - Ẑ(ρ - L)) + 4ρ·D' + F̂ ]`:
///
/// - Additions. At point i difference k is rounded by at most `u·|Δᵏᵢ|`, of which `C(n - i, k)`
///   times as much reaches the value at n. Away from the centre `|Δᵏᵢ| ≤ Δᵏ` of Â at |Xᵢ|, and by
///   Newton's formula `Σₖ C(n - i, k)·Δᵏ` is `Â(Xₙ)`, of which the value itself, k = 0, is `Â(Xᵢ)`.
///   So the differences contribute the sum of `Â(Xₙ) - Â(Xᵢ)`, and M bounds the mean of Â over the
///   last n points from below: Â is convex, `M = (Â(ρ - (n-1)·step/4) + Â(ρ - 3(n-1)·step/4))/2`.
///   Towards the centre it would be `Â(ρ + L)` instead of `Â(ρ)`: several times as much where
///   spacing is wide.
/// - Additions to the value: half a unit in its last place, w·u with w the power of two within the
///   largest distortion; for Dx also at most the mean of |X| times the largest G, plus the terms
///   beside X·G.
/// - The start, `f₀` to `f_m`: through synthetic division, X·G included, `a_m` passes into `fₖ`
///   over 2m - k + 1 roundings: Â + 2Ẑ. From `fₖ` to `Δᵏ`, k ≥ 1, there are one more, those of
///   `k!·stepᵏ` (0, 1, 3, 4, 6, 8, 10) and k for each of m - k nodes: less k at most 2m for every m
///   up to 7, and as the `Δᵏ` from k = 1 on amount to `Â(Xₙ) - Â(X₀)`, 2(Ẑ(ρ) - Ẑ(ρ - L)).
/// - The position of the start: four roundings of ρ, times D', the largest slope of the distortion
///   along the row.
/// - F̂: the roundings in the fold of the form into `a_m`, counted coefficient by coefficient.
///
/// Largest distortion and D' are those of K1 to K3 together, which often compete; all other sums
/// are of absolute values.
///
/// The interval is the longest of 64, 56, 48, … that keeps the bound within [`ROW_ROUNDING_NM`]: 64
/// on every camera of `host-sim/cameras` at 8 to 128 pixels from point to point, 48 or more for 0.5
/// mm of distortion over 104 mm of width. Errors found there are at most 0.6 nm
/// (`tests/geometry/mesh.rs`), and 2.3 nm if all roundings came together
/// (`tests/geometry/mesh_rounding.rs`). For a lens whose bound exceeds it at 8, too, the interval
/// is 8 and the larger bound is stated.
///
/// A point costs 13 instructions on a Cortex-M4F, 17 with K3, starts every 64 points included; a
/// row costs 80 and a frame 1100. In all, it is 20.5 per point with K3 where two starts serve 82
/// points (104 mm, 128 pixels of 10 µm).
///
/// # Examples
/// ```
/// use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
/// use fmc_camera::geometry::evaluation_form::Displacement;
/// use fmc_camera::geometry::frame_correction::FrameCorrection;
/// use fmc_camera::geometry::mesh::displacement_rows::DisplacementRows;
/// use fmc_camera::geometry::sensor::SensorPoint;
/// let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
/// lens.distortion.k1 = -1e-6;
/// let correction = FrameCorrection::without_motion(&Calibration::new(lens)?);
/// let rows = DisplacementRows::new(&correction, 10.0);
/// let mut row = [Displacement::default(); 4];
/// rows.row(SensorPoint::new(-10.0, 0.0)).write(&mut row);
/// // K1·r³: 1 µm towards the centre at 10 mm, 8 µm at 20 mm.
/// let expected_um = [1.0, 0.0, -1.0, -8.0];
/// for (found, expected_um) in row.iter().zip(expected_um) {
///     assert!((1000.0 * found.dx_mm - expected_um).abs() < 1e-5);
/// }
/// # Ok::<(), fmc_camera::geometry::calibration::CalibrationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementRows {
    centre: SensorPoint,
    form: EvaluationForm,
    /// Strides along the row and against it.
    strides: [Stride; 2],
    interval: NonZero<u16>,
    bound_nm: f32,
}

impl DisplacementRows {
    /// Returns the rows of a frame in steps of `step_mm`; if the step is not finite all points are
    /// NaN, and so is the bound.
    #[must_use]
    pub fn new(correction: &FrameCorrection, step_mm: f32) -> Self {
        Self::with_margin(correction, step_mm, 0.0)
    }

    /// Returns the rows as [`Self::new`] does, with a bound that holds for points up to `margin_mm`
    /// off the sensor, too (0 or more). There the same polynomial is used, although no calibration
    /// has seen an image.
    #[must_use]
    pub fn with_margin(correction: &FrameCorrection, step_mm: f32, margin_mm: f32) -> Self {
        let centre = correction.centre();
        let sensor = correction.sensor();
        let reach = [
            sensor.half_width_mm() + margin_mm + centre.x_mm.abs(),
            sensor.half_height_mm() + margin_mm + centre.y_mm.abs(),
        ];
        let rounding = RoundingBound::new(correction.form(), reach);
        let [mut interval, ..] = INTERVALS;
        let mut bound_nm = f32::INFINITY;
        for candidate in INTERVALS {
            if bound_nm <= ROW_ROUNDING_NM {
                break;
            }
            interval = candidate;
            bound_nm = rounding.nanometres(candidate, step_mm);
        }
        Self {
            centre,
            form: *correction.form(),
            strides: [step_mm, -step_mm].map(Stride::new),
            interval,
            bound_nm,
        }
    }

    /// Number of points from one start of the differences to the next.
    #[must_use]
    pub const fn restart_interval(&self) -> u16 {
        self.interval.get()
    }

    /// Upper bound of the rounding error of a displacement, nm per axis.
    #[must_use]
    pub const fn rounding_bound_nm(&self) -> f32 {
        self.bound_nm
    }

    /// Prepares the row that begins at `first`, once per row.
    #[must_use]
    pub fn row(&self, first: SensorPoint) -> DisplacementRow<'_> {
        DisplacementRow {
            rows: self,
            x_mm: first.x_mm - self.centre.x_mm,
            polynomial: RowPolynomial::new(&self.form, first.y_mm - self.centre.y_mm),
        }
    }
}

/// One row of [`DisplacementRows`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementRow<'rows> {
    rows: &'rows DisplacementRows,
    x_mm: f32,
    polynomial: RowPolynomial,
}

impl DisplacementRow<'_> {
    /// Fills a slice with the displacements of the row's points, from its first on.
    ///
    /// # Units and frames
    /// As for [`DisplacementRows`]; the bound holds only for points on the sensor or its margin.
    pub fn write(&self, displacements: &mut [Displacement]) {
        self.write_as(displacements, |displacement| displacement);
    }

    /// Fills a slice with the results of `of` for the displacements.
    #[inline]
    pub(super) fn write_as<T>(&self, points: &mut [T], of: impl Fn(Displacement) -> T) {
        if self.rows.form.k3 == 0.0 {
            self.write_outward::<6, 5, T>(self.polynomial.gain_without_k3(), points, of);
        } else {
            self.write_outward::<8, 7, T>(self.polynomial.gain(), points, of);
        }
    }

    /// Fills the row away from the centre to either side; the gain has N coefficients, Dx one more.
    #[inline]
    fn write_outward<const M: usize, const N: usize, T>(
        &self,
        gain: [f32; N],
        points: &mut [T],
        of: impl Fn(Displacement) -> T,
    ) {
        let [along, against] = &self.rows.strides;
        let interval = self.rows.interval;
        let block_points = NonZero::<usize>::from(interval).get();
        let nearest = self.points_before_the_centre(points.len());
        let Some((before, after)) = points.split_at_mut_checked(nearest) else {
            return;
        };
        // Four points are unrolled by hand: a jump costs a quarter of a point.
        let mut index = index_of(nearest);
        for block in after.chunks_mut(block_points) {
            let mut start = self.start::<M, N>(gain, index, along);
            let (fours, rest) = block.as_chunks_mut::<4>();
            for four in fours {
                for point in four {
                    *point = of(start.take());
                }
            }
            for point in rest {
                *point = of(start.take());
            }
            index += f32::from(interval.get());
        }
        let mut index = index_of(nearest) - 1.0;
        for block in before.rchunks_mut(block_points) {
            let mut start = self.start::<M, N>(gain, index, against);
            let (rest, fours) = block.as_rchunks_mut::<4>();
            for four in fours.iter_mut().rev() {
                for point in four.iter_mut().rev() {
                    *point = of(start.take());
                }
            }
            for point in rest.iter_mut().rev() {
                *point = of(start.take());
            }
            index -= f32::from(interval.get());
        }
    }

    /// Returns the number of the first points of a row that come before X changes its sign,
    /// including one at X = 0.
    fn points_before_the_centre(&self, count: usize) -> usize {
        let [along, _] = self.rows.strides;
        let steps_to_the_centre = -self.x_mm / along.step();
        if steps_to_the_centre >= 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates; positive"
            )]
            let whole = steps_to_the_centre as usize;
            whole.saturating_add(1).min(count)
        } else {
            0
        }
    }

    /// Returns the differences of both axes at point `index`.
    #[expect(
        clippy::inline_always,
        reason = "the differences stay in registers: 60 instructions per start"
    )]
    #[inline(always)]
    fn start<const M: usize, const N: usize>(
        &self,
        gain: [f32; N],
        index: f32,
        stride: &Stride,
    ) -> RowStart<M, N> {
        let [along, _] = self.rows.strides;
        let RowPolynomial { y, beside_x, .. } = self.polynomial;
        let nodes = stride.nodes(self.x_mm + index * along.step());
        let gain = newton_form(gain, &nodes);
        let mut dx = times_x(gain, &nodes);
        let mut dy = gain.map(|coefficient| y * coefficient);
        let besides = [beside_x, self.polynomial.beside_y()].map(|q| newton_form(q, &nodes));
        let [beside_x, beside_y] = besides;
        for (coefficient, beside) in dx.iter_mut().zip(beside_x) {
            *coefficient += beside;
        }
        for (coefficient, beside) in dy.iter_mut().zip(beside_y) {
            *coefficient += beside;
        }
        RowStart {
            dx: Differences::of_newton_form(dx, stride),
            dy: Differences::of_newton_form(dy, stride),
        }
    }
}

/// Differences at the start of a block of a row.
struct RowStart<const M: usize, const N: usize> {
    dx: Differences<M>,
    dy: Differences<N>,
}

impl<const M: usize, const N: usize> RowStart<M, N> {
    #[inline]
    fn take(&mut self) -> Displacement {
        Displacement {
            dx_mm: self.dx.take(),
            dy_mm: self.dy.take(),
        }
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "a row has fewer than 2²⁴ points"
)]
const fn index_of(point: usize) -> f32 {
    point as f32
}
