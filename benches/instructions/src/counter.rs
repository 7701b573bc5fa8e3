//! The instruction counter.

use core::hint::black_box;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::hprintln;

/// Instructions to so many ticks: 1 ns each, the timer runs at 25 MHz.
#[cfg(not(mps3))]
const INSTRUCTIONS_PER_TICKS: (u32, u32) = (40, 1);
/// Instructions to so many ticks: 1 ns each, the timer runs at 32 MHz.
#[cfg(mps3)]
const INSTRUCTIONS_PER_TICKS: (u32, u32) = (125, 4);
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
        let (instructions, per_ticks) = INSTRUCTIONS_PER_TICKS;
        Some((ticks * instructions / per_ticks, black_box(result)))
    }

    /// Prints what `repetitions` have taken.
    pub(crate) fn print(kernel: &str, (repetitions, unit): (u32, &str), instructions: u32) {
        hprintln!("{},{},{},{}", kernel, unit, repetitions, instructions);
    }
}
