//! Slices of every length at every alignment, and the memory beside them.

use std::ops::Range;

use crate::call::{FORM, TERMS, assert_all_same, assert_same, batches, portable};

/// Number in the memory that must not be written.
const BESIDE: f32 = -77.25;
/// Smallest count of numbers before and after a slice.
const MARGIN: usize = 20;
/// Numbers in two vectors of the widest level, which is the number of alignments that a slice can
/// have.
pub(crate) const PLACES: usize = 32;

/// Numbers with a margin before and after, at a known alignment, which determines the whole
/// vectors.
pub(crate) struct Placed {
    all: Vec<f32>,
    range: Range<usize>,
}

impl Placed {
    /// Creates a slice that begins `offset` numbers after an address that is a multiple of
    /// [`PLACES`].
    pub(crate) fn new(numbers: &[f32], offset: usize) -> Self {
        let room = numbers.len() + 2 * MARGIN + 2 * PLACES;
        let mut all = vec![BESIDE; room];
        let past = all[MARGIN..].as_ptr().addr() / size_of::<f32>() % PLACES;
        let start = MARGIN + (PLACES - past) % PLACES + offset;
        let range = start..start + numbers.len();
        all[range.clone()].copy_from_slice(numbers);
        Self { all, range }
    }

    /// Creates a slice for results that holds other numbers.
    pub(crate) fn empty(length: usize, offset: usize) -> Self {
        Self::new(&vec![1.0; length], offset)
    }

    fn slice(&mut self) -> &mut [f32] {
        &mut self.all[self.range.clone()]
    }

    pub(crate) fn pairs(&mut self) -> &mut [[f32; 2]] {
        self.slice().as_chunks_mut().0
    }

    /// Asserts that the slice holds the expected numbers and that the margins are unchanged.
    pub(crate) fn assert_holds(&self, name: &str, input: [&[f32]; 2], expected: &[f32]) {
        assert_same(name, input, &self.all[self.range.clone()], expected);
        let before = &self.all[..self.range.start];
        let behind = &self.all[self.range.end..];
        for number in before.iter().chain(behind) {
            assert_eq!(number.to_bits(), BESIDE.to_bits(), "{name}");
        }
    }
}

fn numbers(count: usize, step: f32) -> Vec<f32> {
    let all = (0_u16..=u16::MAX).cycle().take(count);
    all.map(|i| f32::from(i % 251) * step - 20.0).collect()
}

#[test]
fn every_length_and_place_gives_the_same_bits_and_leaves_the_neighbours() {
    for terms in TERMS {
        for length in (0..70).chain([96, 127, 128, 129, 200]) {
            let (x, y) = (numbers(length, 0.31), numbers(length, 0.17));
            let (ideal_x, ideal_y) = portable(&FORM, terms, &x, &y);
            let distortion = |measured: &[f32], ideal: &[f32]| -> Vec<f32> {
                measured.iter().zip(ideal).map(|(m, i)| m - i).collect()
            };
            for (name, batch) in batches(FORM, terms) {
                let alike = (0..PLACES / 2).map(|place| (place, place));
                for (at_x, at_y) in alike.chain([(3, 7), (5, 0), (15, 14)]) {
                    let name = format!("{name}, {length} points at {at_x} and {at_y}");
                    let input = [x.as_slice(), y.as_slice()];
                    let (mut found_x, mut found_y) = (Placed::new(&x, at_x), Placed::new(&y, at_y));
                    batch.xy(found_x.slice(), found_y.slice());
                    found_x.assert_holds(&name, input, &ideal_x);
                    found_y.assert_holds(&name, input, &ideal_y);

                    let mut found_x = Placed::empty(length, at_x);
                    let mut found_y = Placed::empty(length, at_y);
                    batch.xy_into(input, [found_x.slice(), found_y.slice()]);
                    found_x.assert_holds(&name, input, &ideal_x);
                    found_y.assert_holds(&name, input, &ideal_y);

                    let mut found_x = Placed::empty(length, at_y);
                    let mut found_y = Placed::empty(length, at_x);
                    let (mut dx, mut dy) = (Placed::empty(length, at_x), Placed::empty(length, 3));
                    batch.xy_with_distortion(
                        input,
                        [found_x.slice(), found_y.slice()],
                        [dx.slice(), dy.slice()],
                    );
                    found_x.assert_holds(&name, input, &ideal_x);
                    found_y.assert_holds(&name, input, &ideal_y);
                    // One subtraction leads from the point to the ideal one.
                    let (found_dx, found_dy) = (dx.slice().to_vec(), dy.slice().to_vec());
                    assert_same(&name, input, &distortion(&x, &found_dx), &ideal_x);
                    assert_same(&name, input, &distortion(&y, &found_dy), &ideal_y);
                    dx.assert_holds(&name, input, &found_dx);
                    dy.assert_holds(&name, input, &found_dy);
                }
            }
        }
    }
}

#[test]
fn pairs_of_every_length_at_every_half_point_give_the_same_bits() {
    for terms in TERMS {
        for length in (0..70).chain([96, 127, 128, 129, 200]) {
            let (x, y) = (numbers(length, 0.31), numbers(length, 0.17));
            let joined = |x: &[f32], y: &[f32]| -> Vec<f32> {
                x.iter().zip(y).flat_map(|(x, y)| [*x, *y]).collect()
            };
            let flat = joined(&x, &y);
            let (ideal_x, ideal_y) = portable(&FORM, terms, &x, &y);
            let ideal = joined(&ideal_x, &ideal_y);
            for (name, batch) in batches(FORM, terms) {
                for place in 0..PLACES {
                    let name = format!("{name}, {length} pairs at {place}");
                    let mut found = Placed::new(&flat, place);
                    batch.pairs(found.pairs());
                    found.assert_holds(&name, [&flat, &flat], &ideal);

                    let mut found = Placed::empty(2 * length, place);
                    batch.pairs_into(flat.as_chunks().0, found.pairs());
                    found.assert_holds(&name, [&flat, &flat], &ideal);
                }
            }
        }
    }
}

/// Number of points that a thread takes at once.
const SHARE: usize = 1 << 15;

#[test]
fn shares_of_threads_give_the_same_bits_however_short_the_last_is() {
    for terms in TERMS {
        for rest in [0, 1, 5, 16, 31, 33, 127] {
            let length = 2 * SHARE + rest;
            let (x, y) = (numbers(length, 0.31), numbers(length, 0.17));
            let (ideal_x, ideal_y) = portable(&FORM, terms, &x, &y);
            for (name, batch) in batches(FORM, terms) {
                let name = format!("{name}, {length} points");
                assert_all_same(&name, &batch, (&x, &y), (&ideal_x, &ideal_y));
            }
        }
    }
}

#[test]
fn what_a_longer_slice_has_more_stays() {
    let (x, y) = (numbers(50, 0.31), numbers(41, 0.17));
    for terms in TERMS {
        let (ideal_x, ideal_y) = portable(&FORM, terms, &x[..41], &y);
        for (name, batch) in batches(FORM, terms) {
            let (mut found_x, mut found_y) = (x.clone(), y.clone());
            batch.xy(&mut found_x, &mut found_y);
            assert_same(&name, [&x, &y], &found_x[..41], &ideal_x);
            assert_same(&name, [&x, &y], &found_y, &ideal_y);
            assert_eq!(found_x[41..], x[41..], "{name}");

            let (mut found_x, mut found_y) = (vec![7.0; 30], vec![7.0; 60]);
            batch.xy_into([&x, &y], [&mut found_x, &mut found_y]);
            assert_same(&name, [&x, &y], &found_x, &ideal_x[..30]);
            assert_same(&name, [&x, &y], &found_y[..30], &ideal_y[..30]);
            assert_eq!(found_y[30..], [7.0; 30], "{name}");
        }
    }
}
