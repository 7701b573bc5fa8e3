//! Functions that checks of the library need, and that the library does not have: one that can
//! panic, and the correction by itself.

#![expect(unreachable_pub, reason = "only C calls them")]

use fmc::geometry::sensor::SensorPoint;

use crate::memory;
use crate::{fmc_frame, fmc_point};

/// Returns the element of an index, which the link check must find: it panics beyond the last.
///
/// # Safety
/// There are `count` elements.
#[unsafe(no_mangle)]
#[expect(clippy::indexing_slicing, reason = "it is to panic")]
pub unsafe extern "C" fn fmc_can_panic(elements: *const u8, count: usize, index: usize) -> u8 {
    // SAFETY: the caller's promise.
    let elements = unsafe { core::slice::from_raw_parts(elements, count) };
    elements[index]
}

/// Corrects points as `fmc_correct` does, behind its checks: the difference of both is what a call
/// from C costs.
///
/// # Safety
/// All pointers are to initialised objects, `points` to `count` of them.
#[unsafe(no_mangle)]
#[inline(never)]
pub unsafe extern "C" fn fmc_bare_correct(
    frame: *const fmc_frame,
    points: *mut fmc_point,
    count: usize,
) {
    // SAFETY: the caller's promise.
    let frame = unsafe { memory::known(frame) };
    // SAFETY: the caller's promise; both types are two numbers.
    let points = unsafe { core::slice::from_raw_parts_mut(points.cast::<SensorPoint>(), count) };
    frame.correction.correct_slice(points);
}
