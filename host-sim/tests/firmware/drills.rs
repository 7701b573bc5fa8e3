//! Accidents on request, in firmware that is built with them.

use std::io::Write as _;
use std::thread;
use std::time::{Duration, Instant};

use fmc_camera::io::link::message::ResetCause;
use host_sim::device::qemu::Qemu;

/// Time from one look at the camera to the next.
pub(crate) const LOOK_EVERY: Duration = Duration::from_millis(5);

/// Longest time until the restart: the watchdog's quarter of a second is camera time, which may
/// take many seconds on a busy PC.
pub(crate) const RESTARTED_WITHIN: Duration = Duration::from_mins(2);

/// Accident after which the camera starts again: its byte, and what the start is told to follow.
pub(crate) struct Drill {
    byte: u8,
    pub(crate) cause: ResetCause,
    pub(crate) start: &'static str,
}

impl Drill {
    const fn new(byte: u8, cause: ResetCause, start: &'static str) -> Self {
        Self { byte, cause, start }
    }
}

/// The watchdog bites: the main loop stops, or sleeps without an event that wakes it.
pub(crate) const WATCHDOG: [Drill; 2] = [
    Drill::new(b'h', ResetCause::Watchdog, "starts after watchdog"),
    Drill::new(b's', ResetCause::Watchdog, "starts after watchdog"),
];

/// The stack overflows, in the main loop or in an interrupt.
pub(crate) const OVERFLOW: [Drill; 2] = [
    Drill::new(
        b'o',
        ResetCause::StackOverflow,
        "starts after stack overflow",
    ),
    Drill::new(
        b'i',
        ResetCause::StackOverflow,
        "starts after stack overflow",
    ),
];

/// Brings an accident about and waits until the camera has started again.
pub(crate) fn restart_by(qemu: &mut Qemu, drill: &Drill) {
    let starts = |qemu: &Qemu| {
        let lines = qemu.log();
        lines
            .iter()
            .filter(|line| line.contains(drill.start))
            .count()
    };
    let before = starts(qemu);
    qemu.log_wire().write_all(&[drill.byte]).unwrap();
    let start = Instant::now();
    while starts(qemu) == before {
        assert!(start.elapsed() < RESTARTED_WITHIN, "{:?}", qemu.log());
        thread::sleep(LOOK_EVERY);
    }
}
