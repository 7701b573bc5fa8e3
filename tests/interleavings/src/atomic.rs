//! Atomics of the model checker that a constant can hold, as those of `core`.
//!
//! They are made at their first use. That has to be before another thread uses them, or the model
//! checker takes it for a race.

use std::sync::{Mutex, OnceLock};

use loom::cell::UnsafeCell;
use loom::sync::atomic;
pub use loom::sync::atomic::Ordering;
use loom::thread::{self, ThreadId};

/// A number that both sides read and write.
#[derive(Debug, Default)]
pub struct Atomic<T, A> {
    first: T,
    modelled: OnceLock<A>,
}

pub type AtomicU32 = Atomic<u32, atomic::AtomicU32>;

impl<T, A> Atomic<T, A> {
    pub const fn new(first: T) -> Self {
        Self {
            first,
            modelled: OnceLock::new(),
        }
    }
}

impl AtomicU32 {
    fn modelled(&self) -> &atomic::AtomicU32 {
        self.modelled
            .get_or_init(|| atomic::AtomicU32::new(self.first))
    }

    pub fn load(&self, order: Ordering) -> u32 {
        self.modelled().load(order)
    }

    pub fn store(&self, value: u32, order: Ordering) {
        self.modelled().store(value, order);
    }

    pub fn fetch_add(&self, value: u32, order: Ordering) -> u32 {
        self.modelled().fetch_add(value, order)
    }

    pub fn swap(&self, value: u32, order: Ordering) -> u32 {
        self.modelled().swap(value, order)
    }
}

/// A counter of a ring, which one side writes and the other reads.
///
/// The model checker compares a step with the last access alone. The writer's look at its own
/// counter would hide that of the reader before it, and the order in which the writer is first
/// would not be tried. So a side that has written last, and can only find that, is told it without
/// a look; all other looks take turns, which order nothing else (`Relaxed`).
#[derive(Debug)]
pub struct AtomicUsize {
    number: Atomic<usize, atomic::AtomicUsize>,
    last: Mutex<Option<(ThreadId, usize)>>,
}

loom::lazy_static! {
    static ref TURNS: atomic::AtomicUsize = atomic::AtomicUsize::new(0);
}

impl AtomicUsize {
    pub const fn new(first: usize) -> Self {
        Self {
            number: Atomic::new(first),
            last: Mutex::new(None),
        }
    }

    fn modelled(&self) -> &atomic::AtomicUsize {
        let number = &self.number;
        number
            .modelled
            .get_or_init(|| atomic::AtomicUsize::new(number.first))
    }

    pub fn load(&self, order: Ordering) -> usize {
        let last = *self.last.lock().unwrap();
        match last {
            Some((thread, value)) if thread == thread::current().id() => value,
            _ => {
                TURNS.fetch_add(1, Ordering::Relaxed);
                self.modelled().load(order)
            }
        }
    }

    pub fn store(&self, value: usize, order: Ordering) {
        self.modelled().store(value, order);
        *self.last.lock().unwrap() = Some((thread::current().id(), value));
    }
}

/// The place of a byte in a ring. Writer and reader must never use it at one time, which the model
/// checker takes for a race though it were none: the order of the ring's counters alone is to keep
/// them apart.
#[derive(Debug)]
pub struct AtomicU8 {
    byte: Atomic<u8, atomic::AtomicU8>,
    use_of_it: OnceLock<UnsafeCell<()>>,
}

// SAFETY: the cell holds nothing, and is there for the model checker to see who uses it; its
// threads run one after the other.
unsafe impl Sync for AtomicU8 {}

impl AtomicU8 {
    pub const fn new(first: u8) -> Self {
        Self {
            byte: Atomic::new(first),
            use_of_it: OnceLock::new(),
        }
    }

    fn modelled(&self) -> (&atomic::AtomicU8, &UnsafeCell<()>) {
        let byte = &self.byte;
        (
            byte.modelled
                .get_or_init(|| atomic::AtomicU8::new(byte.first)),
            self.use_of_it.get_or_init(|| UnsafeCell::new(())),
        )
    }

    pub fn load(&self, order: Ordering) -> u8 {
        let (byte, use_of_it) = self.modelled();
        use_of_it.with(|_| ());
        byte.load(order)
    }

    pub fn store(&self, value: u8, order: Ordering) {
        let (byte, use_of_it) = self.modelled();
        use_of_it.with_mut(|_| ());
        byte.store(value, order);
    }
}
