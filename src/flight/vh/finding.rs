//! Findings of the samples of V/H, and their counts.

use core::fmt;

use super::sample::VhSample;

/// A quantity of one sensor, as one source of V/H.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[expect(missing_docs, reason = "each variant is the sample of the same name")]
pub enum VhChannel {
    Direct,
    GroundSpeed,
    InertialSpeed,
    HeightAboveGround,
    LaserHeight,
    Altitude,
    TerrainHeight,
}

impl VhChannel {
    /// All channels.
    pub const ALL: [Self; 7] = [
        Self::Direct,
        Self::GroundSpeed,
        Self::InertialSpeed,
        Self::HeightAboveGround,
        Self::LaserHeight,
        Self::Altitude,
        Self::TerrainHeight,
    ];

    /// Returns channel and value of a sample.
    #[must_use]
    pub const fn of(sample: VhSample) -> (Self, f32) {
        match sample {
            VhSample::Direct(value) => (Self::Direct, value),
            VhSample::GroundSpeed(value) => (Self::GroundSpeed, value),
            VhSample::InertialSpeed(value) => (Self::InertialSpeed, value),
            VhSample::HeightAboveGround(value) => (Self::HeightAboveGround, value),
            VhSample::LaserHeight(value) => (Self::LaserHeight, value),
            VhSample::Altitude(value) => (Self::Altitude, value),
            VhSample::TerrainHeight(value) => (Self::TerrainHeight, value),
        }
    }

    /// The unit to which its sensors may be set by mistake.
    pub(super) const fn wrong_unit(self) -> Option<WrongUnit> {
        match self {
            Self::Direct => None,
            Self::GroundSpeed | Self::InertialSpeed => Some(WrongUnit::Knots),
            Self::HeightAboveGround | Self::LaserHeight | Self::Altitude | Self::TerrainHeight => {
                Some(WrongUnit::Feet)
            }
        }
    }

    /// The name in documents and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "V/H",
            Self::GroundSpeed => "ground speed",
            Self::InertialSpeed => "inertial speed",
            Self::HeightAboveGround => "height above ground",
            Self::LaserHeight => "laser height",
            Self::Altitude => "altitude",
            Self::TerrainHeight => "terrain height",
        }
    }
}

/// A unit that differs from the agreed one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum WrongUnit {
    /// Feet for metres.
    Feet,
    /// Knots for metres per second.
    Knots,
}

impl WrongUnit {
    /// The number in this unit that equals 1 in the right one.
    #[must_use]
    pub const fn factor(self) -> f32 {
        match self {
            Self::Feet => 1.0 / 0.3048,
            Self::Knots => 3600.0 / 1852.0,
        }
    }
}

/// Kind of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum VhFindingKind {
    /// A NaN or an infinity; not used.
    NotANumber,
    /// Outside the source's range; not used.
    OutOfRange,
    /// The value is right with the other sign; not used.
    WrongSign,
    /// The source has changed its unit, or never had the right one; not used until it has the right
    /// one.
    WrongUnit(WrongUnit),
    /// Farther from the last value than the source can have gone; not used until it has stayed
    /// there.
    Jump,
    /// The same value for too long; not used until it changes.
    Frozen,
    /// Older than the last sample of its source; not used.
    FromThePast,
    /// Two ways to the same number differ; used, and σ covers the difference.
    Disagreement,
    /// The source is used again, or two ways agree again.
    Recovered,
}

impl VhFindingKind {
    /// All kinds; units are counted together.
    pub const ALL: [Self; 9] = [
        Self::NotANumber,
        Self::OutOfRange,
        Self::WrongSign,
        Self::WrongUnit(WrongUnit::Feet),
        Self::Jump,
        Self::Frozen,
        Self::FromThePast,
        Self::Disagreement,
        Self::Recovered,
    ];

    /// The name in documents and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotANumber => "not a number",
            Self::OutOfRange => "out of range",
            Self::WrongSign => "wrong sign",
            Self::WrongUnit(WrongUnit::Feet) => "feet for metres",
            Self::WrongUnit(WrongUnit::Knots) => "knots for metres per second",
            Self::Jump => "jump",
            Self::Frozen => "frozen",
            Self::FromThePast => "from the past",
            Self::Disagreement => "disagreement",
            Self::Recovered => "recovered",
        }
    }
}

/// A finding of a sample about its source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VhFinding {
    /// Channel of the sample.
    pub channel: VhChannel,
    /// Kind of the finding.
    pub kind: VhFindingKind,
    /// The value, in the source's unit; for a disagreement the V/H or speed in use.
    pub value: f32,
    /// The value it was compared with: the last good value, the end of the range, the other way to
    /// the same number.
    pub expected: Option<f32>,
}

impl fmt::Display for VhFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (channel, kind) = (self.channel.name(), self.kind.name());
        write!(f, "{channel} = {}: {kind}", self.value)?;
        match self.expected {
            Some(expected) => write!(f, ", compared with {expected}"),
            None => Ok(()),
        }
    }
}

/// Counts of the findings by kind; a count that is full stays so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[expect(
    missing_docs,
    reason = "each field counts the finding of the same name"
)]
pub struct VhCounters {
    pub not_a_number: u32,
    pub out_of_range: u32,
    pub wrong_sign: u32,
    pub wrong_unit: u32,
    pub jump: u32,
    pub frozen: u32,
    pub from_the_past: u32,
    pub disagreement: u32,
    pub recovered: u32,
}

impl VhCounters {
    /// Count of a kind of finding.
    #[must_use]
    pub const fn of(&self, kind: VhFindingKind) -> u32 {
        match kind {
            VhFindingKind::NotANumber => self.not_a_number,
            VhFindingKind::OutOfRange => self.out_of_range,
            VhFindingKind::WrongSign => self.wrong_sign,
            VhFindingKind::WrongUnit(_) => self.wrong_unit,
            VhFindingKind::Jump => self.jump,
            VhFindingKind::Frozen => self.frozen,
            VhFindingKind::FromThePast => self.from_the_past,
            VhFindingKind::Disagreement => self.disagreement,
            VhFindingKind::Recovered => self.recovered,
        }
    }

    pub(super) const fn count(&mut self, kind: VhFindingKind) {
        let counter = match kind {
            VhFindingKind::NotANumber => &mut self.not_a_number,
            VhFindingKind::OutOfRange => &mut self.out_of_range,
            VhFindingKind::WrongSign => &mut self.wrong_sign,
            VhFindingKind::WrongUnit(_) => &mut self.wrong_unit,
            VhFindingKind::Jump => &mut self.jump,
            VhFindingKind::Frozen => &mut self.frozen,
            VhFindingKind::FromThePast => &mut self.from_the_past,
            VhFindingKind::Disagreement => &mut self.disagreement,
            VhFindingKind::Recovered => &mut self.recovered,
        };
        *counter = counter.saturating_add(1);
    }
}
