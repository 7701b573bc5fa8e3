//! Comparison of a kernel on a slice with the portable kernel on its single points, in both
//! layouts.

use core::fmt;
use core::hint::black_box;

use fmc_camera_kernel::{Coefficients, full_pairs, full_xy, portable, short_pairs, short_xy};

use crate::arithmetic::Arithmetic;

/// Largest number of points of a comparison.
pub(crate) const MOST: usize = 300;
/// Value of the memory before and after the points.
const GUARD: f32 = -7.25;
/// Count of numbers before the first point: the second makes a slice that is aligned to four bytes
/// and not to eight.
const OFFSETS: [usize; 2] = [2, 3];
/// Count of numbers in a buffer: points, and guards on both sides.
const ROOM: usize = 2 * MOST + 8;

/// A result that differs from the portable kernel's.
#[derive(Debug)]
pub(crate) struct Difference {
    /// Name of the kernel or property.
    pub(crate) what: &'static str,
    /// Number of points.
    pub(crate) points: usize,
    /// Index of the first number in memory that differs.
    pub(crate) index: usize,
    /// Bits that were found.
    pub(crate) found: u32,
    /// Bits of the portable kernel.
    pub(crate) expected: u32,
}

impl Difference {
    /// Returns the difference for a number of points that is not allowed.
    pub(crate) fn of_count(what: &'static str, points: usize) -> Self {
        Self {
            what,
            points,
            index: 0,
            found: 0,
            expected: 0,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            what,
            points,
            index,
            found,
            expected,
        } = self;
        write!(
            f,
            "{what}, {points} points: number {index} is {found:#010x}, must be {expected:#010x}"
        )
    }
}

/// Memory aligned to eight bytes.
#[repr(align(8))]
struct Memory([f32; ROOM]);

type Pairs = fn(&Coefficients, &mut [[f32; 2]]);
type Xy = fn(&Coefficients, &mut [f32], &mut [f32]);

type Single = fn(&Coefficients, [f32; 2]) -> [f32; 2];

const PAIRS: [(&str, Pairs, Single); 2] = [
    ("short_pairs", short_pairs, portable::short),
    ("full_pairs", full_pairs, portable::full),
];
const XY: [(&str, Xy, Single); 2] = [
    ("short_xy", short_xy, portable::short),
    ("full_xy", full_xy, portable::full),
];

/// Compares pairs, through the short and the full form, with single points. `arithmetic` applies to
/// single numbers: to the reference, and to the points that a kernel does not put into its vectors.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn pairs(
    form: &Coefficients,
    points: &[[f32; 2]],
    arithmetic: Arithmetic,
) -> Result<(), Difference> {
    for (what, kernel, single) in PAIRS {
        for offset in OFFSETS {
            let run = |work: &dyn Fn(&mut [[f32; 2]])| {
                let mut memory = Memory([GUARD; ROOM]);
                let (slots, _) = memory.0.split_at_mut(ROOM - 2);
                let (_, slots) = slots.split_at_mut(offset);
                let (slots, _) = slots.as_chunks_mut::<2>();
                let (slots, _) = slots.split_at_mut(points.len());
                slots.copy_from_slice(points);
                work(slots);
                memory
            };
            let found = run(&|slots| arithmetic.run(|| kernel(black_box(form), slots)));
            let expected = run(&|slots| one_by_one(single, form, slots.iter_mut(), arithmetic));
            same(what, points.len(), &found, &expected)?;
        }
    }
    Ok(())
}

/// Compares the same points with x and y in separate slices.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn xy(
    form: &Coefficients,
    points: &[[f32; 2]],
    arithmetic: Arithmetic,
) -> Result<(), Difference> {
    for (what, kernel, single) in XY {
        for offset in OFFSETS {
            let run = |work: &dyn Fn(&mut [f32], &mut [f32])| {
                let mut memory = Memory([GUARD; ROOM]);
                let (x, y) = memory.0.split_at_mut(ROOM / 2);
                let (_, x) = x.split_at_mut(offset);
                let (x, _) = x.split_at_mut(points.len());
                let (y, _) = y.split_at_mut(points.len());
                for ((x, y), point) in x.iter_mut().zip(y.iter_mut()).zip(points) {
                    [*x, *y] = *point;
                }
                work(x, y);
                memory
            };
            let found = run(&|x, y| arithmetic.run(|| kernel(black_box(form), x, y)));
            let expected = run(&|x, y| {
                let mut slots = [[0.0; 2]; MOST];
                for (slot, point) in slots.iter_mut().zip(points) {
                    *slot = *point;
                }
                let slots = slots.split_at_mut(points.len()).0;
                one_by_one(single, form, slots.iter_mut(), arithmetic);
                for ((x, y), slot) in x.iter_mut().zip(y).zip(slots) {
                    [*x, *y] = *slot;
                }
            });
            same(what, points.len(), &found, &expected)?;
        }
    }
    Ok(())
}

/// Largest difference of coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound {
    /// Difference in addition to one unit in the last place.
    pub(crate) difference_mm: f32,
    /// Largest coordinate that may differ.
    pub(crate) up_to_mm: f32,
}

/// Compares every form and layout with single points in IEEE arithmetic; returns how many
/// coordinates differ.
///
/// # Errors
/// The first [`Difference`] beyond the bound.
pub(crate) fn within(
    form: &Coefficients,
    points: &[[f32; 2]; MOST],
    bound: Bound,
) -> Result<usize, Difference> {
    let mut different = 0;
    for ((what, pairs, single), (_, xy, _)) in PAIRS.into_iter().zip(XY) {
        let mut as_pairs = *points;
        pairs(form, &mut as_pairs);
        let (mut x, mut y) = (points.map(|[x, _]| x), points.map(|[_, y]| y));
        xy(form, &mut x, &mut y);
        let mut expected = *points;
        one_by_one(single, form, expected.iter_mut(), Arithmetic::Gradual);
        let found = as_pairs.iter().zip(x.iter().zip(&y));
        for (index, ((pair, (x, y)), expected)) in found.zip(&expected).enumerate() {
            for (found, expected) in pair.iter().chain([x, y]).zip(expected.iter().cycle()) {
                if found.to_bits() == expected.to_bits() {
                    continue;
                }
                different += 1;
                let most = bound.difference_mm + f32::EPSILON * expected.abs();
                let is_within =
                    (found - expected).abs() <= most && expected.abs() <= bound.up_to_mm;
                if !is_within {
                    return Err(Difference {
                        what,
                        points: MOST,
                        index,
                        found: found.to_bits(),
                        expected: expected.to_bits(),
                    });
                }
            }
        }
    }
    Ok(different)
}

/// Runs the portable kernel on single numbers, from a black box and into it, so that no compiler
/// combines points.
fn one_by_one<'a>(
    single: Single,
    form: &Coefficients,
    points: impl Iterator<Item = &'a mut [f32; 2]>,
    arithmetic: Arithmetic,
) {
    arithmetic.run(|| {
        for point in points {
            *point = black_box(single(form, black_box(*point)));
        }
    });
}

fn same(
    what: &'static str,
    points: usize,
    found: &Memory,
    expected: &Memory,
) -> Result<(), Difference> {
    for (index, (found, expected)) in found.0.iter().zip(&expected.0).enumerate() {
        let equal = found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
        if !equal {
            return Err(Difference {
                what,
                points,
                index,
                found: found.to_bits(),
                expected: expected.to_bits(),
            });
        }
    }
    Ok(())
}

/// Checks that the comparison sees a different last bit, sign of zero and NaN.
///
/// # Errors
/// The [`Difference`] that it does not see.
pub(crate) fn sees_differences() -> Result<(), Difference> {
    let (one, next) = (1.0, f32::from_bits(1.0_f32.to_bits() + 1));
    for (found, expected) in [(one, next), (0.0, -0.0), (f32::NAN, one)] {
        let [mut left, mut right] = [Memory([GUARD; ROOM]), Memory([GUARD; ROOM])];
        if let (Some(left), Some(right)) = (left.0.last_mut(), right.0.last_mut()) {
            [*left, *right] = [found, expected];
        }
        if same("control", 0, &left, &right).is_ok() {
            return Err(Difference {
                what: "a difference that is not seen",
                points: 0,
                index: ROOM - 1,
                found: found.to_bits(),
                expected: expected.to_bits(),
            });
        }
    }
    Ok(())
}
