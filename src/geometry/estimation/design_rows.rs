//! Rows of the design: the equations of one observation in the unknowns.

use super::known_lens::KnownLens;
use super::number::Number;
use super::observation::Observation;
use crate::geometry::range::{OutOfRange, Quantity};

/// Two rows of the design with their right-hand side, each divided by σ: along the FMC axis and
/// across it.
pub(super) type Rows<T> = [[T; 7]; 2];

impl<T: Number> Observation<T> {
    /// Returns the observation if every number of it is finite and in range.
    ///
    /// # Errors
    /// [`OutOfRange`], which names the first that is not, in the unit of its name.
    pub fn checked(self, lens: &KnownLens<T>) -> Result<Self, OutOfRange> {
        let farthest_mm = 2.0 * lens.radius_mm.single();
        Quantity::XMm.check_within(self.x_mm.single(), -farthest_mm, farthest_mm)?;
        Quantity::YMm.check_within(self.y_mm.single(), -farthest_mm, farthest_mm)?;
        Quantity::DxUm.check(1000.0 * self.dx_mm.single())?;
        Quantity::DyUm.check(1000.0 * self.dy_mm.single())?;
        Quantity::TravelMm.check(self.regressor_mm.single())?;
        Quantity::SigmaUm.check(1000.0 * self.sigma_mm.single())?;
        Ok(self)
    }

    /// Returns the rows of the design.
    ///
    /// # Model
    /// Yuan et al. 2012, eq. 25 with its y rows mended, in coordinates divided by the format radius
    /// ρ: with a, b along and across the FMC axis, q = a² + b², d = σs (s the regressor)
    ///
    /// `along:  a, aq, aq², d·a², d·q, q + 2a²  | l`,
    /// `across: b, bq, bq², d·ab, 0,   2ab      | l`,
    ///
    /// l is the part that the static calibration does not explain, so that the unknowns are
    /// corrections.
    #[expect(
        clippy::many_single_char_names,
        reason = "symbols of the equation above"
    )]
    pub(super) fn rows(&self, lens: &KnownLens<T>) -> Rows<T> {
        let [x0, y0] = lens.principal_point_mm;
        let point_mm = [self.x_mm - x0, self.y_mm - y0];
        let [static_x, static_y] = lens.displacement(point_mm);
        let l_x = self.dx_mm - static_x;
        let l_y = self.dy_mm - static_y;
        let [x, y] = point_mm.map(|part| part / lens.radius_mm);
        let (a, b, l_along, l_across) = if lens.axis.is_x() {
            (x, y, l_x, l_y)
        } else {
            (y, x, l_y, l_x)
        };
        let q = a * a + b * b;
        let d = T::of(lens.axis.sign()) * self.regressor_mm;
        let two = T::of(2.0);
        let weight = T::ONE / self.sigma_mm;
        [
            [
                a,
                a * q,
                a * q * q,
                d * (a * a),
                d * q,
                q + two * (a * a),
                l_along,
            ]
            .map(|term| weight * term),
            [
                b,
                b * q,
                b * q * q,
                d * (a * b),
                T::ZERO,
                two * (a * b),
                l_across,
            ]
            .map(|term| weight * term),
        ]
    }
}
