//! Time: a counter of microseconds, and a tick that wakes the main loop.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::exception;

use super::registers::{COUNTER, PRESCALER};

/// Cycles of the processor and of the counter per microsecond.
pub(super) const CYCLES_PER_US: u32 = 25;
const TICK_US: u32 = 1000;

/// Longest time from a reset until the counter runs, ms.
pub(super) const RUNS_WITHIN_MS: u32 = 10;

static TICKS: AtomicU32 = AtomicU32::new(0);

/// Starts both.
pub(super) fn start(tick: &mut SYST) {
    PRESCALER.write(CYCLES_PER_US - 1);
    tick.set_clock_source(SystClkSource::Core);
    tick.set_reload(CYCLES_PER_US * TICK_US - 1);
    tick.clear_current();
    tick.enable_interrupt();
    tick.enable_counter();
}

/// Microseconds, wrapping after 71 minutes.
pub(in super::super) fn now_us() -> u32 {
    COUNTER.read()
}

/// Milliseconds in which the tick was not masked, wrapping.
pub(super) fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

#[exception]
fn SysTick() {
    TICKS.fetch_add(1, Ordering::Relaxed);
    #[cfg(drills)]
    super::drills::run_in_interrupt();
}

/// Stops the tick, for a drill.
#[cfg(drills)]
pub(super) fn stop_tick() {
    // SAFETY: nothing else writes the timer's control register once it has started.
    unsafe { (*SYST::PTR).csr.write(0) }
}
