//! Homogeneous linear solution of the direct linear transformation.

use nalgebra::{DMatrix, Matrix3, Matrix3x4, Matrix4, SymmetricEigen, Vector3, Vector4};

/// Fewest points.
pub const LEAST_POINTS: usize = 6;

/// Spread of points across a plane, as a share of their largest spread, below which they lie in it.
const LEAST_DEPTH: f64 = 1e-4;

/// Second smallest singular value, as a share of the largest, below which the points do not
/// determine the twelve.
const LEAST_SECOND: f64 = 1e-4;

/// A configuration of points that has no direct linear transformation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Configuration {
    /// All points lie on a line.
    OnALine,
    /// All points lie in a plane.
    Coplanar,
    /// All points but this one lie in a plane.
    AllButOneCoplanar { index: usize },
    /// Points and projection centre lie on a twisted cubic, or on a plane and a line through the
    /// projection centre.
    Critical,
}

/// Checks what can be seen of the object points alone.
pub(super) fn check_shape(points: &[Vector3<f64>]) -> Result<(), Configuration> {
    let sums = Sums::of(points);
    let [least, middle, most] = sums.spreads();
    if middle <= LEAST_DEPTH * most {
        return Err(Configuration::OnALine);
    }
    if least <= LEAST_DEPTH * most {
        return Err(Configuration::Coplanar);
    }
    for (index, point) in points.iter().enumerate() {
        let [least, _, most] = sums.without(point).spreads();
        if least <= LEAST_DEPTH * most {
            return Err(Configuration::AllButOneCoplanar { index });
        }
    }
    Ok(())
}

/// First and second moments of points.
#[derive(Debug, Clone, Copy)]
struct Sums {
    count: f64,
    sum: Vector3<f64>,
    squares: Matrix3<f64>,
}

impl Sums {
    fn of(points: &[Vector3<f64>]) -> Self {
        let mut sums = Self {
            count: 0.0,
            sum: Vector3::zeros(),
            squares: Matrix3::zeros(),
        };
        for point in points {
            sums.count += 1.0;
            sums.sum += point;
            sums.squares += point * point.transpose();
        }
        sums
    }

    fn without(&self, point: &Vector3<f64>) -> Self {
        Self {
            count: self.count - 1.0,
            sum: self.sum - point,
            squares: self.squares - point * point.transpose(),
        }
    }

    fn covariance(&self) -> Matrix3<f64> {
        let mean = self.sum / self.count;
        self.squares / self.count - mean * mean.transpose()
    }

    /// Spreads along the principal axes, smallest first.
    fn spreads(&self) -> [f64; 3] {
        let eigen = SymmetricEigen::new(self.covariance());
        let mut spreads: Vec<f64> = eigen
            .eigenvalues
            .iter()
            .map(|value| value.max(0.0).sqrt())
            .collect();
        spreads.sort_by(f64::total_cmp);
        match spreads.as_slice() {
            &[least, middle, most] => [least, middle, most],
            _ => [0.0; 3],
        }
    }
}

/// Returns the projection matrix of unit norm that fits image points (mm) and object points best
/// in the algebraic sense.
///
/// # Model
/// Null vector, by singular values, of the rows `r1·X + m14 - x(r3·X + m34)` and those of y, in
/// coordinates of mean zero: image points of unit spread, object points of unit spread along each
/// principal axis, so that a thin field is no special case and an origin far away costs nothing.
#[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
pub(super) fn projection(
    images_mm: &[[f64; 2]],
    points: &[Vector3<f64>],
) -> Result<Matrix3x4<f64>, Configuration> {
    let count = super::super::snooping::count(points.len());
    let sums = Sums::of(points);
    let mean = sums.sum / sums.count;
    let eigen = SymmetricEigen::new(sums.covariance());
    let mut whitening = eigen.eigenvectors.transpose();
    for (mut row, value) in whitening.row_iter_mut().zip(eigen.eigenvalues.iter()) {
        row /= value.max(f64::MIN_POSITIVE).sqrt();
    }
    let mut object = Matrix4::identity();
    object.fixed_view_mut::<3, 3>(0, 0).copy_from(&whitening);
    object
        .fixed_view_mut::<3, 1>(0, 3)
        .copy_from(&-(whitening * mean));
    let (mut x_mean, mut y_mean, mut squares) = (0.0, 0.0, 0.0);
    for [x, y] in images_mm {
        x_mean += x / count;
        y_mean += y / count;
        squares += (x * x + y * y) / count;
    }
    let scale = (0.5 * (squares - x_mean * x_mean - y_mean * y_mean))
        .max(f64::MIN_POSITIVE)
        .sqrt()
        .recip();
    let mut rows = Vec::with_capacity(24 * points.len());
    for ([x, y], point) in images_mm.iter().zip(points) {
        let p = object * Vector4::new(point.x, point.y, point.z, 1.0);
        let [[a, b, c, d]] = p.data.0;
        let [u, v] = [(x - x_mean) * scale, (y - y_mean) * scale];
        rows.extend([a, b, c, d, 0.0, 0.0, 0.0, 0.0]);
        rows.extend([a, b, c, d].map(|one| -u * one));
        rows.extend([0.0, 0.0, 0.0, 0.0, a, b, c, d]);
        rows.extend([a, b, c, d].map(|one| -v * one));
    }
    let design = DMatrix::from_row_slice(2 * points.len(), 12, &rows);
    let svd = design.qr().r().svd(false, true);
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    let value = |index: usize| svd.singular_values.get(index).copied().unwrap_or(0.0);
    order.sort_by(|a, b| value(*a).total_cmp(&value(*b)));
    let (Some(&least), Some(&second), Some(&largest), Some(vt)) =
        (order.first(), order.get(1), order.last(), &svd.v_t)
    else {
        return Err(Configuration::Critical);
    };
    if value(second) <= LEAST_SECOND * value(largest) {
        return Err(Configuration::Critical);
    }
    let solution: Vec<f64> = vt.row(least).iter().copied().collect();
    let normalised = Matrix3x4::from_row_slice(&solution);
    let image = Matrix3::new(
        scale.recip(),
        0.0,
        x_mean,
        0.0,
        scale.recip(),
        y_mean,
        0.0,
        0.0,
        1.0,
    );
    let matrix = image * normalised * object;
    Ok(matrix / matrix.norm())
}
