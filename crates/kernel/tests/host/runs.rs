//! Points of many frames behind each other, in runs of every length, at every alignment.

use fmc_camera_kernel::host::{Level, Run, Runs};
use fmc_camera_kernel::{Coefficients, Terms};

use crate::call::{FORM, TERMS, assert_same, portable};
use crate::places::{PLACES, Placed};

/// Returns runs of random lengths below a limit, each of a frame of its own.
fn runs(random: &mut fastrand::Rng, count: usize, longest: usize) -> Vec<Run> {
    let run = |_| Run {
        form: Coefficients {
            cx: random.f32(),
            cy: -random.f32(),
            ..FORM
        },
        terms: TERMS[random.usize(..2)],
        points: random.usize(..=longest),
    };
    (0..count).map(run).collect()
}

/// Returns the ideal points of some by the portable kernel, run by run; those beyond the runs as
/// `beyond` has them.
fn expected(runs: &[Run], points: &[[f32; 2]], beyond: &[[f32; 2]]) -> Vec<f32> {
    let mut found = Vec::new();
    for run in runs {
        let (x, y): (Vec<f32>, Vec<f32>) = points[found.len() / 2..]
            .iter()
            .take(run.points)
            .map(|[x, y]| (*x, *y))
            .unzip();
        let (x, y) = portable(&run.form, run.terms, &x, &y);
        found.extend(x.iter().zip(&y).flat_map(|(x, y)| [*x, *y]));
    }
    found.extend(beyond[found.len() / 2..].iter().flatten());
    found
}

fn points(random: &mut fastrand::Rng, count: usize) -> Vec<[f32; 2]> {
    let mut about = || 80.0 * random.f32() - 40.0;
    (0..count).map(|_| [about(), about()]).collect()
}

/// Asserts that all levels give the bits of the portable kernel, and leave the neighbours alone.
fn assert_levels_are_the_same(runs: &[Run], points: &[[f32; 2]], [from, to]: [usize; 2]) {
    let other = vec![[1.0; 2]; points.len()];
    let in_place = expected(runs, points, points);
    let elsewhere = expected(runs, points, &other);
    let numbers = points.as_flattened();
    for level in Level::all() {
        let all = Runs::new().at(level);
        let mut placed = Placed::new(numbers, to);
        all.pairs(&mut runs.iter().copied(), placed.pairs());
        let name = format!("{level}, in place at {to}");
        placed.assert_holds(&name, [numbers, numbers], &in_place);
        for bytes in [0, usize::MAX] {
            let mut given = Placed::new(numbers, from);
            let mut placed = Placed::empty(numbers.len(), to);
            let all = all.streamed_from(bytes);
            all.pairs_into(&mut runs.iter().copied(), given.pairs(), placed.pairs());
            let name = format!("{level}, from {from} to {to}, streamed from {bytes}");
            placed.assert_holds(&name, [numbers, numbers], &elsewhere);
            given.assert_holds(&name, [numbers, numbers], numbers);
        }
    }
}

#[test]
fn runs_of_every_length_and_place_have_the_bits_of_the_portable_kernel() {
    let mut random = fastrand::Rng::with_seed(3);
    for longest in [1, 2, 5, 17, 40, 200] {
        for place in 0..PLACES {
            let runs = runs(&mut random, 40, longest);
            let count = runs.iter().map(|run| run.points).sum();
            let points = points(&mut random, count);
            assert_levels_are_the_same(&runs, &points, [random.usize(..PLACES), place]);
        }
    }
}

#[test]
fn points_beyond_the_runs_stay_and_runs_beyond_the_points_end() {
    let mut random = fastrand::Rng::with_seed(4);
    for count in (0..70).chain([127, 128, 129]) {
        let points = points(&mut random, count);
        for total in [
            0,
            1,
            count / 2,
            count.saturating_sub(1),
            count + 1,
            3 * count,
        ] {
            let mut runs = runs(&mut random, 5, total / 5 + 1);
            runs.truncate(random.usize(..=5));
            assert_levels_are_the_same(&runs, &points, [0, random.usize(..PLACES)]);
        }
    }
}

#[test]
fn shorter_slice_of_both_counts() {
    let run = Run {
        form: FORM,
        terms: Terms::Full,
        points: usize::MAX / 2,
    };
    for [given, room] in [[40, 21], [21, 40]] {
        let points = points(&mut fastrand::Rng::with_seed(5), given);
        for level in Level::all() {
            let mut ideal = vec![[1.0; 2]; room];
            let runs = Runs::new().at(level);
            runs.pairs_into(&mut [run].into_iter(), &points, &mut ideal);
            let mut kept = expected(&[run], &points[..21], &points[..21]);
            kept.resize(2 * room, 1.0);
            let numbers = points.as_flattened();
            assert_same(
                &format!("{level}"),
                [numbers; 2],
                ideal.as_flattened(),
                &kept,
            );
        }
    }
}
