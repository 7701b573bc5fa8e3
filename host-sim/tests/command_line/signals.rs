//! Signals that a test may send to its programs.

use std::fs;

use rustix::process::Signal;

/// Returns true if a caller of this test has told it, and so its children, to ignore a signal.
pub(crate) fn is_ignored(signal: Signal) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut lines = status.lines();
    let mask = lines.find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = mask.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
    let bit = 1 << (signal.as_raw() - 1);
    ignored & bit != 0
}

/// Returns the signal of Ctrl-C, or where that is ignored the one that is to do the same.
pub(crate) fn ctrl_c() -> Signal {
    if is_ignored(Signal::INT) {
        Signal::TERM
    } else {
        Signal::INT
    }
}
