//! Heading of a table of exposures, and the cells of its rows.

use csv::StringRecord;
use fmc_camera_file::InputError;
use fmc_camera_file::number::finite;

use crate::columns::shown;

/// A column of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Column {
    Sequence,
    Frame,
    Image,
    Vh,
    GroundSpeed,
    Height,
    Exposure,
    OpeningOffset,
    FocusShift,
    Direction,
    FocusSign,
    Model,
    Centroid,
    CentroidUnix,
    UtcSigma,
    FrameSigma,
    CommonSigma,
}

impl Column {
    /// All columns with their names, the first the one that messages suggest.
    const ALL: [(Self, &'static [&'static str]); 17] = [
        (Self::Sequence, &["sequence"]),
        (Self::Frame, &["frame"]),
        (Self::Image, &["image"]),
        (Self::Vh, &["vh", "vh_per_s"]),
        (Self::GroundSpeed, &["ground_speed", "ground_speed_m_s"]),
        (Self::Height, &["height", "height_m"]),
        (Self::Exposure, &["exposure", "exposure_s"]),
        (Self::OpeningOffset, &["opening_offset_mm"]),
        (Self::FocusShift, &["focus_shift_um"]),
        (Self::Direction, &["direction"]),
        (Self::FocusSign, &["focus_sign"]),
        (Self::Model, &["model"]),
        (Self::Centroid, &["centroid_us"]),
        (Self::CentroidUnix, &["centroid_unix_us"]),
        (Self::UtcSigma, &["utc_sigma_s"]),
        (Self::FrameSigma, &["principal_point_frame_sigma_mm"]),
        (Self::CommonSigma, &["principal_point_common_sigma_mm"]),
    ];

    fn of(name: &str) -> Option<Self> {
        let name = name.replace('-', "_");
        let found = Self::ALL
            .iter()
            .find(|(_, names)| names.contains(&name.as_str()));
        found.map(|(column, _)| *column)
    }
}

/// The columns of a table, by their places.
#[derive(Debug, Clone)]
pub(super) struct Heading {
    columns: Vec<Column>,
    names: Vec<String>,
}

impl Heading {
    /// Returns the columns of a header.
    ///
    /// # Errors
    /// [`InputError`] for a column that is not known, that stands twice under two names, and for a
    /// table whose rows have no name.
    pub(super) fn find(file: &str, names: &[String]) -> Result<Self, InputError> {
        let refused = |text: String| {
            let known: Vec<&str> = Column::ALL
                .iter()
                .filter_map(|(_, names)| names.first().copied())
                .collect();
            InputError::invalid(format!("{file}, line 1: {text}"))
                .with_help(format!("the columns are {}", known.join(", ")))
        };
        let mut columns = Vec::new();
        for name in names {
            let column = Column::of(name)
                .ok_or_else(|| refused(format!("column {} is not known", shown(name))))?;
            if columns.contains(&column) {
                return Err(refused(format!("column {} appears twice", shown(name))));
            }
            columns.push(column);
        }
        let has = |column| columns.contains(&column);
        if !has(Column::Sequence) && !has(Column::Frame) && !has(Column::Image) {
            return Err(refused(format!(
                "column sequence, frame or image is missing; found {}",
                shown(&names.join(","))
            )));
        }
        if has(Column::GroundSpeed) != has(Column::Height) {
            let missing = if has(Column::Height) {
                "ground_speed"
            } else {
                "height"
            };
            return Err(refused(format!("column {missing} is missing")));
        }
        if has(Column::Vh) && has(Column::GroundSpeed) {
            return Err(refused(
                "both vh and ground_speed,height are given".to_owned(),
            ));
        }
        Ok(Self {
            columns,
            names: names.to_vec(),
        })
    }

    /// Returns the cells of a row.
    pub(super) fn row<'a>(&'a self, file: &'a str, line: u64, row: &'a StringRecord) -> Cells<'a> {
        Cells {
            heading: self,
            file,
            line,
            row,
        }
    }
}

/// The cells of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cells<'a> {
    heading: &'a Heading,
    file: &'a str,
    line: u64,
    row: &'a StringRecord,
}

impl<'a> Cells<'a> {
    /// Returns the text of a cell that is not empty, with the name of its column.
    fn text(&self, column: Column) -> Option<(&'a str, &'a str)> {
        let place = self.heading.columns.iter().position(|one| *one == column)?;
        let text = self.row.get(place).filter(|text| !text.is_empty())?;
        Some((self.heading.names.get(place)?, text))
    }

    /// Reads a cell, `None` if it is empty.
    ///
    /// # Errors
    /// [`InputError`] with the sentence that `read` returns.
    pub(super) fn read<T>(
        &self,
        column: Column,
        read: impl FnOnce(&str) -> Result<T, String>,
    ) -> Result<Option<T>, InputError> {
        let Some((name, text)) = self.text(column) else {
            return Ok(None);
        };
        match read(text) {
            Ok(value) => Ok(Some(value)),
            Err(fault) => Err(self.refused(&format!("{name} = \"{}\": {fault}", shown(text)))),
        }
    }

    /// Reads a number, `None` if the cell is empty.
    pub(super) fn number(&self, column: Column) -> Result<Option<f64>, InputError> {
        self.read(column, finite)
    }

    /// Reads a number that is not negative, `None` if the cell is empty.
    pub(super) fn non_negative(&self, column: Column) -> Result<Option<f64>, InputError> {
        self.read(column, |text| match finite(text)? {
            number if number >= 0.0 => Ok(number),
            _ => Err("must be at least 0".to_owned()),
        })
    }

    /// Reads a whole number, `None` if the cell is empty.
    pub(super) fn whole<N: std::str::FromStr>(
        &self,
        column: Column,
    ) -> Result<Option<N>, InputError> {
        self.read(column, |text| {
            text.parse()
                .map_err(|_| "must be a whole number, at least 0".to_owned())
        })
    }

    /// Returns sequence number and image of the row, the `count`th of the table.
    pub(super) fn name(&self, count: u32) -> Result<(u32, Option<String>), InputError> {
        let image = self.text(Column::Image).map(|(_, text)| text);
        let frame = self.text(Column::Frame).map(|(_, text)| text);
        if let Some(sequence) = self.whole(Column::Sequence)? {
            return Ok((sequence, image.or(frame).map(str::to_owned)));
        }
        match frame.map(|frame| (frame, frame.parse())) {
            Some((_, Ok(sequence))) => Ok((sequence, image.map(str::to_owned))),
            Some((frame, Err(_))) => Ok((count, Some(image.unwrap_or(frame).to_owned()))),
            None if image.is_none() => Err(self.refused("the row has neither sequence nor image")),
            None => Ok((count, image.map(str::to_owned))),
        }
    }

    /// Returns the name of a column as the table has it, or as messages suggest it.
    pub(super) fn column_name(&self, column: Column) -> &'a str {
        let names = || Column::ALL.iter().find(|(one, _)| *one == column);
        match self.text(column) {
            Some((name, _)) => name,
            None => names()
                .and_then(|(_, names)| names.first().copied())
                .unwrap_or_default(),
        }
    }

    /// Returns the error of this row.
    pub(super) fn refused(&self, text: &str) -> InputError {
        InputError::invalid(format!("{}, line {}: {text}", self.file, self.line))
    }
}
