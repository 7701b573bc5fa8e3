//! Memory that the firmware never reaches: a stray access is a fault of the processor at once.
//!
//! The memory below the stack is so on every board; a board may add regions. Numbers of the
//! registers are those of the ARMv7-M manual (DDI 0403E), section B3.5. In the handlers of a hard
//! fault and of the non-maskable interrupt the protection is off.

use cortex_m::{asm, peripheral::MPU};

use super::stack;

/// Enables the regions, and the default map for what they leave out.
const ENABLE: u32 = 1 | 1 << 2;

/// Attributes of a region: the processor does not execute from it, and has no access.
pub(super) const NO_CODE: u32 = 1 << 28;
pub(super) const NO_ACCESS: u32 = 0;

/// Bytes of the guard below the stack, as `memory.x` leaves them.
const GUARD_BYTES: u32 = 1024;

/// Returns size and enable of a region, a power of 2 of bytes.
pub(super) const fn size(bytes: u64) -> u32 {
    assert!(bytes.is_power_of_two() && bytes >= 32);
    (bytes.trailing_zeros() - 1) << 1 | 1
}

/// Switches the protection on: addresses and attributes of the board's regions, of which a later
/// one takes precedence, and the guard below the stack.
pub(super) fn start<const N: usize>(mpu: &mut MPU, regions: [(u32, u32); N]) {
    let guard = u32::try_from(stack::guard().start).unwrap_or(0);
    let guard = (
        guard,
        NO_ACCESS | NO_CODE | const { size(GUARD_BYTES as u64) },
    );
    for (number, (base, attributes)) in (0..).zip(regions.into_iter().chain([guard])) {
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

/// Gives the board's region with this number other attributes, once what was begun under the old
/// ones is done.
#[cfg(feature = "board-nucleo-h743zi")]
pub(super) fn change(number: u32, attributes: u32) {
    asm::dsb();
    // SAFETY: as above; the main loop alone comes here, and no handler uses the registers.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rnr.write(number);
        mpu.rasr.write(attributes);
    }
    asm::dsb();
    asm::isb();
}
