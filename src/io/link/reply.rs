//! The packets that the camera sends: the kept answer, and refusals beside it.

use heapless::Vec;

use super::LONGEST_READING;
use super::contents::Contents;
use super::message::{self, Answer, Header, Refusal};
use super::packet::Packet;

/// The packet that is on its way, of two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Which {
    /// The answer to the last request of the session.
    Answer,
    /// The refusal of a message that is not the next of the session, or an answer of a session for
    /// reading.
    Aside,
}

/// The packets that the camera sends. An answer is written from where its contents lie.
#[derive(Debug)]
pub(super) struct Reply {
    /// The request to which the kept answer belongs.
    kept: Option<Header>,
    answer: Packet,
    /// The packet of [`Which::Aside`]: the answer stays meanwhile, and can be asked for again.
    aside: Vec<u8, LONGEST_READING>,
    which: Which,
    sent: usize,
}

impl Reply {
    /// No packet.
    pub(super) const NONE: Self = Self {
        kept: None,
        answer: Packet::EMPTY,
        aside: Vec::new(),
        which: Which::Answer,
        sent: 0,
    };

    /// Sends an answer. Neither this function nor the next is generic, so that a board's program
    /// has the code that writes answers once.
    pub(super) fn send(&mut self, header: Header, answer: &Answer) {
        self.which = Which::Answer;
        self.sent = 0;
        self.kept = answer.write(header, &mut self.answer).map(|()| header);
    }

    /// Sends contents as their answer.
    pub(super) fn send_contents(&mut self, header: Header, contents: &Contents<'_>) {
        self.which = Which::Answer;
        self.sent = 0;
        self.kept = message::write(contents, header, &mut self.answer).map(|()| header);
    }

    /// Returns true if the kept answer belongs to this request.
    pub(super) fn is_kept(&self, header: Header) -> bool {
        self.kept == Some(header)
    }

    /// Sends the kept answer again; returns false if it belongs to another request.
    pub(super) fn send_again(&mut self, header: Header) -> bool {
        let is_kept = self.is_kept(header);
        if is_kept {
            self.which = Which::Answer;
            self.sent = 0;
        }
        is_kept
    }

    /// Sends a refusal that is not an answer within the session.
    pub(super) fn refuse_aside(&mut self, header: Header, refusal: Refusal) {
        self.send_aside(header, &Answer::Refused(refusal));
    }

    /// Sends an answer that is not kept.
    #[inline(never)]
    pub(super) fn send_aside(&mut self, header: Header, answer: &Answer) {
        self.which = Which::Aside;
        self.sent = 0;
        self.aside.clear();
        let mut packet = Packet::EMPTY;
        // All that are sent so fit.
        if answer.write(header, &mut packet).is_some() {
            let _ = self.aside.extend_from_slice(packet.bytes());
        }
    }

    /// The bytes that are left to be sent.
    pub(super) fn to_send(&self) -> &[u8] {
        let bytes = match self.which {
            Which::Answer => self.answer.bytes(),
            Which::Aside => &self.aside,
        };
        bytes.get(self.sent..).unwrap_or_default()
    }

    /// Notes that a number of bytes of [`Self::to_send`] are on their way.
    pub(super) fn note_sent(&mut self, bytes: usize) {
        self.sent = self.sent.saturating_add(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::link::packet::PacketReceiver;

    #[test]
    fn every_refusal_aside_fits_whatever_its_numbers() {
        let header = Header {
            session: u32::MAX,
            sequence: u16::MAX,
        };
        let expected = u16::MAX;
        for refusal in [
            Refusal::OtherProtocol,
            Refusal::OtherSession,
            Refusal::OutOfOrder { expected },
        ] {
            let mut reply = Reply::NONE;
            reply.refuse_aside(header, refusal);
            let mut receiver = PacketReceiver::new();
            let bytes = reply.to_send().to_vec();
            let mut received = bytes.iter().filter_map(|byte| {
                let payload = receiver.receive(*byte)?;
                Some(Answer::read(payload.unwrap()))
            });
            let answer = received.next().unwrap();
            assert_eq!(answer, Ok((header, Some(Answer::Refused(refusal)))));
        }
    }
}
