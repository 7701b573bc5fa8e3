//! Causes of image motion that the compensation leaves.

use fmc_camera::geometry::image_motion::{Attitude, FlightState, GroundMotion};
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::number::single;

/// Range of the error of V/H, per cent.
const VH_ERROR_PERCENT: [f64; 2] = [-50.0, 50.0];

/// One cause of smear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// The V/H that the camera is told is wrong.
    VhError,
    /// The terrain is higher than the plane that V/H holds for.
    Relief,
    /// The optical axis is tilted forward.
    Pitch,
    /// The optical axis is tilted to the left.
    Roll,
    /// The track is to the right of the FMC axis.
    Drift,
    /// The camera turns nose up.
    PitchRate,
    /// The camera turns right side down.
    RollRate,
    /// The camera turns its nose to the left.
    YawRate,
}

impl Term {
    /// All terms, in the order of the options.
    pub const ALL: [Self; 8] = [
        Self::VhError,
        Self::Relief,
        Self::Pitch,
        Self::Roll,
        Self::Drift,
        Self::PitchRate,
        Self::RollRate,
        Self::YawRate,
    ];

    /// Returns the option without its dashes.
    #[must_use]
    pub const fn option(self) -> &'static str {
        match self {
            Self::VhError => "vh-error-percent",
            Self::Relief => "relief-percent",
            Self::Pitch => "pitch-deg",
            Self::Roll => "roll-deg",
            Self::Drift => "drift-deg",
            Self::PitchRate => "pitch-rate-deg-s",
            Self::RollRate => "roll-rate-deg-s",
            Self::YawRate => "yaw-rate-deg-s",
        }
    }

    /// Returns the name in reports.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::VhError => "V/H error",
            Self::Relief => "relief",
            Self::Pitch => "pitch",
            Self::Roll => "roll",
            Self::Drift => "drift",
            Self::PitchRate => "pitch rate",
            Self::RollRate => "roll rate",
            Self::YawRate => "yaw rate",
        }
    }

    /// Returns the unit of the term's value.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::VhError | Self::Relief => "%",
            Self::Pitch | Self::Roll | Self::Drift => "°",
            Self::PitchRate | Self::RollRate | Self::YawRate => "°/s",
        }
    }

    /// Returns the smallest and the largest value allowed.
    #[must_use]
    pub fn range(self) -> [f64; 2] {
        let quantity = match self {
            Self::VhError => return VH_ERROR_PERCENT,
            Self::Relief => Quantity::ReliefPercent,
            Self::Pitch => Quantity::PitchDeg,
            Self::Roll => Quantity::RollDeg,
            Self::Drift => Quantity::DriftDeg,
            Self::PitchRate => Quantity::PitchRateDegS,
            Self::RollRate => Quantity::RollRateDegS,
            Self::YawRate => Quantity::YawRateDegS,
        };
        let (least, most) = quantity.range();
        [least, most].map(f64::from)
    }
}

/// Values of all terms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disturbances {
    values: [f64; 8],
}

/// A value outside its range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("--{} = {value} is outside {} to {} {}", term.option(), term.range()[0], term.range()[1], term.unit())]
pub struct NotBelievable {
    /// The term.
    pub term: Term,
    /// The value.
    pub value: f64,
}

impl Disturbances {
    /// Creates the disturbances of some terms; the others are 0.
    ///
    /// # Errors
    /// [`NotBelievable`] for the first value outside of its range.
    pub fn new(values: impl IntoIterator<Item = (Term, f64)>) -> Result<Self, NotBelievable> {
        let mut disturbances = Self::default();
        for (term, value) in values {
            let [least, most] = term.range();
            if !(least..=most).contains(&value) {
                return Err(NotBelievable { term, value });
            }
            disturbances.set(term, value);
        }
        Ok(disturbances)
    }

    fn set(&mut self, term: Term, value: f64) {
        for (one, place) in Term::ALL.into_iter().zip(&mut self.values) {
            if one == term {
                *place = value;
            }
        }
    }

    /// Returns the value of a term, in its unit.
    #[must_use]
    pub fn value(&self, term: Term) -> f64 {
        Term::ALL
            .into_iter()
            .zip(self.values)
            .find_map(|(one, value)| (one == term).then_some(value))
            .unwrap_or_default()
    }

    /// Returns the terms that are not 0.
    #[must_use]
    pub fn terms(&self) -> Vec<Term> {
        Term::ALL
            .into_iter()
            .filter(|term| self.value(*term) != 0.0)
            .collect()
    }

    /// Returns the disturbances of one term alone.
    #[must_use]
    pub fn alone(&self, term: Term) -> Self {
        let mut alone = Self::default();
        alone.set(term, self.value(term));
        alone
    }

    /// Returns the V/H that the camera is told.
    #[must_use]
    pub fn told_vh_per_s(&self, vh_per_s: f64) -> f64 {
        vh_per_s * (1.0 + self.value(Term::VhError) / 100.0)
    }

    /// Returns the flight state for a true V/H, in the camera's precision.
    #[must_use]
    pub fn flight_state(&self, vh_per_s: f64) -> FlightState {
        let value = |term| single(self.value(term));
        FlightState {
            motion: GroundMotion {
                vh_per_s: single(vh_per_s),
                relief_percent: value(Term::Relief),
                drift_deg: value(Term::Drift),
            },
            attitude: Attitude {
                pitch_deg: value(Term::Pitch),
                roll_deg: value(Term::Roll),
                pitch_rate_deg_s: value(Term::PitchRate),
                roll_rate_deg_s: value(Term::RollRate),
                yaw_rate_deg_s: value(Term::YawRate),
            },
            compensated_vh_per_s: single(self.told_vh_per_s(vh_per_s)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_term_has_a_range_and_its_ends_are_inside() {
        for term in Term::ALL {
            let [least, most] = term.range();
            assert!(Disturbances::new([(term, least)]).is_ok());
            assert!(Disturbances::new([(term, most)]).is_ok());
            for value in [least - 1e-6, most + 1e-6, f64::NAN] {
                let error = Disturbances::new([(term, value)]).unwrap_err();
                assert!(error.to_string().contains(term.option()));
            }
        }
    }

    #[test]
    fn term_alone_is_the_only_one() {
        let all = Disturbances::new(Term::ALL.map(|term| (term, 1.5))).unwrap();
        assert_eq!(all.terms(), Term::ALL);
        assert_eq!(all.alone(Term::Roll).terms(), [Term::Roll]);
        assert!((all.told_vh_per_s(0.1) - 0.1015).abs() < 1e-12);
    }
}
