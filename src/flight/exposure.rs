//! Exposures as they are asked of the camera, and their limits.

use crate::geometry::principal_distance::FocusSign;
use crate::geometry::range::{OutOfRange, Quantity};

/// Model that corrects the coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CorrectionModel {
    /// Exposure mean of the calibration about the moving principal point.
    #[default]
    Exact,
    /// Five fitted coefficients.
    Fitted,
    /// Static calibration, motion and focus shift ignored.
    Static,
}

/// Direction of flight. Strips are flown to and fro; the camera need not be turned round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FlightDirection {
    /// Along the FMC axis.
    #[default]
    Forward,
    /// Against it: the stage moves the other way, v and δ are negative.
    Reverse,
}

impl FlightDirection {
    /// Sign of v and δ along the FMC axis: +1 or -1.
    #[must_use]
    pub const fn sign(self) -> f32 {
        match self {
            Self::Forward => 1.0,
            Self::Reverse => -1.0,
        }
    }
}

/// One exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Exposure {
    /// η = V/H, 1/s.
    pub vh_per_s: f32,
    /// t: exposure time, the shutter's base, s.
    pub exposure_s: f32,
    /// Δδ, mm along the FMC axis; `None` leaves it to the run-up strategy.
    pub opening_offset_mm: Option<f32>,
    /// Δz beyond the stage's run-out, positive away from the lens, µm.
    pub focus_shift_um: f32,
    /// Formula that turns Δz into distortion.
    pub focus_sign: FocusSign,
    /// Model that corrects the coordinates.
    pub model: CorrectionModel,
    /// Direction of flight; V/H is positive either way.
    pub direction: FlightDirection,
}

impl Exposure {
    /// Returns an exposure at `vh_per_s` (1/s) of `exposure_s` (s), everything else as planned.
    #[must_use]
    pub const fn new(vh_per_s: f32, exposure_s: f32) -> Self {
        Self {
            vh_per_s,
            exposure_s,
            opening_offset_mm: None,
            focus_shift_um: 0.0,
            focus_sign: FocusSign::Physical,
            model: CorrectionModel::Exact,
            direction: FlightDirection::Forward,
        }
    }
}

/// Exposures that a camera accepts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// Smallest and largest V/H, 1/s.
    pub vh_per_s: [f32; 2],
    /// Shortest and longest exposure, s.
    pub exposure_s: [f32; 2],
}

impl Limits {
    /// Limits of a camera that states none: V/H 0.01 to 0.3 1/s, exposures of 1/5000 to 1/30 s.
    ///
    /// They are not those of the mechanism: an exposure within them that the stage cannot take is
    /// refused for its stroke or speed, and
    /// [`Controller::flyable`](crate::flight::controller::Controller::flyable) makes them fit a
    /// flight.
    pub const DEFAULT: Self = Self {
        vh_per_s: [0.01, 0.3],
        exposure_s: [1.0 / 5000.0, 1.0 / 30.0],
    };

    /// Returns the limits, if both pairs are in order and in range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the quantity.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        for (quantity, (min, max), [least, most]) in [
            (
                Quantity::VhPerS,
                const { Quantity::VhPerS.range() },
                self.vh_per_s,
            ),
            (
                Quantity::ExposureS,
                const { Quantity::ExposureS.range() },
                self.exposure_s,
            ),
        ] {
            quantity.check_within(least, min, max)?;
            quantity.check_within(most, least, max)?;
        }
        Ok(self)
    }

    /// Checks the exposure's V/H and time against the limits.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the quantity and the camera's own limits.
    pub fn check(&self, exposure: &Exposure) -> Result<(), OutOfRange> {
        let [least, most] = self.vh_per_s;
        Quantity::VhPerS.check_within(exposure.vh_per_s, least, most)?;
        let [least, most] = self.exposure_s;
        Quantity::ExposureS.check_within(exposure.exposure_s, least, most)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_inclusive_and_must_be_in_order() {
        let limits = Limits {
            vh_per_s: [0.05, 0.17],
            exposure_s: [0.001, 0.02],
        };
        assert_eq!(limits.checked(), Ok(limits));
        assert_eq!(limits.check(&Exposure::new(0.17, 0.02)), Ok(()));
        for bad in [(0.18, 0.01), (0.1, 0.03), (0.0, 0.01), (f32::NAN, 0.01)] {
            assert!(limits.check(&Exposure::new(bad.0, bad.1)).is_err());
        }
        let reversed = Limits {
            vh_per_s: [0.17, 0.05],
            ..limits
        };
        assert!(reversed.checked().is_err());
    }
}
