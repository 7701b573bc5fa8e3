//! Calls of every entry of the kernel, and the results of the portable one.

use fmc_camera_kernel::{Coefficients, portable};
use fmc_camera_kernel::{
    Terms,
    host::{Batch, Level},
};

pub(crate) use crate::form::FORM;

/// Both forms.
pub(crate) const TERMS: [Terms; 2] = [Terms::Short, Terms::Full];

/// Returns x and y of the ideal points by the portable kernel.
pub(crate) fn portable(
    form: &Coefficients,
    terms: Terms,
    x: &[f32],
    y: &[f32],
) -> (Vec<f32>, Vec<f32>) {
    let (mut x, mut y) = (x.to_vec(), y.to_vec());
    match terms {
        Terms::Short => portable::short_xy(form, &mut x, &mut y),
        Terms::Full => portable::full_xy(form, &mut x, &mut y),
    }
    (x, y)
}

/// Returns the batches to try: every level of this machine, with ordinary stores and past the
/// caches, in one thread and in many.
pub(crate) fn batches(form: Coefficients, terms: Terms) -> Vec<(String, Batch)> {
    let mut batches = Vec::new();
    for level in Level::all() {
        let batch = Batch::new(form, terms).at(level);
        for (stores, bytes) in [("stored", usize::MAX), ("streamed", 0)] {
            for (threads, points) in [("one thread", usize::MAX), ("threads", 0)] {
                batches.push((
                    format!("{level}, {terms:?}, {stores}, {threads}"),
                    batch.streamed_from(bytes).threaded_from(points),
                ));
            }
        }
    }
    batches
}

/// Returns true for equal bits; two NaNs count as equal, because the processor chooses their
/// payload.
pub(crate) fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Asserts that two results of the same points are equal.
pub(crate) fn assert_same(name: &str, input: [&[f32]; 2], found: &[f32], expected: &[f32]) {
    assert_eq!(found.len(), expected.len(), "{name}");
    let differs = found
        .iter()
        .zip(expected)
        .position(|(found, expected)| !same(*found, *expected));
    if let Some(index) = differs {
        panic!(
            "{name}: point {index} ({:e}, {:e}): {:e} instead of {:e}",
            input[0][index], input[1][index], found[index], expected[index]
        );
    }
}

/// Asserts that every entry of a batch gives the result of the portable kernel.
pub(crate) fn assert_all_same(
    name: &str,
    batch: &Batch,
    (x, y): (&[f32], &[f32]),
    (ideal_x, ideal_y): (&[f32], &[f32]),
) {
    let check = |entry: &str, found_x: &[f32], found_y: &[f32]| {
        assert_same(&format!("{name}, {entry}, x"), [x, y], found_x, ideal_x);
        assert_same(&format!("{name}, {entry}, y"), [x, y], found_y, ideal_y);
    };
    let (mut found_x, mut found_y) = (x.to_vec(), y.to_vec());
    batch.xy(&mut found_x, &mut found_y);
    check("xy", &found_x, &found_y);

    let (mut found_x, mut found_y) = (vec![7.0; x.len()], vec![7.0; y.len()]);
    batch.xy_into([x, y], [&mut found_x, &mut found_y]);
    check("xy_into", &found_x, &found_y);

    let (mut found_x, mut found_y) = (vec![7.0; x.len()], vec![7.0; y.len()]);
    let (mut dx, mut dy) = (vec![7.0; x.len()], vec![7.0; y.len()]);
    batch.xy_with_distortion([x, y], [&mut found_x, &mut found_y], [&mut dx, &mut dy]);
    check("xy_with_distortion", &found_x, &found_y);
    // One subtraction leads from the point to the ideal one.
    let by = |from: &[f32], less: &[f32]| -> Vec<f32> {
        from.iter()
            .zip(less)
            .map(|(from, less)| from - less)
            .collect()
    };
    check("distortion", &by(x, &dx), &by(y, &dy));

    let points: Vec<[f32; 2]> = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
    let parted = |points: &[[f32; 2]]| -> (Vec<f32>, Vec<f32>) {
        points.iter().map(|[x, y]| (*x, *y)).unzip()
    };
    let mut found = points.clone();
    batch.pairs(&mut found);
    let (found_x, found_y) = parted(&found);
    check("pairs", &found_x, &found_y);

    let mut found = vec![[7.0; 2]; points.len()];
    batch.pairs_into(&points, &mut found);
    let (found_x, found_y) = parted(&found);
    check("pairs_into", &found_x, &found_y);
}
