//! Kernel for Cortex-M4F and M7: blocks of three points by `thumbv7em.s`; the remaining points are
//! returned to the caller.

use core::arch::global_asm;

use crate::Coefficients;

global_asm!(include_str!("thumbv7em.s"), options(raw));

/// Number of points in a block.
const BLOCK: usize = 3;

/// Three points (x, y) in memory.
type Pairs = [[f32; 2]; BLOCK];
/// Three x or three y in memory.
type Singles = [f32; BLOCK];

type PairKernel = unsafe extern "C" fn(*mut Pairs, blocks: usize, *const Coefficients);
type XyKernel =
    unsafe extern "C" fn(*mut Singles, *mut Singles, blocks: usize, *const Coefficients);

unsafe extern "C" {
    fn fmc_camera_kernel_short_pairs(_: *mut Pairs, blocks: usize, _: *const Coefficients);
    fn fmc_camera_kernel_full_pairs(_: *mut Pairs, blocks: usize, _: *const Coefficients);
    fn fmc_camera_kernel_short_xy(
        x: *mut Singles,
        y: *mut Singles,
        blocks: usize,
        _: *const Coefficients,
    );
    fn fmc_camera_kernel_full_xy(
        x: *mut Singles,
        y: *mut Singles,
        blocks: usize,
        _: *const Coefficients,
    );
    safe fn fmc_camera_kernel_sqrt(_: f32) -> f32;
}

/// Performs [`crate::sqrt`].
#[inline]
pub(crate) fn sqrt(number: f32) -> f32 {
    fmc_camera_kernel_sqrt(number)
}

/// Performs [`crate::short_pairs`] on whole blocks and returns the points left over.
#[inline]
pub(crate) fn short_pairs<'a>(
    form: &Coefficients,
    points: &'a mut [[f32; 2]],
) -> &'a mut [[f32; 2]] {
    pairs(fmc_camera_kernel_short_pairs, form, points)
}

/// Performs [`crate::full_pairs`] on whole blocks and returns the points left over.
#[inline]
pub(crate) fn full_pairs<'a>(
    form: &Coefficients,
    points: &'a mut [[f32; 2]],
) -> &'a mut [[f32; 2]] {
    pairs(fmc_camera_kernel_full_pairs, form, points)
}

/// Performs [`crate::short_xy`] on whole blocks and returns the coordinates left over.
#[inline]
pub(crate) fn short_xy<'a>(
    form: &Coefficients,
    x: &'a mut [f32],
    y: &'a mut [f32],
) -> (&'a mut [f32], &'a mut [f32]) {
    xy(fmc_camera_kernel_short_xy, form, x, y)
}

/// Performs [`crate::full_xy`] on whole blocks and returns the coordinates left over.
#[inline]
pub(crate) fn full_xy<'a>(
    form: &Coefficients,
    x: &'a mut [f32],
    y: &'a mut [f32],
) -> (&'a mut [f32], &'a mut [f32]) {
    xy(fmc_camera_kernel_full_xy, form, x, y)
}

/// Calls one of the two kernels of pairs.
#[inline]
fn pairs<'a>(
    kernel: PairKernel,
    form: &Coefficients,
    points: &'a mut [[f32; 2]],
) -> &'a mut [[f32; 2]] {
    let (blocks, rest) = points.as_chunks_mut();
    if !blocks.is_empty() {
        // SAFETY: both kernels read and write the given number of blocks, at least one, from the
        // first on, which here is all of one slice that is borrowed exclusively. They read the
        // fourteen coefficients and nothing else, and follow the ABI. Loads and stores of several
        // words need only the alignment of f32.
        unsafe { kernel(blocks.as_mut_ptr(), blocks.len(), form) }
    }
    rest
}

/// Calls one of the two kernels of separate coordinates.
#[inline]
fn xy<'a>(
    kernel: XyKernel,
    form: &Coefficients,
    x: &'a mut [f32],
    y: &'a mut [f32],
) -> (&'a mut [f32], &'a mut [f32]) {
    // Both have one length, so that the rest begins at the same point in both.
    let points = x.len().min(y.len());
    let x = x.get_mut(..points).unwrap_or_default();
    let y = y.get_mut(..points).unwrap_or_default();
    let (x_blocks, x_rest) = x.as_chunks_mut();
    let (y_blocks, y_rest) = y.as_chunks_mut();
    let blocks = x_blocks.len().min(y_blocks.len());
    if blocks > 0 {
        // SAFETY: as in `pairs`; each of the two slices has at least this many blocks, and they do
        // not overlap, as both are borrowed exclusively.
        unsafe { kernel(x_blocks.as_mut_ptr(), y_blocks.as_mut_ptr(), blocks, form) }
    }
    (x_rest, y_rest)
}
