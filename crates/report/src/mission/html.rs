//! The mission as a self-contained page: `report.html`.

use askama::Template;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Outcome};
use fmc_simulation::mission::flown::Flown;

use super::summary::{Count, Summary};
use super::{MissionReport, flags, frames_plot, histogram, sigma_figures, text, timeline};
use crate::page::{PageError, inline};
use crate::wording;

/// Largest number of rows in the table of frames that need a look.
const MOST_ROWS: usize = 200;

#[derive(Template)]
#[template(path = "mission.html")]
struct Page {
    summary: Summary,
    headline: String,
    setting: String,
    frames: String,
    histograms: String,
    sigma: Vec<String>,
    timeline: Option<Timeline>,
    injected: Vec<Injected>,
    noted: Vec<Noted>,
    left_out: usize,
    counts: Vec<(&'static str, Vec<Count>)>,
    flags: Vec<FlagRow>,
}

/// A flag that some frame has.
struct FlagRow {
    name: &'static str,
    told_of: &'static str,
    frames: usize,
    meaning: &'static str,
}

/// One frame, round by round.
struct Timeline {
    sequence: u32,
    why: &'static str,
    figure: String,
}

/// A fault of the scenario.
struct Injected {
    name: String,
    onset_s: String,
    size: String,
    duration: String,
    expected: String,
    announced: String,
}

/// A frame that needs a look.
struct Noted {
    sequence: u32,
    time_s: String,
    outcome: String,
    faults: String,
    flags: String,
    pp_error_px: String,
    smear_px: String,
}

/// Writes the whole mission as one HTML page, with the figures in it.
///
/// # Errors
/// [`PageError`] if a figure cannot be drawn.
pub fn page(report: &MissionReport<'_>) -> Result<String, PageError> {
    let summary = Summary::of(report);
    let mut noted = noted(report);
    let left_out = noted.len().saturating_sub(MOST_ROWS);
    noted.truncate(MOST_ROWS);
    let timeline = match &report.flown.trace {
        Some(trace) if !trace.rounds.is_empty() => Some(Timeline {
            sequence: trace.sequence,
            why: why(report, trace.sequence),
            figure: inline(timeline::timeline(report)?),
        }),
        _ => None,
    };
    let page = Page {
        headline: text::headline(&summary),
        setting: text::setting(report, &summary),
        frames: inline(frames_plot::frames(report)?),
        histograms: inline(histogram::histograms(report)?),
        sigma: sigma_figures::of(report)?
            .into_iter()
            .map(|(_, figure)| inline(figure))
            .collect(),
        timeline,
        injected: injected(report),
        noted,
        left_out,
        counts: vec![
            ("refused", summary.refusals.clone()),
            ("fault", summary.faults.clone()),
        ],
        flags: flag_rows(report),
        summary,
    };
    Ok(page.render()?)
}

fn flag_rows(report: &MissionReport<'_>) -> Vec<FlagRow> {
    let rows = flags::counts(report)
        .into_iter()
        .map(|(flag, frames)| FlagRow {
            name: flag.name(),
            told_of: flags::told_of(flag),
            frames,
            meaning: flags::meaning(flag),
        });
    rows.collect()
}

/// Returns the reason why this frame is shown.
fn why(report: &MissionReport<'_>, sequence: u32) -> &'static str {
    let first_with_fault = report
        .flown
        .frames
        .iter()
        .find(|frame| !frame.record.faults.is_empty());
    match first_with_fault {
        Some(frame) if frame.record.sequence == sequence => "the first frame with a fault",
        _ => "as asked for, or the frame with the largest smear",
    }
}

fn injected(report: &MissionReport<'_>) -> Vec<Injected> {
    let flown = report.flown;
    report
        .scenario
        .faults
        .iter()
        .map(|planned| {
            let injection = &planned.injection;
            let later = named(flown, injection.onset_s);
            let lasts_s = injection.end_s() - injection.onset_s;
            Injected {
                name: match injection.source {
                    Some(source) => format!("{} of {}", injection.fault, source.name()),
                    None => injection.fault.to_string(),
                },
                onset_s: format!("{:.3}", injection.onset_s),
                size: format!("{} {}", injection.size, injection.fault.unit()),
                duration: if lasts_s.is_finite() {
                    format!("{} s", wording::decimals(lasts_s, 3))
                } else {
                    "to the end".to_owned()
                },
                expected: planned.expectation.to_string(),
                announced: if later.is_empty() {
                    "nothing".to_owned()
                } else {
                    later.join(", ")
                },
            }
        })
        .collect()
}

/// Returns the first faults and states without compensation that the camera has named after a time.
fn named(flown: &Flown, onset_s: f64) -> Vec<String> {
    let announced = flown
        .announced
        .iter()
        .map(|(time_us, fault)| (*time_us, fault.to_string()));
    let states = flown
        .states
        .iter()
        .filter_map(|(time_us, state)| match state {
            State::Degraded(fault) => Some((*time_us, format!("{fault}, without compensation"))),
            _ => None,
        });
    let mut all: Vec<(u64, String)> = announced.chain(states).collect();
    all.retain(|(time_us, _)| seconds(*time_us) >= onset_s);
    all.sort_by_key(|(time_us, _)| *time_us);
    all.dedup_by(|next, one| next.1 == one.1);
    all.into_iter()
        .take(3)
        .map(|(time_us, what)| format!("{what} at {:.3} s", seconds(time_us)))
        .collect()
}

fn noted(report: &MissionReport<'_>) -> Vec<Noted> {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.3}"));
    report
        .flown
        .frames
        .iter()
        .zip(&report.judgement.errors)
        .filter(|(frame, _)| {
            let record = &frame.record;
            let is_usual = |flag: Flag| flag == Flag::WithAttitude;
            matches!(record.outcome, Outcome::Refused(_))
                || !record.faults.is_empty()
                || record.flags.iter().any(|flag| !is_usual(flag))
        })
        .map(|(frame, errors)| {
            let record = &frame.record;
            let faults: Vec<String> = record
                .faults
                .iter()
                .map(|fault: Fault| fault.to_string())
                .collect();
            let flags: Vec<&str> = record.flags.iter().map(Flag::name).collect();
            Noted {
                sequence: record.sequence,
                time_s: wording::decimals(seconds(record.trigger.us()), 3),
                outcome: match record.outcome {
                    Outcome::Exposed(_) => "exposed".to_owned(),
                    Outcome::Refused(reason) => format!("refused: {reason}"),
                },
                faults: faults.join(", "),
                flags: flags.join(", "),
                pp_error_px: number(errors.as_ref().map(|errors| errors.pp_error_px)),
                smear_px: number(errors.as_ref().map(|errors| errors.smear_px)),
            }
        })
        .collect()
}

#[expect(
    clippy::cast_precision_loss,
    reason = "a flight is shorter than 2^53 µs"
)]
fn seconds(us: u64) -> f64 {
    us as f64 * 1e-6
}
