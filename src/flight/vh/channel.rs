//! One source of V/H: its checks, and its value while it is silent.

use super::finding::{VhFindingKind, WrongUnit};
use super::held::{Held, Stamped};
use super::refusal::Refusal;
use super::settings::ChannelSettings;
use super::unit_watch::{Comparison, UnitWatch};
use super::variability::Variability;
use crate::flight::time::Time;

/// Number of samples near each other after which a source that has jumped is trusted again.
pub const CONSISTENT_SAMPLES: u8 = 5;

/// Number of σ by which a sample may differ from the last beyond the slew limit.
pub const NOISE_SIGMAS: f32 = 6.0;

/// Number of σ of the change that its samples have shown by which a speed or V/H may differ from
/// the last one beyond slew and noise: gusts are faster than an aircraft slews.
pub const GUST_SIGMAS: f32 = 3.0;

/// Largest difference from another way to the same number, as a part of it, at which a value that
/// has jumped is confirmed.
pub const CONFIRMED_WITHIN: f32 = 0.05;

/// Numbers of the other sources that concern one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Others {
    /// Value that follows from all others.
    pub(super) expected: Option<f32>,
    /// Height above ground, m, for a height above the sea: differences count as parts of it.
    pub(super) height_m: Option<f32>,
}

impl Others {
    /// Returns `true` if a value is so near to another that they confirm each other.
    fn are_near(&self, settings: &ChannelSettings, value: f32, other: f32) -> bool {
        let noise = NOISE_SIGMAS * settings.sigma;
        let whole = self.height_m.unwrap_or(other).abs();
        (value - other).abs() <= CONFIRMED_WITHIN * whole + noise
    }
}

/// Effect of a sample that is used: it may end a silence or a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Accepted {
    AsBefore,
    Recovered,
}

/// One source.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Channel {
    /// The last sample that was trusted.
    last: Option<Stamped>,
    /// The last value, with the time since which it has repeated.
    repeated: Option<Stamped>,
    /// Time of the last sample.
    heard: Time,
    /// The last sample at a new level, and the number of samples there.
    candidate: Option<(Stamped, u8)>,
    unit: UnitWatch,
    /// `true` if the last sample was refused.
    refused: bool,
    /// The value before a jump that nothing has confirmed.
    doubt: Option<f32>,
    /// `true` if another way has agreed with the value since it jumped last.
    confirmed: bool,
    variability: Variability,
}

impl Channel {
    pub(super) const NEW: Self = Self {
        last: None,
        repeated: None,
        heard: Time::START,
        candidate: None,
        unit: UnitWatch::NEW,
        refused: false,
        doubt: None,
        confirmed: false,
        variability: Variability::NEW,
    };

    /// Returns the last value, as long as it is valid, with its uncertainty.
    ///
    /// # Model
    /// The value is held. While its source is heard its variance is that of [`Variability`], at the
    /// age of the measurement: time since its arrival and latency of the source; of a value that
    /// repeats, since it came first. From the period of a silent source on the value changes by its
    /// slew limit at most, a uniform error of standard deviation slew·T/√3 after T:
    /// `σ² = r + q·age + (slew·T)²/3`. The value before a jump may be true, and one to which the
    /// source has jumped, from its second sample there on.
    pub(super) fn held(&self, settings: &ChannelSettings, now: Time) -> Option<Held> {
        let last = self.last?;
        let since_s = now.seconds_since(last.time).max(0.0);
        if since_s >= settings.validity_s {
            return None;
        }
        let [noise, change_per_s] = self.variability.variances();
        let unknown_s = settings.latency_s + since_s + self.unchanged_s(settings, last);
        let drift = settings.slew_per_s * (since_s - settings.period_s).max(0.0);
        let held = Held {
            value: last.value,
            variance: noise + change_per_s * unknown_s + drift * drift / 3.0,
            change_per_s,
            bounds: [last.value; 2],
            is_in_doubt: self.doubt.is_some(),
            age_s: settings.latency_s + since_s,
            silent: since_s >= settings.period_s,
        };
        let held = self.doubt.map_or(held, |before| held.or(before));
        Some(match self.candidate {
            // Refused more than once, but not for its sign.
            Some((refused, samples)) if samples > 1 && refused.value * last.value > 0.0 => {
                held.or(refused.value)
            }
            _ => held,
        })
    }

    /// Returns the time for which the last value has repeated, s: the true value is unknown since
    /// then if the source never gives the same one for long.
    fn unchanged_s(&self, settings: &ChannelSettings, last: Stamped) -> f32 {
        match self.repeated {
            Some(first)
                if first.time < last.time
                    && settings.frozen_s > 0.0
                    && is_same(first.value, last.value) =>
            {
                last.time.seconds_since(first.time)
            }
            _ => 0.0,
        }
    }

    /// Returns the last value, as long as it is valid.
    pub(super) fn valid(&self, settings: &ChannelSettings, now: Time) -> Option<f32> {
        let last = self.last?;
        (now.seconds_since(last.time) < settings.validity_s).then_some(last.value)
    }

    /// Returns the last value, as long as it is valid and not in doubt.
    pub(super) fn undoubted(&self, settings: &ChannelSettings, now: Time) -> Option<f32> {
        self.valid(settings, now).filter(|_| self.doubt.is_none())
    }

    /// Trusts the last value, for the operator.
    pub(super) const fn clear_doubt(&mut self) {
        self.doubt = None;
    }

    /// Returns `true` if another way has agreed with the value since it jumped last.
    pub(super) const fn is_confirmed(&self) -> bool {
        self.confirmed
    }

    /// Takes a sample.
    pub(super) fn take(
        &mut self,
        settings: &ChannelSettings,
        unit: Option<WrongUnit>,
        sample: Stamped,
        others: &Others,
    ) -> Result<Accepted, Refusal> {
        let Stamped { time, .. } = sample;
        let has_jumped = match self.judge(settings, unit, sample, others) {
            Ok(has_jumped) => has_jumped,
            Err(refusal) => {
                self.refused = true;
                return Err(refusal);
            }
        };
        let lost = self
            .last
            .is_some_and(|last| time.seconds_since(last.time) >= settings.validity_s);
        let recovered = self.refused || lost;
        self.settle(settings, sample, has_jumped, others);
        self.refused = false;
        self.candidate = None;
        self.last = Some(sample);
        Ok(if recovered {
            Accepted::Recovered
        } else {
            Accepted::AsBefore
        })
    }

    /// Notes whether a sample that is used is confirmed by the others or in doubt, and measures the
    /// source's noise.
    ///
    /// A value that has jumped is in doubt until another way agrees with it or it is back at the
    /// value before the jump.
    fn settle(
        &mut self,
        settings: &ChannelSettings,
        sample: Stamped,
        has_jumped: bool,
        others: &Others,
    ) {
        let is_near = |other| others.are_near(settings, sample.value, other);
        self.variability.begin(settings);
        if has_jumped {
            self.variability.interrupt();
            self.confirmed = false;
            self.doubt = match self.doubt {
                Some(before) if is_near(before) => None,
                Some(before) => Some(before),
                None => self.last.map(|last| last.value),
            };
        } else if let Some(last) = self.last.filter(|last| !is_same(last.value, sample.value)) {
            self.variability.take(settings, last, sample);
        }
        if others.expected.is_some_and(is_near) {
            self.confirmed = true;
            self.doubt = None;
        }
    }

    /// Bars the source, after the others have shown that its trusted value is in the wrong unit.
    pub(super) fn bar(&mut self, unit: WrongUnit) {
        if let Some(last) = self.last {
            self.unit.bar(unit, last.value);
            // No earlier value can be compared with later ones.
            self.last = None;
            self.candidate = None;
            self.doubt = None;
            self.refused = true;
        }
    }

    /// Returns whether a sample that can be used has jumped.
    fn judge(
        &mut self,
        settings: &ChannelSettings,
        unit: Option<WrongUnit>,
        sample: Stamped,
        others: &Others,
    ) -> Result<bool, Refusal> {
        let Stamped { time, value } = sample;
        let refuse = |kind, expected| Err(Refusal { kind, expected });
        if !value.is_finite() {
            return refuse(VhFindingKind::NotANumber, None);
        }
        if time < self.heard {
            return refuse(VhFindingKind::FromThePast, None);
        }
        self.heard = time;
        let repeated_since = self.repeated_since(sample);
        if let Some(unit) = unit {
            let comparison = self.comparison(settings, unit, sample, others.expected);
            self.unit.check(unit, value, &comparison)?;
        }
        let [min, max] = settings.range;
        if !(value >= min && value <= max) {
            return if -value >= min && -value <= max {
                refuse(VhFindingKind::WrongSign, None)
            } else {
                refuse(
                    VhFindingKind::OutOfRange,
                    Some(if value < min { min } else { max }),
                )
            };
        }
        if settings.frozen_s > 0.0 && time.seconds_since(repeated_since) > settings.frozen_s {
            // The true value is unknown since the first repetition.
            if let Some(last) = &mut self.last {
                last.time = last.time.min(repeated_since);
            }
            return refuse(VhFindingKind::Frozen, None);
        }
        self.check_jump(settings, unit, sample, others)
    }

    /// Returns the time since which the value has been exactly this.
    fn repeated_since(&mut self, sample: Stamped) -> Time {
        match self.repeated {
            Some(before) if is_same(before.value, sample.value) => before.time,
            _ => {
                self.repeated = Some(sample);
                sample.time
            }
        }
    }

    /// Returns the numbers that show whether a sample's unit is right.
    fn comparison(
        &self,
        settings: &ChannelSettings,
        unit: WrongUnit,
        sample: Stamped,
        expected: Option<f32>,
    ) -> Comparison {
        let is_continuous = self
            .last
            .is_some_and(|last| self.reaches(settings, last, sample, Some(unit)));
        Comparison {
            expected,
            // A source that was right and has not jumped has not changed its unit.
            from_others: expected.filter(|_| !(is_continuous && self.confirmed)),
            from_past: self.last.filter(|_| !is_continuous).map(|last| last.value),
        }
    }

    /// Checks that the source can have reached this value from its last one, or has stayed there
    /// long enough. Returns whether it has jumped.
    fn check_jump(
        &mut self,
        settings: &ChannelSettings,
        unit: Option<WrongUnit>,
        sample: Stamped,
        others: &Others,
    ) -> Result<bool, Refusal> {
        let Some(last) = self.last else {
            return Ok(false);
        };
        if self.reaches(settings, last, sample, unit) {
            // One that follows refused samples may have come this far since, or have jumped.
            let off = |from: Stamped| (sample.value - from.value).abs();
            let is_far = !others.are_near(settings, sample.value, last.value);
            return Ok(self
                .candidate
                .is_some_and(|(candidate, _)| is_far && off(candidate) < off(last)));
        }
        let negated = Stamped {
            value: -sample.value,
            ..sample
        };
        let kind = if last.value.abs() > NOISE_SIGMAS * settings.sigma
            && self.reaches(settings, last, negated, unit)
        {
            VhFindingKind::WrongSign
        } else {
            VhFindingKind::Jump
        };
        let before = match self.candidate {
            Some((candidate, samples)) if self.reaches(settings, candidate, sample, unit) => {
                samples
            }
            _ => 0,
        };
        let samples = before.saturating_add(1);
        self.candidate = Some((sample, samples));
        if kind == VhFindingKind::Jump && samples >= CONSISTENT_SAMPLES {
            return Ok(true);
        }
        Err(Refusal {
            kind,
            expected: Some(last.value),
        })
    }

    /// Returns `true` if the source can have come from one sample to the other.
    fn reaches(
        &self,
        settings: &ChannelSettings,
        from: Stamped,
        to: Stamped,
        unit: Option<WrongUnit>,
    ) -> bool {
        let elapsed_s = to.time.seconds_since(from.time).max(0.0);
        let within = settings.slew_per_s * elapsed_s + NOISE_SIGMAS * settings.sigma;
        let beyond = (to.value - from.value).abs() - within;
        let has_gusts = unit != Some(WrongUnit::Feet);
        let change = self.variability.shown_change_per_s(settings) * elapsed_s;
        beyond <= 0.0 || has_gusts && beyond * beyond <= GUST_SIGMAS * GUST_SIGMAS * change
    }
}

/// Returns `true` if a source repeats itself.
const fn is_same(before: f32, value: f32) -> bool {
    before.to_bits() == value.to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::vh::VhSettings;

    fn at(ms: u64, value: f32) -> Stamped {
        Stamped {
            time: Time::from_us(1000 * ms),
            value,
        }
    }

    #[test]
    fn source_without_a_trusted_value_is_not_barred_and_frozen_from_its_first_sample() {
        let mut channel = Channel::NEW;
        channel.bar(WrongUnit::Knots);
        assert!(!channel.refused && channel.last.is_none());
        let settings = ChannelSettings {
            frozen_s: 1.0,
            ..VhSettings::DEFAULT.ground_speed
        };
        channel.repeated = Some(at(0, 60.0));
        let others = Others {
            expected: None,
            height_m: None,
        };
        let refused = channel.judge(&settings, None, at(1001, 60.0), &others);
        let Err(refusal) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(refusal.kind, VhFindingKind::Frozen);
        assert!(channel.last.is_none());
    }

    #[test]
    fn last_value_is_unchanged_only_since_a_sample_of_the_same_value() {
        let settings = ChannelSettings {
            frozen_s: 5.0,
            ..VhSettings::DEFAULT.ground_speed
        };
        let since = |first| {
            let channel = Channel {
                repeated: Some(first),
                ..Channel::NEW
            };
            channel.unchanged_s(&settings, at(3000, 60.0))
        };
        assert!((since(at(1000, 60.0)) - 2.0).abs() < 1e-6);
        assert!(since(at(1000, 60.1)).abs() <= 0.0);
        assert!(since(at(3000, 60.0)).abs() <= 0.0);
    }
}
