//! The frame of a point, by the text or the number in its column.

use std::sync::Arc;

use fmc_camera_file::number::clipped;
use fmc_frames::FrameTable;

/// Column that names the frame of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum KeyColumn {
    Sequence,
    Frame,
    Image,
}

impl KeyColumn {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Sequence => "sequence",
            Self::Frame => "frame",
            Self::Image => "image",
        }
    }

    /// Returns the column of a file, and its place among the names.
    ///
    /// A number goes before a name: `sequence`, then `frame`, then `image`.
    pub(super) fn find<'a>(
        names: impl Iterator<Item = &'a str> + Clone,
        has_images: bool,
    ) -> Result<(Self, usize), String> {
        let place = |column: Self| names.clone().position(|name| name == column.name());
        if let Some(place) = place(Self::Sequence) {
            return Ok((Self::Sequence, place));
        }
        if let Some(place) = place(Self::Frame) {
            return Ok((Self::Frame, place));
        }
        match place(Self::Image) {
            Some(place) if has_images => Ok((Self::Image, place)),
            Some(_) => {
                Err("column image: the frames have no images; --images names them".to_owned())
            }
            None => Err(format!(
                "column sequence, frame or image is missing; found {}",
                clipped(&names.collect::<Vec<_>>().join(",")).escape_debug()
            )),
        }
    }
}

/// Finder of the frames that points name.
#[derive(Debug, Clone)]
pub struct FrameFinder {
    table: Arc<FrameTable>,
    /// Name of the file of frames in messages.
    file: String,
}

impl FrameFinder {
    /// Creates the finder of the frames of a table; `file` is its name in messages.
    #[must_use]
    pub fn new(table: Arc<FrameTable>, file: String) -> Self {
        Self { table, file }
    }

    /// Returns `true` if frames can be found by images.
    pub(super) fn has_images(&self) -> bool {
        self.table.has_images()
    }

    /// Returns the place of the frame that a cell names.
    ///
    /// # Errors
    /// A sentence for the user, without the place in the file.
    pub(super) fn find(&self, column: KeyColumn, cell: &[u8]) -> Result<u32, String> {
        let text = str::from_utf8(cell)
            .map_err(|_| format!("column {} is not text (UTF-8)", column.name()))?;
        let number = text.parse().ok();
        let found = match (column, number) {
            (KeyColumn::Image, _) | (KeyColumn::Frame, None) => self.table.find_image(text),
            (KeyColumn::Sequence | KeyColumn::Frame, Some(number)) => self.table.find(number),
            (KeyColumn::Sequence, None) => {
                return Err(format!(
                    "sequence = \"{}\" is not a whole number from 0 to {}",
                    clipped(text).escape_debug(),
                    u32::MAX
                ));
            }
        };
        self.place(found, column, || clipped(text).escape_debug().to_string())
    }

    /// Returns the place of the frame with a number.
    ///
    /// # Errors
    /// A sentence for the user, without the place in the file.
    pub(super) fn find_number(&self, column: KeyColumn, number: i64) -> Result<u32, String> {
        let found = u32::try_from(number).ok();
        let found = found.and_then(|sequence| self.table.find(sequence));
        self.place(found, column, || number.to_string())
    }

    fn place(
        &self,
        found: Option<usize>,
        column: KeyColumn,
        value: impl FnOnce() -> String,
    ) -> Result<u32, String> {
        found
            .and_then(|place| u32::try_from(place).ok())
            .ok_or_else(|| {
                let rows = self.table.rows();
                let [first, last] =
                    [rows.first(), rows.last()].map(|row| row.map_or(0, |row| row.sequence));
                format!(
                    "{} = {}: {} has no such frame; its sequence numbers are {first} to {last}",
                    column.name(),
                    value(),
                    self.file
                )
            })
    }
}
