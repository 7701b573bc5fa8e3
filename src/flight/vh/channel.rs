//! One source of V/H: its checks, and its value while it is silent.

use super::finding::{VhFindingKind, WrongUnit};
use super::settings::ChannelSettings;
use crate::flight::time::Time;

/// Number of samples near each other after which a source that has jumped is trusted again.
pub const CONSISTENT_SAMPLES: u8 = 5;

/// Number of σ by which a sample may differ from the last beyond the slew limit.
pub const NOISE_SIGMAS: f32 = 6.0;

/// Largest difference of a ratio from a unit's factor, as a part of it, at which the unit counts as
/// wrong.
pub const UNIT_TOLERANCE: f32 = 0.03;

/// Largest difference from another way to the same number, as a part of it, at which a source that
/// had the wrong unit is trusted again.
pub const UNIT_RELEASE: f32 = 0.1;

/// Present value and its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Held {
    pub(super) value: f32,
    pub(super) sigma: f32,
    pub(super) age_s: f32,
    /// `true` if it is older than the period of its source.
    pub(super) silent: bool,
}

impl Held {
    /// Returns a value made of two; its age is that of the older.
    pub(super) const fn of_two(value: f32, sigma: f32, one: Self, other: Self) -> Self {
        Self {
            value,
            sigma,
            age_s: one.age_s.max(other.age_s),
            silent: one.silent || other.silent,
        }
    }
}

/// A sample at its time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stamped {
    time: Time,
    value: f32,
}

/// A source with a wrong unit: its last value, and the ratio of that value to the right one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Barred {
    unit: WrongUnit,
    value: f32,
    ratio: f32,
}

/// Finding for which a sample is not used, and the value it was compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Refusal {
    pub(super) kind: VhFindingKind,
    pub(super) expected: Option<f32>,
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
    barred: Option<Barred>,
    /// `true` if the last sample was refused.
    refused: bool,
}

impl Channel {
    pub(super) const NEW: Self = Self {
        last: None,
        repeated: None,
        heard: Time::START,
        candidate: None,
        barred: None,
        refused: false,
    };

    /// Returns the last value, with its uncertainty now, as long as it is valid.
    ///
    /// # Model
    /// The value is held. It changes by its slew limit at most, so after an age T it lies
    /// within ± slew·T of the sample, a uniform error of standard deviation slew·T/√3:
    /// `σ² = σ₀² + (slew·T)²/3`.
    pub(super) fn held(&self, settings: &ChannelSettings, now: Time) -> Option<Held> {
        let last = self.last?;
        let age_s = now.seconds_since(last.time).max(0.0);
        if age_s >= settings.validity_s {
            return None;
        }
        let drift = settings.slew_per_s * age_s;
        Some(Held {
            value: last.value,
            sigma: libm::sqrtf(settings.sigma * settings.sigma + drift * drift / 3.0),
            age_s,
            silent: age_s >= settings.period_s,
        })
    }

    /// Takes a sample; `expected` is the value that follows from all other sources.
    pub(super) fn take(
        &mut self,
        settings: &ChannelSettings,
        unit: Option<WrongUnit>,
        time: Time,
        value: f32,
        expected: Option<f32>,
    ) -> Result<Accepted, Refusal> {
        let sample = Stamped { time, value };
        let verdict = self.judge(settings, unit, sample, expected);
        if verdict.is_ok() {
            let lost = self
                .last
                .is_some_and(|last| time.seconds_since(last.time) >= settings.validity_s);
            let recovered = self.refused || lost;
            self.refused = false;
            self.candidate = None;
            self.last = Some(sample);
            return Ok(if recovered {
                Accepted::Recovered
            } else {
                Accepted::AsBefore
            });
        }
        self.refused = true;
        verdict.map(|()| Accepted::AsBefore)
    }

    /// Bars the source, after the others have shown that its trusted value is in the wrong unit.
    pub(super) fn bar(&mut self, unit: WrongUnit) {
        if let Some(last) = self.last {
            self.barred = Some(Barred {
                unit,
                value: last.value,
                ratio: unit.factor(),
            });
            // No earlier value can be compared with later ones.
            self.last = None;
            self.candidate = None;
            self.refused = true;
        }
    }

    fn judge(
        &mut self,
        settings: &ChannelSettings,
        unit: Option<WrongUnit>,
        sample: Stamped,
        expected: Option<f32>,
    ) -> Result<(), Refusal> {
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
        self.check_unit(settings, unit, sample, expected)?;
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
        self.check_jump(settings, sample)
    }

    /// Returns the time since which the value has been exactly this.
    fn repeated_since(&mut self, sample: Stamped) -> Time {
        match self.repeated {
            Some(before) if before.value.to_bits() == sample.value.to_bits() => before.time,
            _ => {
                self.repeated = Some(sample);
                sample.time
            }
        }
    }

    /// Checks the unit of a value against its own past, against the others, and against a unit that
    /// was wrong before.
    fn check_unit(
        &mut self,
        settings: &ChannelSettings,
        unit: Option<WrongUnit>,
        sample: Stamped,
        expected: Option<f32>,
    ) -> Result<(), Refusal> {
        let Some(unit) = unit else {
            return Ok(());
        };
        let value = sample.value;
        if let Some(barred) = self.barred {
            let confirmed = expected
                .is_some_and(|expected| (value - expected).abs() <= UNIT_RELEASE * expected.abs());
            // The value is nearer to the right one than to the wrong one.
            let back = if barred.ratio > 1.0 {
                value * value * barred.ratio < barred.value * barred.value
            } else {
                value * value * barred.ratio > barred.value * barred.value
            };
            if !(confirmed || back && value > 0.0) {
                // The barred value follows while the aircraft climbs.
                if value > 0.0 {
                    self.barred = Some(Barred { value, ..barred });
                }
                return Err(Refusal {
                    kind: VhFindingKind::WrongUnit(barred.unit),
                    expected,
                });
            }
            self.barred = None;
        }
        let factor = unit.factor();
        let from_past = self
            .last
            .filter(|last| !reaches(settings, *last, sample))
            .map(|last| last.value);
        let found = [
            (expected, factor),
            (from_past, factor),
            (from_past, 1.0 / factor),
        ]
        .into_iter()
        .find_map(|(right, ratio)| {
            right
                .filter(|right| is_times(value, *right, ratio))
                .map(|right| (right, ratio))
        });
        let Some((right, ratio)) = found else {
            return Ok(());
        };
        self.barred = Some(Barred { unit, value, ratio });
        Err(Refusal {
            kind: VhFindingKind::WrongUnit(unit),
            expected: Some(right),
        })
    }

    /// Checks that the source can have reached this value from its last one, or has stayed there
    /// long enough.
    fn check_jump(&mut self, settings: &ChannelSettings, sample: Stamped) -> Result<(), Refusal> {
        let Some(last) = self.last else {
            return Ok(());
        };
        if reaches(settings, last, sample) {
            return Ok(());
        }
        let negated = Stamped {
            value: -sample.value,
            ..sample
        };
        let kind = if last.value.abs() > NOISE_SIGMAS * settings.sigma
            && reaches(settings, last, negated)
        {
            VhFindingKind::WrongSign
        } else {
            VhFindingKind::Jump
        };
        let before = match self.candidate {
            Some((candidate, samples)) if reaches(settings, candidate, sample) => samples,
            _ => 0,
        };
        let samples = before.saturating_add(1);
        self.candidate = Some((sample, samples));
        if kind == VhFindingKind::Jump && samples >= CONSISTENT_SAMPLES {
            return Ok(());
        }
        Err(Refusal {
            kind,
            expected: Some(last.value),
        })
    }
}

/// Returns `true` if a source can have come from one sample to the other.
fn reaches(settings: &ChannelSettings, from: Stamped, to: Stamped) -> bool {
    let elapsed_s = to.time.seconds_since(from.time).max(0.0);
    (to.value - from.value).abs() <= settings.slew_per_s * elapsed_s + NOISE_SIGMAS * settings.sigma
}

/// Returns `true` if a value is about `ratio` times the right one.
pub(super) fn is_times(value: f32, right: f32, ratio: f32) -> bool {
    let expected = ratio * right;
    right > 0.0 && (value - expected).abs() <= UNIT_TOLERANCE * expected
}
