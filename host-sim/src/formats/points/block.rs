//! Blocks of consecutive points of a file.

use fmc_camera_file::CameraFile;
use fmc_camera_file::number::clipped;

use super::{CoordinateFrame, Source};
use crate::failure::Failure;

/// Number of points that are read, corrected and written together.
///
/// Large enough that the work done once per block costs nothing, small enough that a block stays in
/// a cache.
pub(super) const POINTS: usize = 16_384;

/// Consecutive points of a file, read in blocks so that memory does not grow with the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    /// Places in the sensor frame, mm, in the order of the file; none as long as they are in
    /// `rows`.
    pub points_mm: Vec<[f64; 2]>,
    /// Rows of an array in single precision, as it holds them.
    pub(crate) rows: Vec<[[u8; 4]; 2]>,
    /// Number of points of the file before the block.
    pub before: u64,
    /// Number of bytes of the file up to the end of this block; of an array, without its header.
    pub read_bytes: u64,
    /// Names, one behind the other, as written, in UTF-8; empty for an array.
    names: Vec<u8>,
    /// End of each name.
    name_ends: Vec<usize>,
    /// Line of each point; empty for an array.
    lines: Vec<u64>,
}

impl Block {
    /// Empties the block, to begin behind `before` points.
    pub(super) fn restart(&mut self, before: u64) {
        self.points_mm.clear();
        self.before = before;
        self.names.clear();
        self.name_ends.clear();
        self.lines.clear();
    }

    /// Gives the block a number of rows, whose content is any.
    pub(super) fn resize_rows(&mut self, rows: usize) {
        self.rows.resize(rows, [[0; 4]; 2]);
    }

    /// Returns `true` without points.
    pub(super) const fn is_empty(&self) -> bool {
        self.points_mm.is_empty() && self.rows.is_empty()
    }

    /// Converts the rows of an array into places.
    pub(crate) fn widen(&mut self) {
        let double = |number| f64::from(f32::from_le_bytes(number));
        let rows = self.rows.drain(..).map(|row| row.map(double));
        self.points_mm.extend(rows);
    }

    /// Returns the number of points for which there is room.
    pub(super) const fn room(&self) -> usize {
        POINTS.saturating_sub(self.points_mm.len())
    }

    /// Adds a point, whose line [`Self::number_lines`] tells.
    pub(super) fn push(&mut self, name: &[u8], point_mm: [f64; 2]) {
        self.points_mm.push(point_mm);
        self.names.extend_from_slice(name);
        self.name_ends.push(self.names.len());
    }

    /// Adds the points of another block.
    pub(super) fn append(&mut self, behind: &Self) {
        let names = self.names.len();
        self.points_mm.extend_from_slice(&behind.points_mm);
        self.names.extend_from_slice(&behind.names);
        let ends = behind.name_ends.iter().map(|end| names + end);
        self.name_ends.extend(ends);
    }

    /// Gives the points without a line the lines from `line` on.
    pub(super) fn number_lines(&mut self, line: u64) {
        let count = self.points_mm.len() - self.lines.len();
        self.lines.extend((line..).take(count));
    }

    /// Returns the names, in order; none for an array.
    pub(super) fn names(&self) -> impl Iterator<Item = &[u8]> {
        let mut from = 0;
        self.name_ends.iter().map(move |end| {
            let name = self.names.get(from..*end).unwrap_or_default();
            from = *end;
            name
        })
    }

    /// Place of a point in the file, for messages.
    #[must_use]
    pub fn place(&self, source: &Source, index: usize) -> String {
        let file = &source.file;
        match (self.lines.get(index), self.names().nth(index)) {
            (Some(line), Some(name)) => {
                let name = String::from_utf8_lossy(name);
                format!("{file}, line {line}: point {}", clipped(&name))
            }
            _ => format!("{file}, row {}", self.before + index as u64),
        }
    }

    /// Checks that every point lies on the sensor, edges included.
    ///
    /// # Errors
    /// [`Failure`] naming the first point off the sensor, and the sensor's extent.
    pub fn check_on_sensor(&mut self, source: &Source, camera: &CameraFile) -> Result<(), Failure> {
        let [half_width, half_height] = half_format_mm(camera);
        if !self.rows.is_empty() {
            let [x, y] = farthest(&self.rows).map(f64::from);
            if x <= half_width && y <= half_height {
                return Ok(());
            }
            self.widen();
        }
        let off = |[x, y]: &[f64; 2]| !(x.abs() <= half_width && y.abs() <= half_height);
        match self.points_mm.iter().position(off) {
            None => Ok(()),
            Some(index) => {
                let point_mm = self.points_mm.get(index).copied().unwrap_or_default();
                Err(self.off_sensor(source, index, "the point", point_mm, camera))
            }
        }
    }

    /// Returns the failure of a point whose measured place, `point_mm`, is off the sensor.
    #[must_use]
    pub fn off_sensor(
        &self,
        source: &Source,
        index: usize,
        what: &str,
        point_mm: [f64; 2],
        camera: &CameraFile,
    ) -> Failure {
        Failure::bad_input(format!(
            "{}: {}",
            self.place(source, index),
            off_sensor(source.frame, what, point_mm, camera)
        ))
    }
}

/// Returns the largest |x| and |y| of rows; a NaN where one is not a number.
pub(crate) fn farthest(rows: &[[[u8; 4]; 2]]) -> [f32; 2] {
    /// Rows that are compared side by side.
    const ROWS: usize = 8;
    // Without their signs, numbers are ordered as their bits are, and a NaN is behind all.
    let farther = |farthest: &mut [i32; 2], row: &[[u8; 4]; 2]| {
        for (farthest, number) in farthest.iter_mut().zip(row) {
            *farthest = (i32::from_le_bytes(*number) & i32::MAX).max(*farthest);
        }
    };
    let (blocks, rest) = rows.as_chunks::<ROWS>();
    let mut farthest = [[0; 2]; ROWS];
    for block in blocks {
        for (farthest, row) in farthest.iter_mut().zip(block) {
            farther(farthest, row);
        }
    }
    let mut of_all = [0; 2];
    for bits in &farthest {
        farther(&mut of_all, &bits.map(i32::to_le_bytes));
    }
    for row in rest {
        farther(&mut of_all, row);
    }
    of_all.map(|bits| f32::from_bits(bits.cast_unsigned()))
}

/// Describes a point whose measured place, `point_mm`, is off the sensor.
pub(crate) fn off_sensor(
    frame: CoordinateFrame,
    what: &str,
    point_mm: [f64; 2],
    camera: &CameraFile,
) -> String {
    let [first, second] = frame.columns();
    let [x, y] = camera.half_format_mm();
    let ([a, b], [least, most]) = match frame {
        CoordinateFrame::Sensor => (point_mm, [[-x, -y], [x, y]]),
        CoordinateFrame::Pixel => {
            let [first, last] = [[-x, y], [x, -y]].map(|p| camera.pixel_from_sensor(p));
            (camera.pixel_from_sensor(point_mm), [first, last])
        }
    };
    let [least_a, least_b] = least;
    let [most_a, most_b] = most;
    format!(
        "{what} {first} = {a}, {second} = {b} is off the sensor: \
         {first} {least_a} to {most_a}, {second} {least_b} to {most_b}"
    )
}

/// Half of the format, mm, with room for the rounding of W·p/2: an edge typed in decimals may
/// exceed it by rounding and still belongs to the sensor.
pub(crate) fn half_format_mm(camera: &CameraFile) -> [f64; 2] {
    camera.half_format_mm().map(|half| half * (1.0 + 1e-12))
}
