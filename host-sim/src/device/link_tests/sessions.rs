//! Sessions: their beginning, and what ends them.

use fmc_camera::io::link::message::{Answer, Ending, Refusal, ResetCause};

use super::{EXPOSURE, camera, exposed, link_error, points};
use crate::device::CorrectingDevice;
use crate::device::client::Client;
use crate::device::error::DeviceError;
use crate::device::faulty_port::{Fault, FaultyPort};
use crate::device::link_error::LinkError;
use crate::device::remote::{Remote, Session};

#[test]
fn second_host_takes_the_session_and_the_first_is_told() {
    let (mut first, port) = exposed();
    let mut second = Remote::connect("second", port.another(), Session::Whole).unwrap();
    assert_eq!(
        link_error(first.correct(&points(3))),
        LinkError::SessionEnded
    );
    // The calibration belongs to the camera and stays; the frame belonged to the first host.
    assert_eq!(second.correct(&points(3)), Err(DeviceError::NoFrame));
    second.load(&camera()).unwrap();
    second.expose(&EXPOSURE).unwrap();
    second.correct(&points(100)).unwrap();
    assert_eq!(
        link_error(first.interior_orientation()),
        LinkError::SessionEnded
    );
    first.reconnect().unwrap();
    first.load(&camera()).unwrap();
    assert_eq!(
        link_error(second.interior_orientation()),
        LinkError::SessionEnded
    );
}

#[test]
fn restart_of_the_camera_ends_the_session_and_a_new_one_starts_afresh() {
    let (mut remote, port) = exposed();
    assert_eq!(remote.identity().reset_cause, ResetCause::PowerOn);
    port.restart();
    let error = remote.correct(&points(3)).unwrap_err();
    assert!(error.to_string().contains("has restarted"), "{error}");
    remote.reconnect().unwrap();
    assert_eq!(remote.identity().reset_cause, ResetCause::Watchdog);
    assert_eq!(remote.identity().calibration, None);
    assert_eq!(remote.correct(&points(3)), Err(DeviceError::NoFrame));
}

#[test]
fn reset_starts_the_camera_again() {
    let (mut remote, _) = exposed();
    remote.reset().unwrap();
    assert_eq!(remote.identity().reset_cause, ResetCause::Requested);
    assert_eq!(remote.expose(&EXPOSURE), Err(DeviceError::NoFrame));
    assert_eq!(remote.counters().unwrap().unwrap().done, 1);
}

#[test]
fn reset_whose_answer_is_lost_is_still_a_reset() {
    let (mut remote, port) = exposed();
    port.set_faults([Fault::None, Fault::Lost]);
    remote.reset().unwrap();
}

#[test]
fn late_answers_of_an_earlier_session_are_ignored() {
    let (mut remote, port) = exposed();
    port.set_faults([Fault::None, Fault::Echoed(1)]);
    remote.counters().unwrap().unwrap();
    port.set_faults([Fault::Lost, Fault::None]);
    remote.reconnect().unwrap();
    remote.load(&camera()).unwrap();
    remote.expose(&EXPOSURE).unwrap();
    remote.correct(&points(10)).unwrap();
}

#[test]
fn connect_after_a_host_that_died_in_the_middle_of_a_batch() {
    let (_, port) = exposed();
    // Half a frame, whose rest never comes.
    port.inject(&[0, 200, 1, 2, 3, 4, 5, 6, 7, 8]);
    let mut next = Remote::connect("next", port.clone(), Session::Whole).unwrap();
    next.load(&camera()).unwrap();
    next.expose(&EXPOSURE).unwrap();
    assert_eq!(next.counters().unwrap().unwrap().truncated, 1);
}

#[test]
fn closed_port_is_an_error_at_once() {
    let (mut remote, port) = exposed();
    port.close();
    assert_eq!(link_error(remote.interior_orientation()), LinkError::Closed);
}

#[test]
fn power_off_ends_the_session() {
    let mut client = Client::new(FaultyPort::new([]));
    client.connect().unwrap();
    client.power_off(Ending::Orderly).unwrap();
    assert_eq!(client.counters(), Err(LinkError::SessionEnded));
}

#[test]
fn request_out_of_order_ends_the_conversation() {
    let (mut remote, port) = exposed();
    port.tamper(|answer| *answer = Answer::Refused(Refusal::OutOfOrder { expected: 9 }));
    let first = link_error(remote.interior_orientation());
    port.tamper(|_| {});
    assert_eq!(link_error(remote.interior_orientation()), first);
}
