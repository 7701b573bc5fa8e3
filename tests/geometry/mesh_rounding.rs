//! Sum of all roundings of a row, at their worst, against the stated bound.
//!
//! The additions and products of `DisplacementRow::write` are repeated in double precision, each
//! with the rounding that it may have in single precision. Unlike the bound, this uses the numbers
//! that are rounded and not the largest possible ones.

use core::ops::{Add, Mul};

use crate::geometry::mesh::{SPACINGS_PX, frames};
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::displacement_rows::DisplacementRows;
use fmc_camera::geometry::sensor::SensorPoint;

/// 2⁻²⁴ of a millimetre, nm.
pub(crate) const UNIT_NM: f64 = 1e6 / 16_777_216.0;

/// Largest sum found, nm.
const WORST_NM: f64 = 2.3;

/// A number and its largest error, in 2⁻²⁴.
#[derive(Clone, Copy)]
pub(crate) struct Rounded {
    pub(crate) value: f64,
    pub(crate) off: f64,
}

impl Rounded {
    pub(crate) const fn exact(value: f64) -> Self {
        Self { value, off: 0.0 }
    }

    pub(crate) fn given(value: f32) -> Self {
        Self::exact(f64::from(value))
    }

    fn is_zero(self) -> bool {
        self.value.abs() + self.off == 0.0
    }

    /// Returns true if a product with the number is not rounded.
    fn is_power_of_two(self) -> bool {
        self.off == 0.0 && self.value.abs().log2().fract() == 0.0
    }

    fn with_rounding(self) -> Self {
        let half_unit = if self.value == 0.0 {
            0.0
        } else {
            self.value.abs().log2().floor().exp2()
        };
        Self {
            off: self.off + half_unit,
            ..self
        }
    }
}

impl Add for Rounded {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = Self {
            value: self.value + other.value,
            off: self.off + other.off,
        };
        if self.is_zero() || other.is_zero() {
            sum
        } else {
            sum.with_rounding()
        }
    }
}

impl Mul for Rounded {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self {
            value: self.value * other.value,
            off: self.off * other.value.abs() + other.off * self.value.abs(),
        };
        if self.is_power_of_two() || other.is_power_of_two() {
            product
        } else {
            product.with_rounding()
        }
    }
}

/// Coefficients of G, of the terms beside X·G, and of those beside Y·G, lowest power first; and Y.
struct Row {
    gain: Vec<Rounded>,
    beside: [Vec<Rounded>; 2],
    y: Rounded,
}

fn row(correction: &FrameCorrection, y_mm: f32) -> Row {
    let form = correction.form();
    let [k0, k1, k2, k3] = [form.k0, form.k1, form.k2, form.k3].map(Rounded::given);
    let [hx, hy, gx, gy] = [form.hx, form.hy, form.gx, form.gy].map(Rounded::given);
    let [b1, b2, tx, ty] = [form.b1, form.b2, form.tx, form.ty].map(Rounded::given);
    let [two, three, none] = [2.0, 3.0, 0.0].map(Rounded::exact);
    let y = Rounded::given(y_mm) + Rounded::given(-correction.centre().y_mm);
    let s = y * y;
    let s_k3 = three * (s * k3);
    let g0 = k0 + hy * y + s * (k1 + s * (k2 + s * k3));
    let g2 = k1 + s * (two * k2 + s_k3);
    let mut gain = vec![g0, hx, g2, none, k2 + s_k3];
    if form.k3 != 0.0 {
        gain.extend([none, k3]);
    }
    let beside_x = vec![gx * s + b2 * y + tx, b1, gx];
    let beside_y = vec![gy * s + ty, none, gy];
    Row {
        gain,
        beside: [beside_x, beside_y],
        y,
    }
}

fn newton_form(coefficients: &[Rounded], nodes: &[Rounded]) -> Vec<Rounded> {
    let mut form = coefficients.to_vec();
    for (lowest, node) in nodes.iter().enumerate() {
        for index in (lowest..form.len() - 1).rev() {
            form[index] = form[index] + *node * form[index + 1];
        }
        if lowest + 2 > form.len() {
            break;
        }
    }
    form
}

/// Returns the differences of Dx and Dy at `x`, taken as exact.
fn start(row: &Row, x: f64, step: f32) -> [Vec<Rounded>; 2] {
    let step = Rounded::given(step);
    let mut nodes = vec![Rounded::exact(x)];
    let mut scales = vec![Rounded::exact(1.0)];
    for order in 1..8_u8 {
        nodes.push(nodes[nodes.len() - 1] + step);
        let factor = Rounded::exact(f64::from(order)) * step;
        scales.push(scales[scales.len() - 1] * factor);
    }
    let gain = newton_form(&row.gain, &nodes);
    let mut dx: Vec<_> = (0..=gain.len())
        .map(|k| match (gain.get(k), k.checked_sub(1)) {
            (Some(own), Some(below)) => nodes[k] * *own + gain[below],
            (Some(own), None) => nodes[k] * *own,
            (None, _) => gain[k - 1],
        })
        .collect();
    let mut dy: Vec<_> = gain.iter().map(|own| row.y * *own).collect();
    for (axis, beside) in [&mut dx, &mut dy].into_iter().zip(&row.beside) {
        for (own, beside) in axis.iter_mut().zip(newton_form(beside, &nodes)) {
            *own = *own + beside;
        }
        for (own, scale) in axis.iter_mut().zip(&scales) {
            *own = *own * *scale;
        }
    }
    [dx, dy]
}

/// Returns the largest possible error of the displacements of one row, nm.
fn worst_nm(correction: &FrameCorrection, rows: &DisplacementRows, step: f32, y_mm: f32) -> f64 {
    let right = correction.sensor().half_width_mm();
    let row = row(correction, y_mm);
    let first = Rounded::given(-right) + Rounded::given(-correction.centre().x_mm);
    let place = |index: u16| first + Rounded::exact(f64::from(index)) * Rounded::given(step);
    let count = 1
        + (1..u16::MAX)
            .take_while(|index| -right + f32::from(*index) * step <= right)
            .count();
    let indices: Vec<u16> = (0..u16::try_from(count).unwrap()).collect();
    let centre = indices.partition_point(|index| place(*index).value <= 0.0);
    let (left, after) = indices.split_at(centre);
    let outward: Vec<u16> = left.iter().rev().copied().collect();
    let interval = usize::from(rows.restart_interval());
    let blocks = outward.chunks(interval).map(|block| (block, -step));
    let blocks = blocks.chain(after.chunks(interval).map(|block| (block, step)));
    let mut found = vec![Displacement::default(); count];
    rows.row(SensorPoint::new(-right, y_mm)).write(&mut found);
    let mut worst = 0.0_f64;
    for (block, step) in blocks {
        let start_place = place(block[0]);
        let mut axes = start(&row, start_place.value, step);
        for index in block {
            #[expect(clippy::cast_possible_truncation, reason = "a slope")]
            let x_mm = place(*index).value as f32 + correction.centre().x_mm;
            let jacobian = correction.jacobian(SensorPoint::new(x_mm, y_mm));
            let slopes = [jacobian.dx_by_x, jacobian.dy_by_x].map(|slope| f64::from(slope.abs()));
            let Displacement { dx_mm, dy_mm } = found[usize::from(*index)];
            for ((axis, slope), found_mm) in axes.iter_mut().zip(slopes).zip([dx_mm, dy_mm]) {
                let off_nm = UNIT_NM * (axis[0].off + slope * start_place.off);
                let error_nm = 1e6 * (f64::from(found_mm) - axis[0].value).abs();
                assert!(error_nm <= off_nm, "{error_nm} > {off_nm} nm");
                worst = worst.max(off_nm);
                for order in 1..axis.len() {
                    axis[order - 1] = axis[order - 1] + axis[order];
                }
            }
        }
    }
    worst
}

#[test]
fn roundings_that_all_come_together_are_within_the_stated_bound() {
    for (name, correction) in frames() {
        for spacing_px in SPACINGS_PX {
            let step_mm = spacing_px * correction.sensor().pixel_mm();
            let rows = DisplacementRows::new(&correction, step_mm);
            let bound_nm = f64::from(rows.rounding_bound_nm());
            let top = correction.sensor().half_height_mm();
            let worst_nm = [-1.0, -0.4, 0.0, 0.7, 1.0]
                .map(|share| worst_nm(&correction, &rows, step_mm, share * top))
                .into_iter()
                .fold(0.0, f64::max);
            assert!(
                worst_nm <= bound_nm,
                "{name}, {spacing_px} px: {worst_nm} > {bound_nm} nm"
            );
            assert!(worst_nm <= WORST_NM, "{name}: {worst_nm} nm");
            // The bound is not many times as large.
            assert!(
                name != "wide" || worst_nm >= 0.2 * bound_nm,
                "{name}, {spacing_px} px: {worst_nm} of {bound_nm} nm"
            );
        }
    }
}
