//! The distortion along rows of the measured image, by differences.

use core::num::NonZero;

use super::differences::{Differences, scales};
use super::rounding_bound::RoundingBound;
use super::row_polynomial::RowPolynomial;
use crate::geometry::evaluation_form::{Displacement, EvaluationForm};
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::sensor::SensorPoint;

/// Points from one analytic start of the differences to the next.
pub const RESTART_INTERVAL: NonZero<u16> = points(64);

/// The intervals tried, the longest first.
const INTERVALS: [NonZero<u16>; 4] = [RESTART_INTERVAL, points(32), points(16), points(8)];

const fn points(count: u16) -> NonZero<u16> {
    match NonZero::new(count) {
        Some(count) => count,
        None => NonZero::<u16>::MIN,
    }
}

/// What the rounding of a row may come to, nm per axis: where [`RESTART_INTERVAL`] would exceed it, the
/// differences start more often.
pub const ROW_ROUNDING_NM: f32 = 4.0;

/// The distortion along rows with one step, for one frame: prepared once, then row by row.
///
/// # Model
/// Along a row the distortion is a polynomial in X, of degree 5 for Dx and 4 for Dy where K3 = 0, of degree 7 and 6
/// otherwise, whatever other terms the form has. Forward differences lead from point to point with 9 additions, 13
/// with K3; every [`Self::restart_interval`] points they start anew from the coefficients. All terms of the form are
/// evaluated, those too that [`Kernel::Short`](crate::geometry::frame_correction::Kernel::Short) drops.
///
/// # Units and frames
/// Sensor frame, mm: points `first + index·step` of the measured image; measured - ideal.
///
/// # Accuracy
/// Adding difference k + 1 to difference k rounds by at most `u·|Δᵏ|`, u = 2⁻²⁴, and grows over N points into
/// `C(N, k+1)` times that in the value. With the reach ρ of X about the centre, `L = N·step`, V the largest distortion,
/// `a_m` the coefficients of a row, `Â(X) = Σ|a_m|Xᵐ` at the largest |Y| and `Ẑ(X) = Σ m|a_m|Xᵐ`,
///
/// `error ≤ u·[ N·V + N·(Â(ρ+L) - Â(ρ))/2 + Â(ρ+L) + F̂(ρ+L) + 6Ẑ(ρ+L) + (Â + 10Ẑ)(ρ+L) - (Â + 10Ẑ)(ρ) ]`:
///
/// - additions to the value, relative to it; to the differences, whose powers of L sum to the mean of Â over L;
/// - the start: 2m + 1 roundings of synthetic division for a term of degree m, and those of the fold into the row's
///   coefficients, F̂, counted by coefficient;
/// - the place of the start, four roundings of ρ, to which a term of degree m answers m times;
/// - the starts of the differences: scale and nodes.
///
/// [`Self::rounding_bound_nm`] is this number for the frame and holds for all rows of the sensor. The interval is the
/// longest of 64, 32, 16 and 8 that keeps it within [`ROW_ROUNDING_NM`]:
/// 104 mm of width and 0.5 mm of distortion stay within it, with errors of at most 0.6 nm
/// (`tests/geometry/mesh.rs`). A lens for which 8 does not has its larger bound stated. 13 instructions per point on a
/// Cortex-M4F, 18 with K3, starts every 64 points included; 170 per row and 560 per frame.
///
/// # Examples
/// ```
/// use fmc_camera::geometry::calibration::{Calibration, CalibrationRecord};
/// use fmc_camera::geometry::evaluation_form::Displacement;
/// use fmc_camera::geometry::frame_correction::FrameCorrection;
/// use fmc_camera::geometry::mesh::displacement_rows::DisplacementRows;
/// use fmc_camera::geometry::sensor::SensorPoint;
/// let mut lens = CalibrationRecord::new(100.0, [8000, 6000], 10.0);
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
    step_mm: f32,
    scales: [f32; 8],
    interval: NonZero<u16>,
    bound_nm: f32,
}

impl DisplacementRows {
    /// Rows of a frame in steps of `step_mm`.
    #[must_use]
    pub fn new(correction: &FrameCorrection, step_mm: f32) -> Self {
        let centre = correction.centre();
        let sensor = correction.sensor();
        let reach = [
            sensor.half_width_mm() + centre.x_mm.abs(),
            sensor.half_height_mm() + centre.y_mm.abs(),
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
            step_mm,
            scales: scales(step_mm),
            interval,
            bound_nm,
        }
    }

    /// Points from one start of the differences to the next.
    #[must_use]
    pub const fn restart_interval(&self) -> u16 {
        self.interval.get()
    }

    /// Upper bound of the rounding error of a displacement, nm per axis.
    #[must_use]
    pub const fn rounding_bound_nm(&self) -> f32 {
        self.bound_nm
    }

    /// The row that begins at `first`: what is done once per row.
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
    /// As [`DisplacementRows`]; the points lie on the sensor, or the bound does not hold.
    pub fn write(&self, displacements: &mut [Displacement]) {
        if self.rows.form.k3 == 0.0 {
            let (dx, dy) = self.polynomial.without_k3();
            self.write_differences(dx, dy, displacements);
        } else {
            self.write_differences(self.polynomial.dx, self.polynomial.dy, displacements);
        }
    }

    #[inline]
    fn write_differences<const X: usize, const Y: usize>(
        &self,
        dx: [f32; X],
        dy: [f32; Y],
        displacements: &mut [Displacement],
    ) {
        let rows = self.rows;
        let step = rows.step_mm;
        let interval = NonZero::<usize>::from(rows.interval);
        let mut index = 0.0;
        for block in displacements.chunks_mut(interval.get()) {
            let x = self.x_mm + index * step;
            let mut dx = Differences::at(dx, x, step, &rows.scales);
            let mut dy = Differences::at(dy, x, step, &rows.scales);
            let mut fill = |displacement: &mut Displacement| {
                *displacement = Displacement {
                    dx_mm: dx.take(),
                    dy_mm: dy.take(),
                };
            };
            // Unrolled by hand: a jump costs a quarter of a point.
            let (fours, rest) = block.as_chunks_mut::<4>();
            for four in fours {
                four.iter_mut().for_each(&mut fill);
            }
            rest.iter_mut().for_each(fill);
            index += f32::from(rows.interval.get());
        }
    }
}
