//! How a camera is flown: what its calibration does not say.

use super::drive::pwm_encoder::DriveSettings;
use super::drive::settings::SettingOutOfRange;
use super::exposure::FlightDirection;
use super::stage_watch::StageTolerance;
use super::vh::settings::VhSettings;

/// How a camera is flown.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
pub struct FlightSettings {
    /// Exposure time of the frames to come, s.
    pub exposure_s: f32,
    /// Whether the aircraft flies along the FMC axis or against it.
    pub direction: FlightDirection,
    /// Smear that a frame may have before it is flagged, and the shutter may open at, pixels.
    pub smear_budget_px: f32,
    /// How far the stage's speed may be off when the shutter is told to open, per cent.
    pub speed_tolerance_percent: f32,
    /// How far the stage may be off its set point before something is wrong, µm.
    pub following_tolerance_um: f32,
    /// By how much a step of the encoder's reading may differ from its set point's at constant speed, µm.
    pub jump_tolerance_um: f32,
    /// From command to first light, s.
    pub shutter_latency_s: f32,
    /// How far first light and exposure may be off in time, s.
    pub shutter_tolerance_s: f32,
    /// Shortest time between triggers that is planned, s; 0: not known.
    pub trigger_interval_s: f32,
    /// σ of the satellite receiver's time pulse, s.
    pub time_pulse_sigma_s: f32,
    /// Sources of V/H.
    pub vh: VhSettings,
    /// Motor, encoder and velocity loop.
    pub drive: DriveSettings,
}

impl FlightSettings {
    /// The settings, if each is believable.
    ///
    /// # Errors
    /// [`SettingOutOfRange`] naming the field, its value and its range.
    pub fn checked(self) -> Result<Self, SettingOutOfRange> {
        let ranges = [
            ("exposure_s", self.exposure_s, 1e-6, 10.0),
            ("smear_budget_px", self.smear_budget_px, 0.01, 100.0),
            (
                "speed_tolerance_percent",
                self.speed_tolerance_percent,
                0.01,
                100.0,
            ),
            (
                "following_tolerance_um",
                self.following_tolerance_um,
                0.1,
                10_000.0,
            ),
            ("jump_tolerance_um", self.jump_tolerance_um, 0.01, 10_000.0),
            ("shutter_latency_s", self.shutter_latency_s, 0.0, 1.0),
            ("shutter_tolerance_s", self.shutter_tolerance_s, 1e-5, 0.1),
            ("time_pulse_sigma_s", self.time_pulse_sigma_s, 0.0, 0.01),
            ("trigger_interval_s", self.trigger_interval_s, 0.0, 3600.0),
        ];
        for (field, value, min, max) in ranges {
            super::drive::settings::within(field, value, min, max)?;
        }
        Ok(Self {
            vh: self.vh.checked()?,
            drive: self.drive.checked()?,
            ..self
        })
    }

    pub(super) fn stage_tolerance(&self) -> StageTolerance {
        StageTolerance {
            following_mm: 1e-3 * self.following_tolerance_um,
            jump_mm: 1e-3 * self.jump_tolerance_um,
        }
    }
}

impl Default for FlightSettings {
    /// 1/300 s along the FMC axis, a quarter of a pixel of smear, a shutter that opens 2 ms after its command to
    /// within 1 ms.
    fn default() -> Self {
        Self {
            exposure_s: 1.0 / 300.0,
            direction: FlightDirection::Forward,
            smear_budget_px: 0.25,
            speed_tolerance_percent: 1.0,
            following_tolerance_um: 10.0,
            jump_tolerance_um: 1.0,
            shutter_latency_s: 0.002,
            shutter_tolerance_s: 0.001,
            trigger_interval_s: 0.0,
            time_pulse_sigma_s: 1e-6,
            vh: VhSettings::default(),
            drive: DriveSettings::default(),
        }
    }
}
