//! Row of a record in `records.csv` and `records.json`, as it is written and read.

use std::borrow::Cow;
use std::io::Write;

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::vh::VhSource;
use fmc_camera::geometry::frame_correction::Terms;
use serde::{Deserialize, Serialize};

/// Convention by which a focus shift is reported, by the letter of `docs/conventions.md`, section
/// 6: the principal distance stays, the corrected coordinates contain the enlargement.
pub const FOCUS_CONVENTION: &str = "A";

/// Names of the columns, in their order.
pub const NAMES: [&str; 48] = [
    "sequence",
    "trigger_us",
    "outcome",
    "reason",
    "opened_us",
    "closed_us",
    "centroid_us",
    "centroid_unix_us",
    "utc_sigma_s",
    "exposure_s",
    "principal_point_x_mm",
    "principal_point_y_mm",
    "principal_point_sigma_mm",
    "principal_distance_mm",
    "focus_shift_mm",
    "enlargement",
    "focus_convention",
    "model",
    "kernel",
    "left_out_nm",
    "opening_offset_mm",
    "travel_mm",
    "centroid_offset_mm",
    "centroid_after_opening_s",
    "variance_mm2",
    "third_moment_mm3",
    "fourth_moment_mm4",
    "planned_opening_mm",
    "planned_travel_mm",
    "compensated_vh_per_s",
    "vh_per_s",
    "vh_sigma_per_s",
    "vh_age_s",
    "vh_source",
    "vh_extrapolated",
    "predicted_smear_um",
    "predicted_smear_px",
    "faults",
    "fault_codes",
    "flags",
    "calibration_crc32",
    "principal_point_frame_sigma_mm",
    "principal_point_common_sigma_mm",
    "calibration_serial",
    "calibration_version",
    "calibration_storage",
    "boot",
    "flight",
];

/// Stands between the names of a cell.
const SEPARATOR: &str = "; ";

/// A name of the record, borrowed where it is written and owned where it is read.
type Name = Cow<'static, str>;

/// A list of names: several in one cell, or an array.
pub trait Names {
    /// Returns the list of these names.
    fn of(names: Vec<&'static str>) -> Self;

    /// Returns `true` if a name is among them.
    fn contains(&self, name: &str) -> bool;

    /// Returns the names as one cell has them.
    fn into_cell(self) -> String;
}

impl Names for String {
    fn of(names: Vec<&'static str>) -> Self {
        names.join(SEPARATOR)
    }

    fn contains(&self, name: &str) -> bool {
        self.split(SEPARATOR).any(|one| one == name)
    }

    fn into_cell(self) -> String {
        self
    }
}

impl Names for Vec<Name> {
    fn of(names: Vec<&'static str>) -> Self {
        names.into_iter().map(Name::Borrowed).collect()
    }

    fn contains(&self, name: &str) -> bool {
        self.iter().any(|one| one == name)
    }

    fn into_cell(self) -> String {
        self.join(SEPARATOR)
    }
}

/// A record; fields that a refused trigger does not have are empty.
///
/// Lists of names are of the type `L`: `String` in a table, `Vec` in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row<L> {
    pub(crate) sequence: u32,
    pub(crate) trigger_us: u64,
    pub(crate) outcome: Name,
    pub(crate) reason: Option<Name>,
    pub(crate) opened_us: Option<u64>,
    pub(crate) closed_us: Option<u64>,
    pub(crate) centroid_us: Option<u64>,
    pub(crate) centroid_unix_us: Option<u64>,
    pub(crate) utc_sigma_s: Option<f32>,
    pub(crate) exposure_s: Option<f32>,
    pub(crate) principal_point_x_mm: Option<f32>,
    pub(crate) principal_point_y_mm: Option<f32>,
    pub(crate) principal_point_sigma_mm: Option<f32>,
    pub(crate) principal_distance_mm: Option<f32>,
    pub(crate) focus_shift_mm: Option<f32>,
    pub(crate) enlargement: Option<f32>,
    pub(crate) focus_convention: Option<Name>,
    pub(crate) model: Option<Name>,
    pub(crate) kernel: Option<Name>,
    pub(crate) left_out_nm: Option<f32>,
    pub(crate) opening_offset_mm: Option<f32>,
    pub(crate) travel_mm: Option<f32>,
    pub(crate) centroid_offset_mm: Option<f32>,
    pub(crate) centroid_after_opening_s: Option<f32>,
    pub(crate) variance_mm2: Option<f32>,
    pub(crate) third_moment_mm3: Option<f32>,
    pub(crate) fourth_moment_mm4: Option<f32>,
    pub(crate) planned_opening_mm: Option<f32>,
    pub(crate) planned_travel_mm: Option<f32>,
    pub(crate) compensated_vh_per_s: Option<f32>,
    pub(crate) vh_per_s: Option<f32>,
    pub(crate) vh_sigma_per_s: Option<f32>,
    pub(crate) vh_age_s: Option<f32>,
    pub(crate) vh_source: Option<Name>,
    pub(crate) vh_extrapolated: Option<bool>,
    pub(crate) predicted_smear_um: Option<f32>,
    pub(crate) predicted_smear_px: Option<f32>,
    pub(crate) faults: L,
    pub(crate) fault_codes: String,
    pub(crate) flags: L,
    pub(crate) calibration_crc32: String,
    pub(crate) principal_point_frame_sigma_mm: Option<f32>,
    pub(crate) principal_point_common_sigma_mm: Option<f32>,
    pub(crate) calibration_serial: Option<String>,
    pub(crate) calibration_version: Option<u32>,
    pub(crate) calibration_storage: Option<Name>,
    /// Empty in records of a camera that did not count its starts.
    pub(crate) boot: Option<u32>,
    pub(crate) flight: Option<u32>,
}

impl<L: Names> Row<L> {
    /// Returns the row of a record.
    #[must_use]
    pub fn of(record: &FrameRecord) -> Self {
        let (exposed, reason) = match &record.outcome {
            Outcome::Exposed(exposed) => (Some(exposed), None),
            Outcome::Refused(reason) => (None, Some(reason.name())),
        };
        let frame = |value: fn(&ExposedFrame) -> f32| exposed.map(value);
        let vh = exposed.and_then(|exposed| exposed.vh.as_ref());
        let utc = exposed.and_then(|exposed| exposed.centroid_utc.as_ref());
        let calibration = record.calibration.as_ref();
        Self {
            sequence: record.sequence,
            trigger_us: record.trigger.us(),
            outcome: Name::Borrowed(if exposed.is_some() { EXPOSED } else { REFUSED }),
            reason: reason.map(Name::Borrowed),
            opened_us: exposed.map(|exposed| exposed.opened.us()),
            closed_us: exposed.map(|exposed| exposed.closed.us()),
            centroid_us: exposed.map(|exposed| exposed.centroid.us()),
            centroid_unix_us: utc.map(|utc| utc.unix_us),
            utc_sigma_s: utc.map(|utc| utc.sigma_s),
            exposure_s: frame(|frame| frame.interior.exposure_s),
            principal_point_x_mm: frame(|frame| frame.interior.principal_point.x_mm),
            principal_point_y_mm: frame(|frame| frame.interior.principal_point.y_mm),
            principal_point_sigma_mm: frame(|frame| frame.principal_point_sigma.total_mm()),
            principal_distance_mm: frame(|frame| frame.interior.principal_distance_mm),
            focus_shift_mm: frame(|frame| frame.interior.focus_shift_mm),
            enlargement: frame(|frame| frame.interior.enlargement),
            focus_convention: exposed.map(|_| Name::Borrowed(FOCUS_CONVENTION)),
            model: exposed.map(|exposed| Name::Borrowed(model(exposed.interior.model))),
            kernel: exposed.map(|exposed| Name::Borrowed(kernel(exposed.interior.terms))),
            left_out_nm: frame(|frame| frame.interior.left_out_nm),
            opening_offset_mm: frame(|frame| frame.interior.motion.opening_offset_mm),
            travel_mm: frame(|frame| frame.interior.motion.travel_mm),
            centroid_offset_mm: frame(|frame| frame.interior.motion.centroid_mm),
            centroid_after_opening_s: frame(|frame| frame.interior.motion.centroid_time_s),
            variance_mm2: frame(|frame| frame.interior.motion.moments.second),
            third_moment_mm3: frame(|frame| frame.interior.motion.moments.third),
            fourth_moment_mm4: frame(|frame| frame.interior.motion.moments.fourth),
            planned_opening_mm: frame(|frame| frame.planned_opening_mm),
            planned_travel_mm: frame(|frame| frame.planned_travel_mm),
            compensated_vh_per_s: frame(|frame| frame.interior.vh_per_s),
            vh_per_s: vh.map(|vh| vh.vh_per_s),
            vh_sigma_per_s: vh.map(|vh| vh.sigma_per_s),
            vh_age_s: vh.map(|vh| vh.age_s),
            vh_source: vh.map(|vh| Name::Borrowed(source(vh.source))),
            vh_extrapolated: vh.map(|vh| vh.extrapolated),
            predicted_smear_um: frame(|frame| frame.smear_um),
            predicted_smear_px: frame(|frame| frame.smear_px),
            faults: L::of(record.faults.iter().map(Fault::name).collect()),
            fault_codes: codes(record.faults.iter()),
            flags: L::of(record.flags.iter().map(Flag::name).collect()),
            calibration_crc32: format!("{:08x}", calibration.map_or(0, |id| id.crc)),
            principal_point_frame_sigma_mm: frame(|frame| frame.principal_point_sigma.frame_mm),
            principal_point_common_sigma_mm: frame(|frame| frame.principal_point_sigma.common_mm),
            calibration_serial: calibration
                .filter(|id| !id.serial.is_empty())
                .map(|id| id.serial.to_string()),
            calibration_version: calibration
                .map(|id| id.version)
                .filter(|version| *version != 0),
            calibration_storage: calibration.map(|id| Name::Borrowed(id.storage.name())),
            boot: Some(record.boot),
            flight: Some(record.flight),
        }
    }

    /// Marks the record if its exposure is in doubt, as [`FrameRecord::doubt`] does. Returns `true`
    /// for an exposure.
    pub(crate) fn doubt(&mut self, exposures: &InDoubt) -> bool {
        let sigmas = (
            self.principal_point_frame_sigma_mm,
            self.principal_point_common_sigma_mm,
        );
        let (Some(frame_mm), Some(common_mm)) = sigmas else {
            return false;
        };
        let sigma = PrincipalPointSigma {
            frame_mm,
            common_mm,
        }
        .in_doubt_by(exposures.off_mm);
        self.principal_point_common_sigma_mm = Some(sigma.common_mm);
        self.principal_point_sigma_mm = Some(sigma.total_mm());
        let faults: Vec<Fault> = Fault::ALL
            .into_iter()
            .filter(|fault| {
                let is_named = exposures.is_fault && *fault == Fault::Encoder;
                is_named || self.faults.contains(fault.name())
            })
            .collect();
        self.fault_codes = codes(faults.iter().copied());
        self.faults = L::of(faults.into_iter().map(Fault::name).collect());
        let flags = Flag::ALL.into_iter();
        let flags =
            flags.filter(|flag| *flag == Flag::Unreferenced || self.flags.contains(flag.name()));
        self.flags = L::of(flags.map(Flag::name).collect());
        true
    }
}

impl Row<String> {
    /// Returns `true` if flag, fault and σ cover exposures in doubt.
    pub(crate) fn holds(&self, exposures: &InDoubt) -> bool {
        let common_mm = self.principal_point_common_sigma_mm;
        common_mm.is_some_and(|sigma_mm| sigma_mm >= exposures.off_mm.abs())
            && self.flags.contains(Flag::Unreferenced.name())
            && (!exposures.is_fault || self.faults.contains(Fault::Encoder.name()))
    }

    /// Returns `true` if it is the row of a record, apart from what a doubt changes.
    pub(crate) fn is_of(&self, record: &FrameRecord) -> bool {
        let theirs = Self::of(record);
        *self
            == Self {
                principal_point_sigma_mm: self.principal_point_sigma_mm,
                principal_point_common_sigma_mm: self.principal_point_common_sigma_mm,
                faults: self.faults.clone(),
                fault_codes: self.fault_codes.clone(),
                flags: self.flags.clone(),
                ..theirs
            }
    }
}

/// Writes records as `records.csv`: one row per trigger.
///
/// # Errors
/// Those of the sink.
pub fn write_csv(records: &[FrameRecord], sink: impl Write) -> csv::Result<()> {
    write_rows(records.iter().map(Row::<String>::of), sink)
}

/// Writes the row of a record, to be appended to `records.csv`.
///
/// # Errors
/// Those of the sink.
pub fn write_row(record: &FrameRecord, sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(sink);
    writer.serialize(Row::<String>::of(record))?;
    Ok(writer.flush()?)
}

/// Writes rows as `records.csv`.
pub(crate) fn write_rows(
    rows: impl IntoIterator<Item = impl Serialize>,
    sink: impl Write,
) -> csv::Result<()> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(sink);
    writer.write_record(NAMES)?;
    for row in rows {
        writer.serialize(row)?;
    }
    Ok(writer.flush()?)
}

/// Returns the codes of faults as one cell has them.
fn codes(faults: impl Iterator<Item = Fault>) -> String {
    let codes: Vec<String> = faults.map(|fault| fault.code().to_string()).collect();
    codes.join(SEPARATOR)
}

/// Outcome of a trigger with an exposure.
pub(crate) const EXPOSED: &str = "exposed";
/// Outcome of a trigger without one.
pub(crate) const REFUSED: &str = "refused";

/// Returns the name of a model, as records and options have it.
#[must_use]
pub const fn model(model: CorrectionModel) -> &'static str {
    match model {
        CorrectionModel::Exact => "exact",
        CorrectionModel::Fitted => "fitted",
        CorrectionModel::Static => "static",
    }
}

/// Returns the name of the kernel that computes a correction.
#[must_use]
pub const fn kernel(terms: Terms) -> &'static str {
    match terms {
        Terms::Short => "short",
        Terms::Full => "full",
    }
}

const fn source(source: VhSource) -> &'static str {
    match source {
        VhSource::Direct => "direct",
        VhSource::Altimeter => "altimeter",
        VhSource::Terrain => "terrain",
    }
}
