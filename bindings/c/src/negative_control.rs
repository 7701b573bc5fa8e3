//! A function that can panic, for the check that a link finds it.

/// Returns the element of an index.
///
/// # Safety
/// There are `count` elements.
#[unsafe(no_mangle)]
#[expect(clippy::indexing_slicing, reason = "it is to panic")]
pub unsafe extern "C" fn fmc_negative_control(
    elements: *const u8,
    count: usize,
    index: usize,
) -> u8 {
    // SAFETY: the caller's promise.
    unsafe { core::slice::from_raw_parts(elements, count) }
    [index]
}
