//! The flight against its limits and what was expected of its faults.

use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};

use super::expectation::Expectation;
use super::fault::trigger::microseconds;
use super::flight_loop::{Flown, FlownFrame};
use crate::formats::camera_file::CameraFile;
use crate::formats::mission_scenario::{MissionScenario, PlannedFault};

/// Flags that say nothing against the coordinates of a frame.
const HARMLESS: [Flag; 6] = [
    Flag::NoCompensation,
    Flag::LastGoodVh,
    Flag::OffCentre,
    Flag::SmearOverBudget,
    Flag::WithAttitude,
    Flag::EncoderGlitch,
];

/// One frame's errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameErrors {
    /// Reported centroid principal point less the true one, along the FMC axis, px.
    pub pp_error_px: f64,
    /// What the image of a point moved on the detector, px.
    pub smear_px: f64,
    /// The part that compensation is responsible for, px, signed.
    pub compensation_px: f64,
    /// Smear that the camera predicted, px.
    pub predicted_px: f64,
    /// Whether the camera stands by its coordinates: no fault, no flag against them.
    pub is_clean: bool,
}

impl FrameErrors {
    /// Those of a frame; `None` where no light passed or nothing was recorded.
    #[must_use]
    pub fn of(camera: &CameraFile, frame: &FlownFrame) -> Option<Self> {
        let Outcome::Exposed(exposed) = &frame.record.outcome else {
            return None;
        };
        let truth = frame.truth.as_ref()?;
        let pixel_mm = camera.sensor.pixel_um / 1000.0;
        Some(Self {
            pp_error_px: (reported_offset_mm(camera, exposed) - truth.centroid_offset_mm)
                / pixel_mm,
            smear_px: truth.smear_mm / pixel_mm,
            compensation_px: truth.compensation_smear_mm / pixel_mm,
            predicted_px: f64::from(exposed.smear_px),
            is_clean: is_clean(&frame.record),
        })
    }
}

/// The principal point as the block adjustment gets it, along the FMC axis from the calibrated one, mm.
fn reported_offset_mm(camera: &CameraFile, exposed: &ExposedFrame) -> f64 {
    let [x0, y0] = camera.principal_point_mm;
    let [ex, ey] = camera.fmc.axis.unit();
    let point = exposed.interior.principal_point;
    (f64::from(point.x_mm) - x0) * ex + (f64::from(point.y_mm) - y0) * ey
}

fn is_clean(record: &FrameRecord) -> bool {
    record.faults.is_empty()
        && Flag::ALL
            .into_iter()
            .filter(|flag| !HARMLESS.contains(flag))
            .all(|flag| !record.flags.contains(flag))
}

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What.
    pub what: String,
    /// What was found.
    pub found: String,
    /// Whether that is as it should be.
    pub passed: bool,
}

/// What is found of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Each frame's errors, as the frames.
    pub errors: Vec<Option<FrameErrors>>,
    /// What was looked at.
    pub findings: Vec<Finding>,
}

impl Judgement {
    /// Looks at a flight.
    #[must_use]
    pub fn of(scenario: &MissionScenario, flown: &Flown) -> Self {
        let errors: Vec<Option<FrameErrors>> = flown
            .frames
            .iter()
            .map(|frame| FrameErrors::of(&scenario.camera, frame))
            .collect();
        let mut findings = vec![unanswered(flown), coordinates(scenario, flown, &errors)];
        if scenario.faults.is_empty() {
            findings.push(nominal_smear(scenario, &errors));
            findings.push(refused(flown, 0));
        } else {
            findings.push(predicted_smear(scenario, flown, &errors));
        }
        for (fault, felt_us) in scenario.faults.iter().zip(&flown.felt_us) {
            findings.extend(outcome(flown, fault, *felt_us));
        }
        Self { errors, findings }
    }

    /// Whether everything is as it should be.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.findings.iter().all(|finding| finding.passed)
    }
}

/// Every trigger has its record, numbered without a gap, at its own time.
fn unanswered(flown: &Flown) -> Finding {
    let answered = flown
        .triggers_us
        .iter()
        .zip(&flown.frames)
        .zip(1_u32..)
        .filter(|((trigger_us, frame), number)| {
            frame.record.sequence == *number && frame.record.trigger.us() == **trigger_us
        })
        .count();
    let missing = flown.triggers_us.len() - answered;
    let extra = flown.frames.len().saturating_sub(flown.triggers_us.len());
    Finding {
        what: "every trigger has its record".to_owned(),
        found: format!(
            "{answered} of {} triggers answered in order, {extra} records too many",
            flown.triggers_us.len()
        ),
        passed: missing == 0 && extra == 0,
    }
}

/// No frame that the camera stands by has a wrong principal point.
fn coordinates(
    scenario: &MissionScenario,
    flown: &Flown,
    errors: &[Option<FrameErrors>],
) -> Finding {
    let limit_px = scenario.written.limits.pp_error_px;
    let clean = || errors.iter().flatten().filter(|errors| errors.is_clean);
    let worst = clean()
        .map(|errors| errors.pp_error_px.abs())
        .fold(0.0, f64::max);
    // A record of light that did not pass would be the worst of all.
    let invented = flown
        .frames
        .iter()
        .filter(|frame| {
            matches!(frame.record.outcome, Outcome::Exposed(_)) && frame.truth.is_none()
        })
        .count();
    let not_numbers = clean().any(|errors| !errors.pp_error_px.is_finite());
    Finding {
        what: format!(
            "principal point within {limit_px} px of the truth in all frames without fault or flag"
        ),
        found: format!(
            "{} frames, largest error {worst:.4} px, {invented} records of light that did not pass",
            clean().count()
        ),
        passed: worst <= limit_px && !not_numbers && invented == 0,
    }
}

/// Smear of a flight in which nothing goes wrong.
fn nominal_smear(scenario: &MissionScenario, errors: &[Option<FrameErrors>]) -> Finding {
    let limit_px = scenario.written.limits.smear_px;
    let worst = errors
        .iter()
        .flatten()
        .map(|errors| errors.smear_px)
        .fold(0.0, f64::max);
    Finding {
        what: format!("smear of all frames at most {limit_px} px, attitude included"),
        found: format!("largest {worst:.4} px"),
        passed: worst <= limit_px,
    }
}

/// Smear of a flight with faults: the camera knows of what it cannot help.
fn predicted_smear(
    scenario: &MissionScenario,
    flown: &Flown,
    errors: &[Option<FrameErrors>],
) -> Finding {
    let limit_px = scenario.written.limits.smear_px;
    let excess = flown
        .frames
        .iter()
        .zip(errors)
        .filter(|(frame, _)| frame.record.faults.is_empty())
        .filter_map(|(_, errors)| errors.as_ref())
        .map(|errors| errors.smear_px - errors.predicted_px)
        .fold(f64::NEG_INFINITY, f64::max);
    Finding {
        what: format!("no frame without fault smeared by {limit_px} px more than predicted"),
        found: format!("at most {excess:.4} px more"),
        passed: excess <= limit_px,
    }
}

fn refused(flown: &Flown, most: usize) -> Finding {
    let refused = flown
        .frames
        .iter()
        .filter(|frame| matches!(frame.record.outcome, Outcome::Refused(_)))
        .count();
    Finding {
        what: match most {
            0 => "no trigger refused".to_owned(),
            most => format!("at most {most} triggers refused"),
        },
        found: format!("{refused} refused"),
        passed: refused <= most,
    }
}

/// What a fault led to, against what was expected.
fn outcome(flown: &Flown, planned: &PlannedFault, felt_us: Option<u64>) -> Vec<Finding> {
    let Expectation {
        fault,
        within_ms,
        state,
        refused: reason,
        flag,
        refused_at_most,
    } = &planned.expectation;
    let injection = &planned.injection;
    let name = injection.fault.name();
    let onset_us = microseconds(injection.onset_s);
    let mut findings = Vec::new();
    if let Some(fault) = fault {
        let announced = flown
            .announced
            .iter()
            .filter(|(time_us, _)| *time_us >= onset_us)
            .find(|(_, one)| one == fault)
            .map(|(time_us, _)| *time_us);
        let recorded = flown.frames.iter().any(|frame| {
            frame.record.trigger.us() >= onset_us.saturating_sub(1_000_000)
                && frame.record.faults.contains(*fault)
        });
        let after_us = announced.map(|time_us| time_us - felt_us.unwrap_or(onset_us).min(time_us));
        let in_time = match (within_ms, after_us) {
            (Some(within_ms), Some(after_us)) => {
                super::sensors::seconds(after_us) * 1e3 <= *within_ms
            }
            (Some(_), None) => false,
            (None, _) => announced.is_some() || recorded,
        };
        findings.push(Finding {
            what: match within_ms {
                Some(within_ms) => format!("{name}: {fault} named within {within_ms} ms"),
                None => format!("{name}: {fault} named"),
            },
            found: match after_us {
                Some(after_us) => format!(
                    "{:.1} ms after it could be felt",
                    super::sensors::seconds(after_us) * 1e3
                ),
                None if recorded => "in a record".to_owned(),
                None => "not named".to_owned(),
            },
            passed: in_time,
        });
    }
    if let Some(state) = state {
        let found = flown
            .states
            .iter()
            .filter(|(time_us, _)| *time_us >= onset_us)
            .find(|(_, one)| one.name() == state);
        findings.push(Finding {
            what: format!("{name}: state {state}"),
            found: found.map_or("never".to_owned(), |(time_us, one)| {
                format!("{one} at {:.3} s", super::sensors::seconds(*time_us))
            }),
            passed: found.is_some(),
        });
    }
    let later = || {
        flown
            .frames
            .iter()
            .filter(move |frame| frame.record.trigger.us() + 1_000_000 >= onset_us)
    };
    if let Some(reason) = reason {
        let found = later()
            .filter(|frame| match frame.record.outcome {
                Outcome::Refused(one) => one.name() == reason,
                Outcome::Exposed(_) => false,
            })
            .count();
        findings.push(Finding {
            what: format!("{name}: a trigger refused: {reason}"),
            found: format!("{found} refused so"),
            passed: found > 0,
        });
    }
    if let Some(flag) = flag {
        let found = later()
            .filter(|frame| frame.record.flags.contains(*flag))
            .count();
        findings.push(Finding {
            what: format!("{name}: a frame with the flag \"{}\"", flag.name()),
            found: format!("{found} frames"),
            passed: found > 0,
        });
    }
    if let Some(most) = refused_at_most {
        let mut finding = refused(flown, *most);
        finding.what = format!("{name}: {}", finding.what);
        findings.push(finding);
    }
    findings
}
