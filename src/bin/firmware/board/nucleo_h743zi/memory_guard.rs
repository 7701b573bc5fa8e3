//! Memory that the firmware never reaches: a stray access is a fault of the processor at once.
//!
//! Numbers of the registers are those of the ARMv7-M manual (DDI 0403E), section B3.5.

use cortex_m::{asm, peripheral::MPU};

/// Enables the regions, and the default map for what they leave out.
const ENABLE: u32 = 1 | 1 << 2;

/// Attributes of a region: the processor does not execute from it; access; kind of memory.
const NO_CODE: u32 = 1 << 28;
const NO_ACCESS: u32 = 0;
const ALL_ACCESS: u32 = 0b011 << 24;
const READ_ONLY: u32 = 0b110 << 24;
/// As the default map has flash (written through) and memory (written back, allocated).
const FLASH: u32 = 1 << 17;
const MEMORY: u32 = 1 << 19 | 1 << 17 | 1 << 16;

/// Eighths of the address space that stay as they are: memories and peripherals of the chip below
/// `0x6000_0000`, and the processor's own registers above `0xE000_0000`.
const CHIP: u32 = 0b1000_0111 << 8;

/// Bytes of the guard below the stack, as `memory.x` leaves them.
const GUARD_BYTES: u32 = 1024;

unsafe extern "C" {
    /// Lowest address of the guard, by the linker script.
    static _stack_guard: u32;
}

/// Returns size and enable of a region, a power of 2 of bytes.
const fn size(bytes: u64) -> u32 {
    assert!(bytes.is_power_of_two() && bytes >= 32);
    (bytes.trailing_zeros() - 1) << 1 | 1
}

/// Switches the protection on. A later region comes before an earlier one.
pub(super) fn start(mpu: &mut MPU) {
    let guard = (&raw const _stack_guard).addr();
    let regions = [
        // No memory is connected outside, and the processor must not look for it either.
        (0, NO_ACCESS | NO_CODE | CHIP | const { size(1 << 32) }),
        // Null pointers, and jumps through them: the memory there is not used.
        (0, NO_ACCESS | NO_CODE | const { size(64 << 10) }),
        // The first bank of the flash, in which the image is.
        (0x0800_0000, READ_ONLY | FLASH | const { size(1 << 20) }),
        // Data are never executed.
        (
            0x2000_0000,
            ALL_ACCESS | NO_CODE | MEMORY | const { size(512 << 20) },
        ),
        (
            u32::try_from(guard).unwrap_or(0),
            NO_ACCESS | NO_CODE | const { size(GUARD_BYTES as u64) },
        ),
    ];
    for (number, (base, attributes)) in (0..).zip(regions) {
        // SAFETY: no region takes memory away that the firmware uses, or changes its kind.
        unsafe {
            mpu.rnr.write(number);
            mpu.rbar.write(base);
            mpu.rasr.write(attributes);
        }
    }
    asm::dmb();
    // SAFETY: as above.
    unsafe { mpu.ctrl.write(ENABLE) };
    asm::dsb();
    asm::isb();
}
