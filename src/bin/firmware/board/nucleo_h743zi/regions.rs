//! Regions of the chip's memory that the protection has beside the guard of the stack.

use super::super::memory_guard::{self, NO_ACCESS, NO_CODE, size};

/// Access, and kind of memory.
const ALL_ACCESS: u32 = 0b011 << 24;
const READ_ONLY: u32 = 0b110 << 24;
/// As the default map has flash (written through) and memory (written back, allocated).
const FLASH: u32 = 1 << 17;
const MEMORY: u32 = 1 << 19 | 1 << 17 | 1 << 16;
/// Past the cache, in order, and never ahead of the program: a word of the flash that cannot be
/// read is met by the load that wants it, and a load after a write sees what was written.
const DEVICE: u32 = 1 << 20;
/// Memory that is not cached: what is written is there after a reset.
const UNCACHED: u32 = 1 << 19;

/// Eighths of the address space that stay as they are: memories and peripherals of the chip below
/// `0x6000_0000`, and the processor's own registers above `0xE000_0000`.
const CHIP: u32 = 0b1000_0111 << 8;

/// The second bank of the flash: its address, its place among the regions, and its attributes.
pub(super) const BANK_2: u32 = 0x0810_0000;
pub(super) const BANK_2_BYTES: u32 = 1 << 20;
const BANK_2_REGION: u32 = 3;
const BANK_2_CLOSED: u32 = READ_ONLY | NO_CODE | DEVICE | size(BANK_2_BYTES as u64);
const BANK_2_OPEN: u32 = ALL_ACCESS | NO_CODE | DEVICE | size(BANK_2_BYTES as u64);

/// Lets the second bank be written.
pub(super) fn open_bank_2() {
    memory_guard::change(BANK_2_REGION, BANK_2_OPEN);
}

/// Lets the second bank be read alone, as it is from the start.
pub(super) fn close_bank_2() {
    memory_guard::change(BANK_2_REGION, BANK_2_CLOSED);
}

/// Addresses and attributes.
pub(super) const REGIONS: [(u32, u32); 6] = [
    // No memory is connected outside, and the processor must not look for it either.
    (0, NO_ACCESS | NO_CODE | CHIP | size(1 << 32)),
    // Null pointers, and jumps through them: the memory there is not used.
    (0, NO_ACCESS | NO_CODE | size(64 << 10)),
    // The first bank of the flash, in which the image is.
    (0x0800_0000, READ_ONLY | FLASH | size(1 << 20)),
    // The second, in which calibrations are.
    (BANK_2, BANK_2_CLOSED),
    // Data are never executed.
    (0x2000_0000, ALL_ACCESS | NO_CODE | MEMORY | size(512 << 20)),
    // The flight that outlives a reset.
    (
        0x2400_0000,
        ALL_ACCESS | NO_CODE | UNCACHED | size(16 << 10),
    ),
];
