//! Frames in which nothing goes wrong.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::fault::Faults;
use fmc_camera::flight::frame_record::{Flags, Outcome};

use crate::bench::Bench;

#[test]
fn trigger_leads_through_all_states_to_a_measured_record() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    let mut states = vec![bench.controller.state()];
    for _ in 0..200 {
        bench.round();
        if states.last() != Some(&bench.controller.state()) {
            states.push(bench.controller.state());
        }
    }
    assert_eq!(
        states,
        [
            State::RunUp,
            State::Tracking,
            State::Exposing,
            State::FlyBack,
            State::Armed
        ]
    );
    let [record] = bench.records()[..] else {
        panic!("one record");
    };
    assert_eq!((record.sequence, record.faults), (1, Faults::NONE));
    assert_eq!(record.flags, Flags::NONE);
    let Outcome::Exposed(frame) = record.outcome else {
        panic!("{record:?}");
    };
    // 10 mm/s for 1/300 s, centred: 33.3 µm about the calibrated principal point.
    let motion = frame.interior.motion;
    assert!((motion.travel_mm - 0.0333).abs() < 2e-4, "{motion:?}");
    assert!(motion.centroid_mm.abs() < 2e-5, "{motion:?}");
    // σ of V/H given directly: 0.0005 1/s of 0.1 1/s, 0.5 % of 33.3 µm.
    assert!((frame.smear_px - 0.019).abs() < 0.002, "{}", frame.smear_px);
    assert!(frame.principal_point_sigma_mm < 5e-5);
}
