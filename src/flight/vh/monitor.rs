//! Monitor of the sources of V/H.

use super::channel::{Accepted, Channel, Held, is_times};
use super::estimate::{VhEstimate, VhSource};
use super::finding::{VhChannel, VhCounters, VhFinding, VhFindingKind};
use super::sample::VhSample;
use super::settings::{ChannelSettings, VhSettings};
use crate::flight::time::Time;

/// Keeps the samples of all sources and derives V/H from them.
///
/// # Model
/// Of three ways the first that is not lost is used: V/H as given; ground speed over the height of
/// an altimeter; ground speed over altitude less terrain height. Of two sensors of one quantity the
/// satellite receiver goes before the inertial unit, the laser before the radar. Every sample
/// passes the checks of its own source first (range, sign, unit, jump, frozen), see
/// [`VhFindingKind`].
///
/// `σ² = (σ_V/H)² + (V·σ_H/H²)²`, each with its age; see [`ChannelSettings`]. If another sensor or
/// way that is not lost differs by more than the limit, σ² grows by the square of the difference:
/// the wrong one of the two is not known, so V/H is still given, and the smear budget decides on
/// its use.
///
/// # Undetected errors
/// A value that drifts no faster than the slew limit cannot be told from a real change; it is
/// bounded by the ranges, and by the disagreement limit if there is a second way. A first sample
/// has no past: alone, it is bounded by its range.
#[derive(Debug, Clone)]
pub struct VhMonitor {
    settings: VhSettings,
    direct: Channel,
    ground_speed: Channel,
    inertial_speed: Channel,
    height_above_ground: Channel,
    laser_height: Channel,
    altitude: Channel,
    terrain_height: Channel,
    disagree: bool,
    counters: VhCounters,
}

impl Default for VhMonitor {
    fn default() -> Self {
        Self::new(VhSettings::DEFAULT)
    }
}

impl VhMonitor {
    /// Returns a monitor without samples; the settings are those that [`VhSettings::checked`]
    /// returned.
    #[must_use]
    pub const fn new(settings: VhSettings) -> Self {
        Self {
            settings,
            direct: Channel::NEW,
            ground_speed: Channel::NEW,
            inertial_speed: Channel::NEW,
            height_above_ground: Channel::NEW,
            laser_height: Channel::NEW,
            altitude: Channel::NEW,
            terrain_height: Channel::NEW,
            disagree: false,
            counters: VhCounters {
                not_a_number: 0,
                out_of_range: 0,
                wrong_sign: 0,
                wrong_unit: 0,
                jump: 0,
                frozen: 0,
                from_the_past: 0,
                disagreement: 0,
                recovered: 0,
            },
        }
    }

    /// The settings.
    #[must_use]
    pub const fn settings(&self) -> &VhSettings {
        &self.settings
    }

    /// Counts of each kind of finding.
    #[must_use]
    pub const fn counters(&self) -> VhCounters {
        self.counters
    }

    /// Forgets samples and suspicions, for the operator. The counts stay.
    pub const fn clear(&mut self) {
        let counters = self.counters;
        *self = Self::new(self.settings);
        self.counters = counters;
    }

    /// Takes a sample, and returns its finding if there is one.
    pub fn observe(&mut self, time: Time, sample: VhSample) -> Option<VhFinding> {
        let finding = self.finding(time, sample);
        if let Some(finding) = finding {
            self.counters.count(finding.kind);
        }
        finding
    }

    /// Returns V/H now; `None` if there is none within its validity and the range of V/H.
    #[must_use]
    pub fn estimate(&self, now: Time) -> Option<VhEstimate> {
        let ways = self.ways(now);
        let (source, way) = first(&ways)?;
        let difference = self.farthest(&ways, way.value);
        Some(VhEstimate {
            vh_per_s: way.value,
            sigma_per_s: libm::sqrtf(way.sigma * way.sigma + difference * difference),
            age_s: way.age_s,
            source,
            extrapolated: way.silent,
        })
    }

    /// Returns `true` if two sensors or ways differed by more than the limit at the last sample
    /// that was used.
    #[must_use]
    pub const fn has_disagreed(&self) -> bool {
        self.disagree
    }

    fn finding(&mut self, time: Time, sample: VhSample) -> Option<VhFinding> {
        let (channel, value) = VhChannel::of(sample);
        let expected = self.values(time).expected(channel);
        let settings = *self.settings.of(channel);
        let unit = channel.wrong_unit();
        let taken = self
            .channel_mut(channel)
            .take(&settings, unit, time, value, expected);
        let accepted = match taken {
            Err(refusal) => {
                return Some(VhFinding {
                    channel,
                    kind: refusal.kind,
                    value,
                    expected: refusal.expected,
                });
            }
            Ok(accepted) => accepted,
        };
        let disagreed = self.disagree;
        if let Some(found) = self.bar_another(channel, time) {
            return Some(found);
        }
        let against = self.disagreement(time);
        self.disagree = against.is_some();
        let (kind, value, expected) = match (against, disagreed, accepted) {
            (Some([used, other]), false, _) => (VhFindingKind::Disagreement, used, Some(other)),
            (None, true, _) | (_, _, Accepted::Recovered) => {
                (VhFindingKind::Recovered, value, expected)
            }
            (_, _, Accepted::AsBefore) => return None,
        };
        Some(VhFinding {
            channel,
            kind,
            value,
            expected,
        })
    }

    /// Bars a source that the new sample shows to be in the wrong unit. Of two numbers that differ
    /// by a unit's factor the larger is wrong, as feet and knots are smaller than metres and metres
    /// per second.
    fn bar_another(&mut self, accepted: VhChannel, time: Time) -> Option<VhFinding> {
        let values = self.values(time);
        for channel in VhChannel::ALL {
            let Some(unit) = channel.wrong_unit() else {
                continue;
            };
            let (Some(value), Some(expected)) = (values.of(channel), values.expected(channel))
            else {
                continue;
            };
            if channel != accepted && is_times(value, expected, unit.factor()) {
                self.channel_mut(channel).bar(unit);
                return Some(VhFinding {
                    channel,
                    kind: VhFindingKind::WrongUnit(unit),
                    value,
                    expected: Some(expected),
                });
            }
        }
        None
    }

    fn values(&self, now: Time) -> Values {
        let value = |channel| self.held(channel, now).map(|held| held.value);
        Values {
            direct: value(VhChannel::Direct),
            ground_speed: value(VhChannel::GroundSpeed),
            inertial_speed: value(VhChannel::InertialSpeed),
            radar: value(VhChannel::HeightAboveGround),
            laser: value(VhChannel::LaserHeight),
            altitude: value(VhChannel::Altitude),
            terrain: value(VhChannel::TerrainHeight),
        }
    }

    /// Returns the V/H or speed in use and another that differs from it by more than the limit.
    pub(super) fn disagreement(&self, now: Time) -> Option<[f32; 2]> {
        let sensors = [
            [VhChannel::GroundSpeed, VhChannel::InertialSpeed],
            [VhChannel::LaserHeight, VhChannel::HeightAboveGround],
        ]
        .into_iter()
        .filter_map(|[one, other]| {
            let used = self.held(one, now)?.value;
            Some([used, self.held(other, now)?.value])
        });
        let ways = self.ways(now);
        let used = first(&ways).map(|(_, way)| way.value);
        let others = ways
            .iter()
            .filter_map(|(_, way)| Some([used?, (*way)?.value]));
        sensors
            .chain(others)
            .find(|[used, other]| self.differ(*used, *other))
    }

    /// Returns the difference of the way farthest from the value in use, if it exceeds the limit;
    /// else 0.
    fn farthest(&self, ways: &Ways, used: f32) -> f32 {
        ways.iter()
            .filter_map(|(_, way)| *way)
            .filter(|way| self.differ(used, way.value))
            .fold(0.0, |farthest, way| (way.value - used).abs().max(farthest))
    }

    fn differ(&self, used: f32, other: f32) -> bool {
        (used - other).abs() > 0.01 * self.settings.disagreement_percent * used
    }

    /// Returns V/H by each way that is not lost, the best first.
    fn ways(&self, now: Time) -> Ways {
        let speed = self.of_two(VhChannel::GroundSpeed, VhChannel::InertialSpeed, now);
        let altimeter = self.of_two(VhChannel::LaserHeight, VhChannel::HeightAboveGround, now);
        let over_terrain = self
            .held(VhChannel::Altitude, now)
            .zip(self.held(VhChannel::TerrainHeight, now))
            .map(|(altitude, terrain)| {
                let variance = altitude.sigma * altitude.sigma + terrain.sigma * terrain.sigma;
                let height = altitude.value - terrain.value;
                Held::of_two(height, libm::sqrtf(variance), altitude, terrain)
            })
            .filter(|height| within(&self.settings.height_above_ground, height.value));
        let quotient = |height: Option<Held>| {
            let (speed, height) = (speed?, height?);
            let vh_per_s = speed.value / height.value;
            let of_speed = speed.sigma / height.value;
            let of_height = vh_per_s * height.sigma / height.value;
            let sigma = libm::sqrtf(of_speed * of_speed + of_height * of_height);
            Some(Held::of_two(vh_per_s, sigma, speed, height))
        };
        [
            (VhSource::Direct, self.held(VhChannel::Direct, now)),
            (VhSource::Altimeter, quotient(altimeter)),
            (VhSource::Terrain, quotient(over_terrain)),
        ]
        .map(|(source, way)| {
            let way = way.filter(|way| within(&self.settings.direct, way.value));
            (source, way)
        })
    }

    /// Returns the better of two sensors of one quantity that are not lost, with their difference
    /// in its σ if they disagree.
    fn of_two(&self, better: VhChannel, other: VhChannel, now: Time) -> Option<Held> {
        let other = self.held(other, now);
        let Some(better) = self.held(better, now) else {
            return other;
        };
        let difference = other
            .filter(|other| self.differ(better.value, other.value))
            .map_or(0.0, |other| better.value - other.value);
        Some(Held {
            sigma: libm::sqrtf(better.sigma * better.sigma + difference * difference),
            ..better
        })
    }

    fn held(&self, channel: VhChannel, now: Time) -> Option<Held> {
        self.channel(channel).held(self.settings.of(channel), now)
    }

    const fn channel(&self, channel: VhChannel) -> &Channel {
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

    const fn channel_mut(&mut self, channel: VhChannel) -> &mut Channel {
        match channel {
            VhChannel::Direct => &mut self.direct,
            VhChannel::GroundSpeed => &mut self.ground_speed,
            VhChannel::InertialSpeed => &mut self.inertial_speed,
            VhChannel::HeightAboveGround => &mut self.height_above_ground,
            VhChannel::LaserHeight => &mut self.laser_height,
            VhChannel::Altitude => &mut self.altitude,
            VhChannel::TerrainHeight => &mut self.terrain_height,
        }
    }
}

/// Values of the sources that are not lost.
#[derive(Debug, Clone, Copy)]
struct Values {
    direct: Option<f32>,
    ground_speed: Option<f32>,
    inertial_speed: Option<f32>,
    radar: Option<f32>,
    laser: Option<f32>,
    altitude: Option<f32>,
    terrain: Option<f32>,
}

impl Values {
    const fn of(&self, channel: VhChannel) -> Option<f32> {
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
    fn expected(&self, channel: VhChannel) -> Option<f32> {
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
            VhChannel::Direct => None,
            VhChannel::GroundSpeed => inertial_speed.or_else(from_height),
            VhChannel::InertialSpeed => ground_speed.or_else(from_height),
            VhChannel::HeightAboveGround => laser.or(over_terrain).or_else(from_direct),
            VhChannel::LaserHeight => radar.or(over_terrain).or_else(from_direct),
            VhChannel::Altitude => Some(terrain? + altimeter.or_else(from_direct)?),
            VhChannel::TerrainHeight => Some(altitude? - altimeter.or_else(from_direct)?),
        }
    }
}

/// V/H by each way, the best first.
type Ways = [(VhSource, Option<Held>); 3];

fn first(ways: &Ways) -> Option<(VhSource, Held)> {
    ways.iter()
        .find_map(|(source, way)| Some((*source, (*way)?)))
}

fn within(settings: &ChannelSettings, value: f32) -> bool {
    let [min, max] = settings.range;
    value >= min && value <= max
}
