//! Faults of the wire: every result is right, or an error.

use fmc_camera::flight::exposure::Exposure;
use proptest::prelude::*;

use super::{camera, exposed, grid, link_error, points};
use crate::device::client::TRIES;
use crate::device::error::DeviceError;
use crate::device::faulty_port::{Fault, FaultyPort};
use crate::device::link_error::LinkError;
use crate::device::remote::{Remote, Session};
use crate::device::{CorrectingDevice, Device, InProcess};

#[test]
fn request_is_given_up_after_the_documented_tries_and_nothing_follows() {
    let (mut remote, port) = exposed();
    port.set_faults([Fault::Lost; TRIES as usize]);
    let LinkError::NoAnswer { tries, heard, .. } = link_error(remote.interior_orientation()) else {
        panic!();
    };
    assert_eq!((tries, heard.bytes), (TRIES, 0));
    // The wire is free of faults again, but what the camera did meanwhile is not known.
    assert!(matches!(
        link_error(remote.interior_orientation()),
        LinkError::NoAnswer { .. }
    ));
    remote.reconnect().unwrap();
    port.set_faults([Fault::Lost; TRIES as usize - 1]);
    remote.counters().unwrap().unwrap();
}

#[test]
fn lost_answer_is_given_again_without_acting_twice() {
    let (mut remote, port) = exposed();
    let before = remote.counters().unwrap().unwrap();
    // The request arrives and the answer is lost, twice.
    port.set_faults([Fault::None, Fault::Lost, Fault::None, Fault::Lost]);
    remote.correct(&points(10)).unwrap();
    let after = remote.counters().unwrap().unwrap();
    assert_eq!(after.done - before.done, 2);
    assert_eq!(after.repeated - before.repeated, 2);
}

fn fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        12 => Just(Fault::None),
        2 => Just(Fault::Lost),
        2 => (any::<usize>(), 1_u8..).prop_map(|(at, bits)| Fault::Corrupted { at, bits }),
        2 => any::<u8>().prop_map(Fault::Truncated),
        2 => Just(Fault::Duplicated),
        2 => (1_u8..12).prop_map(Fault::Delayed),
        2 => (1_u8..12).prop_map(Fault::Echoed),
        1 => Just(Fault::Restart),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_result_is_right_or_an_error(faults in proptest::collection::vec(fault(), 0..80)) {
        let port = FaultyPort::new(faults);
        let Ok(mut remote) = Remote::connect("test", port, Session::Whole) else {
            return Ok(());
        };
        let mut twin = InProcess::default();
        twin.load(&camera()).unwrap();
        let points = points(100);
        for vh in [0.06, 0.1, 0.16] {
            let exposure = Exposure::new(vh, 0.005);
            let record = twin.expose(&exposure).unwrap();
            let answers = (|| {
                remote.load(&camera())?;
                let record = remote.expose(&exposure)?;
                let corrected = remote.correct(&points)?;
                let distorted = remote.distort(&points)?;
                let gridded = remote.correct_grid(&grid())?;
                Ok((record, corrected, distorted, gridded))
            })();
            match answers {
                Ok(answers) => {
                    let expected = (
                        record,
                        twin.correct(&points).unwrap(),
                        twin.distort(&points).unwrap(),
                        twin.correct_grid(&grid()).unwrap(),
                    );
                    prop_assert_eq!(answers, expected);
                }
                // Faults of the wire may end the session, but no answer may be taken for that to
                // another request.
                Err(DeviceError::Link { .. } | DeviceError::NoFrame) => {
                    let _ = remote.reconnect();
                }
                Err(other) => prop_assert!(false, "{}", other),
            }
        }
    }
}
