//! Bytes between the interrupt that receives them and the main loop.

use core::cell::RefCell;

use critical_section::Mutex;
use heapless::Deque;

/// Room for bytes that wait: the main loop may be away for as long as the link needs to fill it.
const BYTES: usize = 4096;

/// Received bytes in order, and how many found no room.
pub(super) struct Inbox {
    waiting: Mutex<RefCell<Waiting>>,
}

struct Waiting {
    bytes: Deque<u8, BYTES>,
    lost: u32,
}

impl Inbox {
    /// Nothing received yet.
    pub(super) const fn new() -> Self {
        let waiting = Waiting {
            bytes: Deque::new(),
            lost: 0,
        };
        Self {
            waiting: Mutex::new(RefCell::new(waiting)),
        }
    }

    /// Whether another byte can be kept.
    pub(super) fn has_room(&self) -> bool {
        self.with(|waiting| !waiting.bytes.is_full())
            .unwrap_or(false)
    }

    /// Keeps a byte, or counts it where there is no room.
    pub(super) fn push(&self, byte: u8) {
        self.with(|waiting| {
            if waiting.bytes.push_back(byte).is_err() {
                waiting.lost = waiting.lost.saturating_add(1);
            }
        });
    }

    /// Counts a byte that the hardware lost.
    pub(super) fn count_lost(&self) {
        self.with(|waiting| waiting.lost = waiting.lost.saturating_add(1));
    }

    /// The byte that has waited longest.
    pub(super) fn pop(&self) -> Option<u8> {
        self.with(|waiting| waiting.bytes.pop_front()).flatten()
    }

    /// Whether no byte waits.
    pub(super) fn is_empty(&self) -> bool {
        self.with(|waiting| waiting.bytes.is_empty())
            .unwrap_or(true)
    }

    /// Bytes lost since asked last.
    pub(super) fn take_lost(&self) -> u32 {
        self.with(|waiting| core::mem::take(&mut waiting.lost))
            .unwrap_or(0)
    }

    /// `None` only where it is called from within itself, which no method does.
    fn with<T>(&self, act: impl FnOnce(&mut Waiting) -> T) -> Option<T> {
        critical_section::with(|section| {
            let mut waiting = self.waiting.borrow(section).try_borrow_mut().ok()?;
            Some(act(&mut waiting))
        })
    }
}
