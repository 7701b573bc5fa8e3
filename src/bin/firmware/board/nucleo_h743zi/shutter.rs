//! The shutter's command: a line that channel 4 of TIM5 sets when it matches, in step with the
//! clock.
//!
//! The timer changes the line at the microsecond for which the change was set, whatever the
//! processor does then. The interrupt comes after it, and sets the next change: two changes that
//! are nearer to each other than the interrupt takes are as late as it.

use core::cell::Cell;

use critical_section::Mutex;
use embassy_stm32::{
    Peri, bind_interrupts,
    gpio::{AfType, Flex, OutputType, Speed},
    interrupt::typelevel::{self, Interrupt as _},
    pac::{
        self,
        timer::{
            regs::SrGp16,
            vals::{CcmrOutputCcs, OcmGp},
        },
    },
    peripherals::{PA3, TIM5},
    timer::{Ch4, low_level::Timer},
};
use fmc_camera::flight::{
    shutter_output::{ShutterOutput, has_come},
    time::Time,
};

use super::{clock, line::attach};

/// Channel of the command: high opens, low closes.
const COMMAND: usize = 3;

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
    _command: Flex<'static>,
    _timer: Timer<'static, TIM5>,
}

impl Shutter {
    /// Starts the timer so that it counts with the clock, which runs already, to within a
    /// microsecond; the shutter is told to be closed.
    pub(super) fn start(timer: Peri<'static, TIM5>, command: Peri<'static, PA3>) -> Self {
        let timer = Timer::new(timer);
        let counter = pac::TIM5;
        counter.psc().write_value(clock::TIMER_MHZ - 1);
        counter.arr().write_value(u32::MAX);
        timer.generate_update_event();
        counter
            .ccmr_output(COMMAND / 2)
            .modify(|w| w.set_ccs(COMMAND % 2, CcmrOutputCcs::OUTPUT));
        set_mode(OcmGp::FORCE_INACTIVE);
        counter.ccer().modify(|w| w.set_cce(COMMAND, true));
        timer.start();
        for _ in 0..TRIES {
            let now_us = clock::now_us();
            counter.cnt().write_value(now_us);
            if clock::now_us() == now_us {
                break;
            }
        }
        counter.sr().write_value(SrGp16(0));
        let output = AfType::output(OutputType::PushPull, Speed::Medium);
        let command = attach::<_, TIM5, Ch4>(command, output);
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
        let timer = pac::TIM5;
        if timer.dier().read().ccie(COMMAND) && timer.sr().read().ccif(COMMAND) {
            // The timer has made this change at its time, however long ago that was.
            shutter.look(timer.ccr(COMMAND).read());
        }
        change(&mut shutter);
        work(&mut shutter);
        state.set(shutter);
    });
}

/// Says what the line does.
fn set_mode(mode: OcmGp) {
    pac::TIM5
        .ccmr_output(COMMAND / 2)
        .modify(|w| w.set_ocm(COMMAND % 2, mode));
}

/// Sets the level of the line, and the next change; with interrupts masked. All times are of one
/// counter, so that none is missed.
fn work(shutter: &mut ShutterOutput) {
    let timer = pac::TIM5;
    let mut now_us = timer.cnt().read();
    for _ in 0..CHANGES {
        let level = shutter.look(now_us);
        let (forced, on_match) = if level.is_high {
            (OcmGp::FORCE_ACTIVE, OcmGp::INACTIVE_ON_MATCH)
        } else {
            (OcmGp::FORCE_INACTIVE, OcmGp::ACTIVE_ON_MATCH)
        };
        // No change, where the timer has made it.
        set_mode(forced);
        let Some(next_us) = level.next_us else {
            timer.dier().modify(|w| w.set_ccie(COMMAND, false));
            timer.sr().write_value(SrGp16(0));
            return;
        };
        timer.ccr(COMMAND).write_value(next_us);
        timer.sr().write_value(SrGp16(0));
        set_mode(on_match);
        timer.dier().modify(|w| w.set_ccie(COMMAND, true));
        now_us = timer.cnt().read();
        if !has_come(next_us, now_us) {
            return;
        }
    }
    // More changes cannot be due at once; the interrupt looks again.
    timer.egr().write(|w| w.set_ccg(COMMAND, true));
}

/// The compare interrupt.
struct Compare;

impl typelevel::Handler<typelevel::TIM5> for Compare {
    unsafe fn on_interrupt() {
        change(|_| ());
    }
}
