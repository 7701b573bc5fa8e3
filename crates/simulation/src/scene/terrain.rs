//! Terrain of a scene.

use std::f64::consts::TAU;

/// Largest number of steps in the search for where a ray meets the ground.
const MOST_ROUNDS: u8 = 60;
/// Distance from the ground at which the search ends, m.
const NEAR_ENOUGH_M: f64 = 1e-9;

/// Heights over the ground frame's x, y, m.
#[derive(Debug, Clone, PartialEq)]
pub enum Terrain {
    /// Level ground.
    Plane {
        /// Height of the ground, m.
        height_m: f64,
    },
    /// A slope.
    Slope {
        /// Height at the origin, m.
        height_m: f64,
        /// Rise along x and y, m/m.
        gradient: [f64; 2],
    },
    /// Hills and hollows: `height + amplitude·sin(2πx/λx)·sin(2πy/λy)`.
    Hills {
        /// Mean height, m.
        height_m: f64,
        /// Height of the hills above the mean, m.
        amplitude_m: f64,
        /// λx, λy, m.
        wavelength_m: [f64; 2],
    },
    /// A grid of heights, bilinear in between, level beyond its edges.
    Grid(HeightGrid),
}

/// Heights on a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightGrid {
    /// x, y of the first height, m.
    pub origin_m: [f64; 2],
    /// Distance of neighbouring heights along x and y, m.
    pub spacing_m: f64,
    /// Rows along x, from the smallest y up; all of one length, m.
    pub rows_m: Vec<Vec<f64>>,
}

impl HeightGrid {
    fn height_m(&self, x: f64, y: f64) -> f64 {
        let [origin_x, origin_y] = self.origin_m;
        let (row, across) = cell((y - origin_y) / self.spacing_m, self.rows_m.len());
        let height = |row: usize| {
            let heights = self.rows_m.get(row).map_or(&[][..], Vec::as_slice);
            let (column, along) = cell((x - origin_x) / self.spacing_m, heights.len());
            let at = |column: usize| heights.get(column).or(heights.last()).copied();
            between(
                at(column).unwrap_or(0.0),
                at(column + 1).unwrap_or(0.0),
                along,
            )
        };
        let next = (row + 1).min(self.rows_m.len().saturating_sub(1));
        between(height(row), height(next), across)
    }
}

/// Returns the cell of a position counted in spacings, and the fraction of the cell before it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative, and less than the number of cells"
)]
fn cell(place: f64, nodes: usize) -> (usize, f64) {
    let last = f64::from(u32::try_from(nodes).unwrap_or(u32::MAX)) - 1.0;
    let place = place.clamp(0.0, last.max(0.0));
    (place.floor() as usize, place.fract())
}

fn between(from: f64, to: f64, share: f64) -> f64 {
    from + share * (to - from)
}

impl Terrain {
    /// Returns the height at a position, m.
    #[must_use]
    pub fn height_m(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Plane { height_m } => *height_m,
            Self::Slope {
                height_m,
                gradient: [rise_x, rise_y],
            } => height_m + rise_x * x + rise_y * y,
            Self::Hills {
                height_m,
                amplitude_m,
                wavelength_m: [wave_x, wave_y],
            } => height_m + amplitude_m * (TAU * x / wave_x).sin() * (TAU * y / wave_y).sin(),
            Self::Grid(grid) => grid.height_m(x, y),
        }
    }

    /// Returns the ground point at a position, m.
    #[must_use]
    pub fn point(&self, x: f64, y: f64) -> [f64; 3] {
        [x, y, self.height_m(x, y)]
    }

    /// Returns the point where a ray meets the ground; `None` for a ray that does not look down,
    /// and where the ground is too steep for the search to end.
    ///
    /// # Model
    /// Secant steps along the ray from the level of the ground below the eye; at the end the ray is
    /// within 1 nm of the ground's height. Where hills hide each other, the result is any one of
    /// the crossings.
    #[must_use]
    pub fn seen_along(&self, eye_m: [f64; 3], direction: [f64; 3]) -> Option<[f64; 3]> {
        let [eye_x, eye_y, eye_z] = eye_m;
        let [x, y, z] = direction;
        if z >= 0.0 || z.is_nan() {
            return None;
        }
        let above = |distance: f64| {
            eye_z + distance * z - self.height_m(eye_x + distance * x, eye_y + distance * y)
        };
        let mut far = (self.height_m(eye_x, eye_y) - eye_z) / z;
        let mut near = 0.99 * far;
        let (mut above_near, mut above_far) = (above(near), above(far));
        for _ in 0..MOST_ROUNDS {
            if above_far.abs() <= NEAR_ENOUGH_M {
                return Some(self.point(eye_x + far * x, eye_y + far * y));
            }
            let slope = (above_far - above_near) / (far - near);
            (near, above_near) = (far, above_far);
            far -= above_far / slope;
            above_far = above(far);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Terrain {
        Terrain::Grid(HeightGrid {
            origin_m: [-100.0, 0.0],
            spacing_m: 100.0,
            rows_m: vec![vec![0.0, 10.0, 20.0], vec![20.0, 40.0, 20.0]],
        })
    }

    #[test]
    fn grid_is_bilinear_and_level_outside() {
        let grid = grid();
        for (x, y, height) in [
            (-100.0, 0.0, 0.0),
            (0.0, 100.0, 40.0),
            (-50.0, 50.0, 17.5),
            (500.0, 0.0, 20.0),
            (-500.0, 500.0, 20.0),
        ] {
            assert!((grid.height_m(x, y) - height).abs() < 1e-12, "{x} {y}");
        }
        let empty = Terrain::Grid(HeightGrid {
            origin_m: [0.0; 2],
            spacing_m: 1.0,
            rows_m: vec![],
        });
        assert!(empty.height_m(3.0, 4.0).abs() < 1e-12);
    }

    #[test]
    fn ray_ends_on_every_kind_of_ground() {
        let grounds = [
            Terrain::Plane { height_m: 120.0 },
            Terrain::Slope {
                height_m: 50.0,
                gradient: [0.2, -0.1],
            },
            Terrain::Hills {
                height_m: 80.0,
                amplitude_m: 60.0,
                wavelength_m: [900.0, 1300.0],
            },
            grid(),
        ];
        for ground in grounds {
            for (x, y) in [(0.0, 0.0), (0.4, -0.3), (-0.5, 0.5)] {
                let [px, py, pz] = ground
                    .seen_along([10.0, 20.0, 1000.0], [x, y, -1.0])
                    .unwrap();
                assert!((pz - ground.height_m(px, py)).abs() < 1e-12);
                let distance = 1000.0 - pz;
                assert!((px - 10.0 - distance * x).abs() < 2e-9);
                assert!((py - 20.0 - distance * y).abs() < 2e-9);
            }
            assert_eq!(ground.seen_along([0.0, 0.0, 1000.0], [1.0, 0.0, 0.1]), None);
        }
    }
}
