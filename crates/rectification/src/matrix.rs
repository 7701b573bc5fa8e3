//! Matrices and vectors of the plane.

/// A matrix by rows.
pub(crate) type Matrix = [[f64; 2]; 2];

/// Returns the inverse of the identity less a matrix; `None` where its determinant is not positive.
pub(crate) fn inverse([[a, b], [c, d]]: Matrix) -> Option<Matrix> {
    let determinant = (1.0 - a) * (1.0 - d) - b * c;
    (determinant > 0.0).then(|| {
        let scale = 1.0 / determinant;
        [
            [scale * (1.0 - d), scale * b],
            [scale * c, scale * (1.0 - a)],
        ]
    })
}

pub(crate) fn times([of_x, of_y]: Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    [of_x[0] * x + of_x[1] * y, of_y[0] * x + of_y[1] * y]
}

/// Returns the length of a vector, with the same bits on every machine.
pub(crate) fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
