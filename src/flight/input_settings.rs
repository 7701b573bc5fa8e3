//! Settings of the lines that lead into a board: their filters, and the levels that count.

use crate::geometry::range::{OutOfRange, Quantity};

/// Edge of a line that is stamped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Edge {
    /// From low to high; the line idles low.
    #[default]
    Rising,
    /// From high to low; the line idles high.
    Falling,
}

/// Level of a limit switch's line at the end of the travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LimitLevel {
    /// High: a switch to ground that opens there. A broken wire also counts as an end.
    #[default]
    High,
    /// Low: a switch to ground that closes there. A broken wire is not seen.
    Low,
}

/// Input that takes the force off the stage without any software.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BrakeInput {
    /// Nothing is connected.
    #[default]
    Unused,
    /// High, or a broken wire, takes the force off.
    High,
    /// Low, or a broken wire, takes the force off.
    Low,
}

/// Settings of the lines that lead into a board. A test rig has no such lines and ignores them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InputSettings {
    /// Shortest pulse of trigger, time pulse, shutter, index mark and brake that must count, ns.
    /// The board takes the longest filter that lets it pass.
    pub shortest_pulse_ns: f32,
    /// Shortest time between two edges of an encoder's track, ns; as above.
    pub shortest_track_ns: f32,
    /// Edge of the trigger.
    pub trigger: Edge,
    /// Edge of the time pulse that begins the second.
    pub time_pulse: Edge,
    /// Edge of first light.
    pub shutter_opened: Edge,
    /// Edge of last light.
    pub shutter_closed: Edge,
    /// Edge of the index mark at which the count is latched.
    pub index: Edge,
    /// Level of both limit switches at the end of the travel.
    pub limit_switch: LimitLevel,
    /// The brake.
    pub brake: BrakeInput,
    /// Speed of the satellite receiver's wire, bits/s.
    pub receiver_baud: f32,
    /// Speed of the autopilot's wire, bits/s.
    pub autopilot_baud: f32,
}

impl Default for InputSettings {
    fn default() -> Self {
        Self {
            shortest_pulse_ns: 40.0,
            shortest_track_ns: 40.0,
            trigger: Edge::Rising,
            time_pulse: Edge::Rising,
            shutter_opened: Edge::Rising,
            shutter_closed: Edge::Rising,
            index: Edge::Rising,
            limit_switch: LimitLevel::High,
            brake: BrakeInput::Unused,
            receiver_baud: 38_400.0,
            autopilot_baud: 57_600.0,
        }
    }
}

impl InputSettings {
    /// Returns the settings, if each is in its range.
    ///
    /// # Errors
    /// [`OutOfRange`] naming the field.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        Quantity::ShortestPulseNs.check(self.shortest_pulse_ns)?;
        Quantity::ShortestTrackNs.check(self.shortest_track_ns)?;
        Quantity::ReceiverBaud.check(self.receiver_baud)?;
        Quantity::AutopilotBaud.check(self.autopilot_baud)?;
        Ok(self)
    }
}
