//! Bytes over the link.

use std::{
    io::{Read as _, Write as _},
    thread,
};

use super::machine::{MACHINES, Machine};

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn lines_come_back_whole_and_in_order() {
    for machine in MACHINES {
        let mut machine = Machine::start(machine);
        for length in [1, 2, 100, 1000] {
            let mut line = vec![b'x'; length];
            line.push(0);
            assert_eq!(machine.ask(&line), line);
        }
    }
}

#[test]
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn link_answers_after_100_kb_of_garbage() {
    const LAST: &[u8] = b"the last line\0";
    for machine in MACHINES {
        let mut machine = Machine::start(machine);
        let mut link = machine.link.try_clone().expect("link");
        let flood = thread::spawn(move || {
            let garbage: Vec<u8> = garbage().take(100_000).collect();
            link.write_all(&garbage).expect("link");
            link.write_all(b"\0").expect("link");
            link.write_all(LAST).expect("link");
        });
        let mut answers = vec![];
        while !answers.ends_with(LAST) {
            let mut chunk = [0; 4096];
            let count = machine.link.read(&mut chunk).expect("answer");
            assert!(count > 0, "the link ended");
            answers.extend(chunk.iter().take(count));
        }
        flood.join().expect("flood");
        assert_eq!(machine.ask(b"still here\0"), b"still here\0");
    }
}

/// Bytes without end and without pattern, the same every time: Marsaglia's xorshift32.
fn garbage() -> impl Iterator<Item = u8> {
    let mut state = 0x2545_f491_u32;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state.to_be_bytes()[0]
    })
}
