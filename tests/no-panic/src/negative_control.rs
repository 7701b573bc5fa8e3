//! A function that can panic and one that can overflow, to show that the checks are able to fail.

use core::hint::black_box;

/// Keeps the functions.
pub(crate) fn keep() {
    keep![table_entry, sum];
}

#[allow(clippy::indexing_slicing, reason = "the panic is the purpose")]
fn table_entry() -> f32 {
    let table = black_box([0.0; 4]);
    table[black_box(4)]
}

fn sum(a: u32, b: u32) -> u32 {
    a + b
}
