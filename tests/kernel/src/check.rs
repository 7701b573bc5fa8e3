//! One comparison: the same points through the kernel and, one at a time, through the portable one, in both layouts.

use core::fmt;
use core::hint::black_box;
use core::slice;

use fmc_camera_kernel::{Coefficients, portable};

use crate::subnormal::{Numbers, flushed};

/// Most points of one comparison.
pub(crate) const MOST: usize = 300;
/// What lies before and after the points.
const GUARD: f32 = -7.25;
/// Numbers before the first point: the second makes a slice that is aligned to four bytes and not to eight.
const OFFSETS: [usize; 2] = [2, 3];
/// Numbers of a buffer: points, and guards on both sides.
const ROOM: usize = 2 * MOST + 8;

/// A result that is not the portable kernel's.
#[derive(Debug)]
pub(crate) struct Difference {
    /// What was compared.
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

/// Memory that starts on eight bytes.
#[repr(align(8))]
struct Memory([f32; ROOM]);

type Pairs = fn(&Coefficients, &mut [[f32; 2]]);
type Xy = fn(&Coefficients, &mut [f32], &mut [f32]);

/// The portable kernel, a point at a time, so that no compiler makes vectors of them.
macro_rules! one_at_a_time {
    (pairs $kernel:path) => {
        |form, points| {
            for point in points {
                $kernel(form, black_box(slice::from_mut(point)));
            }
        }
    };
    (xy $kernel:path) => {
        |form, x, y| {
            for (x, y) in x.iter_mut().zip(y) {
                let (x, y) = black_box((slice::from_mut(x), slice::from_mut(y)));
                $kernel(form, x, y);
            }
        }
    };
}

/// Name, kernel, and what it is held against.
const PAIRS: [(&str, Pairs, Pairs); 2] = [
    (
        "short_pairs",
        fmc_camera_kernel::short_pairs,
        one_at_a_time!(pairs portable::short_pairs),
    ),
    (
        "full_pairs",
        fmc_camera_kernel::full_pairs,
        one_at_a_time!(pairs portable::full_pairs),
    ),
];
const XY: [(&str, Xy, Xy); 2] = [
    (
        "short_xy",
        fmc_camera_kernel::short_xy,
        one_at_a_time!(xy portable::short_xy),
    ),
    (
        "full_xy",
        fmc_camera_kernel::full_xy,
        one_at_a_time!(xy portable::full_xy),
    ),
];

/// Pairs through the short and the full form.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn pairs(
    numbers: Numbers,
    form: &Coefficients,
    points: &[[f32; 2]],
) -> Result<(), Difference> {
    for (what, kernel, portable) in PAIRS {
        for offset in OFFSETS {
            let run = |kernel: Pairs| {
                let mut memory = Memory([GUARD; ROOM]);
                let (slots, _) = memory.0.split_at_mut(ROOM - 2);
                let (_, slots) = slots.split_at_mut(offset);
                let (slots, _) = slots.as_chunks_mut::<2>();
                let (slots, _) = slots.split_at_mut(points.len());
                slots.copy_from_slice(points);
                kernel(form, slots);
                memory
            };
            let expected = run(portable);
            let or = flushed(numbers, || run(portable));
            same(what, points.len(), &run(kernel), &expected, or.as_ref())?;
        }
    }
    Ok(())
}

/// The same points with x and y apart.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn xy(
    numbers: Numbers,
    form: &Coefficients,
    points: &[[f32; 2]],
) -> Result<(), Difference> {
    for (what, kernel, portable) in XY {
        for offset in OFFSETS {
            let run = |kernel: Xy| {
                let mut memory = Memory([GUARD; ROOM]);
                let (x, y) = memory.0.split_at_mut(ROOM / 2);
                let (_, x) = x.split_at_mut(offset);
                let (x, _) = x.split_at_mut(points.len());
                let (y, _) = y.split_at_mut(points.len());
                for ((x, y), point) in x.iter_mut().zip(y.iter_mut()).zip(points) {
                    [*x, *y] = *point;
                }
                kernel(form, x, y);
                memory
            };
            let expected = run(portable);
            let or = flushed(numbers, || run(portable));
            same(what, points.len(), &run(kernel), &expected, or.as_ref())?;
        }
    }
    Ok(())
}

/// Whether every number is the expected one, or that of `or`.
fn same(
    what: &'static str,
    points: usize,
    found: &Memory,
    expected: &Memory,
    or: Option<&Memory>,
) -> Result<(), Difference> {
    let or = or.unwrap_or(expected);
    let numbers = found.0.iter().zip(&expected.0).zip(&or.0);
    for (index, ((found, expected), or)) in numbers.enumerate() {
        if !equal(*found, *expected) && !equal(*found, *or) {
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

fn equal(found: f32, expected: f32) -> bool {
    found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan())
}

/// Shows that a last bit, a sign of zero and a NaN are seen where they differ.
///
/// # Errors
/// Where one is not.
pub(crate) fn sees_differences() -> Result<(), Difference> {
    let (one, next) = (1.0, f32::from_bits(1.0_f32.to_bits() + 1));
    for (found, expected) in [(one, next), (0.0, -0.0), (f32::NAN, one)] {
        let [mut left, mut right] = [Memory([GUARD; ROOM]), Memory([GUARD; ROOM])];
        if let (Some(left), Some(right)) = (left.0.last_mut(), right.0.last_mut()) {
            [*left, *right] = [found, expected];
        }
        if same("control", 0, &left, &right, None).is_ok() {
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
