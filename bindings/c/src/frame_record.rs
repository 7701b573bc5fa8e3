//! Record of a trigger, with every field in its own place.

use fmc::flight::calibration_id::CalibrationId;
use fmc::flight::frame_record::{ExposedFrame, FrameRecord, Outcome};
use fmc::flight::interior_orientation::InteriorOrientation;
use fmc::flight::principal_point_sigma::PrincipalPointSigma;
use fmc::flight::time::Time;
use fmc::flight::utc::UtcTime;
use fmc::flight::vh::VhEstimate;
use fmc::geometry::moments::CentralMoments;
use fmc::geometry::principal_point::PrincipalPointMotion;
use fmc::geometry::sensor::SensorPoint;

use crate::camera::fmc_calibration_id;
use crate::camera_record::serial;
use crate::code::{self, fmc_code};

use crate::frame::{fmc_interior, terms};
use crate::record_code::{code_of_reason, fault_bits, faults, flag_bits, flags, reason};
use crate::record_code::{code_of_source, source};
use crate::refusal::Refusal;
use crate::{FMC_SERIAL_LENGTH, FMC_VOLATILE};

/// The record of one trigger. Times are those of the camera, µs since it started.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct fmc_record {
    /// Time of the trigger, µs.
    pub trigger_us: u64,
    /// First light, µs.
    pub opened_us: u64,
    /// Last light, µs.
    pub closed_us: u64,
    /// Centroid of the exposure, µs.
    pub centroid_us: u64,
    /// The centroid in UTC, µs since 1970.
    pub centroid_unix_us: u64,
    /// Number of the trigger, from 1, without gaps.
    pub sequence: u32,
    /// `FMC_EXPOSED`, or the reason for the refusal, `FMC_REFUSED_...`; all fields of an exposure are 0
    /// then.
    pub outcome: fmc_code,
    /// Code of the fault of `FMC_REFUSED_FAULT`, or 0.
    pub refused_by: fmc_code,
    /// Faults, 1 << the place of its code among all.
    pub faults: u32,
    /// Flags, 1 << the place of its name among the flags of `docs/integration.md`, section 7.
    pub flags: u64,
    /// `FMC_YES` with a calibration that has an identity.
    pub has_calibration: fmc_code,
    /// The calibration in use.
    pub calibration: fmc_calibration_id,
    /// `FMC_YES` if the satellite receiver has set the clock.
    pub has_utc: fmc_code,
    /// σ of the time in UTC, s.
    pub utc_sigma_s: f32,
    /// `FMC_YES` with V/H.
    pub has_vh: fmc_code,
    /// V/H, 1/s.
    pub vh_per_s: f32,
    /// σ of V/H, 1/s.
    pub vh_sigma_per_s: f32,
    /// Age of V/H, s.
    pub vh_age_s: f32,
    /// `FMC_VH_...`
    pub vh_source: fmc_code,
    /// `FMC_YES` if V/H is extrapolated.
    pub vh_extrapolated: fmc_code,
    /// Offset of the plan when the shutter opens, mm.
    pub planned_opening_mm: f32,
    /// Travel of the plan, mm.
    pub planned_travel_mm: f32,
    /// Interior orientation from the measured motion.
    pub interior: fmc_interior,
    /// σ of the centroid principal point that each frame has for itself, mm.
    pub sigma_frame_mm: f32,
    /// σ of the centroid principal point that all frames share, mm.
    pub sigma_common_mm: f32,
    /// Predicted residual smear, µm.
    pub smear_um: f32,
    /// Predicted residual smear, pixels.
    pub smear_px: f32,
    /// Number of the camera's start in which the trigger came, from 1.
    pub boot: u32,
    /// Number of the flight, from 1.
    pub flight: u32,
}

impl Default for fmc_calibration_id {
    fn default() -> Self {
        Self {
            serial: [0; FMC_SERIAL_LENGTH],
            calibration_version: 0,
            crc32: 0,
            storage: FMC_VOLATILE,
        }
    }
}

impl From<&FrameRecord> for fmc_record {
    fn from(record: &FrameRecord) -> Self {
        let blank = Self {
            trigger_us: record.trigger.us(),
            sequence: record.sequence,
            faults: fault_bits(record.faults),
            flags: flag_bits(record.flags),
            boot: record.boot,
            flight: record.flight,
            has_calibration: code::code_of_bool(record.calibration.is_some()),
            calibration: record
                .calibration
                .as_ref()
                .map(Into::into)
                .unwrap_or_default(),
            ..Self::default()
        };
        match &record.outcome {
            Outcome::Exposed(frame) => blank.exposed(frame),
            Outcome::Refused(reason) => {
                let (outcome, refused_by) = code_of_reason(*reason);
                Self {
                    outcome,
                    refused_by,
                    ..blank
                }
            }
        }
    }
}

impl fmc_record {
    /// Returns the record with the fields of an exposure.
    fn exposed(self, frame: &ExposedFrame) -> Self {
        let utc = frame.centroid_utc;
        let vh = frame.vh;
        Self {
            opened_us: frame.opened.us(),
            closed_us: frame.closed.us(),
            centroid_us: frame.centroid.us(),
            centroid_unix_us: utc.map_or(0, |utc| utc.unix_us),
            has_utc: code::code_of_bool(utc.is_some()),
            utc_sigma_s: utc.map_or(0.0, |utc| utc.sigma_s),
            has_vh: code::code_of_bool(vh.is_some()),
            vh_per_s: vh.map_or(0.0, |vh| vh.vh_per_s),
            vh_sigma_per_s: vh.map_or(0.0, |vh| vh.sigma_per_s),
            vh_age_s: vh.map_or(0.0, |vh| vh.age_s),
            vh_source: vh.map_or(0, |vh| code_of_source(vh.source)),
            vh_extrapolated: code::code_of_bool(vh.is_some_and(|vh| vh.extrapolated)),
            planned_opening_mm: frame.planned_opening_mm,
            planned_travel_mm: frame.planned_travel_mm,
            interior: (&frame.interior).into(),
            sigma_frame_mm: frame.principal_point_sigma.frame_mm,
            sigma_common_mm: frame.principal_point_sigma.common_mm,
            smear_um: frame.smear_um,
            smear_px: frame.smear_px,
            ..self
        }
    }

    /// Returns the library's record.
    pub(crate) fn record(&self) -> Result<FrameRecord, Refusal> {
        let outcome = match reason(self.outcome, self.refused_by)? {
            Some(reason) => Outcome::Refused(reason),
            None => Outcome::Exposed(self.exposed_frame()?),
        };
        let calibration = code::bool_of(self.has_calibration)?
            .then(|| {
                Ok::<_, Refusal>(CalibrationId {
                    serial: serial(&self.calibration.serial)?,
                    version: self.calibration.calibration_version,
                    crc: self.calibration.crc32,
                    storage: code::storage(self.calibration.storage)?,
                })
            })
            .transpose()?;
        Ok(FrameRecord {
            sequence: self.sequence,
            trigger: Time::from_us(self.trigger_us),
            outcome,
            faults: faults(self.faults)?,
            flags: flags(self.flags)?,
            calibration,
            boot: self.boot,
            flight: self.flight,
        })
    }

    fn exposed_frame(&self) -> Result<ExposedFrame, Refusal> {
        let vh = code::bool_of(self.has_vh)?
            .then(|| {
                Ok::<_, Refusal>(VhEstimate {
                    vh_per_s: self.vh_per_s,
                    sigma_per_s: self.vh_sigma_per_s,
                    age_s: self.vh_age_s,
                    source: source(self.vh_source)?,
                    extrapolated: code::bool_of(self.vh_extrapolated)?,
                })
            })
            .transpose()?;
        Ok(ExposedFrame {
            opened: Time::from_us(self.opened_us),
            closed: Time::from_us(self.closed_us),
            centroid: Time::from_us(self.centroid_us),
            centroid_utc: code::bool_of(self.has_utc)?.then_some(UtcTime {
                unix_us: self.centroid_unix_us,
                sigma_s: self.utc_sigma_s,
            }),
            vh,
            planned_opening_mm: self.planned_opening_mm,
            planned_travel_mm: self.planned_travel_mm,
            interior: self.interior.orientation()?,
            principal_point_sigma: PrincipalPointSigma {
                frame_mm: self.sigma_frame_mm,
                common_mm: self.sigma_common_mm,
            },
            smear_um: self.smear_um,
            smear_px: self.smear_px,
        })
    }
}

impl fmc_interior {
    fn orientation(&self) -> Result<InteriorOrientation, Refusal> {
        Ok(InteriorOrientation {
            vh_per_s: self.vh_per_s,
            exposure_s: self.exposure_s,
            motion: PrincipalPointMotion {
                opening_offset_mm: self.opening_offset_mm,
                travel_mm: self.travel_mm,
                centroid_time_s: self.centroid_time_s,
                centroid_mm: self.centroid_mm,
                moments: CentralMoments {
                    second: self.second_moment_mm2,
                    third: self.third_moment_mm3,
                    fourth: self.fourth_moment_mm4,
                },
            },
            principal_point: SensorPoint::new(self.principal_point_x_mm, self.principal_point_y_mm),
            principal_distance_mm: self.principal_distance_mm,
            focus_shift_mm: self.focus_shift_mm,
            enlargement: self.enlargement,
            model: code::model(self.model)?,
            terms: terms(self.has_all_terms)?,
            left_out_nm: self.left_out_nm,
        })
    }
}
