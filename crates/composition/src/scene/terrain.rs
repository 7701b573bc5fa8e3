//! Relief of the ground.

use std::f64::consts::TAU;

use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_simulation::noise::Noise;
use nalgebra::Vector3;

use crate::number::real;

/// Periods of the waves of the relief, parts of the extent of the ground.
const PERIODS: [f64; 4] = [0.75, 0.9, 1.1, 1.4];
/// Steps of the way along a ray to the ground, which ends below [`CLOSE_M`].
const STEPS: usize = 60;
const CLOSE_M: f64 = 1e-7;

/// Smooth relief: a sum of long waves.
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    waves: Vec<[f64; 3]>,
    scale_m: f64,
    mean: f64,
}

impl Terrain {
    /// Draws the relief of a ground of some extent, m, whose heights at these places have a mean of
    /// 0 and a standard deviation, m.
    #[must_use]
    pub fn new(places_m: &[[f64; 2]], extent_m: f64, deviation_m: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed, 0);
        let first = noise.between(0.0, TAU);
        let waves = PERIODS.iter().zip(0..4).map(|(part, number)| {
            let direction = first + f64::from(number) * TAU / 8.0;
            let frequency = TAU / (part * extent_m);
            [
                frequency * direction.cos(),
                frequency * direction.sin(),
                noise.between(0.0, TAU),
            ]
        });
        let mut terrain = Self {
            waves: waves.collect(),
            scale_m: 1.0,
            mean: 0.0,
        };
        let heights: Vec<f64> = places_m
            .iter()
            .map(|place| terrain.height_m(*place))
            .collect();
        let count = real(heights.len().max(1));
        terrain.mean = heights.iter().sum::<f64>() / count;
        let squares: f64 = heights
            .iter()
            .map(|height| (height - terrain.mean).powi(2))
            .sum();
        let deviation = (squares / count).sqrt();
        terrain.scale_m = if deviation > 0.0 {
            deviation_m / deviation
        } else {
            0.0
        };
        terrain
    }

    /// Returns the height of a place, m.
    #[must_use]
    pub fn height_m(&self, [x, y]: [f64; 2]) -> f64 {
        let waves = self
            .waves
            .iter()
            .map(|[by_x, by_y, phase]| (by_x * x + by_y * y + phase).sin());
        self.scale_m * (waves.sum::<f64>() - self.mean)
    }

    /// Returns the place where a ray, with tangents to the right and downwards of the image, comes
    /// to the ground; `None` if it does not.
    #[must_use]
    pub fn seen(
        &self,
        orientation: &ExteriorOrientation,
        [right, down]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let ray = orientation.ground_from_camera() * Vector3::new(right, -down, -1.0);
        if ray.z >= 0.0 {
            return None;
        }
        let [x, y, z] = orientation.position_m;
        let mut height = 0.0;
        for _ in 0..STEPS {
            let way = (height - z) / ray.z;
            let place = [x + way * ray.x, y + way * ray.y];
            let found = self.height_m(place);
            if (found - height).abs() < CLOSE_M {
                return Some(place);
            }
            height = found;
        }
        None
    }
}
