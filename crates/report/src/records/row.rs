//! One record as a row.

use fmc_camera::flight::exposure::CorrectionModel;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera::flight::vh::VhSource;
use fmc_camera::geometry::frame_correction::Terms;
use serde::Serialize;

use crate::calibration_identity::CalibrationIdentity;
use crate::wording::FOCUS_CONVENTION;

/// Names of the columns, as the fields of [`Row`].
pub(super) const NAMES: [&str; 46] = [
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
];

/// A list of names: several in one cell, or an array.
pub(super) trait Names {
    fn of(names: Vec<&'static str>) -> Self;
}

impl Names for String {
    fn of(names: Vec<&'static str>) -> Self {
        names.join("; ")
    }
}

impl Names for Vec<&'static str> {
    fn of(names: Vec<&'static str>) -> Self {
        names
    }
}

/// A record; fields that a refused trigger does not have are empty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Row<L> {
    sequence: u32,
    trigger_us: u64,
    outcome: &'static str,
    reason: Option<&'static str>,
    opened_us: Option<u64>,
    closed_us: Option<u64>,
    centroid_us: Option<u64>,
    centroid_unix_us: Option<u64>,
    utc_sigma_s: Option<f32>,
    exposure_s: Option<f32>,
    principal_point_x_mm: Option<f32>,
    principal_point_y_mm: Option<f32>,
    principal_point_sigma_mm: Option<f32>,
    principal_distance_mm: Option<f32>,
    focus_shift_mm: Option<f32>,
    enlargement: Option<f32>,
    focus_convention: Option<&'static str>,
    model: Option<&'static str>,
    kernel: Option<&'static str>,
    left_out_nm: Option<f32>,
    opening_offset_mm: Option<f32>,
    travel_mm: Option<f32>,
    centroid_offset_mm: Option<f32>,
    centroid_after_opening_s: Option<f32>,
    variance_mm2: Option<f32>,
    third_moment_mm3: Option<f32>,
    fourth_moment_mm4: Option<f32>,
    planned_opening_mm: Option<f32>,
    planned_travel_mm: Option<f32>,
    compensated_vh_per_s: Option<f32>,
    vh_per_s: Option<f32>,
    vh_sigma_per_s: Option<f32>,
    vh_age_s: Option<f32>,
    vh_source: Option<&'static str>,
    vh_extrapolated: Option<bool>,
    predicted_smear_um: Option<f32>,
    predicted_smear_px: Option<f32>,
    faults: L,
    fault_codes: String,
    flags: L,
    calibration_crc32: String,
    principal_point_frame_sigma_mm: Option<f32>,
    principal_point_common_sigma_mm: Option<f32>,
    calibration_serial: Option<String>,
    calibration_version: Option<u32>,
    calibration_storage: Option<&'static str>,
}

impl<L: Names> Row<L> {
    pub(super) fn of(record: &FrameRecord) -> Self {
        let (exposed, reason) = match &record.outcome {
            Outcome::Exposed(exposed) => (Some(exposed), None),
            Outcome::Refused(reason) => (None, Some(reason.name())),
        };
        let frame = |value: fn(&ExposedFrame) -> f32| exposed.map(value);
        let vh = exposed.and_then(|exposed| exposed.vh.as_ref());
        let utc = exposed.and_then(|exposed| exposed.centroid_utc.as_ref());
        let calibration = record.calibration.as_ref().map(CalibrationIdentity::of);
        let codes: Vec<String> = record
            .faults
            .iter()
            .map(|fault| fault.code().to_string())
            .collect();
        Self {
            sequence: record.sequence,
            trigger_us: record.trigger.us(),
            outcome: if exposed.is_some() {
                "exposed"
            } else {
                "refused"
            },
            reason,
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
            focus_convention: exposed.map(|_| FOCUS_CONVENTION),
            model: exposed.map(|exposed| match exposed.interior.model {
                CorrectionModel::Exact => "exact",
                CorrectionModel::Fitted => "fitted",
                CorrectionModel::Static => "static",
            }),
            kernel: exposed.map(|exposed| match exposed.interior.terms {
                Terms::Short => "short",
                Terms::Full => "full",
            }),
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
            vh_source: vh.map(|vh| source(vh.source)),
            vh_extrapolated: vh.map(|vh| vh.extrapolated),
            predicted_smear_um: frame(|frame| frame.smear_um),
            predicted_smear_px: frame(|frame| frame.smear_px),
            faults: L::of(record.faults.iter().map(Fault::name).collect()),
            fault_codes: codes.join("; "),
            flags: L::of(record.flags.iter().map(Flag::name).collect()),
            calibration_crc32: calibration
                .as_ref()
                .map_or_else(|| "00000000".to_owned(), |it| it.crc32.clone()),
            principal_point_frame_sigma_mm: frame(|frame| frame.principal_point_sigma.frame_mm),
            principal_point_common_sigma_mm: frame(|frame| frame.principal_point_sigma.common_mm),
            calibration_version: calibration.as_ref().and_then(|it| it.version),
            calibration_storage: calibration.as_ref().map(|it| it.storage),
            calibration_serial: calibration.and_then(|it| it.serial),
        }
    }
}

const fn source(source: VhSource) -> &'static str {
    match source {
        VhSource::Direct => "direct",
        VhSource::Altimeter => "altimeter",
        VhSource::Terrain => "terrain",
    }
}
