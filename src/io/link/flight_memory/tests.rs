//! Resets between any two stores.

use core::sync::atomic::AtomicU32;

use super::block::{Block, sum};
use super::words::{load, reset, store};
use super::{FlightMemory, KeptHead, KeptRecord};
use crate::flight::fault::Faults;
use crate::flight::flag::Flags;
use crate::flight::frame_record::{Outcome, Reason};
use crate::flight::record_log::Entry;
use crate::flight::time::Time;

fn head(writing: u32) -> KeptHead {
    KeptHead {
        build: 0xb11d,
        writing,
        boot: 3,
        flight: 7,
        resumed: 1,
        has_round: true,
        prepared: None,
    }
}

fn record(writing: u32, reason: Reason) -> KeptRecord {
    KeptRecord {
        flight: 7,
        writing,
        is_pending: false,
        boot: 3,
        record: Entry {
            sequence: 12,
            trigger: Time::from_us(1_234_567),
            outcome: Outcome::Refused(reason),
            faults: Faults::NONE,
            flags: Flags::NONE,
        },
    }
}

/// Carries out a writing with a reset after each number of its stores; returns their number.
fn with_resets(write: impl Fn(&FlightMemory), check: impl Fn(&FlightMemory, bool)) -> u32 {
    let before = |memory: &FlightMemory| {
        memory.write_head(&head(1));
        memory.write_record(&record(1, Reason::Overlap), 4, None);
        memory.write_time(Time::from_us(0x1_0000_0001));
    };
    let mut stores = 0;
    loop {
        let memory = FlightMemory::blank();
        before(&memory);
        reset::after(Some(stores));
        write(&memory);
        let is_whole = reset::left() != Some(0);
        reset::after(None);
        check(&memory, is_whole);
        if is_whole {
            return stores;
        }
        stores += 1;
    }
}

#[test]
fn reset_after_any_store_leaves_the_state_before_or_after() {
    let stores = with_resets(
        |memory| memory.write_head(&head(2)),
        |memory, is_whole| {
            let found = memory.head();
            let is_new = found == Some(head(2));
            assert!(is_new || found == Some(head(1)) && !is_whole, "{found:?}");
        },
    );
    assert!(stores > 5, "{stores}");
}

#[test]
fn reset_after_any_store_leaves_a_record_that_changes_as_it_was_or_as_it_is() {
    let (old, new) = (record(1, Reason::Overlap), record(2, Reason::Stroke));
    let stores = with_resets(
        |memory| memory.write_record(&new, 9, Some(4)),
        |memory, is_whole| {
            let found = [4, 9].map(|slot| memory.record(slot));
            let kept = [[Some(old), None], [Some(old), Some(new)], [None, Some(new)]];
            assert!(kept.contains(&found), "{found:?}");
            assert!(!is_whole || found == kept[2]);
        },
    );
    assert!(stores > 5, "{stores}");
}

#[test]
fn reset_after_any_store_leaves_the_parameters_in_use_when_others_are_written() {
    let parameters = |first: u8| [first; 7].map(|byte| byte.wrapping_mul(31));
    let crc = |first| {
        let mut buffer = [0; 16];
        sum(postcard::to_slice(&parameters(first), &mut buffer).unwrap())
    };
    let read = |memory: &FlightMemory, first| {
        memory.parameters(crc(first), |bytes| {
            postcard::from_bytes::<[u8; 7]>(bytes).ok()
        })
    };
    // Each is written beside the one before it.
    for [old, new] in [[1, 2], [2, 3], [2, 1]] {
        let stores = with_resets(
            |memory| {
                let left = reset::left();
                reset::after(None);
                memory.write_parameters(&parameters(1), None).unwrap();
                if old == 2 {
                    memory
                        .write_parameters(&parameters(2), Some(crc(1)))
                        .unwrap();
                }
                reset::after(left);
                memory
                    .write_parameters(&parameters(new), Some(crc(old)))
                    .unwrap();
            },
            |memory, is_whole| {
                assert_eq!(read(memory, old), Some(parameters(old)));
                let found = read(memory, new);
                assert!(found == Some(parameters(new)) || found.is_none() && !is_whole);
            },
        );
        assert!(stores > 5, "{stores}");
    }
}

#[test]
fn reset_after_any_store_leaves_the_time_of_a_round() {
    let (old, new) = (0x1_0000_0001, 0x2_0000_0000);
    let stores = with_resets(
        |memory| memory.write_time(Time::from_us(new)),
        |memory, is_whole| {
            let found = memory.time().map(Time::us);
            assert!(found == Some(new) || found == Some(old) && !is_whole);
        },
    );
    assert_eq!(stores, 9, "one more than are made");
}

#[test]
fn blocks_lie_behind_each_other_and_words_behind_the_last_are_left_out() {
    let first = Block::after(None, 8);
    let second = Block::after(Some(&first), 4);
    // Two words are those of check and length.
    let starts = [
        &first,
        &second,
        &second.nth(2),
        &Block::after(Some(&second), 0),
    ];
    assert_eq!(starts.map(Block::start), [0, 4, 10, 7]);
    let memory: [AtomicU32; 7] = [const { AtomicU32::new(0) }; 7];
    first.write(&memory, &[1, 2, 3, 4, 5, 6, 7, 8]);
    second.write(&memory, &[9, 10, 11]);
    let mut buffer = [0; 8];
    let read = first.read(&memory, &mut buffer);
    assert_eq!(read, Some(&[1, 2, 3, 4, 5, 6, 7, 8][..]));
    assert_eq!(second.read(&memory, &mut buffer), Some(&[9, 10, 11][..]));
    let words = || {
        memory
            .each_ref()
            .map(|word| word.load(core::sync::atomic::Ordering::Relaxed))
    };
    let before = words();
    store(&memory, 7, 0x1234_5678);
    assert_eq!((words(), load(&memory, 7)), (before, 0));
}
