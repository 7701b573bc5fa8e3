//! The stack: its depth, since start-up paints its memory and every word that lost its paint was
//! used, and the guard below it.

use core::ops::Range;

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// Lowest address of the guard, by the linker script.
    static _stack_guard: u32;
    /// Lowest address, which the guard ends at.
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

/// Addresses of the guard.
pub(super) fn guard() -> Range<usize> {
    (&raw const _stack_guard).addr()..(&raw const _stack_end).addr()
}

/// Returns the word at an index above the stack pointer, if both are on the stack.
pub(super) fn word(stack_pointer: usize, index: usize) -> Option<u32> {
    let stack = (&raw const _stack_end).addr()..(&raw const _stack_start).addr();
    let address = stack_pointer.checked_add(size_of::<u32>().checked_mul(index)?)?;
    let is_readable = stack.contains(&stack_pointer)
        && stack.contains(&address)
        && address.is_multiple_of(size_of::<u32>());
    // SAFETY: the word is aligned, and is the stack's memory; a volatile read returns its content.
    is_readable.then(|| unsafe { (address as *const u32).read_volatile() })
}
