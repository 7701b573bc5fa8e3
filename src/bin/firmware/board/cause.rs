//! Cause of the firmware's start, in a word of memory that start-up leaves unchanged.

use core::{cell::UnsafeCell, mem::MaybeUninit};

use fmc_camera::io::link::message::ResetCause;

struct Word(UnsafeCell<MaybeUninit<u32>>);

// SAFETY: the word is reached only by the volatile accesses below, each a single load or store.
unsafe impl Sync for Word {}

#[unsafe(link_section = ".uninit.CAUSE")]
static WORD: Word = Word(UnsafeCell::new(MaybeUninit::uninit()));

/// Values that are unlikely to be in memory when power comes on.
const WORDS: [(u32, ResetCause); 4] = [
    (0x5ca1_ab1e, ResetCause::Requested),
    (0xba5e_ba11, ResetCause::Watchdog),
    (0xdead_fa11, ResetCause::Fault),
    (0x0f10_057a, ResetCause::StackOverflow),
];

/// Bits of the word that say that rounds of the control loop came until it was noted.
const PUNCTUAL: u32 = 0x0180_0000;

/// Returns the cause noted before the reset, and forgets it.
pub(super) fn take() -> ResetCause {
    let start = noted();
    write(0);
    start
}

/// Returns the last noted cause: power on, if the value is none of the noted ones.
pub(super) fn noted() -> ResetCause {
    let found = read();
    let known = WORDS.iter().find(|(word, _)| is_of(*word, found));
    known.map_or(ResetCause::PowerOn, |(_, start)| *start)
}

/// Returns `true` if a noted word is that of a cause.
const fn is_of(word: u32, found: u32) -> bool {
    found == word || found == word ^ PUNCTUAL
}

/// Returns `true` if rounds of the control loop came until the cause was noted.
#[cfg(feature = "board-nucleo-h743zi")]
pub(super) fn is_punctual() -> bool {
    let found = read();
    WORDS.iter().any(|(word, _)| word ^ PUNCTUAL == found)
}

/// Forgets the present content of the memory.
#[cfg(feature = "board-nucleo-h743zi")]
pub(super) fn forget() {
    write(0);
}

/// Notes the cause of the reset that follows.
pub(super) fn note(start: ResetCause) {
    write(word_of(start));
}

/// Notes the cause of a reset that follows at once, while rounds of the control loop come.
#[cfg(feature = "board-nucleo-h743zi")]
pub(super) fn note_punctual(start: ResetCause) {
    write(word_of(start) ^ PUNCTUAL);
}

fn word_of(start: ResetCause) -> u32 {
    let known = WORDS.iter().find(|(_, known)| *known == start);
    known.map_or(0, |(word, _)| *word)
}

fn read() -> u32 {
    // SAFETY: the address is that of the static, aligned and never written by Rust's own code. Any
    // bits are a valid u32, and a volatile read returns those in the memory, whatever wrote them.
    unsafe { WORD.0.get().cast::<u32>().read_volatile() }
}

fn write(word: u32) {
    // SAFETY: as above.
    unsafe { WORD.0.get().cast::<u32>().write_volatile(word) }
}
