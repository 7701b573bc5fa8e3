//! Requests that are repeated because their answer was lost.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera::io::link::message::{Answer, Ending, Header, Refusal, Request};
use fmc_camera::io::link::station::LinkEvent;

use crate::link::pc::{Pc, SESSION};
use crate::link::targets::wire_format::frame_of;

const EXPOSURE: Exposure = Exposure::new(0.17, 1.0 / 200.0);

/// Returns the header of the next request of the session.
fn next(pc: &Pc) -> Header {
    Header {
        session: SESSION,
        sequence: pc.next,
    }
}

#[test]
fn request_that_comes_again_is_answered_again_and_not_acted_on_again() {
    let mut pc = Pc::loaded();
    let header = Header {
        session: SESSION,
        sequence: pc.next,
    };
    let first = pc.ask_as(header, &Request::Expose(EXPOSURE));
    let done = pc.station.counters().done;
    // The same number with other contents gets the answer from memory.
    let again = pc.ask_as(header, &Request::Expose(Exposure::new(0.05, 0.01)));
    assert_eq!(again, first);
    assert_eq!(pc.event, Some(LinkEvent::Repeated));
    let counters = pc.station.counters();
    assert_eq!((counters.done, counters.repeated), (done, 1));
}

#[test]
fn answer_survives_what_others_ask_meanwhile() {
    let stranger = Header {
        session: 99,
        sequence: 4,
    };
    let mut pc = Pc::loaded();
    let header = next(&pc);
    let first = pc.ask_as(header, &Request::Expose(EXPOSURE));
    assert_eq!(
        pc.ask_as(stranger, &Request::Counters),
        Answer::Refused(Refusal::OtherSession)
    );
    // This frame is of another version of the protocol.
    assert_eq!(pc.send(&frame_of(&[2, 9, 9])).len(), 1);
    assert_eq!(pc.ask_as(header, &Request::Expose(EXPOSURE)), first);
    // The frame still belongs to the session.
    pc.next += 1;
    assert_eq!(pc.ask(&Request::InteriorOrientation), first);
}

#[test]
fn connecting_under_a_header_that_was_refused_is_not_refused() {
    let mut pc = Pc::unconnected();
    let header = next(&pc);
    assert_eq!(
        pc.ask_as(header, &Request::Counters),
        Answer::Refused(Refusal::OtherSession)
    );
    let answer = pc.ask_as(header, &Request::Connect);
    assert!(matches!(answer, Answer::Connected(_)), "{answer:?}");
}

#[test]
fn ending_that_is_asked_for_again_is_only_answered_again() {
    for request in [
        Request::Reset(Ending::Orderly),
        Request::PowerOff(Ending::Orderly),
    ] {
        let mut pc = Pc::connected();
        let header = next(&pc);
        pc.ask_as(header, &request);
        assert_eq!(pc.ask_as(header, &request), Answer::Ending);
        assert_eq!(pc.event, Some(LinkEvent::Repeated));
    }
}
