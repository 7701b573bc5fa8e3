//! Parameters on which the distortion depends.

use fmc_camera::geometry::evaluation_form::Jacobian;

/// A parameter of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parameter {
    X0,
    Y0,
    /// Kᵢ, by i.
    Radial(i32),
    P1,
    P2,
    B1,
    B2,
    Distance,
}

impl Parameter {
    pub(crate) fn of(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "x0" | "xp" | "principal_point_x_mm" => Self::X0,
            "y0" | "yp" | "principal_point_y_mm" => Self::Y0,
            "k0" => Self::Radial(0),
            "k1" => Self::Radial(1),
            "k2" => Self::Radial(2),
            "k3" => Self::Radial(3),
            "p1" => Self::P1,
            "p2" => Self::P2,
            "b1" => Self::B1,
            "b2" => Self::B2,
            "c" | "f" | "principal_distance_mm" => Self::Distance,
            _ => return None,
        })
    }

    /// Returns ∂D of a point [x, y], mm from the centre of the distortion.
    pub(crate) fn change(self, [x, y]: [f64; 2], jacobian: Jacobian) -> [f64; 2] {
        let r2 = x * x + y * y;
        let Jacobian {
            dx_by_x,
            dx_by_y,
            dy_by_x,
            dy_by_y,
        } = jacobian;
        match self {
            Self::X0 => [-f64::from(dx_by_x), -f64::from(dy_by_x)],
            Self::Y0 => [-f64::from(dx_by_y), -f64::from(dy_by_y)],
            Self::Radial(power) => [x * r2.powi(power), y * r2.powi(power)],
            Self::P1 => [r2 + 2.0 * x * x, 2.0 * x * y],
            Self::P2 => [2.0 * x * y, r2 + 2.0 * y * y],
            Self::B1 => [x, 0.0],
            Self::B2 => [y, 0.0],
            Self::Distance => [0.0; 2],
        }
    }
}
