//! Bytes that belong to no frame.

/// Counts bytes that belong to no frame. A frame that is ignored cannot be checked, and counts as a
/// frame if another one begins behind it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Unexplained {
    bytes: u32,
    /// Bytes still to come of an ignored frame.
    to_come: u32,
    /// Bytes of it that have been dropped.
    passed: u32,
}

impl Unexplained {
    pub(super) const NONE: Self = Self {
        bytes: 0,
        to_come: 0,
        passed: 0,
    };

    /// Notes dropped bytes, which begin an ignored frame of so many bytes, or no frame.
    pub(super) fn pass(&mut self, count: usize, frame_bytes: Option<usize>) {
        let number = |bytes| u32::try_from(bytes).unwrap_or(u32::MAX);
        if self.to_come == 0 {
            // The frame before ends here; it was a frame if another one begins.
            if frame_bytes.is_none() {
                self.bytes = self.bytes.saturating_add(self.passed);
            }
            self.passed = 0;
            self.to_come = frame_bytes.map_or(0, number);
        }
        let count = number(count);
        let within = count.min(self.to_come);
        self.to_come = self.to_come.saturating_sub(within);
        self.passed = self.passed.saturating_add(within);
        if count > within {
            let outside = count.saturating_sub(within).saturating_add(self.passed);
            self.bytes = self.bytes.saturating_add(outside);
            self.passed = 0;
        }
    }

    /// Notes that a frame has been read: an ignored one that should not have ended yet was not a
    /// frame.
    pub(super) const fn read_frame(&mut self) {
        if self.to_come > 0 {
            self.bytes = self.bytes.saturating_add(self.passed);
        }
        self.to_come = 0;
        self.passed = 0;
    }

    pub(super) const fn take(&mut self) -> u32 {
        core::mem::replace(&mut self.bytes, 0)
    }
}
