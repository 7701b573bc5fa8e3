//! Mechanism: the stage that carries the detector, with its faults, or the rows of a TDI sensor.

use fmc_camera::geometry::principal_point::StageSample;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, MechanismName};
use fmc_reference::exposure::{ExposurePath, ExposureRequest};

use super::stage_path::StagePath;

/// Largest number of transfers or readings of one exposure.
const MOST_EVENTS: u32 = 100_000;

/// True motion of the principal point over the detector, along the FMC axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Δδ: offset at first light, mm.
    pub opening_offset_mm: f64,
    /// Commanded speed, mm/s; negative against the FMC axis.
    pub speed_mm_s: f64,
    /// Excess of the true speed over the commanded one, per cent.
    pub speed_error_percent: f64,
    /// Rows of a TDI sensor, whose charge moves in place of a stage.
    pub rows: Option<Rows>,
    /// Recorded path, in place of a constant speed.
    pub path: Option<StagePath>,
    /// Run-out: distance of the detector from its plane, positive away from the lens, µm, a
    /// polynomial of the offset in mm, lowest power first.
    pub flatness_um: Vec<f64>,
    /// Δz beyond the run-out, µm.
    pub focus_shift_um: f64,
    /// Encoder of the stage.
    pub encoder: Encoder,
}

/// The rows of a TDI sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rows {
    /// Pitch, mm.
    pub pitch_mm: f64,
    /// First transfer after opening, row periods.
    pub first_transfer: f64,
}

/// An encoder that counts steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    /// Step, µm; 0 counts as exact.
    pub step_um: f64,
    /// Position of a step's middle, µm.
    pub phase_um: f64,
    /// Rate of the readings, Hz.
    pub rate_hz: f64,
}

impl Encoder {
    /// An exact encoder with a thousand readings per second.
    pub const EXACT: Self = Self {
        step_um: 0.0,
        phase_um: 0.0,
        rate_hz: 1000.0,
    };

    /// Returns the reading at an offset, mm: the nearest step.
    #[must_use]
    pub fn reading_mm(&self, offset_mm: f64) -> f64 {
        if self.step_um <= 0.0 {
            return offset_mm;
        }
        let (step, phase) = (self.step_um / 1000.0, self.phase_um / 1000.0);
        ((offset_mm - phase) / step).round() * step + phase
    }
}

impl Stage {
    /// Returns the mechanism of a camera file, as planned for an exposure.
    #[must_use]
    pub fn planned(camera: &CameraFile, request: &ExposureRequest) -> Self {
        Self {
            opening_offset_mm: ExposurePath::new(camera, request).opening_offset_mm,
            speed_mm_s: camera.principal_distance_mm * request.signed_vh_per_s(),
            speed_error_percent: 0.0,
            rows: match camera.fmc.mechanism {
                MechanismName::Stage => None,
                MechanismName::Tdi => Some(Rows {
                    pitch_mm: camera.sensor.pixel_um / 1000.0,
                    first_transfer: camera.fmc.first_transfer,
                }),
            },
            path: None,
            flatness_um: camera.fmc.flatness_um.clone(),
            focus_shift_um: 1000.0 * request.focus_shift_mm,
            encoder: Encoder::EXACT,
        }
    }

    /// Returns the true speed, mm/s.
    #[must_use]
    pub fn true_speed_mm_s(&self) -> f64 {
        self.speed_mm_s * (1.0 + self.speed_error_percent / 100.0)
    }

    /// Returns the offset of the principal point at a time after first light, mm.
    #[must_use]
    pub fn offset_mm(&self, after_opening_s: f64) -> f64 {
        if let Some(path) = &self.path {
            return path.offset_mm(after_opening_s);
        }
        let travel_mm = self.true_speed_mm_s() * after_opening_s;
        match self.rows {
            None => self.opening_offset_mm + travel_mm,
            Some(rows) => {
                let periods = travel_mm.abs() / rows.pitch_mm;
                let transfers = ((periods - rows.first_transfer).floor() + 1.0).max(0.0);
                self.opening_offset_mm + rows.pitch_mm.copysign(travel_mm) * transfers
            }
        }
    }

    /// Returns the times after first light at which charge is transferred, before `exposure_s`.
    #[must_use]
    pub fn transfers_s(&self, exposure_s: f64) -> Vec<f64> {
        let Some(rows) = self.rows else {
            return Vec::new();
        };
        let period_s = rows.pitch_mm / self.true_speed_mm_s().abs();
        let first = rows.first_transfer * period_s;
        if !(period_s > 0.0 && period_s.is_finite()) {
            return Vec::new();
        }
        (0..MOST_EVENTS)
            .map(|row| first + period_s * f64::from(row))
            .take_while(|time| *time < exposure_s)
            .collect()
    }

    /// Returns the times after first light, before `exposure_s`, between which the motion is
    /// smooth.
    #[must_use]
    pub fn breaks_s(&self, exposure_s: f64) -> Vec<f64> {
        match &self.path {
            None => self.transfers_s(exposure_s),
            Some(path) => path
                .times_s()
                .filter(|time| (0.0..exposure_s).contains(time))
                .collect(),
        }
    }

    /// Returns Δz at a time after first light, mm.
    #[must_use]
    pub fn focus_shift_mm(&self, after_opening_s: f64) -> f64 {
        let offset = self.offset_mm(after_opening_s);
        let run_out_um = self
            .flatness_um
            .iter()
            .rev()
            .fold(0.0, |sum, coefficient| sum * offset + coefficient);
        (run_out_um + self.focus_shift_um) / 1000.0
    }

    /// Returns the encoder's readings from one before the exposure to one after it.
    #[must_use]
    pub fn encoder_samples(&self, exposure_s: f64) -> Vec<StageSample> {
        let period_s = 1.0 / self.encoder.rate_hz;
        (0..MOST_EVENTS)
            .map(|reading| (f64::from(reading) - 1.0) * period_s)
            .take_while(|time| *time < exposure_s + period_s)
            .map(|time| StageSample {
                time_s: single(time),
                offset_mm: single(self.encoder.reading_mm(self.offset_mm(time))),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(rows: Option<Rows>) -> Stage {
        Stage {
            opening_offset_mm: 0.1,
            speed_mm_s: 10.0,
            speed_error_percent: 0.0,
            rows,
            path: None,
            flatness_um: vec![1.0, 2.0, -4.0],
            focus_shift_um: 0.5,
            encoder: Encoder::EXACT,
        }
    }

    #[test]
    fn rows_move_by_a_pitch_at_every_transfer() {
        let rows = Rows {
            pitch_mm: 0.01,
            first_transfer: 0.5,
        };
        let tdi = stage(Some(rows));
        // One row per millisecond, the first after half a millisecond.
        for (time_ms, rows) in [(0.0, 0.0), (0.4, 0.0), (0.6, 1.0), (1.6, 2.0), (9.9, 10.0)] {
            let offset = tdi.offset_mm(1e-3 * time_ms);
            assert!((offset - 0.1 - 0.01 * rows).abs() < 1e-12, "{time_ms}");
        }
        assert_eq!(tdi.transfers_s(0.01).len(), 10);
        assert!(stage(None).transfers_s(0.01).is_empty());
    }

    #[test]
    fn run_out_is_the_polynomial_of_the_offset() {
        // s = 0.2 mm: 1 + 0.4 - 0.16 + 0.5 µm.
        assert!((stage(None).focus_shift_mm(0.01) - 1.74e-3).abs() < 1e-12);
    }

    #[test]
    fn encoder_reads_the_nearest_step_and_covers_the_exposure() {
        let encoder = Encoder {
            step_um: 0.5,
            phase_um: 0.1,
            rate_hz: 1000.0,
        };
        assert!((encoder.reading_mm(0.01039) - 0.0106).abs() < 1e-12);
        assert!((encoder.reading_mm(0.01030) - 0.0101).abs() < 1e-12);
        let samples = stage(None).encoder_samples(0.0105);
        assert!(samples[0].time_s < 0.0 && samples[samples.len() - 1].time_s >= 0.0105);
    }
}
