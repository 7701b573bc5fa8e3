//! Arithmetic of a core's instructions for slices.

use core::arch::asm;
use core::hint::black_box;

/// Treatment of numbers below 2⁻¹²⁶ (subnormal).
#[derive(Clone, Copy, Debug)]
pub(crate) enum Arithmetic {
    /// Subnormal numbers keep their values: IEEE 754.
    Gradual,
    /// Subnormal numbers count as zero: Helium's vectors, for every value of FPSCR (Armv8-M
    /// Architecture Reference Manual, DDI 0553, standard FPSCR value).
    Flushing,
}

/// Arithmetic of the kernels that are compared.
pub(crate) const OF_KERNEL: Arithmetic = if cfg!(mps2) {
    Arithmetic::Gradual
} else {
    Arithmetic::Flushing
};

/// FZ and DN of FPSCR: subnormal numbers count as zero, and every NaN becomes the default one.
const FLUSHING: u32 = 0b11 << 24;

impl Arithmetic {
    /// Does work on single numbers in this arithmetic; it must read its numbers through a black
    /// box.
    pub(crate) fn run(self, work: impl FnOnce()) {
        match self {
            Self::Gradual => work(),
            Self::Flushing => {
                let before = fpscr();
                set_fpscr(before | FLUSHING);
                work();
                set_fpscr(black_box(before));
            }
        }
    }
}

fn fpscr() -> u32 {
    let value;
    // SAFETY: the instruction only reads a register.
    unsafe { asm!("vmrs {}, fpscr", out(reg) value) };
    value
}

fn set_fpscr(value: u32) {
    // SAFETY: the change affects only numbers below 2⁻¹²⁶ and NaN, on which no other code here
    // relies.
    unsafe { asm!("vmsr fpscr, {}", in(reg) value) };
}
