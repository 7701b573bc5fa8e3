//! Answers to a block of points.

use std::borrow::Cow;

use fmc_frames::FrameTable;

use crate::formats::points::Answer;

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

/// Returns the text of a flag, for the point of a frame by its place; empty for an answer.
pub(super) fn flag_text(flag: Flag, frame: u32, table: &FrameTable) -> Cow<'static, str> {
    match flag {
        Flag::None => "".into(),
        Flag::OffSensor => "off sensor".into(),
        Flag::NotConverged => "not converged".into(),
        Flag::Refused => {
            let row = table.rows().get(frame as usize);
            let reason = row.and_then(|row| table.reason_of(row));
            format!("refused: {}", reason.unwrap_or_default()).into()
        }
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
