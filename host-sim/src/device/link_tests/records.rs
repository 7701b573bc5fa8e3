//! Frame records that are fetched and acknowledged.

use fmc_camera::flight::event::Event;
use fmc_camera::flight::rig::RigStep;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::message::Refusal;

use super::{camera, link_error};
use crate::device::FlyingDevice;
use crate::device::faulty_port::FaultyPort;
use crate::device::link_error::LinkError;
use crate::device::remote::{Remote, Session};

/// Returns a camera that keeps the records of so many triggers, refused since it is not armed.
fn triggered(triggers: u64) -> Remote<FaultyPort> {
    let mut remote = Remote::connect("test", FaultyPort::new([]), Session::Whole).unwrap();
    remote
        .prepare(&camera(), &FlightSettings::default())
        .unwrap();
    for trigger in 1..=triggers {
        let time = Time::from_us(1000 * trigger);
        let mut step = RigStep {
            time,
            ..RigStep::default()
        };
        step.events.push((time, Event::Trigger)).unwrap();
        remote.step(&step).unwrap();
    }
    remote
}

#[test]
fn record_that_was_not_fetched_as_it_is_kept_is_not_forgotten() {
    let mut remote = triggered(3);
    let refused = |remote: &mut Remote<FaultyPort>, through| {
        let error = link_error(remote.acknowledge_records(through));
        let sequence = through;
        assert!(
            matches!(error, LinkError::Refused { refusal: Refusal::NotFetched { sequence: named }, .. } if named == sequence),
            "{error:?}"
        );
    };
    refused(&mut remote, 3);
    assert_eq!(remote.fetch_record(0).unwrap().unwrap().sequence, 1);
    // The first is safe; the others are still there.
    refused(&mut remote, 3);
    assert_eq!(remote.fetch_record(0).unwrap().unwrap().sequence, 2);
}

#[test]
fn all_that_was_fetched_is_acknowledged_before_a_record_that_is_refused() {
    let mut remote = triggered(2);
    for sequence in [1, 2] {
        assert!(remote.fetch_record(sequence).unwrap().is_some());
    }
    // The camera keeps no third record: both before it are acknowledged, the newest first.
    assert_eq!(remote.acknowledge_records(3).unwrap(), 0);
    assert_eq!(remote.fetch_record(0).unwrap(), None);
}
