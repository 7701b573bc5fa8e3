//! Focus shift: the effect of a detector out of its calibrated plane on the image.

use super::brown::Brown;
use super::principal_point::PrincipalPointMotion;
use super::range::{OutOfRange, Quantity};

/// Formula that turns a focus shift into distortion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FocusSign {
    /// A detector moved away from the lens enlarges the image by Δz/L, with L from exit pupil to
    /// image, as ray tracing shows.
    #[default]
    Physical,
    /// Yuan et al. 2012, eqs. 14-17, as printed: `k0' = -Δf/f`, `K' = K(1 - k0')`.
    Printed,
}

/// The detector's distance from its calibrated plane in one exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FocusShift {
    /// Δz: exposure mean, positive away from the lens, mm.
    pub shift_mm: f32,
    /// f: principal distance, mm.
    pub principal_distance_mm: f32,
    /// L: distance from the exit pupil to the image, mm.
    pub exit_pupil_mm: f32,
    /// The formula that applies.
    pub sign: FocusSign,
}

impl FocusShift {
    /// Returns the distance to which Δz is related: L, or f with the printed signs, mm.
    #[must_use]
    pub(crate) const fn lever_mm(&self) -> f32 {
        match self.sign {
            FocusSign::Physical => self.exit_pupil_mm,
            FocusSign::Printed => self.principal_distance_mm,
        }
    }

    /// Returns κ, the relative enlargement of the image: Δz/L, or k0' = -Δf/f with the printed
    /// signs.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::principal_distance::{FocusShift, FocusSign};
    /// // Retrofocus lens, f = 50 mm, L = 76.7 mm, detector 10 µm too far back: 1.303e-4.
    /// let shift = FocusShift {
    ///     shift_mm: 0.010,
    ///     principal_distance_mm: 50.0,
    ///     exit_pupil_mm: 76.7,
    ///     sign: FocusSign::Physical,
    /// };
    /// assert!((shift.enlargement() - 1.303e-4).abs() < 1e-7);
    /// ```
    #[must_use]
    pub fn enlargement(&self) -> f32 {
        let relative = self.shift_mm / self.lever_mm();
        match self.sign {
            FocusSign::Physical => relative,
            FocusSign::Printed => -relative,
        }
    }

    /// Returns the distortion about an unchanged principal distance f: convention (A), which
    /// `correct` uses.
    ///
    /// # Model
    /// Physical: `D'(r) = κr/(1+κ) + D(r/(1+κ))`. Printed: the radial polynomial times `1 - κ`,
    /// plus `κr`, with `κ = k0' = -Δf/f` (eq. 16).
    ///
    /// # Accuracy
    /// The formula is exact for a pure scaling about the exit pupil; real lenses depart from it by
    /// 18-173 nm at Δz = 10 µm.
    #[must_use]
    pub fn distortion_at_fixed_distance(&self, lens: &Brown) -> Brown {
        let kappa = self.enlargement();
        match self.sign {
            FocusSign::Physical => {
                let shrink = 1.0 / (1.0 + kappa);
                let shrink2 = shrink * shrink;
                let shrink3 = shrink2 * shrink;
                Brown {
                    k0: (lens.k0 + kappa) * shrink,
                    k1: lens.k1 * shrink3,
                    k2: lens.k2 * (shrink3 * shrink2),
                    k3: lens.k3 * (shrink3 * shrink2 * shrink2),
                    p1: lens.p1 * shrink2,
                    p2: lens.p2 * shrink2,
                    b1: lens.b1 * shrink,
                    b2: lens.b2 * shrink,
                }
            }
            FocusSign::Printed => {
                let radial = 1.0 - kappa;
                Brown {
                    k0: lens.k0 * radial + kappa,
                    k1: lens.k1 * radial,
                    k2: lens.k2 * radial,
                    k3: lens.k3 * radial,
                    ..*lens
                }
            }
        }
    }

    /// Returns the changed principal distance `f(1+κ)`, mm, and the distortion that belongs to it:
    /// convention (B), for software that takes an interior orientation per frame.
    ///
    /// # Model
    /// `D''(r) = (1+κ)·D(r/(1+κ))` at `f(1+κ)`: the same rays as convention (A). It is defined for
    /// the physical sign; with the printed one the two conventions contradict each other, and the
    /// physical formula is used on the printed κ.
    #[must_use]
    pub fn distortion_at_changed_distance(&self, lens: &Brown) -> (f32, Brown) {
        let scale = 1.0 + self.enlargement();
        let shrink = 1.0 / scale;
        let shrink2 = shrink * shrink;
        let distortion = Brown {
            k0: lens.k0,
            k1: lens.k1 * shrink2,
            k2: lens.k2 * (shrink2 * shrink2),
            k3: lens.k3 * (shrink2 * shrink2 * shrink2),
            p1: lens.p1 * shrink,
            p2: lens.p2 * shrink,
            b1: lens.b1,
            b2: lens.b2,
        };
        (self.principal_distance_mm * scale, distortion)
    }
}

/// Number of coefficients of the run-out polynomial.
pub const FLATNESS_TERMS: usize = 5;

/// The stage's out-of-plane run-out Δz(s): a polynomial of its position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flatness {
    /// Coefficients, lowest power first: µm of Δz per power of mm of stage position along the FMC
    /// axis.
    pub coefficients_um: [f32; FLATNESS_TERMS],
}

impl Flatness {
    /// A stage that stays in its plane.
    pub(crate) const FLAT: Self = Self {
        coefficients_um: [0.0; FLATNESS_TERMS],
    };

    /// Checks that the terms are in range at `reach_mm` from the calibrated position.
    ///
    /// # Errors
    /// [`OutOfRange`] for a coefficient that is not a number or a term above 1000 µm.
    pub fn check(&self, reach_mm: f32) -> Result<(), OutOfRange> {
        let mut power = 1.0;
        for coefficient in self.coefficients_um {
            Quantity::FlatnessUm.check(coefficient * power)?;
            power *= reach_mm;
        }
        Ok(())
    }

    /// Returns the exposure mean of Δz, mm.
    ///
    /// # Model
    /// `E[z(c)] = z(c̄) + z''μ₂/2 + z'''μ₃/6 + z''''μ₄/24`, which is exact, as the polynomial ends
    /// at s⁴.
    #[must_use]
    pub(crate) fn mean_shift_mm(&self, motion: &PrincipalPointMotion) -> f32 {
        let [z0, z1, z2, z3, z4] = self.coefficients_um;
        let s = motion.centroid_mm;
        let moments = motion.moments;
        let at_centroid = z0 + s * (z1 + s * (z2 + s * (z3 + s * z4)));
        let half_curvature = z2 + s * (3.0 * z3 + s * (6.0 * z4));
        let sixth_third = z3 + 4.0 * s * z4;
        (at_centroid
            + half_curvature * moments.second
            + sixth_third * moments.third
            + z4 * moments.fourth)
            / 1000.0
    }

    /// Returns a bound on |Δz| within `reach_mm` of the calibrated position, mm.
    #[must_use]
    pub(crate) fn largest_mm(&self, reach_mm: f32) -> f32 {
        let [z0, z1, z2, z3, z4] = self.coefficients_um.map(f32::abs);
        let s = reach_mm;
        (z0 + s * (z1 + s * (z2 + s * (z3 + s * z4)))) / 1000.0
    }

    /// Returns a bound on |dz/ds| within `reach_mm` of the calibrated position, mm per mm.
    #[must_use]
    pub(crate) fn steepest(&self, reach_mm: f32) -> f32 {
        let [_, z1, z2, z3, z4] = self.coefficients_um.map(f32::abs);
        let s = reach_mm;
        (z1 + s * (2.0 * z2 + s * (3.0 * z3 + s * (4.0 * z4)))) / 1000.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::moments::CentralMoments;

    const LENS: Brown = Brown {
        k0: 1e-4,
        k1: -2e-5,
        k2: 5e-9,
        k3: -1e-12,
        p1: 3e-6,
        p2: -4e-6,
        b1: 2e-5,
        b2: -1e-5,
    };

    fn shift(sign: FocusSign) -> FocusShift {
        FocusShift {
            shift_mm: 0.05,
            principal_distance_mm: 50.0,
            exit_pupil_mm: 76.7,
            sign,
        }
    }

    #[test]
    fn physical_shift_enlarges_the_image_and_the_printed_one_shrinks_it() {
        let physical = shift(FocusSign::Physical).distortion_at_fixed_distance(&Brown::default());
        let printed = shift(FocusSign::Printed).distortion_at_fixed_distance(&Brown::default());
        assert!((physical.k0 - 6.515e-4).abs() < 1e-6);
        assert!((printed.k0 + 1e-3).abs() < 1e-6);
    }

    #[test]
    fn both_conventions_describe_the_same_rays() {
        let shift = shift(FocusSign::Physical);
        let fixed = shift.distortion_at_fixed_distance(&LENS);
        let (distance_mm, changed) = shift.distortion_at_changed_distance(&LENS);
        let scale = distance_mm / shift.principal_distance_mm;
        for (x, y) in [(20.0, -15.0), (-3.0, 24.0), (25.0, 25.0)] {
            let a = fixed.displacement(x, y);
            let b = changed.displacement(x, y);
            // ideal/f of (A) equals ideal/(f(1+κ)) of (B).
            assert!(((x - a.dx_mm) * scale - (x - b.dx_mm)).abs() < 4e-6);
            assert!(((y - a.dy_mm) * scale - (y - b.dy_mm)).abs() < 4e-6);
        }
    }

    fn motion(centroid_mm: f32, moments: CentralMoments) -> PrincipalPointMotion {
        PrincipalPointMotion {
            opening_offset_mm: 0.0,
            travel_mm: 0.5,
            centroid_time_s: 0.005,
            centroid_mm,
            moments,
        }
    }

    const FLATNESS: Flatness = Flatness {
        coefficients_um: [3.0, -2.0, 1.5, -4.0, 6.0],
    };

    fn run_out_um(s: f64) -> f64 {
        3.0 - 2.0 * s + 1.5 * s * s - 4.0 * s.powi(3) + 6.0 * s.powi(4)
    }

    #[test]
    fn mean_run_out_is_that_of_a_fine_sum() {
        let moments = CentralMoments {
            second: 1.0 / 12.0,
            third: 0.0,
            fourth: 1.0 / 80.0,
        };
        let steps = 2000;
        let expected_um: f64 = (0..steps)
            .map(|i| run_out_um(0.05 + 0.5 * (f64::from(i) + 0.5) / f64::from(steps)))
            .sum::<f64>()
            / f64::from(steps);
        let mean_mm = FLATNESS.mean_shift_mm(&motion(0.3, moments.scaled(0.5)));
        assert!((f64::from(mean_mm) * 1000.0 - expected_um).abs() < 1e-5);
    }

    #[test]
    fn mean_run_out_of_a_skew_path_is_exact() {
        // The path is a below its mean for two thirds of the light and 2a above it for one third.
        let (centroid, a) = (0.4_f32, 0.2_f32);
        let moments = CentralMoments {
            second: 2.0 * a * a,
            third: 2.0 * a * a * a,
            fourth: 6.0 * a * a * a * a,
        };
        let expected_um = (2.0 * run_out_um(0.2) + run_out_um(0.8)) / 3.0;
        let mean_mm = FLATNESS.mean_shift_mm(&motion(centroid, moments));
        assert!((f64::from(mean_mm) * 1000.0 - expected_um).abs() < 1e-5);
    }

    #[test]
    fn steepest_run_out_is_not_exceeded_and_is_reached_by_single_powers() {
        let reach = 1.7_f32;
        let slopes = [
            1.0,
            2.0 * reach,
            3.0 * reach * reach,
            4.0 * reach * reach * reach,
        ];
        for (power, slope) in (1..).zip(slopes) {
            let mut flatness = Flatness::FLAT;
            flatness.coefficients_um[power] = -2.0;
            let found = flatness.steepest(reach);
            assert!(
                (found / (2.0 * slope / 1000.0) - 1.0).abs() < 1e-6,
                "{power}"
            );
        }
        assert!((Flatness::FLAT.steepest(2.0)).abs() < 1e-12);
    }
}
