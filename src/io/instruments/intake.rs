//! Bytes of one wire that wait for the next round.

use heapless::Deque;

/// Bytes of one wire that a round of the control loop takes at most: a round of 1 ms carries 11.5
/// at 115,200 baud, the fastest that a wire may have.
pub const BYTES_PER_ROUND: usize = 16;

/// Bytes that may wait on one wire: those of four rounds, for a loop that comes round late. Further
/// bytes are dropped and counted.
pub const WAITING_BYTES: usize = 4 * BYTES_PER_ROUND;

/// Bytes of one wire, in order.
#[derive(Debug, Clone, Default)]
pub(super) struct Intake {
    waiting: Deque<u8, WAITING_BYTES>,
    taken: usize,
}

impl Intake {
    pub(super) const fn new() -> Self {
        Self {
            waiting: Deque::new(),
            taken: 0,
        }
    }

    /// Keeps a byte; returns false without room for it.
    pub(super) fn keep(&mut self, byte: u8) -> bool {
        self.waiting.push_back(byte).is_ok()
    }

    /// Begins a round, which may take [`BYTES_PER_ROUND`].
    pub(super) const fn begin_round(&mut self) {
        self.taken = 0;
    }

    /// Returns the oldest byte, if the round may take another.
    pub(super) fn take(&mut self) -> Option<u8> {
        if self.taken >= BYTES_PER_ROUND {
            return None;
        }
        self.taken += 1;
        self.waiting.pop_front()
    }
}
