//! Sum of all roundings of a block of sources, at their worst, against the stated bound.
//!
//! The operations of a block are repeated in double precision, each with the rounding that it may
//! have in single precision. Unlike the bound, this uses the numbers that are rounded and not the
//! largest possible ones.

use crate::geometry::mesh::frames;
use crate::geometry::mesh_rounding::{Rounded, UNIT_NM};
use crate::geometry::source_row::source_f64;
use fmc_camera::geometry::evaluation_form::EvaluationForm;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::mesh::source_mesh::SourceMesh;
use fmc_camera::geometry::sensor::SensorPoint;

/// Largest sum found, nm.
const WORST_NM: f64 = 2.1;

/// Nodes of a block in eighths.
const NODES: [u16; 6] = [0, 1, 3, 5, 7, 8];

/// Returns the displacement at a measured point counted from the centre, with its roundings.
fn displacement(form: &EvaluationForm, x: f64, y: f64) -> [Rounded; 2] {
    let [k0, k1, k2, k3] = [form.k0, form.k1, form.k2, form.k3].map(Rounded::given);
    let [hx, hy, gx, gy] = [form.hx, form.hy, form.gx, form.gy].map(Rounded::given);
    let [b1, b2, tx, ty] = [form.b1, form.b2, form.tx, form.ty].map(Rounded::given);
    let (x, y) = (Rounded::exact(x), Rounded::exact(y));
    let r2 = x * x + y * y;
    let gain = k0 + r2 * (k1 + r2 * (k2 + r2 * k3)) + hx * x + hy * y;
    [
        x * gain + gx * r2 + b1 * x + b2 * y + tx,
        y * gain + gy * r2 + ty,
    ]
}

/// Returns the source of an ideal point with the largest error that Newton's method leaves in it.
fn node(correction: &FrameCorrection, ideal: [f64; 2]) -> [Rounded; 2] {
    let exact = source_f64(correction, ideal);
    let centre = correction.centre();
    let [x, y] = [ideal[0] + exact[0], ideal[1] + exact[1]];
    let from_centre = [x - f64::from(centre.x_mm), y - f64::from(centre.y_mm)];
    let found = displacement(correction.form(), from_centre[0], from_centre[1]);
    #[expect(clippy::cast_possible_truncation, reason = "a slope")]
    let jacobian = correction.jacobian(SensorPoint::new(x as f32, y as f32));
    let by_x = [jacobian.dx_by_x, jacobian.dy_by_x].map(|slope| f64::from(slope.abs()));
    let by_y = [jacobian.dx_by_y, jacobian.dy_by_y].map(|slope| f64::from(slope.abs()));
    // The way from the pixel to the centred point that Newton's step starts from: five roundings.
    let place = from_centre.map(|from_centre| 5.0 * from_centre.abs());
    let [off_x, off_y] = [0, 1].map(|axis| {
        let moved = by_x[axis] * place[0] + by_y[axis] * place[1];
        found[axis].off + moved + exact[axis].abs()
    });
    let steepest = by_x.into_iter().chain(by_y).fold(0.0, f64::max);
    let scale = 1.0 / (1.0 - 2.0 * steepest);
    [(exact[0], off_x), (exact[1], off_y)].map(|(value, off)| Rounded {
        value,
        off: scale * off + 0.01 / UNIT_NM,
    })
}

/// A number with the share of each rounding in its error, in 2⁻²⁴: errors that a block brings
/// back together cancel as they do there.
#[derive(Clone)]
struct Traced {
    value: f64,
    shares: Vec<f64>,
}

impl Traced {
    /// Returns the largest error.
    fn off(&self) -> f64 {
        self.shares.iter().map(|share| share.abs()).sum()
    }
}

/// Arithmetic whose roundings are numbered.
struct Arithmetic {
    roundings: usize,
}

impl Arithmetic {
    /// Returns a number with an error of its own.
    fn rounded(&mut self, value: f64, off: f64, mut shares: Vec<f64>) -> Traced {
        shares.resize(self.roundings, 0.0);
        shares.push(off);
        self.roundings += 1;
        Traced { value, shares }
    }

    /// Returns `p·a + q·b`, where neither product is rounded.
    fn sum(&mut self, p: f64, a: &Traced, q: f64, b: &Traced) -> Traced {
        let value = p * a.value + q * b.value;
        let length = a.shares.len().max(b.shares.len());
        let share = |of: &Traced, index: usize| of.shares.get(index).copied().unwrap_or(0.0);
        let shares = (0..length)
            .map(|index| p * share(a, index) + q * share(b, index))
            .collect();
        self.rounded(value, half_unit(value), shares)
    }

    /// Returns the product with a constant that is itself rounded.
    fn times(&mut self, a: &Traced, constant: f64) -> Traced {
        let value = constant * a.value;
        let shares = a.shares.iter().map(|share| constant * share).collect();
        self.rounded(value, half_unit(value) + value.abs(), shares)
    }
}

/// Half a unit in the last place, in 2⁻²⁴.
fn half_unit(value: f64) -> f64 {
    if value == 0.0 {
        0.0
    } else {
        value.abs().log2().floor().exp2()
    }
}

/// Returns the differences of one axis at the first vertex of a block, as the library computes
/// them.
fn differences(arithmetic: &mut Arithmetic, nodes: &[Traced; 6], length: u16) -> [Traced; 6] {
    let [f0, f1, f2, f3, f4, f5] = nodes;
    let chord = arithmetic.sum(1.0, f5, -1.0, f0);
    let mut residual = |value: &Traced, share: f64| {
        let above = arithmetic.sum(1.0, value, -1.0, f0);
        let way = arithmetic.times(&chord, share);
        arithmetic.sum(1.0, &above, -1.0, &way)
    };
    let [r1, r2] = [residual(f1, 0.125), residual(f2, 0.375)];
    let [r3, r4] = [residual(f3, 0.625), residual(f4, 0.875)];
    // Sums or differences of both sides, for the even or the odd terms.
    let mut two = |side: f64, [outer, inner]: [f64; 2]| {
        let both = arithmetic.sum(1.0, &r4, side, &r1);
        let outer = arithmetic.times(&both, outer);
        let both = arithmetic.sum(1.0, &r3, side, &r2);
        let inner = arithmetic.times(&both, inner);
        let high = arithmetic.sum(8.0, &outer, -8.0, &inner);
        let low = arithmetic.sum(1.0, &inner, -1.0 / 64.0, &high);
        [low, high]
    };
    let even = two(1.0, [32.0 / 7.0, 32.0 / 15.0]);
    let odd = two(-1.0, [256.0 / 21.0, 256.0 / 15.0]);
    let h = 1.0 / f64::from(length);
    let chord = arithmetic.times(&chord, h);
    let mut of = |order: usize, start: Option<&Traced>| {
        let terms = [(&even[0], 0), (&odd[0], 1), (&even[1], 2), (&odd[1], 3)];
        let mut sum = start.cloned();
        for (coefficient, power) in terms.into_iter().skip(order.saturating_sub(2)) {
            let product = arithmetic.times(coefficient, difference(power, order, h));
            sum = Some(match sum {
                Some(sum) => arithmetic.sum(1.0, &sum, 1.0, &product),
                None => product,
            });
        }
        sum.unwrap()
    };
    let [d1, d2, d3] = [of(1, Some(&chord)), of(2, None), of(3, None)];
    let [d4, d5] = [of(4, None), of(5, None)];
    [f0.clone(), d1, d2, d3, d4, d5]
}

/// Returns Δᵏ of `t(1 - t)·sⁿ` at the first vertex, from its values at those behind it.
fn difference(power: i32, order: usize, h: f64) -> f64 {
    let value = |index: usize| {
        let t = h * f64::from(u8::try_from(index).unwrap());
        t * (1.0 - t) * (t - 0.5).powi(power)
    };
    let mut values: Vec<f64> = (0..=order).map(value).collect();
    for _ in 0..order {
        values = values.windows(2).map(|two| two[1] - two[0]).collect();
    }
    values[0]
}

/// Returns the largest possible error of a block that begins at `x_mm`, nm: of roundings, and of
/// the polynomial itself.
fn worst_nm(
    correction: &FrameCorrection,
    length: u16,
    [x_mm, y_mm]: [f64; 2],
    step_mm: f64,
) -> [f64; 2] {
    let ideal = |index: u16| [x_mm + step_mm * f64::from(index), y_mm];
    let nodes = NODES.map(|eighths| node(correction, ideal(length / 8 * eighths)));
    let mut worst = [0.0_f64; 2];
    for axis in 0..2 {
        let mut arithmetic = Arithmetic { roundings: 0 };
        let nodes = nodes.map(|node| (node[axis].value, node[axis].off));
        let nodes = nodes.map(|(value, off)| arithmetic.rounded(value, off, vec![]));
        let mut now = differences(&mut arithmetic, &nodes, length);
        for index in 0..=length {
            let exact = source_f64(correction, ideal(index))[axis];
            worst[0] = worst[0].max(UNIT_NM * now[0].off());
            worst[1] = worst[1].max(1e6 * (now[0].value - exact).abs());
            for order in 1..6 {
                now[order - 1] = arithmetic.sum(1.0, &now[order - 1], 1.0, &now[order]);
            }
        }
    }
    worst
}

#[test]
fn roundings_that_all_come_together_and_the_polynomial_are_within_the_stated_bound() {
    for (name, correction) in frames() {
        for spacing_px in [8, 64] {
            let mesh = SourceMesh::new(&correction, spacing_px);
            let (Some(length), Some(bound_nm)) = (mesh.block_length(), mesh.bound_nm()) else {
                continue;
            };
            let sensor = correction.sensor();
            let step_mm = f64::from(spacing_px) * f64::from(sensor.pixel_mm());
            let [right, top] = [sensor.half_width_mm(), sensor.half_height_mm()].map(f64::from);
            let block_mm = step_mm * f64::from(length);
            let mut worst = [0.0_f64; 2];
            for share in [-1.0, 0.3, 1.0] {
                for y in [-0.4, 0.0, 1.0] {
                    let x_mm = (share * right).clamp(-right + 1.0, right - 1.0 - block_mm);
                    let found = worst_nm(&correction, length, [x_mm, y * (top - 1.0)], step_mm);
                    worst = [worst[0].max(found[0]), worst[1].max(found[1])];
                }
            }
            let [roundings_nm, polynomial_nm] = worst;
            let sum_nm = roundings_nm + polynomial_nm;
            assert!(
                sum_nm <= f64::from(bound_nm),
                "{name}, {spacing_px} px: {worst:?} > {bound_nm}"
            );
            assert!(
                roundings_nm <= WORST_NM,
                "{name}, {spacing_px} px: {worst:?}"
            );
            // The bound is not many times as large.
            assert!(
                name != "wide" || roundings_nm >= 0.3 * f64::from(bound_nm),
                "{name}, {spacing_px} px: {roundings_nm} of {bound_nm} nm"
            );
        }
    }
}
