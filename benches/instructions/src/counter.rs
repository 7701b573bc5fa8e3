//! Instruction counter.

use core::hint::black_box;

use cortex_m::asm::delay;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::hprintln;

/// Instructions to four ticks: 1 ns each, the timer runs at 25 MHz.
#[cfg(mps2)]
const PER_FOUR_TICKS: u32 = 160;
/// The same number if the timer runs at 32 MHz.
#[cfg(not(mps2))]
const PER_FOUR_TICKS: u32 = 125;
/// Value from which the timer counts down.
const RELOAD: u32 = 0x00ff_ffff;

/// Counts instructions in ticks of the system timer.
pub(crate) struct Counter {
    timer: SYST,
}

impl Counter {
    pub(crate) fn new(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
        Self { timer }
    }

    /// Returns true if instructions are counted: a loop of two of them must take as many as it has.
    pub(crate) fn is_calibrated(&mut self) -> bool {
        const ROUNDS: u32 = 100_000;
        // The loop runs once more than its argument.
        let counted = self.measure(|| delay(ROUNDS - 1));
        // The instructions around the loop take less than two ticks.
        counted.is_some_and(|(instructions, ())| {
            (2 * ROUNDS..2 * ROUNDS + PER_FOUR_TICKS / 2).contains(&instructions)
        })
    }

    /// Runs `work` and prints the cost of one of its `repetitions`; `None` if it fails or takes
    /// longer than the timer can count.
    pub(crate) fn count<T>(
        &mut self,
        kernel: &str,
        (repetitions, unit): (u32, &str),
        work: impl FnOnce() -> Option<T>,
    ) -> Option<()> {
        let (instructions, result) = self.measure(work)?;
        black_box(result?);
        Self::print(kernel, (repetitions, unit), instructions);
        Some(())
    }

    /// Runs `work` and returns the number of its instructions; `None` if it takes longer than the
    /// timer can count.
    pub(crate) fn measure<T>(&mut self, work: impl FnOnce() -> T) -> Option<(u32, T)> {
        self.timer.clear_current();
        // The first reading clears the flag that says whether the timer has run out.
        self.timer.has_wrapped();
        let start = SYST::get_current();
        let result = work();
        let end = SYST::get_current();
        let wrapped = self.timer.has_wrapped();
        let ticks = start.wrapping_sub(end) & RELOAD;
        if wrapped && end >= start || ticks > RELOAD / 2 {
            return None;
        }
        // There are at most 2^23 ticks, so the product fits.
        Some((ticks * PER_FOUR_TICKS / 4, black_box(result)))
    }

    /// Prints the cost of `repetitions`.
    pub(crate) fn print(kernel: &str, (repetitions, unit): (u32, &str), instructions: u32) {
        hprintln!("{},{},{},{}", kernel, unit, repetitions, instructions);
    }
}
