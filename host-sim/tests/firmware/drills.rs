//! Accidents on request, in firmware that is built with them.

use std::io::Write as _;
use std::thread;
use std::time::{Duration, Instant};

use host_sim::device::qemu::Qemu;

/// Time from one look at the camera to the next.
pub(crate) const LOOK_EVERY: Duration = Duration::from_millis(5);

/// Longest time until the restart: the watchdog's quarter of a second is camera time, which may
/// take many seconds on a busy PC.
const RESTARTED_WITHIN: Duration = Duration::from_mins(2);

/// Stops the main loop (`h`) or lets it sleep (`s`) until the watchdog has restarted the camera.
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
