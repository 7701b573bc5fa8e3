//! Bound on the error of sources by differences; [`SourceMesh`](super::source_mesh::SourceMesh)
//! explains its parts.

use super::block_matrix::{LEBESGUE, NODE_POLYNOMIAL};
use super::rounding_bound::{
    SECOND_ORDER, UNIT_ROUNDOFF, absolute, largest_of_cubic, power_of_two_within,
};
use crate::geometry::evaluation_form::EvaluationForm;
use crate::geometry::frame_correction::FrameCorrection;
use crate::geometry::newton_step::LEFT_BY_ONE_STEP_NM;

/// Largest c₁ for which the majorant is used: a slope of one half in every direction.
const STEEPEST: f32 = 0.5;

/// Parts of the bound of a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourceBound {
    /// s₁ - 1 and s₂ to s₆, mm¹⁻ᵏ.
    majorant: [f32; 6],
    /// Half a unit in the last place of the largest displacement, in u, mm.
    half_unit: f32,
    /// Largest error of a node, mm.
    node: f32,
}

impl SourceBound {
    /// Returns the bound of a frame, or `None` if its distortion may have a slope above one half.
    pub(super) fn new(correction: &FrameCorrection) -> Option<Self> {
        let (sensor, centre) = (correction.sensor(), correction.centre());
        let reach_x = sensor.half_width_mm() + centre.x_mm.abs();
        let reach_y = sensor.half_height_mm() + centre.y_mm.abs();
        let (reach, end) = (reach_x.max(reach_y), reach_x * reach_x + reach_y * reach_y);
        let radius = SECOND_ORDER * fmc_camera_kernel::sqrt(end);
        let form = correction.form();
        let absolute = absolute(form);
        let tangential = absolute.hx + absolute.hy + absolute.gx + absolute.gy;
        let affine = absolute.k0 + absolute.b1 + absolute.b2;
        let gain = largest_of_cubic([0.0, form.k1, form.k2, form.k3], end);
        let along = largest_of_cubic([0.0, 3.0 * form.k1, 5.0 * form.k2, 7.0 * form.k3], end);
        let slope = gain.max(along) + affine + 2.0 * radius * tangential;
        // A NaN is not within the limit.
        (slope <= STEEPEST).then_some(())?;
        let majorant = majorant(&absolute, tangential, slope, radius);
        let [steepest, ..] = majorant;
        let beside = radius * (affine + radius * tangential) + absolute.tx + absolute.ty;
        let terms =
            end * (12.0 * absolute.k1 + end * (16.0 * absolute.k2 + end * (19.0 * absolute.k3)));
        // Of an axis, and of the vector.
        let roundings = |reach: f32| {
            let displacement = reach * gain + beside;
            reach * (terms + 5.0 * slope) + 8.0 * beside + displacement
        };
        let node = roundings(reach) + steepest * roundings(radius);
        Some(Self {
            majorant,
            half_unit: power_of_two_within(reach * gain + beside),
            node: UNIT_ROUNDOFF * node + 1e-6 * LEFT_BY_ONE_STEP_NM,
        })
    }

    /// Returns the bound for blocks of `length` vertices `step_mm` apart, nm per axis.
    pub(super) fn nanometres(&self, length: u16, step_mm: f32) -> f32 {
        let count = f32::from(length);
        let block = count * step_mm;
        let [s1, s2, s3, s4, s5, s6] = self.majorant;
        // sₖ·Lᵏ.
        let l2 = block * block;
        let (l3, l4) = (l2 * block, l2 * l2);
        let [s1, s2, s3, s4, s5, s6] = [
            s1 * block,
            s2 * l2,
            s3 * l3,
            s4 * l4,
            s5 * l4 * block,
            s6 * l3 * l3,
        ];
        let [p1, p2] = [
            s1 + 2.0 * s2 + 3.0 * s3 + 4.0 * s4 + 5.0 * s5,
            s2 + 3.0 * s3 + 6.0 * s4 + 10.0 * s5,
        ];
        let [p3, p4] = [s3 + 4.0 * s4 + 10.0 * s5, s4 + 5.0 * s5];
        let additions = self.half_unit + 0.5 * p1 + p2 / 3.0 + 0.25 * p3 + 0.2 * p4;
        let start = 8.0 * s1 + 16.0 * s2 + 24.0 * s3 + 40.0 * s4 + 64.0 * s5;
        let between = NODE_POLYNOMIAL * s6;
        let rounding = UNIT_ROUNDOFF * (count * additions + start);
        SECOND_ORDER * 1e6 * (between + LEBESGUE * self.node + rounding)
    }

    /// Returns the largest change of a displacement from a vertex of a block to the nearest node,
    /// mm.
    pub(super) fn off_nodes_mm(&self, length: u16, step_mm: f32) -> f32 {
        let [slope, ..] = self.majorant;
        0.125 * f32::from(length) * step_mm * slope
    }
}

/// Returns s₁ - 1 and s₂ to s₆ for measured points within `radius` of the centre, where the slope
/// of the distortion is at most `c1`, from absolute values of the coefficients.
fn majorant(absolute: &EvaluationForm, tangential: f32, c1: f32, radius: f32) -> [f32; 6] {
    let EvaluationForm { k1, k2, k3, .. } = *absolute;
    let r2 = radius * radius;
    let c2 = radius * (3.0 * k1 + r2 * (10.0 * k2 + r2 * (21.0 * k3))) + tangential;
    let c3 = k1 + r2 * (10.0 * k2 + r2 * (35.0 * k3));
    let c4 = radius * (5.0 * k2 + r2 * (35.0 * k3));
    let c5 = k2 + r2 * (21.0 * k3);
    let c6 = radius * (7.0 * k3);
    // Lagrange's inversion of s - c₂s² - … = t, where c₁ has been divided out.
    let a = 1.0 / (1.0 - c1);
    let [c2, c3, c4, c5, c6] = [c2, c3, c4, c5, c6].map(|c| a * c);
    let square = c2 * c2;
    let s3 = c3 + 2.0 * square;
    let s4 = c4 + c2 * (5.0 * c3 + 5.0 * square);
    let s5 = c5 + 6.0 * c2 * c4 + 3.0 * c3 * c3 + square * (21.0 * c3 + 14.0 * square);
    let s6 = c6
        + 7.0 * (c2 * c5 + c3 * c4)
        + 28.0 * (square * c4 + c2 * c3 * c3)
        + square * c2 * (84.0 * c3 + 42.0 * square);
    let a2 = a * a;
    let a3 = a2 * a;
    [
        a * c1,
        a2 * c2,
        a3 * s3,
        a3 * a * s4,
        a3 * a2 * s5,
        a3 * a3 * s6,
    ]
}
