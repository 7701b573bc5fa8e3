//! The timer of the shutter's command, with the registers that the board's firmware uses.
//!
//! Every access to a register is a step of its own. A match of the counter with the compare
//! register sets the flag, and changes the line as the mode says.

use loom::sync::Mutex;

/// The only channel in use; its number is that of the board.
pub(crate) const COMMAND: usize = 3;

/// Mode of the channel's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(
    non_camel_case_types,
    reason = "names of the manual, as the board's crate has them"
)]
pub(crate) enum OcmGp {
    FORCE_INACTIVE,
    FORCE_ACTIVE,
    ACTIVE_ON_MATCH,
    INACTIVE_ON_MATCH,
}

/// Flags of the status register; a zero clears one.
pub(crate) struct SrGp16(pub(crate) u32);

/// State of the timer.
#[derive(Debug)]
pub(crate) struct State {
    pub(crate) count: u32,
    compare: Option<u32>,
    is_matched: bool,
    is_interrupting: bool,
    mode: OcmGp,
    pub(crate) is_high: bool,
    /// Counts at which the line changed.
    pub(crate) changes: Vec<u32>,
}

loom::lazy_static! {
    static ref TIMER: Mutex<State> = Mutex::new(State {
        count: 0,
        compare: None,
        is_matched: false,
        is_interrupting: false,
        mode: OcmGp::FORCE_INACTIVE,
        is_high: false,
        changes: Vec::new(),
    });
}

/// Takes a look at, or a step of, the timer.
pub(crate) fn step<T>(act: impl FnOnce(&mut State) -> T) -> T {
    act(&mut TIMER.lock().unwrap())
}

impl State {
    fn set_line(&mut self, is_high: bool) {
        if self.is_high != is_high {
            self.is_high = is_high;
            self.changes.push(self.count);
        }
    }

    /// Counts on.
    pub(crate) fn tick(&mut self) {
        self.count += 1;
        if self.compare == Some(self.count) {
            self.is_matched = true;
            match self.mode {
                OcmGp::ACTIVE_ON_MATCH => self.set_line(true),
                OcmGp::INACTIVE_ON_MATCH => self.set_line(false),
                OcmGp::FORCE_ACTIVE | OcmGp::FORCE_INACTIVE => {}
            }
        }
    }

    /// Returns `true` while it asks for its interrupt.
    pub(crate) const fn asks(&self) -> bool {
        self.is_matched && self.is_interrupting
    }
}

/// Registers, named as in the board's crate.
pub(crate) mod pac {
    pub(crate) const TIM5: super::Registers = super::Registers;
}

#[derive(Clone, Copy)]
pub(crate) struct Registers;

impl Registers {
    pub(crate) const fn dier(self) -> Dier {
        Dier(false)
    }

    pub(crate) const fn sr(self) -> Sr {
        Sr(false)
    }

    pub(crate) const fn ccr(self, channel: usize) -> Ccr {
        assert!(channel == COMMAND);
        Ccr
    }

    pub(crate) const fn cnt(self) -> Cnt {
        Cnt
    }

    pub(crate) const fn ccmr_output(self, pair: usize) -> Ccmr {
        assert!(pair == COMMAND / 2);
        Ccmr(None)
    }

    pub(crate) const fn egr(self) -> Egr {
        Egr(false)
    }
}

/// Enabled interrupts.
pub(crate) struct Dier(bool);

impl Dier {
    pub(crate) fn read(self) -> Self {
        Self(step(|timer| timer.is_interrupting))
    }

    pub(crate) const fn ccie(&self, _: usize) -> bool {
        self.0
    }

    pub(crate) const fn set_ccie(&mut self, _: usize, is_enabled: bool) {
        self.0 = is_enabled;
    }

    pub(crate) fn modify(mut self, change: impl FnOnce(&mut Self)) {
        change(&mut self);
        step(|timer| timer.is_interrupting = self.0);
    }
}

/// Status.
pub(crate) struct Sr(bool);

impl Sr {
    pub(crate) fn read(self) -> Self {
        Self(step(|timer| timer.is_matched))
    }

    pub(crate) const fn ccif(&self, _: usize) -> bool {
        self.0
    }

    pub(crate) fn write_value(self, flags: SrGp16) {
        assert_eq!(flags.0, 0, "all are cleared");
        step(|timer| timer.is_matched = false);
    }
}

/// Compare register.
pub(crate) struct Ccr;

impl Ccr {
    pub(crate) fn read(self) -> u32 {
        step(|timer| timer.compare.unwrap_or(0))
    }

    pub(crate) fn write_value(self, value: u32) {
        step(|timer| timer.compare = Some(value));
    }
}

/// Counter.
pub(crate) struct Cnt;

impl Cnt {
    pub(crate) fn read(self) -> u32 {
        step(|timer| timer.count)
    }
}

/// Mode.
pub(crate) struct Ccmr(Option<OcmGp>);

impl Ccmr {
    pub(crate) const fn set_ocm(&mut self, _: usize, mode: OcmGp) {
        self.0 = Some(mode);
    }

    pub(crate) fn modify(mut self, change: impl FnOnce(&mut Self)) {
        change(&mut self);
        let Some(mode) = self.0 else {
            return;
        };
        step(|timer| {
            timer.mode = mode;
            match mode {
                OcmGp::FORCE_ACTIVE => timer.set_line(true),
                OcmGp::FORCE_INACTIVE => timer.set_line(false),
                OcmGp::ACTIVE_ON_MATCH | OcmGp::INACTIVE_ON_MATCH => {}
            }
        });
    }
}

/// Events that software makes.
pub(crate) struct Egr(bool);

impl Egr {
    pub(crate) const fn set_ccg(&mut self, _: usize, is_made: bool) {
        self.0 = is_made;
    }

    pub(crate) fn write(mut self, change: impl FnOnce(&mut Self)) {
        change(&mut self);
        if self.0 {
            step(|timer| timer.is_matched = true);
        }
    }
}
