//! A function that can panic, to show that the check is able to fail.

use core::hint::black_box;

/// Keeps the function.
pub(crate) fn keep() {
    keep![table_entry];
}

#[allow(clippy::indexing_slicing, reason = "the panic is the purpose")]
fn table_entry() -> f32 {
    let table = black_box([0.0; 4]);
    table[black_box(4)]
}
