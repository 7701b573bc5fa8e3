//! σ of a coordinate.

use fmc_camera::geometry::evaluation_form::Jacobian;

use super::active_frame::ActiveFrame;
use crate::cli::AnswerName;
use crate::command::points::Direction;

/// Returns the change of an answer with the principal point along the FMC axis, mm per mm.
///
/// # Model
/// An ideal point is x - D(x - c): it moves by J·e, with J = ∂D/∂x. About the calibrated principal
/// point it moves by J·e - e, a measured one by -e/(1 + κ). In the other direction, with x - D = x'
/// of an ideal point x', the measured point moves by (I - J)⁻¹·J·e, and by e for points about the
/// calibrated principal point.
pub(super) fn by_principal_point(
    frame: &ActiveFrame,
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
        (Direction::Distort, AnswerName::Ideal) => {
            let determinant = (1.0 - xx) * (1.0 - yy) - xy * yx;
            [
                ((1.0 - yy) * mx + xy * my) / determinant,
                (yx * mx + (1.0 - xx) * my) / determinant,
            ]
        }
        (Direction::Distort, AnswerName::IdealShifted | AnswerName::MeasuredShifted) => frame.axis,
    }
}
