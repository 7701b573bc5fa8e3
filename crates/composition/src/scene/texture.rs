//! Grey values of the ground.

use std::f64::consts::TAU;

use fmc_simulation::noise::Noise;

/// Golden angle, rad: no two waves are parallel.
const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;
/// Waves that every band shows, and that green alone shows.
const WAVES: usize = 16;
/// Shortest period, pixels of the ground sample distance.
const SHORTEST_PX: f64 = 12.0;
/// Longest period.
const LONGEST_PX: f64 = 240.0;
/// Mean grey value and amplitude of all waves together, parts of the full scale.
const MEAN: f64 = 0.5;
const AMPLITUDE: f64 = 0.32;
/// Part of green that the panchromatic band does not show: a spectral correlation of 0.98.
const GREEN_ALONE: f64 = 0.2;

/// A sum of waves over the ground.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Texture {
    shared: Vec<Wave>,
    green: Vec<Wave>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Wave {
    by_x: f64,
    by_y: f64,
    phase: f64,
    amplitude: f64,
}

impl Texture {
    pub(super) fn new(ground_sample_m: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed, 0);
        let mut drawn = || {
            let first = noise.between(0.0, TAU);
            let waves = (0..WAVES).zip(0_u32..).map(|(_, number)| {
                let part = f64::from(number) / 15.0;
                let period = SHORTEST_PX * (LONGEST_PX / SHORTEST_PX).powf(part) * ground_sample_m;
                let direction = first + GOLDEN_ANGLE_RAD * f64::from(number);
                Wave {
                    by_x: TAU / period * direction.cos(),
                    by_y: TAU / period * direction.sin(),
                    phase: noise.between(0.0, TAU),
                    // Few of the waves are at their crests at once.
                    amplitude: AMPLITUDE * 0.16,
                }
            });
            waves.collect::<Vec<_>>()
        };
        Self {
            shared: drawn(),
            green: drawn(),
        }
    }

    /// Returns the panchromatic grey value, part of the full scale.
    pub(super) fn pan(&self, place_m: [f64; 2]) -> f64 {
        MEAN + sum(&self.shared, place_m)
    }

    /// Returns the grey value of green.
    pub(super) fn green(&self, place_m: [f64; 2]) -> f64 {
        MEAN + sum(&self.shared, place_m) + GREEN_ALONE * sum(&self.green, place_m)
    }
}

fn sum(waves: &[Wave], [x, y]: [f64; 2]) -> f64 {
    let values = waves
        .iter()
        .map(|wave| wave.amplitude * (wave.by_x * x + wave.by_y * y + wave.phase).sin());
    values.sum()
}
