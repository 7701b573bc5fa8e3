//! Random points and coefficients: those of cameras, and any bits.

use core::array::from_fn;

use fmc_camera_kernel::Coefficients;

use crate::arithmetic::{Arithmetic, OF_KERNEL};
use crate::check::{self, Difference, MOST};
use crate::corners::coefficients;

/// Number of points.
const POINTS: usize = 10_000_000;
/// Half of the largest sensor, mm.
const REACH_MM: f32 = 60.0;
/// Largest values of cx to ty that a camera has, or more.
const LARGEST: [f32; 14] = [
    2.0, 2.0, 1e-2, 1e-4, 1e-7, 1e-10, 1e-4, 1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-2, 1e-2,
];

/// Compares the random points; returns their number.
///
/// # Errors
/// The first [`Difference`].
pub(crate) fn compare() -> Result<usize, Difference> {
    let mut generator = Generator(0x2545_f491);
    let mut points = [[0.0; 2]; MOST];
    let mut compared = 0;
    let mut round = 0_u32;
    while compared < POINTS {
        let any_bits = round.is_multiple_of(4);
        let form = generator.form(any_bits);
        for point in &mut points {
            *point = from_fn(|_| generator.number(REACH_MM, any_bits));
        }
        // The lengths have all remainders of a block and of two.
        let length = MOST - usize::from(generator.next().to_le_bytes()[1] % 12);
        let (points, _) = points.split_at(length);
        // With a camera's numbers no product falls below 2⁻¹²⁶.
        let arithmetic = if any_bits {
            OF_KERNEL
        } else {
            Arithmetic::Gradual
        };
        if round.is_multiple_of(2) == round.is_multiple_of(3) {
            check::pairs(&form, points, arithmetic)?;
        } else {
            check::xy(&form, points, arithmetic)?;
        }
        compared += length;
        round += 1;
    }
    Ok(compared)
}

/// Marsaglia's xorshift of 32 bits (J. Stat. Softw. 8(14), 2003).
pub(crate) struct Generator(pub(crate) u32);

impl Generator {
    pub(crate) fn next(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Returns a number between -`largest` and `largest`, or one of any bits.
    pub(crate) fn number(&mut self, largest: f32, any_bits: bool) -> f32 {
        let bits = self.next();
        if any_bits {
            f32::from_bits(bits)
        } else {
            #[expect(clippy::cast_precision_loss, reason = "a random number is rounded")]
            let signed = bits.cast_signed() as f32;
            signed * (largest / 32768.0 / 65536.0)
        }
    }

    pub(crate) fn form(&mut self, any_bits: bool) -> Coefficients {
        coefficients(LARGEST.map(|largest| self.number(largest, any_bits)))
    }
}
