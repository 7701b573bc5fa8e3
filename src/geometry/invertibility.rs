//! Proof, by bounds, that a distortion polynomial does not fold the image.

use super::evaluation_form::EvaluationForm;
use super::hypotenuse::hypotenuse;
use super::interval::{Interval, cubic_range, greater, lesser};

/// Smallest scale `∂(ideal)/∂(measured)` that a calibration may have anywhere. Below it the image
/// is about to fold over, and the inverse loses a decimal digit.
pub const MIN_SCALE: f32 = 0.1;

/// Largest slope of the distortion for which the bound over a disc decides; beyond it the rectangle
/// is examined box by box, which takes longer and is sharper.
pub const MAX_DISC_SLOPE: f32 = 0.5;

/// Number of pieces into which the range of R and each side of the rectangle are cut: four
/// halvings.
const PIECES: u8 = 16;
/// Number of pieces into which each side of an undecided box is cut.
const SUB_BOXES: u8 = 4;

/// The rectangle |X| ≤ `reach_x`, |Y| ≤ `reach_y` about the principal point, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Farthest |X|, mm.
    pub reach_x: f32,
    /// Farthest |Y|, mm.
    pub reach_y: f32,
}

impl Region {
    /// Returns the distance of the corner, mm.
    #[must_use]
    pub fn radius_mm(&self) -> f32 {
        hypotenuse(self.reach_x, self.reach_y)
    }
}

/// The image folds, or may fold, over the region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Folds {
    /// Lower bound of the scale `∂(ideal)/∂(measured)` at its worst; negative where the image is
    /// folded.
    pub scale: f32,
    /// Place of the smallest scale: X from the principal point, mm.
    pub x: f32,
    /// Place of the smallest scale: Y from the principal point, mm.
    pub y: f32,
}

/// Returns a lower bound of the scale of `p -> p - D(p)` over the region.
///
/// # Model
/// The first bound (`docs/derivations/invertibility.py`) is over the disc about the principal point
/// that holds the region and the largest displacement: with g = k₀ + k₁R + k₂R² + k₃R³,
/// `λ = max(g, g + 2Rg') + 2(|h| + |g⃗|)ρ + (b₁ + hypot(b₁, b₂))/2` and
/// `q = max(|g|, |g + 2Rg'|) + 2(|h| + |g⃗|)ρ + hypot(b₁, b₂)`, both cubics bounded by their
/// Bernstein coefficients. λ < 1 makes the map strongly monotone, hence one-to-one.
///
/// If λ or q is more than [`MAX_DISC_SLOPE`], the second bound is found by intervals over 16 x 16
/// boxes of the rectangle, each cut into 4 x 4 if it does not decide: `1 - ∂xDx`, `1 - ∂yDy` and
/// the determinant all positive make the map one-to-one on a rectangle (Gale & Nikaidô 1965); the
/// determinant alone does not. The larger of the two bounds is the result.
///
/// # Units and frames
/// `added_slope`: the slope that the frames may add to that of `form`, dimensionless.
///
/// # Accuracy
/// The bound is not rounded outwards: f32 rounding, 1e-6, is far below [`MIN_SCALE`].
///
/// # Errors
/// [`Folds`] if the scale cannot be shown to stay at or above [`MIN_SCALE`].
pub fn least_scale(form: &EvaluationForm, region: Region, added_slope: f32) -> Result<f32, Folds> {
    let radius = region.radius_mm();
    let lengths = Lengths {
        decentring: hypotenuse(form.hx, form.hy) + hypotenuse(form.gx, form.gy),
        affinity: hypotenuse(form.b1, form.b2),
    };
    let reach = radius + largest_displacement(form, &lengths, radius);
    let (lambda, q) = disc_slopes(form, &lengths, reach);
    let of_disc = 1.0 - lambda - added_slope;
    if of_disc >= 1.0 - MAX_DISC_SLOPE && q + added_slope <= MAX_DISC_SLOPE {
        return Ok(of_disc);
    }
    let mut worst = Folds {
        scale: f32::INFINITY,
        x: 0.0,
        y: 0.0,
    };
    let x = Interval::around_zero(region.reach_x);
    let y = Interval::around_zero(region.reach_y);
    for column in 0..PIECES {
        let x = x.piece(column, PIECES);
        for row in 0..PIECES {
            let y = y.piece(row, PIECES);
            let mut scale = box_scale(form, x, y, added_slope);
            if scale < MIN_SCALE {
                scale = sub_box_scale(form, x, y, added_slope);
            }
            if scale.is_nan() || scale < worst.scale {
                worst = Folds {
                    scale,
                    x: x.middle(),
                    y: y.middle(),
                };
            }
        }
    }
    // λ < 1 alone makes the map one-to-one, and Newton's method does not need q.
    let scale = if of_disc > worst.scale {
        of_disc
    } else {
        worst.scale
    };
    if scale >= MIN_SCALE && !worst.scale.is_nan() {
        Ok(scale)
    } else {
        Err(worst)
    }
}

/// Lengths of the vectors of a form.
struct Lengths {
    /// `|h| + |g⃗|`.
    decentring: f32,
    /// `hypot(b₁, b₂)`.
    affinity: f32,
}

/// Returns a lower bound of the scale over one box, of those over its parts.
fn sub_box_scale(form: &EvaluationForm, x: Interval, y: Interval, added_slope: f32) -> f32 {
    let mut scale = f32::INFINITY;
    for column in 0..SUB_BOXES {
        let x = x.piece(column, SUB_BOXES);
        for row in 0..SUB_BOXES {
            let y = y.piece(row, SUB_BOXES);
            scale = lesser(scale, box_scale(form, x, y, added_slope));
        }
    }
    scale
}

/// Returns λ and q of [`least_scale`] (`docs/derivations/invertibility.py`) over the disc of radius
/// `radius` mm.
fn disc_slopes(form: &EvaluationForm, lengths: &Lengths, radius: f32) -> (f32, f32) {
    let radial = [form.k0, form.k1, form.k2, form.k3];
    let [k0, k1, k2, k3] = radial;
    let along_radius = [k0, 3.0 * k1, 5.0 * k2, 7.0 * k3];
    let mut highest = f32::NEG_INFINITY;
    let mut largest = 0.0_f32;
    let all = Interval {
        lo: 0.0,
        hi: radius * radius,
    };
    for index in 0..PIECES {
        let squares = all.piece(index, PIECES);
        for cubic in [radial, along_radius] {
            let range = cubic_range(cubic, squares);
            highest = greater(highest, range.hi);
            largest = greater(largest, range.largest());
        }
    }
    let decentring = 2.0 * lengths.decentring * radius;
    let affinity = lengths.affinity;
    (
        highest + decentring + 0.5 * (form.b1 + affinity),
        largest + decentring + affinity,
    )
}

/// Returns a bound on |D| over the disc of radius `radius` mm.
fn largest_displacement(form: &EvaluationForm, lengths: &Lengths, radius: f32) -> f32 {
    let squares = Interval {
        lo: 0.0,
        hi: radius * radius,
    };
    let gain = cubic_range([form.k0, form.k1, form.k2, form.k3], squares).largest();
    radius * (gain + lengths.decentring * radius + lengths.affinity)
}

/// Ranges of the terms that the derivatives of both components have in common.
struct Common {
    gain: Interval,
    twice_slope: Interval,
    /// X·Y times twice the slope.
    mixed: Interval,
}

/// Coefficients in which the derivatives of one component of the distortion differ from those of
/// the other.
struct Component {
    h: f32,
    other_h: f32,
    g: f32,
    b: [f32; 2],
}

/// Returns the ranges of a component's derivatives by its own coordinate and by the other.
#[inline(never)]
fn derivatives(
    common: &Common,
    of: &Component,
    along: Interval,
    across: Interval,
) -> [Interval; 2] {
    let [b_along, b_across] = of.b;
    [
        common.gain
            + along.squared() * common.twice_slope
            + along.scaled(2.0 * (of.h + of.g))
            + across.scaled(of.other_h).shifted(b_along),
        common.mixed + along.scaled(of.other_h) + across.scaled(2.0 * of.g).shifted(b_across),
    ]
}

/// Returns a lower bound of the scale over one box.
fn box_scale(form: &EvaluationForm, x: Interval, y: Interval, added_slope: f32) -> f32 {
    let squares = x.squared() + y.squared();
    let gain = cubic_range([form.k0, form.k1, form.k2, form.k3], squares);
    let twice_slope =
        cubic_range([form.k1, 2.0 * form.k2, 3.0 * form.k3, 0.0], squares).scaled(2.0);
    if !(gain.is_finite() && twice_slope.is_finite()) {
        return f32::NAN;
    }
    let common = Common {
        gain,
        twice_slope,
        mixed: x * y * twice_slope,
    };
    let of_x = Component {
        h: form.hx,
        other_h: form.hy,
        g: form.gx,
        b: [form.b1, form.b2],
    };
    let of_y = Component {
        h: form.hy,
        other_h: form.hx,
        g: form.gy,
        b: [0.0; 2],
    };
    let [dx_by_x, dx_by_y] = derivatives(&common, &of_x, x, y);
    let [dy_by_y, dy_by_x] = derivatives(&common, &of_y, y, x);
    let scale_x = 1.0 - dx_by_x.hi - added_slope;
    let scale_y = 1.0 - dy_by_y.hi - added_slope;
    let mixing = (dx_by_y.largest() + added_slope) * (dy_by_x.largest() + added_slope);
    // No direction is stretched more than this, by Gershgorin's theorem.
    let widest = greater(1.0 - dx_by_x.lo, 1.0 - dy_by_y.lo)
        + greater(dx_by_y.largest(), dy_by_x.largest())
        + 2.0 * added_slope;
    let determinant = scale_x * scale_y - mixing;
    let scale = lesser(scale_x, scale_y);
    if scale <= 0.0 {
        return scale;
    }
    lesser(scale, determinant / widest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::brown::Brown;

    const REGION: Region = Region {
        reach_x: 30.0,
        reach_y: 20.0,
    };

    fn radial(k1: f32) -> EvaluationForm {
        let lens = Brown {
            k1,
            ..Brown::default()
        };
        lens.evaluation_form()
    }

    #[test]
    fn mild_lens_is_shown_by_the_disc_and_a_strong_one_by_the_boxes() {
        // Corner slope 3·K1·r²: 0.02 and 0.7.
        let corner2 = 1300.0;
        assert!(
            (least_scale(&radial(0.02 / 3.0 / corner2), REGION, 0.0).unwrap() - 0.98).abs() < 2e-3
        );
        let strong = least_scale(&radial(0.7 / 3.0 / corner2), REGION, 0.0).unwrap();
        assert!((0.1..=0.3).contains(&strong), "{strong}");
    }

    #[test]
    fn folded_lens_is_refused_with_the_place() {
        let folds = least_scale(&radial(1.1 / 3.0 / 1300.0), REGION, 0.0).unwrap_err();
        assert!(folds.scale < MIN_SCALE);
        assert!(folds.x.abs() > 25.0 && folds.y.abs() > 15.0, "{folds:?}");
    }

    #[test]
    fn positive_determinant_alone_is_not_enough() {
        // 180° turn: b1 = 2 and k0 such that both diagonal terms are negative, determinant
        // positive.
        let turned = EvaluationForm {
            k0: 2.0,
            ..EvaluationForm::default()
        };
        assert!(least_scale(&turned, REGION, 0.0).is_err());
    }

    #[test]
    fn overflow_is_refused_and_not_passed_over() {
        for bad in [f32::MAX, f32::NAN, f32::INFINITY] {
            assert!(least_scale(&radial(bad), REGION, 0.0).is_err());
        }
        assert!(least_scale(&radial(0.0), REGION, f32::NAN).is_err());
    }

    /// Returns the least stretch of `p - D(p)` in any direction, over a grid of the region.
    fn gridded_scale(form: &EvaluationForm) -> f64 {
        let mut smallest = f64::INFINITY;
        for i in -20_i8..=20 {
            for j in -20_i8..=20 {
                let d = form.jacobian(f32::from(i) * 1.5, f32::from(j));
                let [a, b, c, d] =
                    [1.0 - d.dx_by_x, -d.dx_by_y, -d.dy_by_x, 1.0 - d.dy_by_y].map(f64::from);
                let squares = a * a + b * b + c * c + d * d;
                let determinant = a * d - b * c;
                let spread = squares * squares - 4.0 * determinant * determinant;
                let least = libm::sqrt((squares - libm::sqrt(spread.max(0.0))).max(0.0) / 2.0);
                smallest = smallest.min(if determinant > 0.0 { least } else { -least });
            }
        }
        smallest
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(3000))]

        #[test]
        fn bound_never_exceeds_the_scale_on_a_grid(
            k in [-0.3_f32..0.3, -6e-4_f32..6e-4, -6e-7_f32..6e-7, -6e-10_f32..6e-10],
            h in [-4e-3_f32..4e-3, -4e-3_f32..4e-3],
            g in [-4e-3_f32..4e-3, -4e-3_f32..4e-3],
            b in [-0.3_f32..0.3, -0.3_f32..0.3],
            share in 0.0_f32..1.0,
        ) {
            let [k0, k1, k2, k3] = k.map(|k| share * k);
            let ([hx, hy], [gx, gy]) = (h.map(|h| share * h), g.map(|g| share * g));
            let [b1, b2] = b.map(|b| share * b);
            let form = EvaluationForm { k0, k1, k2, k3, hx, hy, gx, gy, b1, b2, tx: 0.0, ty: 0.0 };
            if let Ok(bound) = least_scale(&form, REGION, 0.0) {
                proptest::prop_assert!(f64::from(bound) <= gridded_scale(&form) + 1e-6);
                // The slope that the frames add is subtracted in full, or the lens is refused.
                if let Ok(with_frames) = least_scale(&form, REGION, 0.05) {
                    proptest::prop_assert!(f64::from(with_frames) <= gridded_scale(&form) - 0.05 + 1e-6);
                }
            } else {
                proptest::prop_assert!(gridded_scale(&form) < 0.6, "{}", gridded_scale(&form));
            }
        }
    }

    #[test]
    fn mild_but_competing_terms_are_accepted() {
        // Corner terms -0.255, +0.555, -0.283: 2 % of distortion, scale 0.85.
        let corner2 = 1300.0_f32;
        let form = EvaluationForm {
            k1: -0.255 / corner2,
            k2: 0.555 / (corner2 * corner2),
            k3: -0.283 / (corner2 * corner2 * corner2),
            ..EvaluationForm::default()
        };
        assert!(
            least_scale(&form, REGION, 0.0).is_ok(),
            "{}",
            gridded_scale(&form)
        );
        // Barrel distortion of any strength does not fold the image.
        assert!(least_scale(&radial(-5.0 / corner2), REGION, 0.0).is_ok());
    }
}
