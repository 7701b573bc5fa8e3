//! Encoder counts: from a timer of the chip, or decoded from two pins.

use embedded_hal::digital::InputPin;
use heapless::Vec;

use super::MAX_LATCHES;
use crate::flight::fault::Fault;
use crate::flight::shutter_edge::ShutterEdge;

/// A counter of quadrature edges; a timer of the chip in encoder mode, mostly.
///
/// It counts every edge of both channels, wraps from `i32::MAX` to `i32::MIN` and back, and never
/// stops. The implementation extends a timer of 16 bits to 32, and must be asked at least once per
/// half turn of it: at 0.1 µm per edge and 50 mm/s every 65 ms.
pub trait QuadratureCounter {
    /// Edges so far, one direction up and the other down.
    fn count(&mut self) -> i32;

    /// Returns the count that was latched at the last crossing of the index mark; `None` if there
    /// was none since the last call, or there is no mark.
    fn take_index(&mut self) -> Option<i32> {
        None
    }

    /// Returns the count that hardware latched at the last edge of this kind of the shutter's
    /// sensor; `None` if there was none since the last call, or more than one.
    fn take_latched(&mut self, edge: ShutterEdge) -> Option<i32> {
        let _ = edge;
        None
    }

    /// Returns the counts that hardware has latched before the last call of [`Self::count`], each
    /// with its age then, s; the oldest first. Those of earlier calls may be among them.
    fn take_latches(&mut self) -> Vec<(f32, i32), MAX_LATCHES> {
        Vec::new()
    }
}

/// Extends a timer's count, which wraps at 16 bits, to one that wraps at 32 bits.
///
/// It must be asked at least once per half turn, 32,768 edges: at 0.1 µm per edge and 50 mm/s every
/// 65 ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WideCount {
    last: u16,
    count: i32,
}

impl WideCount {
    /// Returns a count that is 0 where the timer has 0.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: 0, count: 0 }
    }

    /// Returns the count at a reading of the timer: the one nearest to the last.
    pub fn extend(&mut self, timer: u16) -> i32 {
        let step = timer.wrapping_sub(self.last).cast_signed();
        self.last = timer;
        self.count = self.count.wrapping_add(i32::from(step));
        self.count
    }

    /// Returns the count at a reading of the timer shortly before or after the last one, which
    /// stays.
    #[must_use]
    pub fn near(&self, timer: u16) -> i32 {
        let step = timer.wrapping_sub(self.last).cast_signed();
        self.count.wrapping_add(i32::from(step))
    }
}

/// Counts the edges of two pins, in an interrupt at each edge or at a rate above theirs.
///
/// It is for bench set-ups and slow stages: at 17 mm/s and 0.5 µm per edge there are 34 000 edges
/// per second. A transition of both pins at once has no direction; it is counted as a glitch and
/// leaves the count unchanged.
#[derive(Debug)]
pub struct QuadratureDecoder<A, B> {
    a: A,
    b: B,
    phase: Option<u8>,
    count: i32,
    glitches: u32,
}

impl<A: InputPin, B: InputPin> QuadratureDecoder<A, B> {
    /// Returns a decoder at 0; channel A leads where the count rises.
    pub const fn new(a: A, b: B) -> Self {
        Self {
            a,
            b,
            phase: None,
            count: 0,
            glitches: 0,
        }
    }

    /// Reads the pins and counts.
    ///
    /// # Errors
    /// [`Fault::Encoder`] if a pin cannot be read; nothing is counted then.
    pub fn sample(&mut self) -> Result<(), Fault> {
        let a = self.a.is_high().map_err(|_| Fault::Encoder)?;
        let b = self.b.is_high().map_err(|_| Fault::Encoder)?;
        // 00, 10, 11, 01 are quarters 0 to 3 of a period in which A leads.
        let phase = 2 * u8::from(b) + u8::from(a != b);
        let before = self.phase.replace(phase).unwrap_or(phase);
        match phase.wrapping_sub(before) & 3 {
            1 => self.count = self.count.wrapping_add(1),
            3 => self.count = self.count.wrapping_sub(1),
            2 => self.glitches = self.glitches.saturating_add(1),
            _ => {}
        }
        Ok(())
    }

    /// Transitions without a direction: noise, or edges faster than samples.
    pub const fn glitches(&self) -> u32 {
        self.glitches
    }
}

impl<A: InputPin, B: InputPin> QuadratureCounter for QuadratureDecoder<A, B> {
    fn count(&mut self) -> i32 {
        self.count
    }
}
