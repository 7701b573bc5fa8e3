//! Transport of the log: a buffer that the debugger reads while the processor runs (RTT).
//!
//! If the buffer is not read, or is full, bytes are dropped: logging never waits, and nothing in it
//! can panic.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

const SIZE: u32 = 2048;

static BUFFER: [AtomicU8; SIZE as usize] = [const { AtomicU8::new(0) }; SIZE as usize];

/// Structure that the debugger looks for: the layout is SEGGER's, with one channel to the PC and
/// none back.
#[repr(C)]
struct ControlBlock {
    id: [u8; 16],
    channels_up: u32,
    channels_down: u32,
    name: &'static [u8; 6],
    buffer: &'static [AtomicU8; SIZE as usize],
    size: u32,
    write: AtomicU32,
    /// Written by the debugger.
    read: AtomicU32,
    /// Written by the debugger. Its request to wait is ignored.
    flags: AtomicU32,
}

#[unsafe(no_mangle)]
static _SEGGER_RTT: ControlBlock = ControlBlock {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_up: 1,
    channels_down: 0,
    name: b"defmt\0",
    buffer: &BUFFER,
    size: SIZE,
    write: AtomicU32::new(0),
    read: AtomicU32::new(0),
    flags: AtomicU32::new(0),
};

/// Appends bytes to the buffer as far as they fit.
pub(in super::super) fn carry_log(bytes: &[u8]) {
    let channel = &_SEGGER_RTT;
    let mut write = channel.write.load(Ordering::Relaxed);
    for &byte in bytes {
        let next = (write + 1) % SIZE;
        if next == channel.read.load(Ordering::Acquire) {
            break;
        }
        if let Some(place) = channel.buffer.get(write as usize) {
            place.store(byte, Ordering::Relaxed);
        }
        write = next;
    }
    channel.write.store(write, Ordering::Release);
}
