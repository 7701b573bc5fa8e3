//! σ of a coordinate.

use fmc_camera::geometry::evaluation_form::Jacobian;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_frames::CalibrationCovariance;

use super::active_frame::ActiveFrame;
use crate::cli::AnswerName;
use crate::command::points::Direction;

/// Returns the change of an answer with the principal point along the FMC axis, mm per mm.
///
/// # Model
/// An ideal point is x - D(x - c): it moves by J·e, with J = ∂D/∂x, that of the polynomial: the
/// slope of residual grids, a thousandth or less, is left out of σ. About the calibrated principal
/// point it moves by J·e - e, a measured one by -e/(1 + κ). In the other direction, with x - D = x'
/// of an ideal point x', the measured point moves by (I - J)⁻¹·J·e, and by e for points about the
/// calibrated principal point.
pub(super) fn by_principal_point(
    frame: &ActiveFrame<'_>,
    jacobian: Jacobian,
    direction: Direction,
    answer: AnswerName,
) -> [f64; 2] {
    let [ex, ey] = frame.axis;
    let Jacobian {
        dx_by_x,
        dx_by_y,
        dy_by_x,
        dy_by_y,
    } = jacobian;
    let [xx, xy, yx, yy] = [dx_by_x, dx_by_y, dy_by_x, dy_by_y].map(f64::from);
    let moved = [xx * ex + xy * ey, yx * ex + yy * ey];
    let [mx, my] = moved;
    match (direction, answer) {
        (Direction::Correct, AnswerName::Ideal) => moved,
        (Direction::Correct, AnswerName::IdealShifted) => [mx - ex, my - ey],
        (Direction::Correct, AnswerName::MeasuredShifted) => {
            frame.axis.map(|component| -component / frame.enlarged())
        }
        (Direction::Distort, AnswerName::Ideal) => measured_from_ideal(jacobian, moved),
        (Direction::Distort, AnswerName::IdealShifted | AnswerName::MeasuredShifted) => frame.axis,
    }
}

/// Returns the variance of an answer by that of the calibration, mm²: G·C·Gᵀ for ideal points, with
/// (I - J)⁻¹·G for the measured points of ideal ones; points that are moved alone have none.
pub(super) fn by_calibration(
    covariance: &CalibrationCovariance,
    frame: &ActiveFrame<'_>,
    measured: SensorPoint,
    direction: Direction,
    answer: AnswerName,
) -> [f64; 2] {
    if answer == AnswerName::MeasuredShifted {
        return [0.0; 2];
    }
    let polynomial = frame.correction.polynomial();
    let jacobian = polynomial.jacobian(measured);
    let centre = polynomial.centre();
    let point_mm = [measured.x_mm - centre.x_mm, measured.y_mm - centre.y_mm].map(f64::from);
    covariance.variance_mm2(point_mm, jacobian, |change| match direction {
        Direction::Correct => change,
        Direction::Distort => measured_from_ideal(jacobian, change),
    })
}

/// Returns (I - J)⁻¹ times a change of an ideal point: that of its measured point.
fn measured_from_ideal(jacobian: Jacobian, [x, y]: [f64; 2]) -> [f64; 2] {
    let Jacobian {
        dx_by_x,
        dx_by_y,
        dy_by_x,
        dy_by_y,
    } = jacobian;
    let [xx, xy, yx, yy] = [dx_by_x, dx_by_y, dy_by_x, dy_by_y].map(f64::from);
    let determinant = (1.0 - xx) * (1.0 - yy) - xy * yx;
    [
        ((1.0 - yy) * x + xy * y) / determinant,
        (yx * x + (1.0 - xx) * y) / determinant,
    ]
}
