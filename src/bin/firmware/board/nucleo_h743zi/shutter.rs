//! The shutter's command: a line that the compare interrupt of TIM5 sets, in step with the clock.

use core::cell::Cell;

use critical_section::Mutex;
use embassy_stm32::{
    Peri, bind_interrupts,
    gpio::{Level, Output, Speed},
    interrupt::typelevel::{self, Interrupt as _},
    pac::{self, timer::regs::SrGp16},
    peripherals::{PC10, TIM5},
    timer::low_level::Timer,
};
use fmc_camera::flight::{
    shutter_output::{ShutterOutput, has_come},
    time::Time,
};

use super::{clock, line::Line};

/// High opens, low closes.
const COMMAND: Line = Line::new(pac::GPIOC, 10);

/// Number of tries to set the counter equal to the clock: an interrupt may come between.
const TRIES: usize = 16;

/// Largest number of changes of the wire at one time: it opens, it closes, and it stays.
const CHANGES: usize = 4;

static SHUTTER: Mutex<Cell<ShutterOutput>> = Mutex::new(Cell::new(ShutterOutput::new()));

bind_interrupts!(struct Interrupts {
    TIM5 => Compare;
});

/// Line and timer in operation.
pub(super) struct Shutter {
    _command: Output<'static>,
    _timer: Timer<'static, TIM5>,
}

impl Shutter {
    /// Starts the timer so that it counts with the clock, which runs already, to within a
    /// microsecond; the shutter is told to be closed.
    pub(super) fn start(timer: Peri<'static, TIM5>, command: Peri<'static, PC10>) -> Self {
        let command = Output::new(command, Level::Low, Speed::Medium);
        let timer = Timer::new(timer);
        let counter = pac::TIM5;
        counter.psc().write_value(clock::TIMER_MHZ - 1);
        counter.arr().write_value(u32::MAX);
        timer.generate_update_event();
        timer.start();
        for _ in 0..TRIES {
            let now_us = clock::now_us();
            counter.cnt().write_value(now_us);
            if clock::now_us() == now_us {
                break;
            }
        }
        counter.sr().write_value(SrGp16(0));
        // SAFETY: the handler shares with other code only state that is reached with interrupts
        // masked.
        unsafe { typelevel::TIM5::enable() };
        Self {
            _command: command,
            _timer: timer,
        }
    }
}

/// Sets the command that leaves at a time of the counter, for an exposure, s by the counter.
pub(super) fn open(at: Time, exposure_s: f32) {
    change(|shutter| shutter.open(at, exposure_s));
}

/// Closes the shutter at once, or keeps it closed.
pub(super) fn close() {
    change(ShutterOutput::close);
}

fn change(change: impl FnOnce(&mut ShutterOutput)) {
    critical_section::with(|section| {
        let state = SHUTTER.borrow(section);
        let mut shutter = state.get();
        change(&mut shutter);
        work(&mut shutter);
        state.set(shutter);
    });
}

/// Sets the wire, and the next compare; with interrupts masked. All times are of one counter, so
/// that none is missed.
fn work(shutter: &mut ShutterOutput) {
    let timer = pac::TIM5;
    for _ in 0..CHANGES {
        let level = shutter.look(timer.cnt().read());
        COMMAND.set(level.is_high);
        let Some(next_us) = level.next_us else {
            timer.dier().modify(|w| w.set_ccie(0, false));
            timer.sr().write_value(SrGp16(0));
            return;
        };
        timer.ccr(0).write_value(next_us);
        timer.sr().write_value(SrGp16(0));
        timer.dier().modify(|w| w.set_ccie(0, true));
        if !has_come(next_us, timer.cnt().read()) {
            return;
        }
    }
    // More changes cannot be due at once; the interrupt looks again.
    timer.egr().write(|w| w.set_ccg(0, true));
}

/// The compare interrupt.
struct Compare;

impl typelevel::Handler<typelevel::TIM5> for Compare {
    unsafe fn on_interrupt() {
        change(|_| ());
    }
}
