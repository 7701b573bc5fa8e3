//! Numbers below 1.2e-38: the scalar unit keeps them; vectors of Cortex-M55 take them for zero, before and after every
//! operation (Armv8-M Architecture Reference Manual, standard FPSCR value). Which points are in vectors is the compiler's
//! choice.

/// What the numbers of a comparison may be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// Those of a camera: nothing in between is subnormal.
    OfCameras,
    /// Any.
    Any,
}

/// What `work`, which evaluates one point at a time, gives where subnormal numbers are taken for zero; `None` where the
/// kernel must not do so.
#[cfg(hand_scheduled)]
pub(crate) fn flushed<T>(_: Numbers, _: impl FnOnce() -> T) -> Option<T> {
    None
}

/// What `work`, which evaluates one point at a time, gives where subnormal numbers are taken for zero; `None` where the
/// kernel must not do so.
#[cfg(not(hand_scheduled))]
pub(crate) fn flushed<T>(numbers: Numbers, work: impl FnOnce() -> T) -> Option<T> {
    if numbers == Numbers::OfCameras {
        return None;
    }
    let kept = status();
    set_status(kept | FLUSH_TO_ZERO);
    let result = work();
    set_status(kept);
    Some(result)
}

/// FPSCR.FZ.
#[cfg(not(hand_scheduled))]
const FLUSH_TO_ZERO: u32 = 1 << 24;

#[cfg(not(hand_scheduled))]
fn status() -> u32 {
    let status;
    // SAFETY: it reads a register.
    unsafe { core::arch::asm!("vmrs {}, fpscr", out(reg) status) }
    status
}

#[cfg(not(hand_scheduled))]
fn set_status(status: u32) {
    // SAFETY: it changes what becomes of subnormal numbers, on which no memory access depends.
    unsafe { core::arch::asm!("vmsr fpscr, {}", in(reg) status) }
}
