//! Memory for the flight that start-up and a reset leave alone: a region of its own, by the linker
//! script of the board.

use core::{cell::UnsafeCell, mem::MaybeUninit};

use fmc_camera::io::link::{flight_memory::FlightMemory, message::ResetCause};

struct Place(UnsafeCell<MaybeUninit<FlightMemory>>);

// SAFETY: it is reached only by `find`, which the start calls once, and then through a shared
// reference to atomic words.
unsafe impl Sync for Place {}

#[unsafe(link_section = ".kept.FLIGHT")]
static PLACE: Place = Place(UnsafeCell::new(MaybeUninit::uninit()));

/// Writes memory that has no contents yet, before anything waits: the start that follows a watchdog
/// reads it.
#[cfg(feature = "board-nucleo-h743zi")]
pub(super) fn forget() {
    let words = PLACE.0.get().cast::<u32>();
    for index in 0..FlightMemory::WORDS {
        // SAFETY: as in `find`, which has not been called yet.
        unsafe { words.add(index).write_volatile(0) }
    }
}

/// Returns the memory, once. After power on it has no contents, and is written before it is read:
/// reading it could fail its error correction.
pub(super) fn find(start: ResetCause) -> &'static FlightMemory {
    let words = PLACE.0.get().cast::<u32>();
    for index in 0..FlightMemory::WORDS {
        // SAFETY: the place is an array of as many words, which nothing else reaches yet. Any bits
        // are a valid u32; the volatile read returns those in the memory, whatever wrote them, and
        // the write makes them a value of this program.
        unsafe {
            let word = words.add(index);
            let found = match start {
                ResetCause::PowerOn => 0,
                _ => word.read_volatile(),
            };
            word.write_volatile(found);
        }
    }
    // SAFETY: every word has been written, and atomic words are valid with all bits.
    unsafe { (*PLACE.0.get()).assume_init_ref() }
}
