//! Patterns in double precision, as a camera sees them and as they are when exactly rectified.

use std::f64::consts::TAU;

use fmc_camera_kernel::resampling::{Kernel, weights};

/// Shortest period of a wave, pixels.
pub const SHORTEST_PERIOD_PX: f64 = 12.0;

/// A plane wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Distance of crests, pixels.
    pub period_px: f64,
    /// Direction from the columns' to the rows' axis, rad.
    pub direction_rad: f64,
    /// Phase at the origin, rad.
    pub phase_rad: f64,
    /// Amplitude, counts.
    pub amplitude: f64,
}

impl Wave {
    /// Returns the wave at a place, counts.
    #[must_use]
    pub fn value(&self, [col, row]: [f64; 2]) -> f64 {
        let along = col * self.direction_rad.cos() + row * self.direction_rad.sin();
        self.amplitude * (TAU * along / self.period_px + self.phase_rad).sin()
    }
}

/// A sum of waves about a mean; bands differ in the waves' phases.
#[derive(Debug, Clone, PartialEq)]
pub struct Waves {
    /// Mean, counts.
    pub mean: f64,
    /// The waves.
    pub waves: Vec<Wave>,
}

/// Phase by which a wave of one band is ahead of the one before, rad.
const BAND_PHASE_RAD: f64 = 2.0;

impl Waves {
    /// Returns the pattern at a place, counts.
    #[must_use]
    pub fn value(&self, place_px: [f64; 2], band: u8) -> f64 {
        let of_band = |wave: &Wave| {
            let phase_rad = wave.phase_rad + BAND_PHASE_RAD * f64::from(band);
            Wave { phase_rad, ..*wave }.value(place_px)
        };
        self.mean + self.waves.iter().map(of_band).sum::<f64>()
    }
}

/// An image as a pattern: between its pixels the polynomial of six points.
#[derive(Debug, Clone, Copy)]
pub struct PatternImage<'a> {
    width: usize,
    bands: usize,
    values: &'a [f32],
}

impl<'a> PatternImage<'a> {
    /// Returns an image of interleaved values as a pattern; `None` unless they are whole rows.
    #[must_use]
    pub fn new(width: usize, bands: usize, values: &'a [f32]) -> Option<Self> {
        let row = width.checked_mul(bands)?;
        let whole = row > 0 && !values.is_empty() && values.len().is_multiple_of(row);
        whole.then_some(Self {
            width,
            bands,
            values,
        })
    }

    /// Returns a band of whole rows.
    pub(crate) const fn of_plane(width: usize, values: &'a [f32]) -> Self {
        Self {
            width,
            bands: 1,
            values,
        }
    }

    /// Returns the pattern at a place, counts; beyond the edge, that of the edge.
    #[must_use]
    pub fn value(&self, place_px: [f64; 2], band: u8) -> f64 {
        let [col, row] = place_px;
        let (along, down) = (
            weights(Kernel::Keys6, col - col.floor()),
            weights(Kernel::Keys6, row - row.floor()),
        );
        let mut sum = 0.0;
        for (j, down) in (-2..).zip(down) {
            for (i, along) in (-2..).zip(along) {
                sum += down * along * self.at([whole(col) + i, whole(row) + j], band);
            }
        }
        sum
    }

    fn at(&self, [col, row]: [i64; 2], band: u8) -> f64 {
        let height = self.values.len() / (self.width * self.bands);
        let clamped = |place: i64, side: usize| {
            usize::try_from(place.max(0)).map_or(0, |place| place.min(side - 1))
        };
        let pixel = clamped(row, height) * self.width + clamped(col, self.width);
        let value = self.values.get(pixel * self.bands + usize::from(band));
        value.copied().map_or(f64::NAN, f64::from)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the pixel before a place")]
fn whole(place: f64) -> i64 {
    place.floor() as i64
}
