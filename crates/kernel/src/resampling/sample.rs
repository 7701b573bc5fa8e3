//! Samples of an image.

use core::fmt::Debug;

/// A sample of an image: `u8` or `u16`.
pub trait Sample: Copy + Debug + Default + PartialEq + Send + Sync + Sealed + 'static {
    /// Bits of a sample.
    const BITS: u32;

    /// Returns the number that the kernels compute with: of 16 bits, less 2¹⁵.
    fn centred(self) -> i32;

    /// Returns the sample nearest to a number that has been computed.
    fn saturated(centred: i32) -> Self;
}

/// Types whose samples the vectors know.
pub trait Sealed {}

impl Sealed for u8 {}
impl Sealed for u16 {}

impl Sample for u8 {
    const BITS: u32 = 8;

    #[inline(always)]
    fn centred(self) -> i32 {
        i32::from(self)
    }

    #[expect(clippy::cast_sign_loss, reason = "clamped to its range")]
    #[inline(always)]
    fn saturated(centred: i32) -> Self {
        centred.clamp(0, 255) as Self
    }
}

impl Sample for u16 {
    const BITS: u32 = 16;

    #[inline(always)]
    fn centred(self) -> i32 {
        i32::from(self) - (1 << 15)
    }

    #[expect(clippy::cast_sign_loss, reason = "clamped to its range")]
    #[inline(always)]
    fn saturated(centred: i32) -> Self {
        (centred + (1 << 15)).clamp(0, 65535) as Self
    }
}
