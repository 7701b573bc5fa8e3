//! Values of the sources, and the value of each that follows from all others.

use super::finding::VhChannel;

/// Values of the sources that are not lost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Values {
    pub(super) direct: Option<f32>,
    pub(super) ground_speed: Option<f32>,
    pub(super) inertial_speed: Option<f32>,
    pub(super) radar: Option<f32>,
    pub(super) laser: Option<f32>,
    pub(super) altitude: Option<f32>,
    pub(super) terrain: Option<f32>,
}

impl Values {
    pub(super) const fn of(&self, channel: VhChannel) -> Option<f32> {
        match channel {
            VhChannel::Direct => self.direct,
            VhChannel::GroundSpeed => self.ground_speed,
            VhChannel::InertialSpeed => self.inertial_speed,
            VhChannel::HeightAboveGround => self.radar,
            VhChannel::LaserHeight => self.laser,
            VhChannel::Altitude => self.altitude,
            VhChannel::TerrainHeight => self.terrain,
        }
    }

    /// Returns the value of one source that follows from all the others.
    pub(super) fn expected(&self, channel: VhChannel) -> Option<f32> {
        let Self {
            direct,
            ground_speed,
            inertial_speed,
            radar,
            laser,
            altitude,
            terrain,
        } = *self;
        let speed = ground_speed.or(inertial_speed);
        let over_terrain = altitude
            .zip(terrain)
            .map(|(altitude, terrain)| altitude - terrain);
        let altimeter = laser.or(radar);
        let from_direct = || Some(speed? / direct?);
        let from_height = || Some(direct? * altimeter.or(over_terrain)?);
        match channel {
            VhChannel::Direct => Some(speed? / altimeter.or(over_terrain)?),
            VhChannel::GroundSpeed => inertial_speed.or_else(from_height),
            VhChannel::InertialSpeed => ground_speed.or_else(from_height),
            VhChannel::HeightAboveGround => laser.or(over_terrain).or_else(from_direct),
            VhChannel::LaserHeight => radar.or(over_terrain).or_else(from_direct),
            VhChannel::Altitude => Some(terrain? + altimeter.or_else(from_direct)?),
            VhChannel::TerrainHeight => Some(altitude? - altimeter.or_else(from_direct)?),
        }
    }
}
