//! Transmission of the shutter over the exposure, and its moments.
//!
//! Time is counted as a fraction u of the *base*: from first light (u = 0) to last (u = 1). The
//! exposure time t of this crate is that base.

use super::moments::{CentralMoments, gauss_nodes};
use super::range::{OutOfRange, Quantity};

/// Course of the transmission over the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ShutterProfile {
    /// Opening and closing at once: an electronic global shutter.
    #[default]
    Uniform,
    /// Linear ramps, as leaf shutters have.
    Trapezoid {
        /// Opening ramp r₁ as a fraction of the base.
        opening_fraction: f32,
        /// Closing ramp r₂ as a fraction of the base.
        closing_fraction: f32,
    },
}

/// A validated shutter profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    opening: f32,
    closing: f32,
    // `centroid` and `moments` are stored because every frame needs them.
    centroid: f32,
    moments: CentralMoments,
}

impl Shutter {
    /// Returns the shutter of the given profile.
    ///
    /// # Errors
    /// [`OutOfRange`] for a ramp that is negative or not a number, and for ramps that together
    /// are longer than the base.
    pub fn new(profile: ShutterProfile) -> Result<Self, OutOfRange> {
        let (opening, closing) = match profile {
            ShutterProfile::Uniform => (0.0, 0.0),
            ShutterProfile::Trapezoid {
                opening_fraction,
                closing_fraction,
            } => {
                let opening = Quantity::OpeningFraction.check(opening_fraction)?;
                // Fractions that sum to 1 in decimals may exceed it by rounding.
                let rest = 1.0 - opening;
                let closing = if closing_fraction > rest && closing_fraction <= rest + f32::EPSILON
                {
                    rest
                } else {
                    Quantity::ClosingFraction.check_within(closing_fraction, 0.0, rest)?
                };
                (opening, closing)
            }
        };
        let mut shutter = Self {
            opening,
            closing,
            centroid: centroid(opening, closing),
            moments: CentralMoments::default(),
        };
        shutter.moments = shutter.integrated();
        Ok(shutter)
    }

    /// Returns the three parts of the base over which the transmission is linear.
    pub(crate) fn pieces(&self) -> [(f32, f32); 3] {
        let closing_from = 1.0 - self.closing;
        [
            (0.0, self.opening),
            (self.opening, closing_from),
            (closing_from, 1.0),
        ]
    }

    /// Returns the transmission at the fraction `u` of the base: 0 (closed) to 1 (open).
    #[must_use]
    #[inline(never)]
    pub fn transmission(&self, u: f32) -> f32 {
        if !(0.0..=1.0).contains(&u) {
            0.0
        } else if u < self.opening {
            u / self.opening
        } else if u > 1.0 - self.closing {
            (1.0 - u) / self.closing
        } else {
            1.0
        }
    }

    /// Returns [`Self::transmission`] at three fractions of the base that do not decrease, with few
    /// comparisons where they lie in the same part of the profile; `None` where it is open.
    pub(crate) fn transmissions(&self, fractions: [f32; 3]) -> Option<[f32; 3]> {
        let [first, _, last] = fractions;
        let closing_from = 1.0 - self.closing;
        if first >= self.opening && last <= closing_from {
            return None;
        }
        Some(if first >= 0.0 && last < self.opening {
            fractions.map(|u| u / self.opening)
        } else if first >= self.opening && first > closing_from && last <= 1.0 {
            fractions.map(|u| (1.0 - u) / self.closing)
        } else {
            fractions.map(|u| self.transmission(u))
        })
    }

    /// r₁: time in which the shutter opens, as a fraction of the base.
    pub(crate) const fn opening_fraction(&self) -> f32 {
        self.opening
    }

    /// Returns the effective exposure as a fraction of the base: `1 - (r₁+r₂)/2`.
    #[must_use]
    pub fn effective_fraction(&self) -> f32 {
        1.0 - 0.5 * (self.opening + self.closing)
    }

    /// Returns the share of the light that has arrived by the fraction `u` of the base.
    #[must_use]
    pub(crate) fn light_until(&self, u: f32) -> f32 {
        let closing_from = 1.0 - self.closing;
        let area = if u <= 0.0 {
            0.0
        } else if u < self.opening {
            0.5 * u * u / self.opening
        } else if u <= closing_from {
            u - 0.5 * self.opening
        } else if u < 1.0 {
            self.effective_fraction() - 0.5 * (1.0 - u) * (1.0 - u) / self.closing
        } else {
            self.effective_fraction()
        };
        area / self.effective_fraction()
    }

    /// The centroid `E[τ]/t` of the transmission, as a fraction of the base.
    ///
    /// # Model
    /// `E[τ]/t = 1/2 + (r₁-r₂)(3-2r₁-2r₂) / (6(2-r₁-r₂))` with the ramps as fractions of the base;
    /// 1/2 for equal ramps. Unequal ramps move the centroid off the middle of the exposure.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
    /// let (opening_fraction, closing_fraction) = (0.3, 0.1);
    /// let leaf = Shutter::new(ShutterProfile::Trapezoid { opening_fraction, closing_fraction })?;
    /// assert!((leaf.centroid() - 0.5 - 0.0458).abs() < 1e-4); // 4.6 % of the travel
    /// # Ok::<(), fmc_camera::geometry::range::OutOfRange>(())
    /// ```
    #[must_use]
    pub const fn centroid(&self) -> f32 {
        self.centroid
    }

    /// Returns the central moments of the time of a photon, in powers of the base.
    ///
    /// # Accuracy
    /// The quadrature is exact for the profile; the error is rounding, below 1e-7.
    #[must_use]
    pub const fn moments(&self) -> CentralMoments {
        self.moments
    }

    /// Computes [`Self::moments`] from the transmission.
    fn integrated(&self) -> CentralMoments {
        let mut moments = CentralMoments::default();
        for (from, to) in self.pieces() {
            for (u, weight) in gauss_nodes(from, to) {
                let share = weight * self.transmission(u) / self.effective_fraction();
                moments.add(share, u - self.centroid);
            }
        }
        moments
    }
}

/// Returns [`Shutter::centroid`] for two ramps.
fn centroid(r1: f32, r2: f32) -> f32 {
    0.5 + (r1 - r2) * (3.0 - 2.0 * r1 - 2.0 * r2) / (6.0 * (2.0 - r1 - r2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trapezoid(opening_fraction: f32, closing_fraction: f32) -> Shutter {
        Shutter::new(ShutterProfile::Trapezoid {
            opening_fraction,
            closing_fraction,
        })
        .unwrap()
    }

    #[test]
    fn uniform_shutter_has_the_moments_of_a_rectangle() {
        let moments = Shutter::new(ShutterProfile::Uniform).unwrap().moments();
        assert!((moments.second - 1.0 / 12.0).abs() < 1e-7);
        assert!(moments.third.abs() < 1e-8);
        assert!((moments.fourth - 1.0 / 80.0).abs() < 1e-8);
    }

    #[test]
    fn equal_ramps_keep_the_middle_and_have_the_published_variance() {
        for ramp in [0.01, 0.1, 0.3, 0.5] {
            let shutter = trapezoid(ramp, ramp);
            let variance = (1.0 - 2.0 * ramp + 2.0 * ramp * ramp) / 12.0;
            assert!((shutter.centroid() - 0.5).abs() < 1e-7);
            assert!((shutter.moments().second - variance).abs() < 1e-7, "{ramp}");
        }
    }

    #[test]
    fn moments_agree_with_a_fine_midpoint_sum() {
        for (r1, r2) in [(0.3, 0.1), (0.0, 0.4), (0.7, 0.3), (1.0, 0.0)] {
            let shutter = trapezoid(r1, r2);
            let steps = 20_000_u16;
            let sum = |power: i32, about: f64| {
                (0..steps)
                    .map(|i| (f32::from(i) + 0.5) / f32::from(steps))
                    .map(|u| {
                        let transmission = f64::from(shutter.transmission(u));
                        transmission * (f64::from(u) - about).powi(power)
                    })
                    .sum::<f64>()
            };
            let mean = sum(1, 0.0) / sum(0, 0.0);
            assert!((f64::from(shutter.centroid()) - mean).abs() < 1e-6);
            let moments = shutter.moments();
            for (power, moment) in [(2, moments.second), (3, moments.third), (4, moments.fourth)] {
                let expected = sum(power, mean) / sum(0, 0.0);
                assert!(
                    (f64::from(moment) - expected).abs() < 1e-6,
                    "ramps {r1} {r2}: μ{power} {moment} != {expected}"
                );
            }
        }
    }

    #[test]
    fn light_accumulates_as_the_transmission_says() {
        let shutter = trapezoid(0.3, 0.1);
        assert_eq!(shutter.light_until(0.0).to_bits(), 0);
        assert!((shutter.light_until(1.0) - 1.0).abs() < 1e-7);
        for u in [0.05_f32, 0.29, 0.31, 0.6, 0.91, 0.99] {
            let slope = (shutter.light_until(u + 5e-3) - shutter.light_until(u - 5e-3)) / 1e-2;
            let expected = shutter.transmission(u) / shutter.effective_fraction();
            assert!(
                (slope - expected).abs() < 2e-2,
                "at {u}: {slope} != {expected}"
            );
        }
    }

    #[test]
    fn ramps_longer_than_the_base_are_refused() {
        assert!(
            Shutter::new(ShutterProfile::Trapezoid {
                opening_fraction: 0.09,
                closing_fraction: 0.91
            })
            .is_ok()
        );
        for (opening_fraction, closing_fraction) in
            [(0.6, 0.5), (-0.1, 0.0), (0.0, f32::NAN), (1.1, 0.0)]
        {
            let profile = ShutterProfile::Trapezoid {
                opening_fraction,
                closing_fraction,
            };
            assert!(Shutter::new(profile).is_err());
        }
    }
}
