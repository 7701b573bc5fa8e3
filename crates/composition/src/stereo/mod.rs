//! Stereo check.
