//! Polynomial of a camera file as a linear model of its coefficients.

use fmc_reference::lens::Lens;

/// Coefficients of the polynomial: K0 to K3, P1, P2, B1, B2.
pub const COEFFICIENTS: usize = 8;

/// Names of the coefficients in the camera file.
pub const COEFFICIENT_NAMES: [&str; COEFFICIENTS] =
    ["k0", "k1", "k2", "k3", "p1", "p2", "b1", "b2"];

/// Returns a lens whose coefficients are given in the order of [`COEFFICIENTS`].
pub(super) const fn lens([k0, k1, k2, k3, p1, p2, b1, b2]: [f64; COEFFICIENTS]) -> Lens {
    Lens {
        k: [k0, k1, k2, k3],
        p: [p1, p2],
        b: [b1, b2],
    }
}

/// Returns the coefficients of a lens.
pub(super) const fn coefficients(lens: &Lens) -> [f64; COEFFICIENTS] {
    let Lens {
        k: [k0, k1, k2, k3],
        p: [p1, p2],
        b: [b1, b2],
    } = *lens;
    [k0, k1, k2, k3, p1, p2, b1, b2]
}

/// Returns the factors by which coefficients of a polynomial in units of the radius are divided for
/// one in mm.
pub(super) fn scales(radius_mm: f64) -> [f64; COEFFICIENTS] {
    [0, 2, 4, 6, 1, 1, 0, 0].map(|power| radius_mm.powi(power))
}

/// Returns the derivatives of the displacement at a point from the principal point, by the
/// coefficients in units of the radius.
pub(super) fn derivatives(point_mm: [f64; 2], radius_mm: f64) -> [[f64; 2]; COEFFICIENTS] {
    let mut unit = [0.0; COEFFICIENTS];
    let mut found = [[0.0; 2]; COEFFICIENTS];
    for (index, (found, scale)) in found.iter_mut().zip(scales(radius_mm)).enumerate() {
        for (place, one) in unit.iter_mut().enumerate() {
            *one = if place == index { scale.recip() } else { 0.0 };
        }
        *found = lens(unit).displacement(point_mm);
    }
    found
}
