//! Attitude of the aircraft, and the findings of its checks.

use super::event::AttitudeSample;
use crate::geometry::range::Quantity;

/// A finding of an attitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AttitudeFinding {
    /// A NaN or an infinity; the predicted smear leaves the attitude out.
    NotANumber,
    /// An angle or a rate is outside its range; the predicted smear leaves the attitude out.
    OutOfRange,
    /// Attitudes have come, but none near the exposure
    /// ([`ATTITUDE_WITHIN_S`](super::controller::timing::ATTITUDE_WITHIN_S)); the predicted smear
    /// leaves the attitude out.
    Silent,
}

impl AttitudeSample {
    /// Checks angles and rates against the ranges of [`Quantity`]; `None` if all are inside.
    #[must_use]
    pub fn finding(&self) -> Option<AttitudeFinding> {
        let [pitch_rate_deg_s, roll_rate_deg_s, yaw_rate_deg_s] = self.rates_deg_s;
        let numbers = [
            (const { Quantity::PitchDeg.range() }, self.pitch_deg),
            (const { Quantity::RollDeg.range() }, self.roll_deg),
            (const { Quantity::DriftDeg.range() }, self.drift_deg),
            (const { Quantity::PitchRateDegS.range() }, pitch_rate_deg_s),
            (const { Quantity::RollRateDegS.range() }, roll_rate_deg_s),
            (const { Quantity::YawRateDegS.range() }, yaw_rate_deg_s),
        ];
        if numbers
            .iter()
            .all(|((min, max), number)| number >= min && number <= max)
        {
            None
        } else if numbers.iter().all(|(_, number)| number.is_finite()) {
            Some(AttitudeFinding::OutOfRange)
        } else {
            Some(AttitudeFinding::NotANumber)
        }
    }
}
