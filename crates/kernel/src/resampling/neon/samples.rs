//! Samples of rows as numbers of 16 bits, and values as samples.

use core::arch::aarch64::*;

use super::four::FOUR;
use crate::resampling::sample::Sample;

/// Samples that are loaded for a pixel from its first tap on: four for each tap of several bands,
/// and all taps of one band at once.
pub(super) const fn loaded(bands: usize, taps: usize) -> usize {
    if bands > 1 {
        bands * (taps - 1) + 4
    } else if taps > 4 {
        8
    } else {
        4
    }
}

/// Loads four samples.
///
/// # Safety
/// From the first on, four samples lie within the row.
#[target_feature(enable = "neon")]
#[inline]
pub(super) unsafe fn load_4<S: Sample>(row: &[S], first: usize) -> int16x4_t {
    debug_assert!(first + 4 <= row.len(), "{first} of {}", row.len());
    // SAFETY: that of this function.
    let place = unsafe { row.as_ptr().add(first) };
    if S::BITS == 8 {
        // SAFETY: four bytes lie within the row.
        let bytes = unsafe { place.cast::<u32>().read_unaligned() };
        let words = vmovl_u8(vcreate_u8(u64::from(bytes)));
        vreinterpret_s16_u16(vget_low_u16(words))
    } else {
        // SAFETY: four samples of 16 bits lie within the row.
        let words = unsafe { vld1_u16(place.cast()) };
        vreinterpret_s16_u16(veor_u16(words, vdup_n_u16(1 << 15)))
    }
}

/// Loads eight samples.
///
/// # Safety
/// From the first on, eight samples lie within the row.
#[target_feature(enable = "neon")]
#[inline]
pub(super) unsafe fn load_8<S: Sample>(row: &[S], first: usize) -> int16x8_t {
    debug_assert!(first + 8 <= row.len(), "{first} of {}", row.len());
    // SAFETY: that of this function.
    let place = unsafe { row.as_ptr().add(first) };
    if S::BITS == 8 {
        // SAFETY: eight bytes lie within the row.
        vreinterpretq_s16_u16(vmovl_u8(unsafe { vld1_u8(place.cast()) }))
    } else {
        // SAFETY: eight samples of 16 bits lie within the row.
        let words = unsafe { vld1q_u16(place.cast()) };
        vreinterpretq_s16_u16(veorq_u16(words, vdupq_n_u16(1 << 15)))
    }
}

/// Writes up to four pixels: of several bands a vector each, of one band the lanes of the first
/// vector.
#[target_feature(enable = "neon")]
#[inline]
pub(super) fn store<S: Sample, const C: usize>(values: &[int32x4_t; FOUR], pixels: &mut [[S; C]]) {
    let samples = pixels.as_flattened_mut();
    if C == 1 {
        let [all, ..] = values;
        return store_4(*all, samples);
    }
    for (number, value) in values.iter().enumerate() {
        // Of three bands, the fourth lane is overwritten by the next pixel.
        let Some(rest) = samples.get_mut(C * number..) else {
            return;
        };
        store_4(*value, rest);
    }
}

/// Writes the first four samples of a slice, or fewer if it is shorter.
#[target_feature(enable = "neon")]
#[inline]
fn store_4<S: Sample>(value: int32x4_t, samples: &mut [S]) {
    if let Some(four) = samples.first_chunk_mut() {
        return store_all(value, four);
    }
    let mut four = [S::default(); 4];
    store_all(value, &mut four);
    for (to, from) in samples.iter_mut().zip(four) {
        *to = from;
    }
}

#[target_feature(enable = "neon")]
#[inline]
fn store_all<S: Sample>(value: int32x4_t, samples: &mut [S; 4]) {
    let place = samples.as_mut_ptr();
    if S::BITS == 8 {
        let words = vqmovun_s32(value);
        let bytes = vreinterpret_u32_u8(vqmovn_u16(vcombine_u16(words, words)));
        // SAFETY: four samples of 8 bits are borrowed.
        unsafe {
            place
                .cast::<u32>()
                .write_unaligned(vget_lane_u32::<0>(bytes))
        };
    } else {
        let words = vreinterpret_u16_s16(vqmovn_s32(value));
        // SAFETY: four samples of 16 bits are borrowed.
        unsafe { vst1_u16(place.cast(), veor_u16(words, vdup_n_u16(1 << 15))) };
    }
}
