//! Settings of the sources of V/H: ranges, ages and rates of change.

use super::finding::VhChannel;
use crate::geometry::range::{OutOfRange, Quantity};

/// Smallest value at which a source's range of V/H may begin, 1/s: an aircraft that stands has no
/// V/H.
pub const LEAST_VH_PER_S: f32 = 1e-4;

/// Smallest value at which a source's range of ground speed may begin, m/s.
pub const LEAST_SPEED_M_S: f32 = 0.1;

/// Smallest value at which a source's range of height above ground may begin, m.
pub const LEAST_HEIGHT_M: f32 = 1.0;

/// Settings of one source, in its own unit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChannelSettings {
    /// Least and largest value.
    pub range: [f32; 2],
    /// Age from which the source counts as silent, s.
    pub period_s: f32,
    /// Age from which the source is lost, s.
    pub validity_s: f32,
    /// Largest rate of change of its value, per second.
    pub slew_per_s: f32,
    /// σ of a value at its measurement.
    pub sigma: f32,
    /// Time from measurement to arrival, s.
    pub latency_s: f32,
    /// σ by which the true value changes in the first second after a measurement, and by its square
    /// root in another time; measured in flight from the samples, of which this is the first guess.
    pub change_per_sqrt_s: f32,
    /// Time for which exactly the same value may repeat, s; 0: for ever.
    pub frozen_s: f32,
}

impl ChannelSettings {
    /// Returns the settings, if range and times are possible for a source of this quantity.
    const fn checked(self, quantity: Quantity, least: f32) -> Result<Self, OutOfRange> {
        let Self {
            range: [min, max],
            period_s,
            validity_s,
            slew_per_s,
            sigma,
            latency_s,
            change_per_sqrt_s,
            frozen_s,
        } = self;
        let (_, most) = quantity.range();
        let (_, longest_s) = Quantity::SourceValidityS.range();
        let checks = [
            quantity.check_within(min, least, most),
            quantity.check_within(max, min, most),
            Quantity::SourcePeriodS.check(period_s),
            Quantity::SourceValidityS.check(validity_s),
            // A source must be silent before it is lost.
            Quantity::SourceValidityS.check_within(validity_s, period_s, longest_s),
            Quantity::SourceSlew.check(slew_per_s),
            Quantity::SourceSigma.check(sigma),
            Quantity::SourceLatencyS.check(latency_s),
            Quantity::SourceChange.check(change_per_sqrt_s),
            Quantity::SourceFrozenS.check(frozen_s),
        ];
        let mut rest = checks.as_slice();
        while let Some((check, others)) = rest.split_first() {
            if let Err(error) = check {
                return Err(*error);
            }
            rest = others;
        }
        Ok(self)
    }
}

/// Settings of each source, and of V/H itself.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VhSettings {
    /// V/H given directly, 1/s; its range is that of every V/H.
    pub direct: ChannelSettings,
    /// Ground speed of the satellite receiver, m/s.
    pub ground_speed: ChannelSettings,
    /// Ground speed of the inertial unit, m/s.
    pub inertial_speed: ChannelSettings,
    /// Height above ground of the radar altimeter, m; its range also bounds altitude less terrain
    /// height.
    pub height_above_ground: ChannelSettings,
    /// Height above ground of the laser altimeter, m.
    pub laser_height: ChannelSettings,
    /// Altitude above sea level, m.
    pub altitude: ChannelSettings,
    /// Height of the terrain above sea level, m.
    pub terrain_height: ChannelSettings,
    /// Difference between two ways to the same number up to which they agree, per cent.
    pub disagreement_percent: f32,
}

impl VhSettings {
    /// Settings of a survey aircraft with receiver, inertial unit and altimeter of its class:
    /// speeds change by half of g at most, the ground below by a slope of 45° at 100 m/s.
    pub const DEFAULT: Self = Self {
        direct: ChannelSettings {
            range: [0.001, 2.0],
            period_s: 1.2,
            validity_s: 5.0,
            slew_per_s: 0.01,
            sigma: 0.0005,
            latency_s: 0.1,
            change_per_sqrt_s: 0.003,
            frozen_s: 0.0,
        },
        ground_speed: ChannelSettings {
            range: [5.0, 350.0],
            period_s: 1.2,
            validity_s: 10.0,
            slew_per_s: 5.0,
            sigma: 0.1,
            latency_s: 0.2,
            change_per_sqrt_s: 3.0,
            frozen_s: 10.0,
        },
        inertial_speed: ChannelSettings {
            range: [5.0, 350.0],
            period_s: 0.2,
            validity_s: 10.0,
            slew_per_s: 5.0,
            sigma: 0.3,
            latency_s: 0.02,
            change_per_sqrt_s: 3.0,
            frozen_s: 2.0,
        },
        height_above_ground: ChannelSettings {
            range: [20.0, 15_000.0],
            period_s: 0.5,
            validity_s: 5.0,
            slew_per_s: 100.0,
            sigma: 3.0,
            latency_s: 0.1,
            change_per_sqrt_s: 6.0,
            frozen_s: 5.0,
        },
        laser_height: ChannelSettings {
            range: [20.0, 5000.0],
            period_s: 0.5,
            validity_s: 5.0,
            slew_per_s: 100.0,
            sigma: 0.5,
            latency_s: 0.02,
            change_per_sqrt_s: 6.0,
            frozen_s: 5.0,
        },
        altitude: ChannelSettings {
            range: [-450.0, 15_000.0],
            period_s: 1.2,
            validity_s: 10.0,
            slew_per_s: 20.0,
            sigma: 3.0,
            latency_s: 0.2,
            change_per_sqrt_s: 3.0,
            frozen_s: 30.0,
        },
        terrain_height: ChannelSettings {
            range: [-450.0, 9000.0],
            period_s: 10.0,
            validity_s: 60.0,
            slew_per_s: 100.0,
            sigma: 10.0,
            latency_s: 0.2,
            change_per_sqrt_s: 6.0,
            frozen_s: 0.0,
        },
        disagreement_percent: 5.0,
    };

    /// Returns the settings, if all of them are possible.
    ///
    /// # Errors
    /// [`OutOfRange`] of the first that is not.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        let (lowest, _) = Quantity::AltitudeM.range();
        let speed = (Quantity::GroundSpeedMS, LEAST_SPEED_M_S);
        let height = (Quantity::HeightAboveGroundM, LEAST_HEIGHT_M);
        for channel in VhChannel::ALL {
            let (quantity, least) = match channel {
                VhChannel::Direct => (Quantity::VhPerS, LEAST_VH_PER_S),
                VhChannel::GroundSpeed | VhChannel::InertialSpeed => speed,
                VhChannel::HeightAboveGround | VhChannel::LaserHeight => height,
                VhChannel::Altitude => (Quantity::AltitudeM, lowest),
                VhChannel::TerrainHeight => (Quantity::TerrainHeightM, lowest),
            };
            self.of(channel).checked(quantity, least)?;
        }
        Quantity::DisagreementPercent.check(self.disagreement_percent)?;
        Ok(self)
    }

    /// Settings of one source.
    #[must_use]
    pub const fn of(&self, channel: VhChannel) -> &ChannelSettings {
        match channel {
            VhChannel::Direct => &self.direct,
            VhChannel::GroundSpeed => &self.ground_speed,
            VhChannel::InertialSpeed => &self.inertial_speed,
            VhChannel::HeightAboveGround => &self.height_above_ground,
            VhChannel::LaserHeight => &self.laser_height,
            VhChannel::Altitude => &self.altitude,
            VhChannel::TerrainHeight => &self.terrain_height,
        }
    }
}

impl Default for VhSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_is_possible_and_what_is_not_is_named() {
        assert_eq!(VhSettings::DEFAULT.checked(), Ok(VhSettings::DEFAULT));
        let mut standing = VhSettings::DEFAULT;
        standing.ground_speed.range = [0.0, 100.0];
        let mut never_silent = VhSettings::DEFAULT;
        never_silent.altitude.validity_s = 1.0;
        let mut upside_down = VhSettings::DEFAULT;
        upside_down.laser_height.range = [500.0, 100.0];
        let mut without_sigma = VhSettings::DEFAULT;
        without_sigma.direct.sigma = 0.0;
        for (settings, quantity) in [
            (standing, Quantity::GroundSpeedMS),
            (never_silent, Quantity::SourceValidityS),
            (upside_down, Quantity::HeightAboveGroundM),
            (without_sigma, Quantity::SourceSigma),
        ] {
            assert_eq!(settings.checked().unwrap_err().quantity, quantity);
        }
    }
}
