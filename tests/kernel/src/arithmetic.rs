//! The arithmetic that a core has for slices.

use core::arch::asm;
use core::hint::black_box;

/// How numbers below 2⁻¹²⁶ (subnormal) count.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Arithmetic {
    /// As what they are: IEEE 754.
    Gradual,
    /// As zero: Helium's vectors, whatever FPSCR says (Armv8-M Architecture Reference Manual, DDI 0553, standard FPSCR
    /// value).
    Flushing,
}

/// That of the kernels that are compared.
pub(crate) const OF_KERNEL: Arithmetic = if cfg!(mps2) {
    Arithmetic::Gradual
} else {
    Arithmetic::Flushing
};

/// FZ and DN of FPSCR: subnormal numbers count as zero, one NaN for all.
const FLUSHING: u32 = 0b11 << 24;

impl Arithmetic {
    /// Does work on single numbers in this arithmetic; it must take what it works on from a black box.
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
    // SAFETY: reads a register.
    unsafe { asm!("vmrs {}, fpscr", out(reg) value) };
    value
}

fn set_fpscr(value: u32) {
    // SAFETY: changes how numbers below 2⁻¹²⁶ and NaN are treated, which no other code here rests on.
    unsafe { asm!("vmsr fpscr, {}", in(reg) value) };
}
