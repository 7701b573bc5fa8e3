//! Faults, flags and reasons: all of them, under their names.

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, Reason};

use super::rows;

fn column(heading: &str, index: usize) -> Vec<String> {
    let rows = rows(heading);
    rows.iter().map(|row| row[index].to_owned()).collect()
}

#[test]
fn every_fault_has_its_code_cause_and_remedy() {
    let expected: Vec<_> = Fault::ALL
        .map(|fault| [fault.code().to_string(), fault.name().to_owned()])
        .into();
    let documented: Vec<_> = rows("code")
        .iter()
        .map(|row| [row[0].to_owned(), row[1].to_owned()])
        .collect();
    assert_eq!(documented, expected);
    for row in rows("code") {
        assert_eq!(row.len(), 6);
        assert!(row.iter().all(|cell| !cell.is_empty()), "{row:?}");
    }
}

#[test]
fn every_flag_is_explained() {
    let expected: Vec<_> = Flag::ALL.map(|flag| flag.name().to_owned()).into();
    assert_eq!(column("flag", 0), expected);
}

/// Returns the reason after another; does not compile if one is missing here.
const fn next(reason: Reason) -> Option<Reason> {
    Some(match reason {
        Reason::NotArmed => Reason::Overlap,
        Reason::Overlap => Reason::OutsideLimits,
        Reason::OutsideLimits => Reason::Stroke,
        Reason::Stroke => Reason::Speed,
        Reason::Speed => Reason::NotAtSpeed,
        Reason::NotAtSpeed => Reason::ShutterMissing,
        Reason::ShutterMissing => Reason::Fault(Fault::Stall),
        Reason::Fault(_) => Reason::Disarmed,
        Reason::Disarmed => Reason::RecordsFull,
        Reason::RecordsFull => Reason::Unusable,
        Reason::Unusable => return None,
    })
}

#[test]
fn every_reason_of_a_refusal_is_explained() {
    let reasons = std::iter::successors(Some(Reason::NotArmed), |reason| next(*reason));
    let expected: Vec<_> = reasons
        .map(|reason| match reason {
            Reason::Fault(_) => "a fault's name",
            other => other.name(),
        })
        .collect();
    assert_eq!(column("reason", 0), expected);
}
