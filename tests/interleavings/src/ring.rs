//! The ring between an interrupt, which writes, and the main loop, which reads.

use std::ops::RangeInclusive;

use loom::sync::{Arc, Mutex};
use loom::thread;

use crate::runs::{every_order, finds};

/// Models of a copy of the ring.
macro_rules! models_of {
    ($copy:ident) => {
        #[allow(dead_code, reason = "a fault is found by one of the models")]
        mod $copy {
            use super::*;

            #[allow(unreachable_pub, reason = "a copy of the library's")]
            mod ring {
                include!(concat!(env!("OUT_DIR"), "/", stringify!($copy), ".rs"));
            }

            type Ring = ring::Ring<u8, 2>;

            /// A ring that others have used before, and is empty.
            fn used() -> Arc<Ring> {
                let ring = Arc::new(Ring::new());
                let others = {
                    let ring = Arc::clone(&ring);
                    thread::spawn(move || {
                        for byte in [100, 101, 102] {
                            ring.push(byte);
                            assert_eq!(ring.pop(), Some(byte));
                        }
                        assert_eq!(ring.take_lost(), 0);
                    })
                };
                others.join().unwrap();
                ring
            }

            /// Three bytes come into two places while the main loop reads.
            pub(super) fn more_come_than_fit() {
                let ring = used();
                let interrupt = {
                    let ring = Arc::clone(&ring);
                    thread::spawn(move || (1..=3).for_each(|byte| ring.push(byte)))
                };
                let mut read = Vec::from_iter(ring.pop());
                let lost = ring.take_lost();
                interrupt.join().unwrap();
                read.extend(std::iter::from_fn(|| ring.pop()));
                let lost = lost + ring.take_lost();
                assert!(ring.is_empty() && ring.has_room());
                let expected: &[u8] = if lost == 0 { &[1, 2, 3] } else { &[1, 2] };
                assert_eq!(read, expected, "{lost} lost");
                assert_eq!(lost, u32::try_from(3 - read.len()).unwrap());
            }

            /// Two interrupts in which bytes are lost, while the main loop asks how many are.
            pub(super) fn losses_are_counted() {
                let ring = used();
                let interrupt = {
                    let ring = Arc::clone(&ring);
                    thread::spawn(move || {
                        ring.lose(1);
                        ring.lose(2);
                    })
                };
                let lost = ring.take_lost() + ring.take_lost();
                interrupt.join().unwrap();
                assert_eq!(lost + ring.take_lost(), 3);
            }

            /// Bytes are moved from a port, which keeps those for which there is no room, by the
            /// interrupt, and with interrupts masked by the main loop.
            pub(super) fn port_keeps_what_does_not_fit() {
                let ring = used();
                let port = Arc::new(Mutex::new(1..=3));
                let collect = |ring: &Ring, port: &Mutex<RangeInclusive<u8>>| {
                    let mut bytes = port.lock().unwrap();
                    while ring.has_room()
                        && let Some(byte) = bytes.next()
                    {
                        ring.push(byte);
                    }
                };
                let interrupt = {
                    let (ring, port) = (Arc::clone(&ring), Arc::clone(&port));
                    thread::spawn(move || collect(&ring, &port))
                };
                let mut read = Vec::new();
                if ring.is_empty() {
                    collect(&ring, &port);
                }
                read.extend(ring.pop());
                interrupt.join().unwrap();
                collect(&ring, &port);
                read.extend(std::iter::from_fn(|| ring.pop()));
                collect(&ring, &port);
                read.extend(std::iter::from_fn(|| ring.pop()));
                assert_eq!((read, ring.take_lost()), (vec![1, 2, 3], 0));
            }
        }
    };
}

models_of!(ring);
models_of!(ring_number_before_item);
models_of!(ring_writer_without_release);
models_of!(ring_reader_without_acquire);
models_of!(ring_place_free_before_it_is_read);
models_of!(ring_reader_without_release);
models_of!(ring_writer_without_acquire);
models_of!(ring_lost_in_two_steps);

#[test]
fn bytes_come_out_in_order_and_once_or_are_counted_in_every_order_of_interrupt_and_main_loop() {
    let orders = every_order(ring::more_come_than_fit);
    // docs/models.md has this number.
    assert_eq!(orders, 3_381);
}

#[test]
fn every_lost_byte_is_counted_once_in_every_order_of_interrupt_and_main_loop() {
    let orders = every_order(ring::losses_are_counted);
    // docs/models.md has this number.
    assert_eq!(orders, 14);
}

#[test]
fn byte_for_which_there_is_no_room_stays_in_the_port_in_every_order() {
    let orders = every_order(ring::port_keeps_what_does_not_fit);
    // docs/models.md has this number.
    assert_eq!(orders, 21_026);
}

#[test]
fn ring_with_a_wrong_order_of_memory_or_of_its_steps_is_found() {
    finds(
        "number before item",
        ring_number_before_item::more_come_than_fit,
    );
    finds(
        "writer without release",
        ring_writer_without_release::more_come_than_fit,
    );
    finds(
        "reader without acquire",
        ring_reader_without_acquire::more_come_than_fit,
    );
    finds(
        "place free too early",
        ring_place_free_before_it_is_read::more_come_than_fit,
    );
    finds(
        "reader without release",
        ring_reader_without_release::more_come_than_fit,
    );
    finds(
        "writer without acquire",
        ring_writer_without_acquire::more_come_than_fit,
    );
    finds(
        "two steps to a loss",
        ring_lost_in_two_steps::losses_are_counted,
    );
}
