//! Exposures and refused triggers of a flight, and the cost of one camera for all of them.

use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera_file::InputError;
use fmc_frames::Outcome;

use super::image_camera::ImageCamera;
use super::pose::ImagePose;
use crate::calibrated::Calibrated;
use fmc_frames::time;

/// Cost below which one camera for all frames is advised, px.
pub const ONE_CAMERA_PX: f64 = 0.05;

/// Frames of a flight in the order of their records.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Flight {
    /// Exposures.
    pub frames: Vec<ImageCamera>,
    /// Triggers without an exposure.
    pub refused: Vec<Refused>,
    /// Poses by ascending sequence number, of exposures that the trajectory covers; `None` without
    /// a trajectory.
    pub poses: Option<Vec<(u32, ImagePose)>>,
}

/// A trigger without an exposure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// Sequence number of the trigger.
    pub sequence: u32,
    /// Reason, in words.
    pub reason: Box<str>,
}

/// Cost of the calibrated camera for all frames, in place of a camera per image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneCamera {
    /// Largest |c̄|, mm.
    pub offset_mm: f64,
    /// Sequence number of the frame with the largest |c̄|.
    pub sequence: u32,
    /// Largest |κ|.
    pub enlargement: f64,
    /// Largest displacement of a point of the sensor by κ alone, along one axis, mm.
    pub enlarged_mm: f64,
    /// Sum of both, px: no point of any frame is further off.
    pub cost_px: f64,
}

impl OneCamera {
    /// Returns `true` if one camera is good enough for all frames.
    #[must_use]
    pub fn is_advised(&self) -> bool {
        self.cost_px < ONE_CAMERA_PX
    }
}

impl Flight {
    /// Adds a frame of the records; `exit_pupil_mm` is L of its camera.
    ///
    /// # Errors
    /// [`InputError`] naming the sequence number: a focus shift by the printed formula, which no
    /// camera per image can have, and a time that no calendar has.
    pub fn push(
        &mut self,
        frame: &fmc_frames::FlightFrame,
        exit_pupil_mm: f64,
    ) -> Result<(), InputError> {
        let sequence = frame.sequence;
        let exposed = match &frame.outcome {
            Outcome::Refused(reason) => {
                self.refused.push(Refused {
                    sequence,
                    reason: reason.as_str().into(),
                });
                return Ok(());
            }
            Outcome::Exposed(exposed) => exposed,
        };
        if exposed.focus_sign == FocusSign::Printed {
            return Err(InputError::invalid(format!(
                "sequence {sequence}: its enlargement is that of the printed formula, with which \
                 the image has no principal distance of its own"
            )));
        }
        if let Some(utc) = exposed.centroid_utc
            && time::date(utc.unix_us).is_none()
        {
            return Err(InputError::invalid(format!(
                "sequence {sequence}: centroid_unix_us = {} is beyond the calendar",
                utc.unix_us
            )));
        }
        self.frames
            .push(ImageCamera::of(sequence, exposed, exit_pupil_mm));
        Ok(())
    }

    /// Checks that there is a frame.
    ///
    /// # Errors
    /// [`InputError`] naming the file of the records.
    pub fn check(&self, file: &str) -> Result<(), InputError> {
        if self.frames.is_empty() {
            return Err(InputError::invalid(format!(
                "{file}: no exposure among {} records",
                self.refused.len()
            )));
        }
        Ok(())
    }

    /// Returns the cost of one camera.
    #[must_use]
    pub fn one_camera(&self, camera: &Calibrated) -> OneCamera {
        let largest = self
            .frames
            .iter()
            .max_by(|a, b| {
                let [a, b] = [a, b].map(|frame| frame.centroid_offset_mm.abs());
                a.total_cmp(&b)
            })
            .map_or((0.0, 0), |frame| {
                (f64::from(frame.centroid_offset_mm).abs(), frame.sequence)
            });
        let (offset_mm, sequence) = largest;
        let enlargement = self
            .frames
            .iter()
            .map(|frame| f64::from(frame.enlargement).abs())
            .fold(0.0, f64::max);
        let [x0, y0] = camera.principal_point_mm;
        let [half_width, half_height] = camera.half_format_mm();
        let reach_mm = (half_width + x0.abs()).max(half_height + y0.abs()) + offset_mm;
        let enlarged_mm = enlargement * reach_mm;
        OneCamera {
            offset_mm,
            sequence,
            enlargement,
            enlarged_mm,
            cost_px: (offset_mm + enlarged_mm) / camera.pixel_mm,
        }
    }

    /// Returns the frames that differ most from the calibrated camera: with the least and the
    /// largest c̄ and κ.
    #[must_use]
    pub fn extremes(&self) -> Vec<ImageCamera> {
        let by = |key: fn(&ImageCamera) -> f32| {
            let compare = move |a: &&ImageCamera, b: &&ImageCamera| key(a).total_cmp(&key(b));
            [
                self.frames.iter().min_by(compare),
                self.frames.iter().max_by(compare),
            ]
        };
        let mut frames: Vec<ImageCamera> = [
            by(|frame| frame.centroid_offset_mm),
            by(|frame| frame.enlargement),
        ]
        .into_iter()
        .flatten()
        .flatten()
        .copied()
        .collect();
        frames.sort_by_key(|frame| frame.sequence);
        frames.dedup_by_key(|frame| frame.sequence);
        frames
    }

    /// Returns the number of frames whose time in UTC is not known.
    #[must_use]
    pub fn without_utc(&self) -> usize {
        self.frames
            .iter()
            .filter(|frame| frame.centroid_utc.is_none())
            .count()
    }
}
