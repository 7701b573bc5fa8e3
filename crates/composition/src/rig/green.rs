//! Camera of one detector beside those of the virtual image.

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use crate::number::real;

/// Steps of the inverse of the distortion.
const STEPS: usize = 30;

/// A camera of one detector with the ground cover of the virtual image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Green {
    /// Principal distance, mm.
    pub principal_distance_mm: f64,
    /// Side of a pixel, µm.
    pub pixel_um: f64,
    /// Columns.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// Calibrated distortion.
    #[serde(default)]
    pub distortion: Distortion,
}

/// Distortion, measured - ideal, a function of the measured point from the principal point.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Distortion {
    /// K1, mm⁻².
    pub k1: f64,
    /// K2, mm⁻⁴.
    pub k2: f64,
    /// K3, mm⁻⁶.
    pub k3: f64,
    /// P1, mm⁻¹.
    pub p1: f64,
    /// P2, mm⁻¹.
    pub p2: f64,
}

impl Distortion {
    /// Returns the distortion of a measured point, mm (`docs/conventions.md`, section 3).
    #[must_use]
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let square = x * x + y * y;
        let radial = square * (self.k1 + square * (self.k2 + square * self.k3));
        [
            x * radial + self.p1 * (square + 2.0 * x * x) + 2.0 * self.p2 * x * y,
            y * radial + self.p2 * (square + 2.0 * y * y) + 2.0 * self.p1 * x * y,
        ]
    }

    /// Returns the ideal point of a measured one, mm.
    #[must_use]
    pub fn ideal(&self, measured: [f64; 2]) -> [f64; 2] {
        let [dx, dy] = self.at(measured);
        [measured[0] - dx, measured[1] - dy]
    }

    /// Returns the measured point of an ideal one, mm, by Newton's method with differences; `None`
    /// if it does not end below 1e-9 mm within 30 steps.
    #[must_use]
    pub fn measured(&self, ideal: [f64; 2]) -> Option<[f64; 2]> {
        let aim = Vector2::from(ideal);
        let mut measured = aim;
        for _ in 0..STEPS {
            let at = |point: Vector2<f64>| Vector2::from(self.ideal(point.into()));
            let step = 1e-5;
            let by_x = (at(measured + Vector2::new(step, 0.0)) - at(measured)) / step;
            let by_y = (at(measured + Vector2::new(0.0, step)) - at(measured)) / step;
            let way = Matrix2::from_columns(&[by_x, by_y]).try_inverse()? * (aim - at(measured));
            measured += way;
            if way.amax() < 1e-9 {
                return Some(measured.into());
            }
        }
        None
    }
}

impl Green {
    /// Place of the centre, px.
    #[must_use]
    pub fn centre_px(&self) -> [f64; 2] {
        [real(self.width_px), real(self.height_px)].map(|side| (side - 1.0) / 2.0)
    }

    /// Returns the pixel, distorted, of a direction given by the tangents to the right and
    /// downwards; `None` beyond the range of the distortion.
    #[must_use]
    pub fn pixel(&self, [right, down]: [f64; 2]) -> Option<[f64; 2]> {
        let f_mm = self.principal_distance_mm;
        let [x, y] = self.distortion.measured([f_mm * right, -f_mm * down])?;
        let [col, row] = self.centre_px();
        let pixel_mm = self.pixel_um / 1e3;
        Some([col + x / pixel_mm, row - y / pixel_mm])
    }

    /// Returns the direction of a recorded pixel: tangents to the right and downwards.
    #[must_use]
    pub fn direction(&self, [col, row]: [f64; 2]) -> [f64; 2] {
        let [centre_col, centre_row] = self.centre_px();
        let pixel_mm = self.pixel_um / 1e3;
        let measured = [(col - centre_col) * pixel_mm, (centre_row - row) * pixel_mm];
        let [x, y] = self.distortion.ideal(measured);
        [
            x / self.principal_distance_mm,
            -y / self.principal_distance_mm,
        ]
    }
}
