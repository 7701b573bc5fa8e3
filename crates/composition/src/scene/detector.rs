//! A detector: what it makes of light.

use fmc_simulation::noise::Noise;

use crate::number::{real, single, whole};

/// Largest value of the converter of 14 bits.
pub const FULL_SCALE_DN: f64 = 16_383.0;
/// Electrons of a full pixel.
const FULL_WELL_E: f64 = 60_000.0;
/// Noise of reading, electrons.
const READ_NOISE_E: f64 = 20.0;
/// Offset, DN, its deviation from pixel to pixel, and half of its step between two taps.
const OFFSET_DN: f64 = 400.0;
const OFFSET_DEVIATION_DN: f64 = 6.0;
const OFFSET_HALF_STEP_DN: f64 = 45.0;
/// Deviation of the photo response from pixel to pixel, and half of its step between two taps.
const RESPONSE_DEVIATION: f64 = 0.009;
const RESPONSE_HALF_STEP: f64 = 0.004;
/// One pixel in so many is defective.
const PIXELS_PER_DEFECT: usize = 50_000;
/// Response of a dim pixel, and offset that a hot one has more.
const DIM: f64 = 0.4;
const HOT_DN: f64 = 1500.0;

/// Offset and response of every pixel, with two taps and some defects.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    width: usize,
    offset_dn: Vec<f32>,
    response: Vec<f32>,
    defects: Vec<[usize; 2]>,
    seed: u64,
}

impl Detector {
    /// Draws a detector of `size_px` (width, height).
    #[must_use]
    pub fn new([width, height]: [usize; 2], seed: u64) -> Self {
        let mut noise = Noise::new(seed, 0);
        let count = width * height;
        let (mut offset_dn, mut response) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for index in 0..count {
            let [offset, gain] = noise.next([OFFSET_DEVIATION_DN, RESPONSE_DEVIATION]);
            let side = if index % width < width / 2 { 1.0 } else { -1.0 };
            offset_dn.push(single(OFFSET_DN + side * OFFSET_HALF_STEP_DN + offset));
            response.push(single(1.0 + side * RESPONSE_HALF_STEP + gain));
        }
        let mut defects = Vec::new();
        for number in 0..(count / PIXELS_PER_DEFECT).max(2) {
            let col = whole(noise.between(2.0, real(width) - 2.0));
            let row = whole(noise.between(2.0, real(height) - 2.0));
            let index = row * width + col;
            if number % 2 == 0 {
                if let Some(response) = response.get_mut(index) {
                    *response = single(DIM);
                }
            } else if let Some(offset) = offset_dn.get_mut(index) {
                *offset += single(HOT_DN);
            }
            defects.push([col, row]);
        }
        Self {
            width,
            offset_dn,
            response,
            defects,
            seed,
        }
    }

    /// Columns and rows of the defective pixels.
    #[must_use]
    pub fn defects(&self) -> &[[usize; 2]] {
        &self.defects
    }

    /// Returns the mean of many samples of a pixel, DN, under `signal_dn`, what a perfect pixel
    /// would have beyond its offset; 0 beyond the detector.
    #[must_use]
    pub fn expected_dn(&self, [col, row]: [usize; 2], signal_dn: f64) -> f64 {
        let index = row * self.width + col;
        match (self.offset_dn.get(index), self.response.get(index)) {
            (Some(offset), Some(response)) => f64::from(*offset) + f64::from(*response) * signal_dn,
            _ => 0.0,
        }
    }

    /// Returns the samples of a row under a signal for every column, DN; frames differ in
    /// their noise.
    #[must_use]
    pub fn row_dn(&self, row: usize, frame: u64, signal_dn: impl Fn(usize) -> f64) -> Vec<u16> {
        let gain_dn_per_e = FULL_SCALE_DN / FULL_WELL_E;
        let read_noise_dn = READ_NOISE_E * gain_dn_per_e;
        let stream = frame.wrapping_mul(1 << 24).wrapping_add(1 + row as u64);
        let mut noise = Noise::new(self.seed, stream);
        let samples = (0..self.width).map(|col| {
            let signal_dn = signal_dn(col);
            let expected = self.expected_dn([col, row], signal_dn);
            let variance = read_noise_dn * read_noise_dn + gain_dn_per_e * signal_dn.max(0.0);
            let [deviate] = noise.next([variance.sqrt()]);
            crate::number::grey((expected + deviate).min(FULL_SCALE_DN))
        });
        samples.collect()
    }
}
