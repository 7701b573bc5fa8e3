//! Monitor of the sources of V/H.

use super::agreement::{Choice, Limits};
use super::channel::{Accepted, Channel, Others};
use super::estimate::{VhEstimate, VhSource};
use super::finding::{VhChannel, VhCounters, VhFinding, VhFindingKind};
use super::held::{HeldVh, Stamped};
use super::sample::VhSample;
use super::settings::VhSettings;
use super::spread::Spread;
use super::survey::{Agreements, Survey, SurveyLimits, is_within};
use super::unit_watch::is_times;
use super::values::Values;
use crate::flight::time::Time;

/// Keeps the samples of all sources and derives V/H from them.
///
/// # Model
/// There are three ways, in the order of their rank: V/H as given; ground speed over the height of
/// an altimeter; ground speed over altitude less terrain height. Of two sensors of one quantity the
/// satellite receiver goes before the inertial unit, the laser before the radar. Every sample
/// passes the checks of its own source first (range, sign, unit, jump, frozen), see
/// [`VhFindingKind`].
///
/// The first way or sensor is used that is heard. Where two contradict each other, the less
/// plausible gives way: one that has jumped and that nothing has confirmed, one outside the
/// camera's limits, one far from what was trusted in the last minute
/// ([`TRUSTED_S`](super::agreement::TRUSTED_S)), one that two
/// others contradict. Rank decides only between equals.
///
/// `σ² = (σ_V/H)² + (V·σ_H/H²)²`, each with the noise of its source and its change since the
/// measurement, both of which are measured in flight. To that are added half of the part of the
/// squared differences from other ways that their variances do not explain, and the square of the
/// distance to the farthest V/H that may be true in its place: by a source that contradicts the one
/// in use, or by the value before a jump that nothing has confirmed.
///
/// # Undetected errors
///
/// | error | bound |
/// |---|---|
/// | of a source that is alone: a value that drifts no faster than its slew limit | its range |
/// | of a source that is alone: wrong from the first sample | its range |
/// | of the better of two ways: a drift in which the trusted value follows it | the other way: flag, σ covers both |
/// | of both ways at once: the speed or the terrain's height that they share | the range of V/H |
///
/// A source that is alone and jumps is used once it has stayed at its new value; from then on
/// [`Self::is_unconfirmed`], and σ covers the value before, until another way confirms it, it
/// returns, or [`Self::clear_doubt`].
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
    agreements: Agreements,
    /// Limits of the camera, 1/s.
    limits_per_s: [f32; 2],
    spread: Spread,
    disagree: bool,
    unconfirmed: bool,
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
            agreements: Agreements::NEW,
            limits_per_s: settings.direct.range,
            spread: Spread::NEW,
            disagree: false,
            unconfirmed: false,
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

    /// Returns the monitor of a camera whose V/H has these limits, 1/s: of two ways that contradict
    /// each other, one outside them is less plausible.
    #[must_use]
    pub const fn with_limits(mut self, limits_per_s: [f32; 2]) -> Self {
        self.limits_per_s = limits_per_s;
        self
    }

    /// Sets the limits of another camera's V/H, 1/s; samples and suspicions stay.
    pub(crate) const fn set_limits(&mut self, limits_per_s: [f32; 2]) {
        self.limits_per_s = limits_per_s;
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
        *self = Self::new(self.settings).with_limits(self.limits_per_s);
        self.counters = counters;
    }

    /// Trusts a source that has jumped as it is now, for the operator.
    pub const fn clear_doubt(&mut self) {
        self.direct.clear_doubt();
        self.ground_speed.clear_doubt();
        self.inertial_speed.clear_doubt();
        self.height_above_ground.clear_doubt();
        self.laser_height.clear_doubt();
        self.altitude.clear_doubt();
        self.terrain_height.clear_doubt();
        self.unconfirmed = false;
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
        self.estimate_ahead(now, 0.0)
    }

    /// Returns `true` if there is a V/H now: a way whose sources are not lost, in the range of V/H.
    #[must_use]
    pub fn is_known(&self, now: Time) -> bool {
        let last = |channel| self.channel(channel).valid(self.settings.of(channel), now);
        let is_vh = |vh_per_s: f32| is_within(self.settings.direct.range, vh_per_s);
        if last(VhChannel::Direct).is_some_and(is_vh) {
            return true;
        }
        let speed = last(VhChannel::GroundSpeed).or_else(|| last(VhChannel::InertialSpeed));
        let Some(speed_m_s) = speed else {
            return false;
        };
        let is_height = |height_m: &f32| is_vh(speed_m_s / height_m);
        let over_terrain = || {
            let height_m = last(VhChannel::Altitude)? - last(VhChannel::TerrainHeight)?;
            Some(height_m).filter(|it| is_within(self.settings.height_above_ground.range, *it))
        };
        [VhChannel::LaserHeight, VhChannel::HeightAboveGround]
            .into_iter()
            .find_map(|channel| last(channel).filter(is_height))
            .or_else(|| over_terrain().filter(is_height))
            .is_some()
    }

    /// Returns the V/H of [`Self::estimate`], with σ and age at its use a time later, s.
    #[must_use]
    pub fn estimate_ahead(&self, now: Time, ahead_s: f32) -> Option<VhEstimate> {
        Some(self.held(now)?.estimate(ahead_s))
    }

    /// Returns the V/H in use now, whose σ and age at a later time can be given.
    pub(crate) fn held(&self, now: Time) -> Option<HeldVh> {
        let Choice { index, held, .. } = self.survey(now).way?;
        Some(HeldVh {
            source: *WAYS.get(index)?,
            held,
        })
    }

    /// Squared standard deviation of V/H about its mean in the last half minute, as a part of the
    /// square of V/H: by so much differs the image motion across the track and elsewhere in the
    /// picture.
    #[must_use]
    pub fn relative_variance(&self) -> f32 {
        self.spread.relative_variance()
    }

    /// Returns `true` if two sensors or ways contradicted each other at the last sample that was
    /// used.
    #[must_use]
    pub const fn has_disagreed(&self) -> bool {
        self.disagree
    }

    /// Returns `true` if V/H, at the last sample that was used, came from a source that has jumped
    /// and that nothing has confirmed.
    #[must_use]
    pub const fn is_unconfirmed(&self) -> bool {
        self.unconfirmed
    }

    fn finding(&mut self, time: Time, sample: VhSample) -> Option<VhFinding> {
        let (channel, value) = VhChannel::of(sample);
        let expected = self.values(time).expected(channel);
        let others = Others {
            expected,
            height_m: self.height_under(channel, time),
        };
        let settings = *self.settings.of(channel);
        let unit = channel.wrong_unit();
        let taken =
            self.channel_mut(channel)
                .take(&settings, unit, Stamped { time, value }, &others);
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
        let barred = self.bar_another(channel, time);
        let against = self.learn(time);
        self.disagree = against.is_some();
        if barred.is_some() {
            return barred;
        }
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
            let is_right = self.channel(channel).is_confirmed();
            if channel != accepted && !is_right && is_times(value, expected, unit.factor()) {
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

    /// Returns the height above ground that goes with a height above the sea, m; `None` for another
    /// quantity.
    fn height_under(&self, channel: VhChannel, now: Time) -> Option<f32> {
        if !matches!(channel, VhChannel::Altitude | VhChannel::TerrainHeight) {
            return None;
        }
        let last = |channel| self.channel(channel).valid(self.settings.of(channel), now);
        last(VhChannel::LaserHeight)
            .or_else(|| last(VhChannel::HeightAboveGround))
            .or_else(|| Some(last(VhChannel::Altitude)? - last(VhChannel::TerrainHeight)?))
    }

    fn values(&self, now: Time) -> Values {
        let value = |channel| {
            let settings = self.settings.of(channel);
            self.channel(channel).undoubted(settings, now)
        };
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

    /// Learns from the values at a sample that is used. Returns the V/H or quantity in use and
    /// another that contradicts it.
    fn learn(&mut self, now: Time) -> Option<[f32; 2]> {
        let survey = self.survey(now);
        self.agreements.learn(&survey, &self.limits(now));
        self.unconfirmed = false;
        if let Some(way) = survey.way {
            self.unconfirmed = way.held.is_in_doubt;
            if !self.unconfirmed {
                self.spread.take(now, way.held.value);
            }
        }
        survey.against()
    }

    /// Returns the values of all sensors and ways that are not lost, and the choice among them.
    pub(super) fn survey(&self, now: Time) -> Survey {
        let held = |channel| {
            let settings = self.settings.of(channel);
            self.channel(channel).held(settings, now)
        };
        self.agreements
            .survey(&self.settings, &self.limits(now), held)
    }

    /// Limits by which speeds, heights and ways are compared.
    const fn limits(&self, now: Time) -> SurveyLimits {
        let speeds = Limits {
            now,
            difference: 0.01 * self.settings.disagreement_percent,
            plausible: self.settings.ground_speed.range,
        };
        SurveyLimits {
            speeds,
            heights: Limits {
                plausible: self.settings.height_above_ground.range,
                ..speeds
            },
            ways: Limits {
                plausible: self.limits_per_s,
                ..speeds
            },
        }
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

/// The ways, the best first.
const WAYS: [VhSource; 3] = [VhSource::Direct, VhSource::Altimeter, VhSource::Terrain];
