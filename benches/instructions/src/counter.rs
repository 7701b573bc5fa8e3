//! The instruction counter.

use core::hint::black_box;

use cortex_m::asm::delay;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::hprintln;

/// Instructions to four ticks: 1 ns each, the timer runs at 25 MHz.
#[cfg(mps2)]
const PER_FOUR_TICKS: u32 = 160;
/// The same where the timer runs at 32 MHz.
#[cfg(not(mps2))]
const PER_FOUR_TICKS: u32 = 125;
/// The timer counts down from here.
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

    /// Whether what is counted are instructions: a loop of two of them must take as many as it does.
    pub(crate) fn is_calibrated(&mut self) -> bool {
        const ROUNDS: u32 = 100_000;
        // It goes round once more than it is told.
        let counted = self.measure(|| delay(ROUNDS - 1));
        // What is around the loop is less than two ticks.
        counted.is_some_and(|(instructions, ())| {
            (2 * ROUNDS..2 * ROUNDS + PER_FOUR_TICKS / 2).contains(&instructions)
        })
    }

    /// Runs `work` and prints what one of its `repetitions` costs; `None` if it fails or takes longer than the timer
    /// can count.
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

    /// Runs `work` and says how many instructions it takes; `None` if that is longer than the timer can count.
    pub(crate) fn measure<T>(&mut self, work: impl FnOnce() -> T) -> Option<(u32, T)> {
        self.timer.clear_current();
        // Reading says whether the timer has run out since it was read last.
        self.timer.has_wrapped();
        let start = SYST::get_current();
        let result = work();
        let end = SYST::get_current();
        let wrapped = self.timer.has_wrapped();
        let ticks = start.wrapping_sub(end) & RELOAD;
        if wrapped && end >= start || ticks > RELOAD / 2 {
            return None;
        }
        // At most 2^23 ticks: the product fits.
        Some((ticks * PER_FOUR_TICKS / 4, black_box(result)))
    }

    /// Prints what `repetitions` have taken.
    pub(crate) fn print(kernel: &str, (repetitions, unit): (u32, &str), instructions: u32) {
        hprintln!("{},{},{},{}", kernel, unit, repetitions, instructions);
    }
}
