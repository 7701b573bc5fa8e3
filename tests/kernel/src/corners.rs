//! Corner cases: special numbers as coordinates and as coefficients, and every number of points up
//! to nine.

use fmc_camera_kernel::Coefficients;

use crate::arithmetic::OF_KERNEL;
use crate::check::{self, Difference};

/// Coordinates and coefficients that are special in the arithmetic.
const SPECIAL: [f32; 17] = [
    0.0,
    -0.0,
    1.0e-45,
    -1.0e-45,
    1.175_494_2e-38,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1.0e-20,
    1.0,
    -1.0,
    60.0,
    -60.0,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

/// Coefficients of a camera.
pub(crate) const CAMERA: Coefficients = Coefficients {
    cx: 0.131,
    cy: -0.074,
    k0: 1.2e-4,
    k1: -2.1e-5,
    k2: 5.3e-9,
    k3: -1.1e-12,
    hx: 6.1e-6,
    hy: -8.2e-6,
    gx: 3.05e-6,
    gy: -4.1e-6,
    b1: 2.2e-5,
    b2: -1.7e-5,
    tx: 3.0e-6,
    ty: -5.0e-6,
};

/// Compares the corner cases; returns the number of points.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn compare() -> Result<usize, Difference> {
    let mut points = [[0.0; 2]; SPECIAL.len() * SPECIAL.len()];
    let all_x = SPECIAL
        .iter()
        .flat_map(|x| SPECIAL.iter().map(move |y| [*x, *y]));
    for (point, special) in points.iter_mut().zip(all_x) {
        *point = special;
    }
    let mut compared = 0;
    for form in forms() {
        compared += both(&form, &points)?;
        for length in 0..=9 {
            // Each length starts at another point.
            let (_, from) = points.split_at(11 * length);
            compared += both(&form, from.split_at(length).0)?;
        }
    }
    Ok(compared)
}

fn both(form: &Coefficients, points: &[[f32; 2]]) -> Result<usize, Difference> {
    check::pairs(form, points, OF_KERNEL)?;
    check::xy(form, points, OF_KERNEL)?;
    Ok(points.len())
}

/// Returns a camera, all zeros, and for each special number a camera with that number as each
/// coefficient in turn, then as all.
fn forms() -> impl Iterator<Item = Coefficients> {
    let special = SPECIAL.into_iter().flat_map(|value| {
        let one = (0..14).map(move |index| {
            let mut numbers = numbers(CAMERA);
            if let Some(number) = numbers.get_mut(index) {
                *number = value;
            }
            coefficients(numbers)
        });
        one.chain([coefficients([value; 14])])
    });
    [CAMERA, Coefficients::default()].into_iter().chain(special)
}

/// Returns the coefficients as a list.
fn numbers(form: Coefficients) -> [f32; 14] {
    [
        form.cx, form.cy, form.k0, form.k1, form.k2, form.k3, form.hx, form.hy, form.gx, form.gy,
        form.b1, form.b2, form.tx, form.ty,
    ]
}

/// Returns the coefficients of a list.
pub(crate) fn coefficients(
    [cx, cy, k0, k1, k2, k3, hx, hy, gx, gy, b1, b2, tx, ty]: [f32; 14],
) -> Coefficients {
    Coefficients {
        cx,
        cy,
        k0,
        k1,
        k2,
        k3,
        hx,
        hy,
        gx,
        gy,
        b1,
        b2,
        tx,
        ty,
    }
}
