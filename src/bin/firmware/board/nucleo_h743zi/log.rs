//! Log for the debugger: defmt frames in a buffer that the debugger reads while the processor runs (RTT).
//!
//! Where nobody reads, or the buffer is full, bytes are dropped: logging never waits, and nothing in it can panic.

use core::{
    cell::UnsafeCell,
    sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering},
};

use cortex_m::{interrupt, register::primask};
use defmt::Encoder;

const SIZE: u32 = 2048;

static BUFFER: [AtomicU8; SIZE as usize] = [const { AtomicU8::new(0) }; SIZE as usize];

/// What the debugger looks for: the layout is SEGGER's, with one channel to the PC and none back.
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
    /// Written by the debugger. It may ask to be waited for; it is not.
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

/// Appends to the buffer what fits.
fn put(bytes: &[u8]) {
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

/// The line under way.
struct Line {
    encoder: UnsafeCell<Encoder>,
    /// Lines begun inside one another: 1, or more where formatting itself logs.
    depth: AtomicU32,
    /// Whether interrupts were on before it.
    interrupts: AtomicBool,
}

// SAFETY: the encoder is used between `acquire` and `release` alone, with interrupts off on the only processor.
unsafe impl Sync for Line {}

static LINE: Line = Line {
    encoder: UnsafeCell::new(Encoder::new()),
    depth: AtomicU32::new(0),
    interrupts: AtomicBool::new(false),
};

#[defmt::global_logger]
struct Log;

// SAFETY: interrupts are off from `acquire` to `release`, so no two lines mix.
unsafe impl defmt::Logger for Log {
    fn acquire() {
        let interrupts = primask::read().is_active();
        interrupt::disable();
        if LINE.depth.fetch_add(1, Ordering::Relaxed) == 0 {
            LINE.interrupts.store(interrupts, Ordering::Relaxed);
            // SAFETY: interrupts are off, and the outermost line has no other reference to the encoder.
            unsafe { &mut *LINE.encoder.get() }.start_frame(put);
        }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        if LINE.depth.fetch_sub(1, Ordering::Relaxed) == 1 {
            // SAFETY: as in `acquire`.
            unsafe { &mut *LINE.encoder.get() }.end_frame(put);
            if LINE.interrupts.load(Ordering::Relaxed) {
                // SAFETY: they were on before `acquire`.
                unsafe { interrupt::enable() };
            }
        }
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: defmt calls this between `acquire` and `release`, never from inside itself.
        unsafe { &mut *LINE.encoder.get() }.write(bytes, put);
    }
}
