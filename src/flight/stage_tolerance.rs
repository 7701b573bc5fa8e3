//! Tolerances of the stage, by which its readings are judged.

/// Part of a persistent jump that the drive may have made good by the next reading.
pub(crate) const MADE_GOOD: f32 = 0.5;

/// Factor by which a step may be larger while the stage accelerates or is released.
pub(crate) const ACCELERATING: f32 = 4.0;

/// Tolerances of the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StageTolerance {
    /// Largest difference between set point and reading, mm.
    pub(crate) following_mm: f32,
    /// Largest difference between the steps of a reading and of its set point since the last ones,
    /// at constant speed, mm.
    pub(crate) jump_mm: f32,
    /// Distance by which friction and play move a stage off its set point from one reading to the
    /// next, mm.
    pub(crate) slip_mm: f32,
    /// Largest part of a step beyond its set point's that neither the step before nor the next one
    /// shares, mm: more is not motion of a mass.
    pub(crate) isolated_mm: f32,
    /// Largest such part without a doubt, mm: planned acceleration makes it where the set point
    /// begins to move.
    pub(crate) undoubted_mm: f32,
    /// As `isolated_mm`, beyond that where a screw may come to push the stage, mm.
    pub(crate) contact_mm: f32,
    /// Play in which the encoder stands still while the screw moves, mm.
    pub(crate) play_mm: f32,
    /// Following error at which the stage may rest, mm; at twice that it is moved again.
    pub(crate) rest_band_mm: f32,
    /// Step of the encoder, mm.
    pub(crate) step_mm: f32,
}

impl StageTolerance {
    /// Returns the largest number of counts, mm, whose loss in one step may pass as motion of the
    /// stage: the largest step while it accelerates, with what the drive makes good of it until the
    /// next reading.
    pub(crate) fn unseen_mm(&self) -> f32 {
        (1.0 + MADE_GOOD) * (self.slip_mm + ACCELERATING * self.jump_mm)
    }
}
