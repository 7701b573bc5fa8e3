//! Records that are in doubt, marked by their receiver.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome, Reason};
use fmc_camera::flight::in_doubt::InDoubt;

use crate::controller::bench::{Bench, exposed, in_state, only};

/// Returns the record of a frame, which is number 1.
fn flown() -> FrameRecord {
    let mut bench: Bench = in_state(State::Exposing);
    bench.run(100);
    only(&bench)
}

#[test]
fn exposure_in_doubt_is_unreferenced_and_its_sigma_covers_the_difference() {
    for is_fault in [false, true] {
        let before = flown();
        let mut record = before;
        record.doubt(&InDoubt::between([1, 3], -0.01, is_fault));
        assert!(record.flags.contains(Flag::Unreferenced));
        assert_eq!(record.faults.contains(Fault::Encoder), is_fault);
        let sigma = exposed(&record).principal_point_sigma;
        assert!(sigma.total_mm() >= 0.01, "{sigma:?}");
        assert!(exposed(&before).principal_point_sigma.total_mm() < 0.001);
        assert_eq!(exposed(&record).interior, exposed(&before).interior);
    }
}

#[test]
fn exposure_outside_the_range_and_a_refusal_within_it_stay_as_they_are() {
    let record = flown();
    let mut other = record;
    other.doubt(&InDoubt::between([2, 3], 0.01, true));
    assert_eq!(other, record);
    let refused = FrameRecord {
        outcome: Outcome::Refused(Reason::Fault(Fault::Stall)),
        ..record
    };
    let mut same = refused;
    same.doubt(&InDoubt::between([1, 3], 0.01, true));
    assert_eq!(same, refused);
}

#[test]
fn refusal_for_a_fault_has_the_name_of_the_fault() {
    let reason = Reason::Fault(Fault::Stall);
    assert_eq!(reason.name(), Fault::Stall.name());
    assert_ne!(reason.name(), Reason::Fault(Fault::Drive).name());
}
