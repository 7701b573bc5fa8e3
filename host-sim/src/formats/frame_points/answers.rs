//! Answers to a block of points.

use std::borrow::Cow;

use fmc_camera_file::CameraFile;
use fmc_frames::FrameTable;

use super::block::FrameBlock;
use crate::formats::points::{Answer, CoordinateFrame};

/// Reason why a point has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flag {
    /// It has an answer.
    None,
    /// The point, or the measured point of an ideal one, is off the sensor.
    OffSensor,
    /// The iteration to the measured point does not converge.
    NotConverged,
    /// The trigger was refused.
    Refused,
}

impl Flag {
    /// The number in an array.
    #[must_use]
    pub const fn number(self) -> u8 {
        self as u8
    }
}

/// Columns that answers add to those of the points, and rows that they leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutColumns {
    /// σ of the coordinates.
    pub sigma: bool,
    /// The reason why a point has no answer.
    pub flag: bool,
    /// Points without an answer are left out.
    pub skip: bool,
}

/// Names of the distortion's columns.
pub(super) const DISTORTION: [&str; 2] = ["dx_um", "dy_um"];
/// Names of the columns of σ.
pub(super) const SIGMA: [&str; 2] = ["sigma_x_um", "sigma_y_um"];
/// Name of the column of flags.
pub(super) const FLAG: &str = "flag";

impl OutColumns {
    /// Returns the names of the added columns of numbers, in order.
    pub(super) fn numbers(self) -> impl Iterator<Item = &'static str> {
        DISTORTION
            .into_iter()
            .chain(SIGMA.into_iter().filter(move |_| self.sigma))
    }
}

/// The answers to the points of a block, in their order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameAnswers {
    /// Coordinates and distortion; without meaning where there is a flag.
    pub answers: Vec<Answer>,
    /// σ of the coordinates, mm; empty if none are asked for.
    pub sigma_mm: Vec<[f64; 2]>,
    /// Reason of each point why it has no answer.
    pub flags: Vec<Flag>,
}

impl FrameAnswers {
    /// Empties the answers.
    pub fn clear(&mut self) {
        self.answers.clear();
        self.sigma_mm.clear();
        self.flags.clear();
    }

    /// Returns the added numbers of a point: dx, dy, and σ where it is asked for, µm.
    pub(super) fn numbers(&self, index: usize) -> impl Iterator<Item = f64> {
        let answer = self.answers.get(index);
        let distortion = answer.map_or([f64::NAN; 2], |answer| answer.distortion_mm);
        let sigma = self.sigma_mm.get(index).into_iter().flatten();
        distortion
            .into_iter()
            .chain(sigma.copied())
            .map(|value| 1000.0 * value + 0.0)
    }
}

/// A block of points with its answers, as the writers of all formats take it.
#[derive(Debug, Clone, Copy)]
pub struct AnsweredBlock<'a> {
    /// The points, with their frames.
    pub block: &'a FrameBlock,
    /// Their answers.
    pub answers: &'a FrameAnswers,
    /// The frames.
    pub table: &'a FrameTable,
    /// The camera.
    pub camera: &'a CameraFile,
}

impl AnsweredBlock<'_> {
    /// Returns `true` if a point has an answer.
    fn is_answered(&self, index: usize) -> bool {
        self.answers.flags.get(index) == Some(&Flag::None)
    }

    /// Returns the coordinates of a point's answer in a frame; `None` without an answer.
    pub(super) fn point(&self, index: usize, frame: CoordinateFrame) -> Option<[f64; 2]> {
        let answer = self.answers.answers.get(index)?;
        self.is_answered(index).then(|| match frame {
            CoordinateFrame::Sensor => answer.point_mm,
            CoordinateFrame::Pixel => self.camera.pixel_from_sensor(answer.point_mm),
        })
    }

    /// Returns one of the added numbers of a point; `None` without an answer.
    pub(super) fn number(&self, index: usize, which: usize) -> Option<f64> {
        let number = self.answers.numbers(index).nth(which);
        number.filter(|_| self.is_answered(index))
    }

    /// Returns the text of a point's flag; empty for an answer.
    pub(super) fn flag_text(&self, index: usize) -> Cow<'static, str> {
        match self.answers.flags.get(index) {
            None | Some(Flag::None) => "".into(),
            Some(Flag::OffSensor) => "off sensor".into(),
            Some(Flag::NotConverged) => "not converged".into(),
            Some(Flag::Refused) => {
                let place = self.block.frames.get(index).map(|place| *place as usize);
                let row = place.and_then(|place| self.table.rows().get(place));
                let reason = row.and_then(|row| self.table.reason_of(row));
                format!("refused: {}", reason.unwrap_or_default()).into()
            }
        }
    }
}
