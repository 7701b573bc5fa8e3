//! Accidents on request, of firmware that is built with them.

use std::io::Write as _;
use std::thread;
use std::time::{Duration, Instant};

use host_sim::device::qemu::Qemu;

/// From one look at the camera to the next.
pub(crate) const LOOK_EVERY: Duration = Duration::from_millis(5);

/// The watchdog's quarter of a second is the camera's: a busy PC may take many seconds for it.
const RESTARTED_WITHIN: Duration = Duration::from_mins(2);

/// Stops the main loop, by `h` standing still or by `s` sleeping, until the watchdog has started the camera again.
pub(crate) fn bite_watchdog(qemu: &mut Qemu, drill: u8) {
    qemu.log_wire().write_all(&[drill]).unwrap();
    let start = Instant::now();
    while !qemu
        .log()
        .iter()
        .any(|line| line.contains("starts after watchdog"))
    {
        assert!(start.elapsed() < RESTARTED_WITHIN, "{:?}", qemu.log());
        thread::sleep(LOOK_EVERY);
    }
}
