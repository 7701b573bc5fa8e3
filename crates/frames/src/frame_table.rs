//! The frames of a flight in memory, to be found by their numbers and names.

use std::collections::HashMap;

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::moments::CentralMoments;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera::geometry::principal_point::PrincipalPointMotion;
use fmc_camera_file::InputError;
use serde::{Deserialize, Serialize};

use crate::frame::{correction, gridded};
use crate::{FlightFrame, Outcome};

/// The numbers of a frame on which image coordinates depend: [`FrameRow::BYTES`] in memory, so
/// that a flight of a million exposures fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrameRow {
    /// Number of the trigger.
    pub sequence: u32,
    outcome: RowOutcome,
    /// Motion of the principal point; zero for a refused trigger.
    pub motion: PrincipalPointMotion,
    /// Δz, mm.
    pub focus_shift_mm: f32,
    /// κ: relative enlargement of the image.
    pub enlargement: f32,
    sigma: PrincipalPointSigma,
    centroid_us: u64,
    centroid_unix_us: u64,
    utc_sigma_s: f32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum RowOutcome {
    Exposed(CorrectionModel, FocusSign),
    /// Place of the reason in the list of all reasons.
    Refused(u16),
}

/// Stands for the motion of a refused trigger.
const NO_MOTION: PrincipalPointMotion = PrincipalPointMotion {
    opening_offset_mm: 0.0,
    travel_mm: 0.0,
    centroid_time_s: 0.0,
    centroid_mm: 0.0,
    moments: CentralMoments {
        second: 0.0,
        third: 0.0,
        fourth: 0.0,
    },
};

/// Stands for a time that is not known.
const NO_TIME: u64 = u64::MAX;

impl FrameRow {
    /// Size in memory, bytes.
    pub const BYTES: usize = size_of::<Self>();

    /// Returns the correction of the frame's points; `None` for a refused trigger.
    #[must_use]
    pub fn correction(&self, calibration: &Calibration) -> Option<FrameCorrection> {
        match self.outcome {
            RowOutcome::Exposed(model, sign) => {
                correction(calibration, &self.motion, model, self.focus_shift_mm, sign)
            }
            RowOutcome::Refused(_) => None,
        }
    }

    /// Returns the correction of the frame's points with the residual grids of the camera; `None`
    /// as in [`Self::correction`].
    #[must_use]
    pub fn gridded<'a>(
        &self,
        calibration: &Calibration,
        grids: &CameraGrids<'a>,
    ) -> Option<GriddedCorrection<'a>> {
        self.with_grids(self.correction(calibration)?, grids)
    }

    /// Returns the correction of [`Self::correction`] with the residual grids of the camera; `None`
    /// as there.
    pub(crate) fn with_grids<'a>(
        &self,
        correction: FrameCorrection,
        grids: &CameraGrids<'a>,
    ) -> Option<GriddedCorrection<'a>> {
        Some(gridded(
            correction,
            grids,
            self.model()?,
            &self.motion,
            self.enlargement,
        ))
    }

    /// Returns `true` if the trigger was refused.
    #[must_use]
    pub const fn is_refused(&self) -> bool {
        matches!(self.outcome, RowOutcome::Refused(_))
    }

    /// Model of the correction; `None` for a refused trigger.
    #[must_use]
    pub const fn model(&self) -> Option<CorrectionModel> {
        match self.outcome {
            RowOutcome::Exposed(model, _) => Some(model),
            RowOutcome::Refused(_) => None,
        }
    }

    /// Formula that turned the focus shift into the enlargement.
    #[must_use]
    pub const fn focus_sign(&self) -> FocusSign {
        match self.outcome {
            RowOutcome::Exposed(_, sign) => sign,
            RowOutcome::Refused(_) => FocusSign::Physical,
        }
    }

    /// σ of the principal point along the FMC axis, if one is stated.
    #[must_use]
    pub fn sigma(&self) -> Option<PrincipalPointSigma> {
        (!self.sigma.frame_mm.is_nan()).then_some(self.sigma)
    }

    /// Centroid of the exposure, camera time.
    #[must_use]
    pub fn centroid(&self) -> Option<Time> {
        (self.centroid_us != NO_TIME).then(|| Time::from_us(self.centroid_us))
    }

    /// Centroid of the exposure in UTC.
    #[must_use]
    pub fn centroid_utc(&self) -> Option<UtcTime> {
        (self.centroid_unix_us != NO_TIME).then_some(UtcTime {
            unix_us: self.centroid_unix_us,
            sigma_s: self.utc_sigma_s,
        })
    }
}

/// The frames of a flight.
///
/// It can be serialised, to be sent to another process of the same version.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct FrameTable {
    /// In ascending order of their numbers.
    rows: Vec<FrameRow>,
    /// The different reasons of refused triggers.
    reasons: Vec<String>,
    /// Sequence number of each image.
    images: HashMap<Box<str>, u32>,
}

impl FrameTable {
    /// Collects frames, as `read` hands them to the closure it is given.
    ///
    /// # Errors
    /// Those of `read`, and [`InputError`] for an image that is that of two frames.
    pub fn collect(
        read: impl FnOnce(
            &mut dyn FnMut(FlightFrame) -> Result<(), InputError>,
        ) -> Result<(), InputError>,
    ) -> Result<Self, InputError> {
        let mut table = Self::default();
        read(&mut |frame| table.push(frame))?;
        table.rows.sort_unstable_by_key(|row| row.sequence);
        table.rows.shrink_to_fit();
        Ok(table)
    }

    fn push(&mut self, mut frame: FlightFrame) -> Result<(), InputError> {
        let sequence = frame.sequence;
        if let Some(image) = frame.image.take()
            && let Some(other) = self.images.insert(image.clone().into(), sequence)
        {
            return Err(InputError::invalid(format!(
                "image {image} is that of the frames {other} and {sequence}"
            )));
        }
        let row = self.row(frame);
        self.rows.push(row);
        Ok(())
    }

    fn row(&mut self, frame: FlightFrame) -> FrameRow {
        let none = PrincipalPointSigma {
            frame_mm: f32::NAN,
            common_mm: f32::NAN,
        };
        let sequence = frame.sequence;
        match frame.outcome {
            Outcome::Exposed(exposed) => FrameRow {
                sequence,
                outcome: RowOutcome::Exposed(exposed.interior.model, exposed.focus_sign),
                motion: exposed.interior.motion,
                focus_shift_mm: exposed.interior.focus_shift_mm,
                enlargement: exposed.interior.enlargement,
                sigma: exposed.sigma.unwrap_or(none),
                centroid_us: exposed.centroid.map_or(NO_TIME, Time::us),
                centroid_unix_us: exposed.centroid_utc.map_or(NO_TIME, |utc| utc.unix_us),
                utc_sigma_s: exposed.centroid_utc.map_or(0.0, |utc| utc.sigma_s),
            },
            Outcome::Refused(reason) => FrameRow {
                sequence,
                outcome: RowOutcome::Refused(self.reason(reason)),
                motion: NO_MOTION,
                focus_shift_mm: 0.0,
                enlargement: 0.0,
                sigma: none,
                centroid_us: NO_TIME,
                centroid_unix_us: NO_TIME,
                utc_sigma_s: 0.0,
            },
        }
    }

    /// Returns the place of a reason; a camera has a few dozen, and what is beyond 65,535 is told
    /// as the last.
    fn reason(&mut self, reason: String) -> u16 {
        let place = self.reasons.iter().position(|one| *one == reason);
        let place = place.unwrap_or_else(|| {
            if u16::try_from(self.reasons.len()).is_ok() {
                self.reasons.push(reason);
            }
            self.reasons.len() - 1
        });
        u16::try_from(place).unwrap_or(u16::MAX)
    }

    /// All frames, in ascending order of their numbers.
    #[must_use]
    pub fn rows(&self) -> &[FrameRow] {
        &self.rows
    }

    /// Returns the place of a frame among [`Self::rows`] by its sequence number.
    #[must_use]
    pub fn find(&self, sequence: u32) -> Option<usize> {
        // Records have no gaps, so that the place follows from the number.
        let first = self.rows.first()?.sequence;
        let guess = usize::try_from(sequence.checked_sub(first)?).ok()?;
        match self.rows.get(guess) {
            Some(row) if row.sequence == sequence => Some(guess),
            _ => self
                .rows
                .binary_search_by_key(&sequence, |row| row.sequence)
                .ok(),
        }
    }

    /// Returns the place of a frame by the name of its image.
    #[must_use]
    pub fn find_image(&self, image: &str) -> Option<usize> {
        self.find(*self.images.get(image)?)
    }

    /// Returns the images with the sequence numbers of their frames, in no order.
    pub fn images(&self) -> impl Iterator<Item = (&str, u32)> {
        self.images
            .iter()
            .map(|(image, sequence)| (&**image, *sequence))
    }

    /// Returns `true` if a frame has an image.
    #[must_use]
    pub fn has_images(&self) -> bool {
        !self.images.is_empty()
    }

    /// Returns the reason for which a trigger was refused; `None` if it was not.
    #[must_use]
    pub fn reason_of(&self, row: &FrameRow) -> Option<&str> {
        match row.outcome {
            RowOutcome::Exposed(..) => None,
            RowOutcome::Refused(place) => self.reasons.get(usize::from(place)).map(String::as_str),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(sequence: u32, image: Option<&str>) -> FlightFrame {
        FlightFrame {
            sequence,
            image: image.map(str::to_owned),
            trigger: None,
            outcome: Outcome::Refused(
                if sequence.is_multiple_of(2) {
                    "stall"
                } else {
                    "overlap"
                }
                .to_owned(),
            ),
            faults: String::new(),
            flags: String::new(),
            calibration_crc: None,
        }
    }

    #[test]
    fn frames_are_found_in_flights_with_and_without_gaps() {
        let mut sequences: Vec<u32> = (1000..1100).chain([5, 2000, u32::MAX]).collect();
        for _ in 0..2 {
            let table = FrameTable::collect(|each| {
                sequences.iter().try_for_each(|sequence| {
                    let image = format!("image {sequence}");
                    each(frame(*sequence, Some(&image)))
                })
            });
            let table = table.unwrap();
            assert_eq!(table.rows().len(), sequences.len());
            for sequence in &sequences {
                let row = &table.rows()[table.find(*sequence).unwrap()];
                assert_eq!(row.sequence, *sequence);
                assert_eq!(
                    table.find_image(&format!("image {sequence}")),
                    table.find(*sequence)
                );
                let reason = if sequence.is_multiple_of(2) {
                    "stall"
                } else {
                    "overlap"
                };
                assert_eq!(table.reason_of(row), Some(reason));
            }
            for missing in [0, 4, 6, 999, 1100, 1999, u32::MAX - 1] {
                assert_eq!(table.find(missing), None);
            }
            sequences.reverse();
        }
    }

    #[test]
    fn image_of_two_frames_is_refused() {
        let error = FrameTable::collect(|each| {
            each(frame(1, Some("a")))?;
            each(frame(2, None))?;
            each(frame(3, Some("a")))
        });
        let error = error.unwrap_err().to_string();
        assert_eq!(error, "image a is that of the frames 1 and 3");
    }

    /// `docs/formats.md` quotes the size.
    #[test]
    fn row_of_a_million_exposures_is_small() {
        assert_eq!(FrameRow::BYTES, 72);
    }
}
