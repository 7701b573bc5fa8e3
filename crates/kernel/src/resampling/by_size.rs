//! Choice of the code for a number of taps and a number of bands.

use super::portable::{Row, Vectors};
use super::sample::Sample;

/// Calls the code for a number of taps and bands.
#[inline(always)]
pub(super) fn by_size<S: Sample, V>(vectors: V, taps: usize, row: Row<'_, S>) -> u32
where
    V: Copy
        + Vectors<S, 1, 1>
        + Vectors<S, 3, 1>
        + Vectors<S, 4, 1>
        + Vectors<S, 1, 2>
        + Vectors<S, 3, 2>
        + Vectors<S, 4, 2>
        + Vectors<S, 1, 4>
        + Vectors<S, 3, 4>
        + Vectors<S, 4, 4>
        + Vectors<S, 1, 6>
        + Vectors<S, 3, 6>
        + Vectors<S, 4, 6>,
{
    match (taps, row.source.bands()) {
        (1, 1) => row.resample::<1, 1>(vectors),
        (1, 3) => row.resample::<3, 1>(vectors),
        (1, _) => row.resample::<4, 1>(vectors),
        (2, 1) => row.resample::<1, 2>(vectors),
        (2, 3) => row.resample::<3, 2>(vectors),
        (2, _) => row.resample::<4, 2>(vectors),
        (4, 1) => row.resample::<1, 4>(vectors),
        (4, 3) => row.resample::<3, 4>(vectors),
        (4, _) => row.resample::<4, 4>(vectors),
        (_, 1) => row.resample::<1, 6>(vectors),
        (_, 3) => row.resample::<3, 6>(vectors),
        (_, _) => row.resample::<4, 6>(vectors),
    }
}
