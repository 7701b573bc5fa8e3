//! The shutter's command: main loop, compare interrupt and a timer that goes on meanwhile.

use fmc_camera::flight::shutter_output::{ShutterOutput, has_come};
use fmc_camera::flight::time::Time;
use loom::sync::Mutex;
use loom::thread;

use crate::runs::{every_order, finds};
use crate::timer::{COMMAND, OcmGp, SrGp16, pac, step};

/// Largest number of changes of the wire at one time, as on the board.
const CHANGES: usize = 4;

/// The command: opens the shutter at a count of the timer, for so many counts.
const OPENS_AT: u32 = 1;
const EXPOSURE: u32 = 1;
const EXPOSURE_S: f32 = 1e-6;

loom::lazy_static! {
    /// Held while interrupts are masked, and by an interrupt.
    static ref MASK: Mutex<()> = Mutex::new(());
    /// State of the output. Looks at it are no steps of their own; the timer's around it are.
    static ref STATE: std::sync::Mutex<ShutterOutput> = std::sync::Mutex::new(ShutterOutput::new());
}

loom::thread_local! {
    static IN_INTERRUPT: std::cell::Cell<bool> = std::cell::Cell::new(false);
}

/// Sections of the program without interrupts.
mod critical_section {
    /// A section.
    pub(super) struct Section;

    /// Runs a section with interrupts masked, as they are in an interrupt.
    pub(super) fn with(section: impl FnOnce(Section)) {
        let is_masked = super::IN_INTERRUPT.with(std::cell::Cell::get);
        let _masked = (!is_masked).then(|| super::MASK.lock().unwrap());
        section(Section);
    }

    /// Runs a section that interrupts can interrupt.
    pub(super) fn without(section: impl FnOnce(Section)) {
        section(Section);
    }
}

/// The state, as the board's code reaches it in a section.
struct Shared;

static SHUTTER: Shared = Shared;

impl Shared {
    const fn borrow(&self, _: critical_section::Section) -> &Self {
        self
    }

    #[allow(clippy::unused_self, reason = "as that of a cell")]
    fn get(&self) -> ShutterOutput {
        *STATE.lock().unwrap()
    }

    #[allow(clippy::unused_self, reason = "as that of a cell")]
    fn set(&self, shutter: ShutterOutput) {
        *STATE.lock().unwrap() = shutter;
    }
}

/// Models of a copy of the board's code.
macro_rules! models_of {
    ($copy:ident) => {
        #[allow(dead_code, reason = "a fault is found by one of the models")]
        mod $copy {
            use super::*;

            mod board {
                use super::*;

                include!(concat!(env!("OUT_DIR"), "/", stringify!($copy), ".rs"));

                /// The compare interrupt.
                pub(super) fn interrupt() {
                    change(|_| ());
                }
            }

            fn interrupt_if_asked() {
                let _masked = MASK.lock().unwrap();
                let looked =
                    step(|timer| (timer.asks(), timer.count, timer.changes.first().copied()));
                let (true, count, opened) = looked else {
                    return;
                };
                IN_INTERRUPT.with(|it| it.set(true));
                board::interrupt();
                IN_INTERRUPT.with(|it| it.set(false));
                // However late it is, the exposure is counted from the match.
                if opened == Some(OPENS_AT) && count >= OPENS_AT + EXPOSURE {
                    assert!(step(|timer| !timer.is_high), "longer than the exposure");
                }
            }

            /// Runs the main loop while the timer counts `ticks` times and the interrupt comes once
            /// if it is asked for, early or late; then everything goes on until nothing changes.
            /// Returns the changes of the line, and what the main loop returns.
            fn run<T>(ticks: u32, main_loop: impl FnOnce() -> T) -> (Vec<u32>, T) {
                // The threads share it: it is there before them.
                drop(MASK.lock().unwrap());
                assert!(step(|timer| !timer.is_high));
                assert_eq!(SHUTTER.get(), ShutterOutput::new());
                let timer =
                    thread::spawn(move || (0..ticks).for_each(|_| step(|timer| timer.tick())));
                let interrupt = thread::spawn(interrupt_if_asked);
                let returned = main_loop();
                timer.join().unwrap();
                interrupt.join().unwrap();
                for _ in 0..2 * (OPENS_AT + EXPOSURE) {
                    interrupt_if_asked();
                    interrupt_if_asked();
                    step(|timer| timer.tick());
                }
                step(|timer| {
                    assert!(!timer.is_high, "the shutter stays open: {timer:?}");
                    (timer.changes.clone(), returned)
                })
            }

            fn open() {
                board::open(Time::from_us(OPENS_AT.into()), EXPOSURE_S);
            }

            /// The shutter opens once, not before its time, and closes no sooner than an exposure
            /// later.
            pub(super) fn opens() {
                let (changes, ()) = run(2, open);
                let [opened, closed] = changes[..] else {
                    panic!("{changes:?}");
                };
                assert!(
                    opened >= OPENS_AT && closed >= OPENS_AT + EXPOSURE,
                    "{changes:?}"
                );
            }

            /// The shutter is told to close before, while or after it opens, and is closed for good
            /// once it has been told.
            pub(super) fn closes() {
                let (changes, until_closed) = run(1, || {
                    open();
                    board::close();
                    step(|timer| timer.changes.len())
                });
                assert_eq!(changes.len(), until_closed, "{changes:?}");
                assert!(changes.iter().all(|at| *at >= OPENS_AT), "{changes:?}");
                assert!(matches!(changes.len(), 0 | 2), "{changes:?}");
            }
        }
    };
}

models_of!(shutter);
models_of!(shutter_without_mask);
models_of!(shutter_without_second_look);
models_of!(shutter_without_match);

#[test]
fn shutter_opens_at_its_time_and_closes_in_every_order_of_timer_interrupt_and_main_loop() {
    let orders = every_order(shutter::opens);
    // docs/models.md has this number.
    assert_eq!(orders, 10_344);
}

#[test]
fn shutter_that_is_told_to_close_is_closed_for_good_in_every_order() {
    let orders = every_order(shutter::closes);
    // docs/models.md has this number.
    assert_eq!(orders, 16_281);
}

#[test]
fn shutter_without_mask_or_second_look_or_with_a_match_overlooked_is_found() {
    finds("no mask", shutter_without_mask::closes);
    finds("no second look", shutter_without_second_look::opens);
    finds("match overlooked", shutter_without_match::opens);
}
