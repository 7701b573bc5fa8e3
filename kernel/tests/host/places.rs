//! Slices of every length at every place, and what lies beside them.

use crate::call::{FORM, TERMS, assert_same, batches, portable};

/// What must not be touched.
const BESIDE: f32 = -77.25;
/// Points around a slice.
const MARGIN: usize = 20;

/// Numbers with a margin before and behind, `offset` further from where the allocation begins.
fn placed(numbers: &[f32], offset: usize) -> Vec<f32> {
    let mut all = vec![BESIDE; MARGIN + offset];
    all.extend_from_slice(numbers);
    all.resize(all.len() + MARGIN, BESIDE);
    all
}

fn assert_untouched(name: &str, all: &[f32], offset: usize) {
    let before = &all[..MARGIN + offset];
    let behind = &all[all.len() - MARGIN..];
    for number in before.iter().chain(behind) {
        assert_eq!(number.to_bits(), BESIDE.to_bits(), "{name}");
    }
}

fn numbers(count: usize, step: f32) -> Vec<f32> {
    (0_u8..)
        .take(count)
        .map(|i| f32::from(i) * step - 20.0)
        .collect()
}

#[test]
fn every_length_and_place_gives_the_same_bits_and_leaves_the_neighbours() {
    for terms in TERMS {
        for length in (0..70).chain([127, 128, 129, 200]) {
            let (x, y) = (numbers(length, 0.31), numbers(length, 0.17));
            let (ideal_x, ideal_y) = portable(&FORM, terms, &x, &y);
            for (name, batch) in batches(FORM, terms) {
                for (offset_x, offset_y) in [
                    (0, 0),
                    (1, 1),
                    (3, 7),
                    (4, 4),
                    (5, 0),
                    (8, 8),
                    (12, 12),
                    (15, 14),
                ] {
                    let name = format!("{name}, {length} points at {offset_x} and {offset_y}");
                    let range = |offset| MARGIN + offset..MARGIN + offset + length;
                    let mut found_x = placed(&x, offset_x);
                    let mut found_y = placed(&y, offset_y);
                    batch.xy(&mut found_x[range(offset_x)], &mut found_y[range(offset_y)]);
                    assert_untouched(&name, &found_x, offset_x);
                    assert_untouched(&name, &found_y, offset_y);
                    assert_same(&name, [&x, &y], &found_x[range(offset_x)], &ideal_x);
                    assert_same(&name, [&x, &y], &found_y[range(offset_y)], &ideal_y);

                    let mut found_x = placed(&vec![1.0; length], offset_y);
                    let mut found_y = placed(&vec![1.0; length], offset_x);
                    batch.xy_into(
                        [&x, &y],
                        [&mut found_x[range(offset_y)], &mut found_y[range(offset_x)]],
                    );
                    assert_untouched(&name, &found_x, offset_y);
                    assert_untouched(&name, &found_y, offset_x);
                    assert_same(&name, [&x, &y], &found_x[range(offset_y)], &ideal_x);
                    assert_same(&name, [&x, &y], &found_y[range(offset_x)], &ideal_y);
                }
            }
        }
    }
}

#[test]
fn pairs_of_every_length_at_every_half_point_give_the_same_bits() {
    for terms in TERMS {
        for length in (0..70).chain([127, 128, 129]) {
            let (x, y) = (numbers(length, 0.31), numbers(length, 0.17));
            let flat: Vec<f32> = x.iter().zip(&y).flat_map(|(x, y)| [*x, *y]).collect();
            let (ideal_x, ideal_y) = portable(&FORM, terms, &x, &y);
            let ideal: Vec<f32> = ideal_x
                .iter()
                .zip(&ideal_y)
                .flat_map(|(x, y)| [*x, *y])
                .collect();
            for (name, batch) in batches(FORM, terms) {
                for offset in 0..17 {
                    let name = format!("{name}, {length} pairs at {offset}");
                    let range = MARGIN + offset..MARGIN + offset + 2 * length;
                    let mut found = placed(&flat, offset);
                    batch.pairs(found[range.clone()].as_chunks_mut().0);
                    assert_untouched(&name, &found, offset);
                    assert_same(&name, [&flat, &flat], &found[range.clone()], &ideal);

                    let mut found = placed(&vec![1.0; 2 * length], offset);
                    batch.pairs_into(flat.as_chunks().0, found[range.clone()].as_chunks_mut().0);
                    assert_untouched(&name, &found, offset);
                    assert_same(&name, [&flat, &flat], &found[range], &ideal);
                }
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
