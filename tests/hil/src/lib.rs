//! Tests with hardware in the loop; see `tests/board.rs`.
