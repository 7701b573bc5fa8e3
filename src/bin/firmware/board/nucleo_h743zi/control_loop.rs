//! The control loop: a round every millisecond, and no force when rounds fail to come.

use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::{SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use fmc_camera::flight::{
    disciplined_clock::DisciplinedClock, event::Action, round_guard::RoundGuard,
};

use crate::journal;

use super::{Deck, captures, clock, force, inputs, inputs::Inputs, latches, shutter, wires};

/// Time from one round to the next, µs.
const ROUND_US: u32 = 1000;

static IS_DUE: AtomicBool = AtomicBool::new(false);
static GUARD: RoundGuard = RoundGuard::new();

/// Begins to request rounds.
pub(super) fn start(timer: &mut SYST) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(clock::CORE_MHZ * ROUND_US - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();
}

/// Returns `true` if a round is due.
pub(super) fn is_due() -> bool {
    IS_DUE.load(Ordering::Relaxed)
}

/// Returns `true` if rounds have failed to come.
pub(super) fn is_overdue() -> bool {
    GUARD.is_overdue(clock::now_us())
}

/// Sets the deck's time, and makes a round if one is due.
pub(super) fn turn(time: &mut DisciplinedClock, inputs: &Inputs, deck: &mut Deck) {
    deck.flown_mut().set_now(time.extend(clock::now_us()));
    if !IS_DUE.swap(false, Ordering::Relaxed) {
        return;
    }
    captures::hand_over(time, deck.flown_mut());
    deck.flown_mut().see(inputs.levels());
    deck.flown_mut().note_lines(inputs::lines());
    wires::hand_over(deck);
    let now_us = clock::now_us();
    GUARD.come_round(now_us);
    for action in &deck.round(time.extend(now_us)) {
        match *action {
            Action::OpenShutter { at, exposure_s } => {
                latches::take_between(true);
                shutter::open(time.counted(at), time.counted_s(exposure_s));
            }
            Action::CloseShutter => shutter::close(),
            Action::Fault(fault) => journal::note_fault(fault),
            Action::InDoubt(exposures) => journal::note_doubt(exposures),
            Action::FrameReady(_) => latches::take_between(false),
            // The deck has carried out the stage's actions, and does not prepare a camera whose
            // rows are to be clocked.
            Action::MoveStage(_) | Action::ReleaseStage | Action::ClockRows { .. } => {}
        }
    }
}

/// Takes the force off the motor, and closes the shutter.
pub(super) fn stop() {
    force::off();
    shutter::close();
}

/// Requests a round, also if the main loop does not come round.
#[exception]
fn SysTick() {
    IS_DUE.store(true, Ordering::Relaxed);
    if is_overdue() {
        force::off();
    }
}
