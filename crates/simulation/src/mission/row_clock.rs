//! Row clock of a TDI sensor, which moves the charge with the image.

use fmc_camera_file::{CameraFile, MechanismName};

use crate::scene::stage_path::StagePath;

/// Time that a transfer takes, s; the charge moves on a straight line meanwhile.
const TRANSFER_S: f64 = 1e-8;
/// Largest number of rows of one exposure.
const MOST_ROWS: u32 = 100_000;

/// Row clock of a sensor. It starts with the shutter's opening edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RowClock {
    pitch_mm: f64,
    /// First transfer after opening, row periods.
    first_transfer: f64,
    speed_mm_s: f64,
}

impl RowClock {
    /// Creates the clock of a camera, at rest; `None` for a camera with a stage.
    pub(super) fn of(camera: &CameraFile) -> Option<Self> {
        (camera.fmc.mechanism == MechanismName::Tdi).then(|| Self {
            pitch_mm: camera.sensor.pixel_um / 1000.0,
            first_transfer: camera.fmc.first_transfer,
            speed_mm_s: 0.0,
        })
    }

    /// Takes the speed of the exposures to come, mm/s along the FMC axis.
    pub(super) const fn run_at(&mut self, speed_mm_s: f64) {
        self.speed_mm_s = speed_mm_s;
    }

    /// Returns the path of the charge over an exposure; times from first light.
    pub(super) fn path(&self, exposure_s: f64) -> Option<StagePath> {
        let period_s = self.pitch_mm / self.speed_mm_s.abs();
        let step_mm = self.pitch_mm.copysign(self.speed_mm_s);
        let mut knots = vec![(-TRANSFER_S, 0.0)];
        let times = (0..MOST_ROWS)
            .map(|row| period_s * (self.first_transfer + f64::from(row)))
            .take_while(|time_s| *time_s < exposure_s);
        for (time_s, row) in times.zip(0..) {
            knots.push((time_s, step_mm * f64::from(row)));
            knots.push((time_s + TRANSFER_S, step_mm * f64::from(row + 1)));
        }
        StagePath::new(knots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charge_moves_a_row_per_period_either_way() {
        let mut clock = RowClock {
            pitch_mm: 0.01,
            first_transfer: 0.5,
            speed_mm_s: 0.0,
        };
        let still = clock.path(0.0046).unwrap();
        assert!(still.offset_mm(0.004).abs() < 1e-15);
        for speed_mm_s in [10.0, -10.0] {
            clock.run_at(speed_mm_s);
            let path = clock.path(0.0046).unwrap();
            for (time_s, rows) in [(0.0004, 0.0), (0.0006, 1.0), (0.0034, 3.0), (0.0046, 5.0)] {
                let expected_mm = 0.01_f64.copysign(speed_mm_s) * rows;
                assert!(
                    (path.offset_mm(time_s) - expected_mm).abs() < 1e-12,
                    "{time_s}"
                );
            }
        }
    }
}
