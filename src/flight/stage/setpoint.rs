//! Place, speed and acceleration of the stage at one instant.

/// Desired position and motion of the stage at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Setpoint {
    /// Offset along the FMC axis from the calibrated position, mm.
    pub offset_mm: f32,
    /// Speed along the FMC axis, mm/s.
    pub speed_mm_s: f32,
    /// Acceleration along the FMC axis, mm/s².
    pub acceleration_mm_s2: f32,
}

impl Setpoint {
    /// Returns `true` if neither speed nor acceleration is asked for.
    pub(crate) fn is_at_rest(&self) -> bool {
        libm::fabsf(self.speed_mm_s) + libm::fabsf(self.acceleration_mm_s2) <= 0.0
    }

    /// Returns `true` if all components are finite.
    pub(super) const fn is_finite(&self) -> bool {
        self.offset_mm.is_finite()
            && self.speed_mm_s.is_finite()
            && self.acceleration_mm_s2.is_finite()
    }
}
