//! The library for C against the library in Rust, and its header against its sources.

#[cfg(test)]
mod example;
#[cfg(test)]
#[cfg(unix)]
mod guide;
#[cfg(test)]
mod header;
