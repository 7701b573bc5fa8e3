//! Hardware in the loop; see `tests/board.rs`.
