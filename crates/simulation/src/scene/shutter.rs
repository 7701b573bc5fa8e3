//! Shutter: exposure time and transmission.

use fmc_camera_file::{CameraFile, Profile};

/// Transmission over the exposure: linear ramps at both ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shutter {
    /// t, the base: first light to last, s.
    pub exposure_s: f64,
    /// r₁: opening ramp as a fraction of the base.
    pub opening_fraction: f64,
    /// r₂: closing ramp as a fraction of the base.
    pub closing_fraction: f64,
}

impl Shutter {
    /// Creates a shutter that opens and closes at once.
    #[must_use]
    pub const fn uniform(exposure_s: f64) -> Self {
        Self {
            exposure_s,
            opening_fraction: 0.0,
            closing_fraction: 0.0,
        }
    }

    /// Returns the shutter of a camera file.
    #[must_use]
    pub const fn of(camera: &CameraFile, exposure_s: f64) -> Self {
        match camera.shutter.profile {
            Profile::Uniform => Self::uniform(exposure_s),
            Profile::Trapezoid => Self {
                exposure_s,
                opening_fraction: camera.shutter.opening_fraction,
                closing_fraction: camera.shutter.closing_fraction,
            },
        }
    }

    /// Returns the transmission at a time after first light, s: 0 to 1.
    #[must_use]
    pub fn transmission(&self, after_opening_s: f64) -> f64 {
        let [start, open, closing, end] = self.edges_s();
        if after_opening_s < start || after_opening_s > end {
            0.0
        } else if after_opening_s < open {
            after_opening_s / open
        } else if after_opening_s > closing {
            (end - after_opening_s) / (end - closing)
        } else {
            1.0
        }
    }

    /// Returns the times after first light between which the transmission is linear, s.
    #[must_use]
    pub fn edges_s(&self) -> [f64; 4] {
        let base = self.exposure_s;
        [
            0.0,
            base * self.opening_fraction,
            base * (1.0 - self.closing_fraction),
            base,
        ]
    }
}
