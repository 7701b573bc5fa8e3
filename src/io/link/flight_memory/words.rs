//! Words of memory whose every store is carried out, in its order.
//!
//! They are atomic because the reader of a store is the next start of the program, which a compiler
//! does not know of.

use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

/// Returns a word; 0 behind the last.
pub(super) fn load(words: &[AtomicU32], at: usize) -> u32 {
    let word = words.get(at);
    word.map_or(0, |word| word.load(Ordering::Relaxed))
}

/// Writes a word, unless behind the last.
pub(super) fn store(words: &[AtomicU32], at: usize, value: u32) {
    #[cfg(test)]
    if !reset::takes_place() {
        return;
    }
    if let Some(word) = words.get(at) {
        word.store(value, Ordering::Relaxed);
    }
}

/// Ends a step of writing: its stores are in memory before those that follow.
pub(super) fn settle() {
    compiler_fence(Ordering::SeqCst);
}

/// Resets between two stores, for tests.
#[cfg(test)]
pub(super) mod reset {
    use std::cell::Cell;

    std::thread_local! {
        static STORES_LEFT: Cell<Option<u32>> = const { Cell::new(None) };
    }

    /// Lets so many stores of this thread take place and no more; all with `None`.
    pub(in super::super) fn after(stores: Option<u32>) {
        STORES_LEFT.set(stores);
    }

    /// Counts a store. Returns `true` if it takes place.
    pub(super) fn takes_place() -> bool {
        let left = STORES_LEFT.get();
        STORES_LEFT.set(left.map(|left| left.saturating_sub(1)));
        left != Some(0)
    }

    /// Stores that are left; 0 after the reset.
    pub(in super::super) fn left() -> Option<u32> {
        STORES_LEFT.get()
    }
}
