//! Variants of the adjustment that are compared.

use fmc_adjustment::bundle::calibration::CalibrationOptions;
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::tables::{NetworkTables, RowRole};
use fmc_camera_file::InputError;

use super::flown_block::FlownBlock;

/// Adjustment of a block. The principal point is estimated in all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// One principal point for all frames.
    Static,
    /// The same, with control points.
    StaticControl,
    /// The same, with a shift of the positions for every strip, too.
    StaticShift,
    /// Records: a principal point and a focus shift for every frame.
    Records,
    /// The same, with control points and shifts.
    RecordsShift,
    /// Records for the principal points, the distortion about the calibrated one.
    NotRecentred,
}

impl Variant {
    /// All variants, in the order of reports.
    pub const ALL: [Self; 6] = [
        Self::Static,
        Self::StaticControl,
        Self::StaticShift,
        Self::Records,
        Self::RecordsShift,
        Self::NotRecentred,
    ];

    /// Name in reports.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::StaticControl => "static, control",
            Self::StaticShift => "static, control, shifts",
            Self::Records => "records",
            Self::RecordsShift => "records, control, shifts",
            Self::NotRecentred => "records, not recentred",
        }
    }

    /// Name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::StaticControl => "static_control",
            Self::StaticShift => "static_control_shifts",
            Self::Records => "records",
            Self::RecordsShift => "records_control_shifts",
            Self::NotRecentred => "records_not_recentred",
        }
    }

    /// Returns true if control points take part.
    #[must_use]
    pub const fn has_control(self) -> bool {
        matches!(
            self,
            Self::StaticControl | Self::StaticShift | Self::RecordsShift
        )
    }

    /// Returns true if the principal points of the records do.
    #[must_use]
    pub const fn has_records(self) -> bool {
        matches!(
            self,
            Self::Records | Self::RecordsShift | Self::NotRecentred
        )
    }

    /// Returns the observations that the variant adjusts.
    ///
    /// # Errors
    /// [`InputError`] of the records.
    pub(super) fn tables(
        self,
        block: &FlownBlock,
        start: &Interior,
    ) -> Result<NetworkTables, InputError> {
        let mut tables = match self {
            Self::Static | Self::StaticControl | Self::StaticShift => block.tables.clone(),
            Self::Records | Self::RecordsShift => block.records.reduced(&block.tables)?,
            Self::NotRecentred => block.records.not_recentred(&block.tables, start)?,
        };
        if !self.has_control() {
            let rows = &mut tables.object_points.rows;
            rows.retain(|row| row.role != RowRole::Control);
        }
        Ok(tables)
    }

    /// Returns the unknowns.
    pub(super) fn options(self) -> CalibrationOptions {
        let mut estimated = vec![
            Parameter::Interior(InteriorElement::X0),
            Parameter::Interior(InteriorElement::Y0),
        ];
        if matches!(self, Self::StaticShift | Self::RecordsShift) {
            // One stands for all strips and axes.
            estimated.push(Parameter::Shift { strip: 0, axis: 0 });
        }
        CalibrationOptions {
            unknowns: Unknowns {
                estimated,
                priors: Vec::new(),
            },
            ..CalibrationOptions::default()
        }
    }
}
