//! Falloff of the light towards the corners.

use nalgebra::{Matrix3, Vector3};

use crate::number::rms;

/// A place of the frame and the response there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// Tangent of the field angle.
    pub(super) field: f64,
    pub(super) response: f64,
}

/// Falloff of a lens.
///
/// # Model
/// `V = c·cos⁴(atan(t))·(1 + a₂ t² + a₄ t⁴)`, t the tangent of the field angle: the physical law
/// times what the lens adds to it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Falloff {
    /// c, response on the axis, DN per DN of the level.
    pub on_axis: f64,
    /// a₂ and a₄.
    pub even: [f64; 2],
    /// Root mean square of what the model leaves, part of the axis.
    pub misfit: f64,
}

impl Falloff {
    /// Fits the model; `None` where the samples do not determine it.
    pub(super) fn fit(samples: &[Sample]) -> Option<Self> {
        let (mut normals, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for Sample { field, response } in samples {
            let square = field * field;
            let row = cos_fourth(*field) * Vector3::new(1.0, square, square * square);
            normals += row * row.transpose();
            right += *response * row;
        }
        let [[on_axis, second, fourth]] = normals.cholesky()?.solve(&right).data.0;
        if !(on_axis > 0.0 && on_axis.is_finite()) {
            return None;
        }
        let mut falloff = Self {
            on_axis,
            even: [second / on_axis, fourth / on_axis],
            misfit: 0.0,
        };
        let left = samples
            .iter()
            .map(|sample| sample.response / on_axis - falloff.at(sample.field));
        falloff.misfit = rms(left)?;
        Some(falloff)
    }

    /// Returns the light at a tangent of the field angle, 1 on the axis.
    #[must_use]
    pub fn at(&self, field: f64) -> f64 {
        let square = field * field;
        let [second, fourth] = self.even;
        cos_fourth(field) * (1.0 + square * (second + square * fourth))
    }
}

/// Light at a tangent of the field angle, 1 on the axis, by the physical law alone.
pub(super) fn cos_fourth(field: f64) -> f64 {
    (1.0 + field * field).powi(-2)
}
