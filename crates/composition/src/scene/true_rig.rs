//! The rig as it truly is: lens, and places of the detectors.

use fmc_simulation::noise::Noise;

use crate::rig::{Distortion, Rig, SubImage};

/// Parts of K1, K2 and K3 of a lens at its corner, which compete as those of real lenses do. At
/// 0.05 % a cubic per sub-image leaves 0.016 px at most.
const SHARES: [f64; 3] = [1.2, -0.3, 0.1];
/// Standard deviation of the place of a detector, px.
const PLACE_PX: f64 = 2.0;
/// Largest turn and tilt of a detector, degrees.
const LARGEST_TURN_DEG: f64 = 0.05;
/// Largest difference of the scale of a detector.
const LARGEST_SCALE: f64 = 3e-4;

/// Lens and detectors, behind one beam splitter.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueRig {
    lens: Distortion,
    principal_distance_px: f64,
    pixel_mm: f64,
    centre_px: [f64; 2],
    detectors: Vec<Mounting>,
}

/// Place of a detector in the focal plane.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Mounting {
    middle_px: [f64; 2],
    centre_px: [f64; 2],
    turn_rad: f64,
    tilt_rad: [f64; 2],
    scale: f64,
}

/// Returns the distortion of a lens whose distortion at the corner, `corner_mm` from the centre, is
/// a part of the radius.
#[must_use]
pub fn lens_of(part: f64, corner_mm: f64) -> Distortion {
    let [k1, k2, k3] = SHARES.map(|share| share * part);
    let square = corner_mm * corner_mm;
    Distortion {
        k1: k1 / square,
        k2: k2 / (square * square),
        k3: k3 / (square * square * square),
        ..Distortion::default()
    }
}

impl TrueRig {
    /// Draws the mountings of the detectors of a rig: places of σ 2 px, turns and tilts up to
    /// 0.05°, scales up to 3e-4.
    #[must_use]
    pub fn new(rig: &Rig, distortion: f64, seed: u64) -> Self {
        let pixel_mm = rig.pixel_um / 1e3;
        let [u, v] = rig.frame.centre_px();
        let turn = LARGEST_TURN_DEG.to_radians();
        let detectors = rig.sub.iter().zip(0..).map(|(sub, number)| {
            let mut noise = Noise::new(seed, number);
            let [right, down] = noise.next([PLACE_PX; 2]);
            Mounting {
                middle_px: [sub.place_px[0] + right, sub.place_px[1] + down],
                centre_px: sub.centre_px(),
                turn_rad: noise.between(-turn, turn),
                tilt_rad: [noise.between(-turn, turn), noise.between(-turn, turn)],
                scale: 1.0 + noise.between(-LARGEST_SCALE, LARGEST_SCALE),
            }
        });
        Self {
            lens: lens_of(distortion, u.hypot(v) * pixel_mm),
            principal_distance_px: rig.principal_distance_px(),
            pixel_mm,
            centre_px: [u, v],
            detectors: detectors.collect(),
        }
    }

    /// Returns the place of a pixel of a detector in the focal plane, px from the principal point,
    /// to the right and downwards.
    fn in_focal_plane(&self, number: usize, [col, row]: [f64; 2]) -> Option<[f64; 2]> {
        let mounting = self.detectors.get(number)?;
        let [x, y] = [col - mounting.centre_px[0], row - mounting.centre_px[1]];
        let (sin, cos) = mounting.turn_rad.sin_cos();
        let [x, y] = [
            mounting.scale * (cos * x - sin * y),
            mounting.scale * (sin * x + cos * y),
        ];
        let [middle_x, middle_y] = mounting.middle_px;
        // A tilted detector is out of the focal plane, and the rays lead to the lens.
        let depth = mounting.tilt_rad[0] * x + mounting.tilt_rad[1] * y;
        let shrink = self.principal_distance_px / (self.principal_distance_px + depth);
        Some([shrink * (middle_x + x), shrink * (middle_y + y)])
    }

    /// Returns the true place of a pixel in the virtual image; `None` of an unknown detector.
    #[must_use]
    pub fn virtual_px(&self, number: usize, pixel: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.in_focal_plane(number, pixel)?;
        let [x, y] = self.lens.ideal([x * self.pixel_mm, -y * self.pixel_mm]);
        let [u, v] = self.centre_px;
        Some([u + x / self.pixel_mm, v - y / self.pixel_mm])
    }

    /// Returns the distance of a pixel from the principal point, over the principal distance.
    #[must_use]
    pub fn field(&self, number: usize, pixel: [f64; 2]) -> f64 {
        self.in_focal_plane(number, pixel)
            .map_or(0.0, |[x, y]| x.hypot(y) / self.principal_distance_px)
    }

    /// Returns the pixel of a detector at a place of the virtual image, on its pixels or not, step
    /// by step from the nominal one; `None` if it does not end below 1e-8 px within 30 steps.
    #[must_use]
    pub fn pixel(&self, sub: &SubImage, number: usize, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let [centre_col, centre_row] = sub.centre_px();
        let [centre_u, centre_v] = self.centre_px;
        let [right, down] = sub.place_px;
        let mut pixel = [
            u - centre_u - right + centre_col,
            v - centre_v - down + centre_row,
        ];
        for _ in 0..30 {
            let [found_u, found_v] = self.virtual_px(number, pixel)?;
            // The map is a shift within some 1e-3: its inverse is, too.
            let way = [u - found_u, v - found_v];
            pixel = [pixel[0] + way[0], pixel[1] + way[1]];
            if way[0].hypot(way[1]) < 1e-8 {
                return Some(pixel);
            }
        }
        None
    }
}
