//! The software decoder of the encoder.

use std::io;

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use fmc_camera::flight::drive::quadrature::{QuadratureCounter, QuadratureDecoder, WideCount};
use fmc_camera::flight::fault::Fault;

/// Returns the counts after each pair of levels (A, B), and the glitches in the end.
fn decoded(levels: &[(bool, bool)]) -> (Vec<i32>, u32) {
    let pin = |which: fn(&(bool, bool)) -> bool| {
        let reads = levels.iter().map(|pair| {
            let level = if which(pair) { State::High } else { State::Low };
            Transaction::get(level)
        });
        Mock::new(&reads.collect::<Vec<_>>())
    };
    let (a, b) = (pin(|pair| pair.0), pin(|pair| pair.1));
    let mut decoder = QuadratureDecoder::new(a.clone(), b.clone());
    let counts = levels.iter().map(|_| {
        decoder.sample().unwrap();
        decoder.count()
    });
    let counts = counts.collect();
    for mut pin in [a, b] {
        pin.done();
    }
    (counts, decoder.glitches())
}

const CYCLE: [(bool, bool); 4] = [(false, false), (true, false), (true, true), (false, true)];

#[test]
fn a_leads_counts_up_and_b_leads_counts_down() {
    let forth: Vec<_> = CYCLE.into_iter().cycle().take(9).collect();
    assert_eq!(decoded(&forth), ((0..9).collect(), 0));
    let back: Vec<_> = CYCLE.into_iter().rev().cycle().take(9).collect();
    assert_eq!(decoded(&back), ((0..9).map(|count| -count).collect(), 0));
}

#[test]
fn both_at_once_is_a_glitch_and_moves_nothing() {
    let levels = [CYCLE[0], CYCLE[2], CYCLE[2], CYCLE[3], CYCLE[1]];
    assert_eq!(decoded(&levels), (vec![0, 0, 0, 1, 1], 2));
}

#[test]
fn pin_that_cannot_be_read_is_an_encoder_fault_and_counts_nothing() {
    let broken = Transaction::get(State::High).with_error(MockError::Io(io::ErrorKind::Other));
    let mut a = Mock::new(&[Transaction::get(State::Low), broken]);
    let mut b = Mock::new(&[Transaction::get(State::Low)]);
    let mut decoder = QuadratureDecoder::new(a.clone(), b.clone());
    assert_eq!(decoder.sample(), Ok(()));
    assert_eq!(decoder.sample(), Err(Fault::Encoder));
    assert_eq!((decoder.count(), decoder.glitches()), (0, 0));
    a.done();
    b.done();
}

#[test]
fn timer_of_sixteen_bits_counts_on_across_its_wraps_both_ways() {
    let mut wide = WideCount::new();
    let mut true_count = 0_i32;
    // Each step is at most just under half a turn.
    for step in [1, 32_767, 30_000, 12_000, -32_767, -32_767, -32_767, 5, -80] {
        true_count += step;
        let [low, high, ..] = true_count.to_le_bytes();
        assert_eq!(wide.extend(u16::from_le_bytes([low, high])), true_count);
    }
    assert!(true_count < -20_000, "{true_count}");
}
