//! Requests for a round of the control loop, which come a thousand times a second.

use serde::Deserialize as _;

use crate::flight::rig::RigStep;
use crate::io::instruments::WireBytes;

/// Number of `Request::Rig` in a message.
const RIG: u32 = 15;
/// Number of `Request::Wired` in a message.
const WIRED: u32 = 23;

/// Reads a round from the body of a message; `None` if it is another request, or not exactly one.
///
/// A request of any kind takes the room of the longest, and is moved from where it is decoded to
/// where it is kept.
#[inline]
pub(super) fn read(body: &[u8]) -> Option<(RigStep, Option<WireBytes>)> {
    let mut deserializer = postcard::Deserializer::from_bytes(body);
    let kind = u32::deserialize(&mut deserializer).ok()?;
    if kind != RIG && kind != WIRED {
        return None;
    }
    let step = RigStep::deserialize(&mut deserializer).ok()?;
    let sent = if kind == WIRED {
        Some(WireBytes::deserialize(&mut deserializer).ok()?)
    } else {
        None
    };
    let rest = deserializer.finalize().ok()?;
    rest.is_empty().then_some((step, sent))
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;
    use crate::flight::event::{Command, Event};
    use crate::flight::time::Time;
    use crate::io::link::message::Request;

    fn rounds() -> [(RigStep, Option<WireBytes>); 3] {
        let mut step = RigStep {
            time: Time::from_us(1_234_567),
            encoder_count: -70_000,
            ..RigStep::default()
        };
        let silent = step.clone();
        let armed = (step.time, Event::Command(Command::Arm));
        step.events.push(armed).unwrap();
        step.index_count = Some(-3);
        let sent = WireBytes {
            receiver: 300,
            autopilot: 70_000,
        };
        [(silent, None), (step.clone(), None), (step, Some(sent))]
    }

    fn bytes(request: &Request) -> Vec<u8> {
        let mut buffer = [0; 256];
        postcard::to_slice(request, &mut buffer).unwrap().to_vec()
    }

    #[test]
    fn round_is_read_as_its_request_is() {
        for (step, sent) in rounds() {
            let request = match sent {
                None => Request::Rig(step.clone()),
                Some(sent) => Request::Wired(step.clone(), sent),
            };
            let whole = bytes(&request);
            assert_eq!(read(&whole), Some((step, sent)));
            // Cut short, or followed by another byte, it is none.
            for length in 0..whole.len() {
                assert_eq!(read(&whole[..length]), None, "{length} bytes");
            }
            assert_eq!(read(&[&whole[..], &[0]].concat()), None);
        }
    }

    #[test]
    fn other_request_is_none() {
        for request in [Request::Connect, Request::Status, Request::Instruments] {
            assert_eq!(read(&bytes(&request)), None);
        }
    }
}
