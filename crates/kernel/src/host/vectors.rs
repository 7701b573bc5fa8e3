//! Vectors of the host's kernels, with operations for which `pulp` has no common name.

use pulp::{Scalar, Simd};

/// Vectors of one instruction set; each lane holds a different point.
pub(super) trait Vectors: Simd {
    /// Best alignment of a vector in bytes, which [`Self::stream`] requires.
    const ALIGNMENT: usize;

    /// Separates consecutive pairs into all x and all y, in an order that [`Self::joined`]
    /// reverses.
    fn parted(self, pairs: [Self::f32s; 2]) -> [Self::f32s; 2];

    /// Joins x and y, in the order of [`Self::parted`], into pairs.
    fn joined(self, xy: [Self::f32s; 2]) -> [Self::f32s; 2];

    /// Writes past the caches.
    ///
    /// # Safety
    /// The place is aligned to [`Self::ALIGNMENT`], and [`Self::streamed`] is called before any
    /// code reads it.
    unsafe fn stream(self, place: &mut Self::f32s, value: Self::f32s);

    /// Prefetches the memory one page further on; that page need not exist.
    fn ask_ahead(self, place: *const f32);

    /// Makes all streamed data visible in memory as ordinary stores are.
    fn streamed(self);

    /// Runs `work` compiled for these vectors.
    fn run<W: Work>(self, work: W);
}

/// Work that is compiled once for every instruction set.
pub(super) trait Work {
    /// Does the work.
    fn run<V: Vectors>(self, vectors: V);
}

impl Vectors for Scalar {
    const ALIGNMENT: usize = 4;

    #[inline(always)]
    fn parted(self, pairs: [f32; 2]) -> [f32; 2] {
        pairs
    }

    #[inline(always)]
    fn joined(self, xy: [f32; 2]) -> [f32; 2] {
        xy
    }

    #[inline(always)]
    unsafe fn stream(self, place: &mut f32, value: f32) {
        *place = value;
    }

    #[inline(always)]
    fn ask_ahead(self, _: *const f32) {}

    #[inline(always)]
    fn streamed(self) {}

    fn run<W: Work>(self, work: W) {
        work.run(self);
    }
}

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use core::arch::x86_64::_MM_HINT_T0;
    use core::ptr;

    use pulp::x86::{V3, V4};
    use pulp::{NullaryFnOnce, cast};

    use super::{Vectors, Work};

    /// Numbers in a page of memory, at whose end the processor's own prefetch stops.
    const AHEAD: usize = 1024;

    /// Work with its vectors, to be called where their instructions are enabled.
    struct Enabled<V, W>(V, W);

    impl<V: Vectors, W: Work> NullaryFnOnce for Enabled<V, W> {
        type Output = ();

        #[inline(always)]
        fn call(self) {
            self.1.run(self.0);
        }
    }

    impl Vectors for V3 {
        const ALIGNMENT: usize = 32;

        #[inline(always)]
        fn parted(self, [low, high]: [Self::f32s; 2]) -> [Self::f32s; 2] {
            let (low, high) = (cast(low), cast(high));
            [
                cast(self.avx._mm256_shuffle_ps::<0b10_00_10_00>(low, high)),
                cast(self.avx._mm256_shuffle_ps::<0b11_01_11_01>(low, high)),
            ]
        }

        #[inline(always)]
        fn joined(self, [x, y]: [Self::f32s; 2]) -> [Self::f32s; 2] {
            let (x, y) = (cast(x), cast(y));
            [
                cast(self.avx._mm256_unpacklo_ps(x, y)),
                cast(self.avx._mm256_unpackhi_ps(x, y)),
            ]
        }

        #[inline(always)]
        unsafe fn stream(self, place: &mut Self::f32s, value: Self::f32s) {
            // SAFETY: the place is one vector, borrowed exclusively; the caller aligns it and
            // fences the store.
            unsafe {
                self.avx
                    ._mm256_stream_ps(ptr::from_mut(place).cast(), cast(value));
            }
        }

        #[inline(always)]
        fn ask_ahead(self, place: *const f32) {
            self.sse
                ._mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(AHEAD).cast());
        }

        #[inline(always)]
        fn streamed(self) {
            self.sse._mm_sfence();
        }

        #[inline(always)]
        fn run<W: Work>(self, work: W) {
            self.vectorize(Enabled(self, work));
        }
    }

    impl Vectors for V4 {
        const ALIGNMENT: usize = 64;

        #[inline(always)]
        fn parted(self, [low, high]: [Self::f32s; 2]) -> [Self::f32s; 2] {
            let (low, high) = (cast(low), cast(high));
            [
                cast(self.avx512f._mm512_shuffle_ps::<0b10_00_10_00>(low, high)),
                cast(self.avx512f._mm512_shuffle_ps::<0b11_01_11_01>(low, high)),
            ]
        }

        #[inline(always)]
        fn joined(self, [x, y]: [Self::f32s; 2]) -> [Self::f32s; 2] {
            let (x, y) = (cast(x), cast(y));
            [
                cast(self.avx512f._mm512_unpacklo_ps(x, y)),
                cast(self.avx512f._mm512_unpackhi_ps(x, y)),
            ]
        }

        #[inline(always)]
        unsafe fn stream(self, place: &mut Self::f32s, value: Self::f32s) {
            // SAFETY: the place is one vector, borrowed exclusively; the caller aligns it and
            // fences the store.
            unsafe {
                self.avx512f
                    ._mm512_stream_ps(ptr::from_mut(place).cast(), cast(value));
            }
        }

        #[inline(always)]
        fn ask_ahead(self, place: *const f32) {
            self.sse
                ._mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(AHEAD).cast());
        }

        #[inline(always)]
        fn streamed(self) {
            self.sse._mm_sfence();
        }

        #[inline(always)]
        fn run<W: Work>(self, work: W) {
            self.vectorize(Enabled(self, work));
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod aarch64 {
    use pulp::aarch64::Neon;
    use pulp::{Simd as _, cast};

    use super::{Vectors, Work};

    impl Vectors for Neon {
        const ALIGNMENT: usize = 4;

        #[inline(always)]
        fn parted(self, [low, high]: [Self::f32s; 2]) -> [Self::f32s; 2] {
            self.deinterleave_shfl_f32s([low, high])
        }

        #[inline(always)]
        fn joined(self, xy: [Self::f32s; 2]) -> [Self::f32s; 2] {
            self.interleave_shfl_f32s(xy)
        }

        /// Performs an ordinary store: NEON's store of pairs past the cache has no intrinsic.
        #[inline(always)]
        unsafe fn stream(self, place: &mut Self::f32s, value: Self::f32s) {
            *place = cast(value);
        }

        #[inline(always)]
        fn ask_ahead(self, _: *const f32) {}

        #[inline(always)]
        fn streamed(self) {}

        #[inline(always)]
        fn run<W: Work>(self, work: W) {
            // Every aarch64 has NEON, so it need not be enabled.
            work.run(self);
        }
    }
}
