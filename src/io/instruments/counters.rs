//! Counts of the bytes, sentences and messages on the wires of the aircraft's instruments.

/// Counts of the satellite receiver's wire since the camera was prepared. A count stops at its
/// largest value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReceiverCounters {
    /// Bytes that have come, those dropped or lost included.
    pub bytes: u32,
    /// Sentences that were read.
    pub read: u32,
    /// Sentences without an end.
    pub truncated: u32,
    /// Sentences that are too long.
    pub oversized: u32,
    /// Sentences with a wrong checksum, or none.
    pub checksum: u32,
    /// Sentences whose fields are not those of their name.
    pub malformed: u32,
    /// Sentences of a receiver without a fix.
    pub no_fix: u32,
    /// Sentences whose fix is simulated or entered by hand.
    pub simulated_fix: u32,
    /// Sentences with a date or time of day that does not exist.
    pub invalid_time: u32,
    /// Sentences with a year before 2000.
    pub before_year_2000: u32,
    /// Sentences with a number outside its range.
    pub out_of_range: u32,
    /// Sentences of another talker than those in use, without a position that shows them to be of
    /// the same receiver: two receivers are on the wire.
    pub other_talker: u32,
    /// Sentences with a position that the receiver in use cannot have, and those that follow them:
    /// two receivers are on the wire.
    pub other_position: u32,
    /// Bytes that belong to no sentence; many of them indicate a wrong baud rate.
    pub unexplained_bytes: u32,
    /// Bytes dropped because more came than the line can carry.
    pub flooded_bytes: u32,
    /// Bytes lost before they could be taken.
    pub lost_bytes: u32,
}

impl ReceiverCounters {
    /// All counts at 0.
    pub const NONE: Self = Self {
        bytes: 0,
        read: 0,
        truncated: 0,
        oversized: 0,
        checksum: 0,
        malformed: 0,
        no_fix: 0,
        simulated_fix: 0,
        invalid_time: 0,
        before_year_2000: 0,
        out_of_range: 0,
        other_talker: 0,
        other_position: 0,
        unexplained_bytes: 0,
        flooded_bytes: 0,
        lost_bytes: 0,
    };

    /// Returns true if two receivers have spoken on the wire.
    #[must_use]
    pub const fn has_two_receivers(&self) -> bool {
        self.other_talker > 0 || self.other_position > 0
    }
}

/// Counts of the autopilot's wire since the camera was prepared. A count stops at its largest
/// value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AutopilotCounters {
    /// Bytes that have come, those dropped or lost included.
    pub bytes: u32,
    /// Number of the system in use.
    pub system: Option<u8>,
    /// Messages that were read.
    pub read: u32,
    /// Messages with a wrong checksum.
    pub checksum: u32,
    /// Messages with a value that does not exist.
    pub malformed: u32,
    /// Messages of an autopilot that does not know position or time.
    pub no_fix: u32,
    /// Messages of a distance sensor that has not measured.
    pub no_distance: u32,
    /// Messages with a number outside its range.
    pub out_of_range: u32,
    /// Messages of another system than the one in use, or of another component of it.
    pub other_system: u32,
    /// Bytes that belong to no message; many of them indicate a wrong baud rate.
    pub unexplained_bytes: u32,
    /// Bytes dropped because more came than the line can carry.
    pub flooded_bytes: u32,
    /// Bytes lost before they could be taken.
    pub lost_bytes: u32,
}

impl AutopilotCounters {
    /// All counts at 0.
    pub const NONE: Self = Self {
        bytes: 0,
        system: None,
        read: 0,
        checksum: 0,
        malformed: 0,
        no_fix: 0,
        no_distance: 0,
        out_of_range: 0,
        other_system: 0,
        unexplained_bytes: 0,
        flooded_bytes: 0,
        lost_bytes: 0,
    };
}

/// Counts of both wires.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InstrumentCounters {
    /// The satellite receiver's.
    pub receiver: ReceiverCounters,
    /// The autopilot's.
    pub autopilot: AutopilotCounters,
    /// Events that found no place among those that wait for the control loop.
    pub crowded_out: u32,
}

/// Adds to a count, which stops at its largest value.
pub(super) const fn count(counter: &mut u32, by: u32) {
    *counter = counter.saturating_add(by);
}
