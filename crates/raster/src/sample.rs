//! Samples of 8 and 16 bits.

use bytemuck::Pod;

/// The type of a frame's samples: `u8` or `u16`.
pub trait Sample: Pod + PartialEq + Send + Sync + sealed::Sealed {
    /// Bits of a sample.
    const BITS: u16;

    /// Returns the sum modulo the range of the type.
    #[must_use]
    fn plus(self, other: Self) -> Self;

    /// Returns the difference modulo the range of the type.
    #[must_use]
    fn minus(self, other: Self) -> Self;

    /// Returns the sample with its bytes in the other order.
    #[must_use]
    fn swapped(self) -> Self;
}

mod sealed {
    /// No other type is a sample.
    pub trait Sealed {}
    impl Sealed for u8 {}
    impl Sealed for u16 {}
}

impl Sample for u8 {
    const BITS: u16 = 8;

    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }

    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }

    fn swapped(self) -> Self {
        self
    }
}

impl Sample for u16 {
    const BITS: u16 = 16;

    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }

    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }

    fn swapped(self) -> Self {
        self.swap_bytes()
    }
}

/// Returns so many samples of a buffer, which grows to hold them.
pub(crate) fn typed_buffer<S: Sample>(buffer: &mut Vec<u16>, samples: usize) -> &mut [S] {
    let words = (samples * usize::from(S::BITS)).div_ceil(16);
    if buffer.len() < words {
        buffer.reserve_exact(words - buffer.len());
        buffer.resize(words, 0);
    }
    let samples_of_buffer: &mut [S] = bytemuck::cast_slice_mut(buffer);
    samples_of_buffer.get_mut(..samples).unwrap_or_default()
}

/// Replaces each sample of a row by its difference from the pixel before (predictor 2, TIFF 6.0
/// section 14).
pub(crate) fn difference<S: Sample>(row: &mut [S], samples: usize) {
    match samples {
        1 => difference_of::<S, 1>(row),
        2 => difference_of::<S, 2>(row),
        3 => difference_of::<S, 3>(row),
        _ => difference_of::<S, 4>(row),
    }
}

fn difference_of<S: Sample, const N: usize>(row: &mut [S]) {
    let mut before = [S::zeroed(); N];
    for pixel in row.as_chunks_mut::<N>().0 {
        let now = *pixel;
        for (sample, before) in pixel.iter_mut().zip(before) {
            *sample = sample.minus(before);
        }
        before = now;
    }
}

/// Undoes [`difference`].
pub(crate) fn integrate<S: Sample>(row: &mut [S], samples: usize) {
    match samples {
        1 => integrate_of::<S, 1>(row),
        2 => integrate_of::<S, 2>(row),
        3 => integrate_of::<S, 3>(row),
        _ => integrate_of::<S, 4>(row),
    }
}

fn integrate_of<S: Sample, const N: usize>(row: &mut [S]) {
    let mut sums = [S::zeroed(); N];
    for pixel in row.as_chunks_mut::<N>().0 {
        for (sum, sample) in sums.iter_mut().zip(pixel) {
            *sum = sum.plus(*sample);
            *sample = *sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{difference, integrate};

    #[test]
    fn integral_of_differences_is_the_row() {
        for samples in [1, 3, 4] {
            let row: Vec<u16> = (0..12_u16).map(|k| k.wrapping_mul(24_571)).collect();
            let mut other = row.clone();
            difference(&mut other, samples);
            assert_eq!(other[samples], row[samples].wrapping_sub(row[0]));
            integrate(&mut other, samples);
            assert_eq!(other, row);
        }
    }
}
