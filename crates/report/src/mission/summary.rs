//! The mission for programs: `summary.json`.

use fmc_camera::flight::frame_record::Outcome;
use serde::Serialize;

use super::{MissionReport, flags};
use crate::calibration_identity::CalibrationIdentity;
use crate::records;

/// The numbers of a mission. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the camera.
    pub camera: String,
    /// Device on which the camera ran.
    pub device: String,
    /// Seed of air, noise and jitter.
    pub seed: u64,
    /// `true` if every check is as expected.
    pub passed: bool,
    /// Number of triggers.
    pub triggers: usize,
    /// Number of records with an exposure.
    pub exposed: usize,
    /// Number of records without an exposure.
    pub refused: usize,
    /// Number of triggers without a record.
    pub unanswered: usize,
    /// Number of exposures without a record.
    pub unrecorded_exposures: usize,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// Mean V/H, 1/s.
    pub vh_per_s: f64,
    /// Error of the centroid principal point, px.
    pub pp_error_px: Spread,
    /// Error of the centroid principal point in frames without a fault or a flag that concerns it,
    /// px.
    pub pp_error_clean_px: Spread,
    /// Smear of centre and corners, attitude included, px.
    pub smear_px: Spread,
    /// Smear for which the compensation is responsible, px.
    pub compensation_smear_px: Spread,
    /// Limits of both.
    pub limits: Limits,
    /// CRC-32 of all records: the same on every device, bit for bit.
    pub records_crc32: String,
    /// Findings of the judgement.
    #[serde(rename = "findings")]
    pub checks: Vec<CheckSummary>,
    /// Number of frames with each flag.
    pub flags: Vec<Count>,
    /// Number of frames with each fault.
    pub faults: Vec<Count>,
    /// Number of refused triggers for each reason.
    pub refusals: Vec<Count>,
    /// Calibration of the records.
    pub calibration: Option<CalibrationIdentity>,
}

/// Root mean square, mean and largest value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Root mean square.
    pub rms: f64,
    /// Mean.
    pub mean: f64,
    /// Largest absolute value.
    pub max: f64,
}

/// Limits, px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Limit of the error of the principal point.
    pub pp_error_px: f64,
    /// Limit of the smear.
    pub smear_px: f64,
}

/// One check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckSummary {
    /// Property that was examined.
    pub what: String,
    /// Result.
    pub found: String,
    /// `true` if the result is as expected.
    pub passed: bool,
}

/// Number of occurrences.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Count {
    /// Name of the flag, fault or reason.
    pub name: String,
    /// Number of frames.
    pub frames: usize,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut count, mut sum, mut squares, mut max) = (0.0, 0.0, 0.0, 0.0);
        for value in values {
            count += 1.0;
            sum += value;
            squares += value * value;
            max = f64::max(max, value.abs());
        }
        let count = f64::max(count, 1.0);
        Self {
            rms: f64::sqrt(squares / count),
            mean: sum / count,
            max,
        }
    }
}

impl Summary {
    /// Returns the summary of a mission.
    #[must_use]
    pub fn of(report: &MissionReport<'_>) -> Self {
        let MissionReport {
            scenario,
            seed,
            flown,
            judgement,
        } = report;
        let exposed = flown
            .frames
            .iter()
            .filter(|frame| matches!(frame.record.outcome, Outcome::Exposed(_)))
            .count();
        let errors = || judgement.errors.iter().flatten();
        let limits = &scenario.written.limits;
        Self {
            scenario: scenario.written.name.clone(),
            camera: scenario.camera.name.clone(),
            device: flown.device.clone(),
            seed: *seed,
            passed: judgement.passed(),
            triggers: flown.triggers_us.len(),
            exposed,
            refused: flown.frames.len() - exposed,
            unanswered: flown.triggers_us.len().saturating_sub(flown.frames.len()),
            unrecorded_exposures: flown.unrecorded.len(),
            simulated_s: flown.duration_s,
            vh_per_s: scenario.vh_per_s(),
            pp_error_px: Spread::of(errors().map(|errors| errors.pp_error_px)),
            pp_error_clean_px: Spread::of(
                errors()
                    .filter(|errors| errors.is_clean)
                    .map(|errors| errors.pp_error_px),
            ),
            smear_px: Spread::of(errors().map(|errors| errors.smear_px)),
            compensation_smear_px: Spread::of(errors().map(|errors| errors.compensation_px)),
            limits: Limits {
                pp_error_px: limits.pp_error_px,
                smear_px: limits.smear_px,
            },
            records_crc32: format!("{:08x}", records::crc32(&report.records())),
            checks: judgement
                .checks
                .iter()
                .map(|check| CheckSummary {
                    what: check.what.clone(),
                    found: check.found.clone(),
                    passed: check.passed,
                })
                .collect(),
            flags: Self::flags(report),
            faults: Self::faults(report),
            refusals: Self::refusals(report),
            calibration: report.calibration().as_ref().map(CalibrationIdentity::of),
        }
    }

    fn flags(report: &MissionReport<'_>) -> Vec<Count> {
        let counts = flags::counts(report)
            .into_iter()
            .map(|(flag, frames)| Count {
                name: flag.name().to_owned(),
                frames,
            });
        counts.collect()
    }

    fn faults(report: &MissionReport<'_>) -> Vec<Count> {
        let frames = || report.flown.frames.iter();
        let counts = fmc_camera::flight::fault::Fault::ALL
            .into_iter()
            .map(|fault| Count {
                name: fault.to_string(),
                frames: frames()
                    .filter(|frame| frame.record.faults.contains(fault))
                    .count(),
            });
        counts.filter(|count| count.frames > 0).collect()
    }

    fn refusals(report: &MissionReport<'_>) -> Vec<Count> {
        let mut counts: Vec<Count> = Vec::new();
        for frame in &report.flown.frames {
            if let Outcome::Refused(reason) = frame.record.outcome {
                match counts.iter_mut().find(|count| count.name == reason.name()) {
                    Some(count) => count.frames += 1,
                    None => counts.push(Count {
                        name: reason.name().to_owned(),
                        frames: 1,
                    }),
                }
            }
        }
        counts
    }
}
