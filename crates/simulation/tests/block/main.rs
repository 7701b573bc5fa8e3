//! Simulated blocks, as a user of the crate runs them.

#[cfg(test)]
mod shipped;
