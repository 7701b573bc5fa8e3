//! Depth of the stack: start-up paints its memory, and every word that lost its paint was used.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// Lowest address, by the linker script.
    static _stack_end: u32;
    /// Just above the highest.
    static _stack_start: u32;
}

/// Bytes between the highest address and the lowest that has lost its paint.
pub(super) fn used_bytes() -> u32 {
    let (lowest, end) = (&raw const _stack_end, &raw const _stack_start);
    let mut address = lowest;
    // SAFETY: all words between the two symbols are the stack's memory, readable, and painted by
    // start-up; a volatile read of a word in use returns its content.
    while address < end && unsafe { address.read_volatile() } == STACK_PAINT_VALUE {
        address = address.wrapping_add(1);
    }
    u32::try_from(end.addr() - address.addr()).unwrap_or(u32::MAX)
}
