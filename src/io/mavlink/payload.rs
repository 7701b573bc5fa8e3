//! Payload of a message: numbers at their places, the low byte first.

/// Longest payload of a message that is read, with room for fields that newer senders add, bytes.
pub const LONGEST_PAYLOAD: usize = 64;

/// A payload in its full length: version 2 leaves out zeros at the end, and newer senders may add
/// fields.
#[derive(Debug, Clone, Copy)]
pub(super) struct Payload([u8; LONGEST_PAYLOAD]);

impl Payload {
    pub(super) fn of(sent: &[u8]) -> Self {
        let mut whole = [0; LONGEST_PAYLOAD];
        for (to, byte) in whole.iter_mut().zip(sent) {
            *to = *byte;
        }
        Self(whole)
    }

    fn bytes<const N: usize>(&self, at: usize) -> [u8; N] {
        let bytes = self.0.get(at..).and_then(|rest| rest.first_chunk());
        bytes.copied().unwrap_or([0; N])
    }

    pub(super) fn byte(&self, at: usize) -> u8 {
        let [byte] = self.bytes(at);
        byte
    }

    pub(super) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.bytes(at))
    }

    pub(super) fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.bytes(at))
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.bytes(at))
    }

    pub(super) fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.bytes(at))
    }

    pub(super) fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.bytes(at))
    }

    pub(super) fn f32(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.bytes(at))
    }
}
