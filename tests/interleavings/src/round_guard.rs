//! The guard of the rounds, which the main loop sets and an interrupt asks.

use loom::sync::{Arc, Mutex};
use loom::thread;

use crate::runs::{every_order, finds};

/// Counts of microseconds at the first round: one before the counter wraps.
const STARTS: [u32; 2] = [1_000_000, u32::MAX - 3000];

/// Models of a copy of the guard.
macro_rules! models_of {
    ($copy:ident) => {
        #[allow(dead_code, reason = "a fault is found by one of the models")]
        mod $copy {
            use super::*;

            #[allow(unreachable_pub, reason = "a copy of the library's")]
            mod guard {
                include!(concat!(env!("OUT_DIR"), "/", stringify!($copy), ".rs"));
            }

            use guard::{LONGEST_ROUND_US, RoundGuard};

            fn after_a_round(at_us: u32) -> Arc<RoundGuard> {
                let guard = RoundGuard::new();
                guard.come_round(at_us);
                Arc::new(guard)
            }

            /// Rounds come while the interrupt asks at the time of the last; it is asked between
            /// any two accesses to memory.
            pub(super) fn is_asked_while_it_is_set(start_us: u32) {
                let guard = after_a_round(start_us);
                let last_us = start_us.wrapping_add(LONGEST_ROUND_US);
                let main_loop = {
                    let guard = Arc::clone(&guard);
                    thread::spawn(move || {
                        guard.come_round(start_us.wrapping_add(LONGEST_ROUND_US / 2));
                        guard.come_round(last_us);
                    })
                };
                for _ in 0..2 {
                    assert!(!guard.is_overdue(last_us));
                }
                main_loop.join().unwrap();
                assert!(!guard.is_overdue(last_us.wrapping_add(LONGEST_ROUND_US)));
                assert!(guard.is_overdue(last_us.wrapping_add(LONGEST_ROUND_US + 1)));
            }

            /// A main loop that reads the clock some time before it sets the guard, the second time
            /// so long that it is late. An interrupt is not interrupted by the main loop: it holds
            /// the processor from its look at the clock to its answer.
            pub(super) fn clock_goes_on(start_us: u32) {
                let guard = after_a_round(start_us);
                // The clock, and the time to which the guard is set.
                let processor = Arc::new(Mutex::new([start_us; 2]));
                let pass = |processor: &Mutex<[u32; 2]>| {
                    let [now_us, _] = &mut *processor.lock().unwrap();
                    *now_us = now_us.wrapping_add(LONGEST_ROUND_US / 2);
                    *now_us
                };
                let ask = |processor: &Mutex<[u32; 2]>, guard: &RoundGuard| {
                    let held = processor.lock().unwrap();
                    let [now_us, set_us] = *held;
                    let is_late = now_us.wrapping_sub(set_us) > LONGEST_ROUND_US;
                    assert_eq!(guard.is_overdue(now_us), is_late);
                };
                let main_loop = {
                    let (guard, processor) = (Arc::clone(&guard), Arc::clone(&processor));
                    thread::spawn(move || {
                        for _ in 0..2 {
                            let read_us = pass(&processor);
                            pass(&processor);
                            let [_, set_us] = &mut *processor.lock().unwrap();
                            guard.come_round(read_us);
                            *set_us = read_us;
                        }
                    })
                };
                ask(&processor, &guard);
                ask(&processor, &guard);
                main_loop.join().unwrap();
                ask(&processor, &guard);
            }
        }
    };
}

models_of!(round_guard);
models_of!(round_guard_in_two_steps);
models_of!(round_guard_without_wrap);

#[test]
fn rounds_are_overdue_if_they_are_late_and_never_otherwise_in_every_order() {
    for start_us in STARTS {
        let asked = every_order(move || round_guard::is_asked_while_it_is_set(start_us));
        let passing = every_order(move || round_guard::clock_goes_on(start_us));
        // docs/models.md has these numbers.
        assert_eq!((asked, passing), (44, 53));
    }
}

#[test]
fn guard_that_is_set_in_two_steps_or_does_not_wrap_is_found() {
    finds("two steps", || {
        round_guard_in_two_steps::is_asked_while_it_is_set(STARTS[0]);
    });
    finds("no wrap", || {
        round_guard_without_wrap::clock_goes_on(STARTS[1]);
    });
}
