//! Choices of a synthetic camera and its flight.

use crate::number::real;
use crate::rig::{Green, Rig, SubImage, VirtualSize};

/// Sub-images side by side, and one above the other.
const COLUMNS: usize = 3;
const ROWS: usize = 2;
/// Detector of the DMZ camera, columns and rows, px.
const DETECTOR_PX: [usize; 2] = [4096, 7168];
/// Overlap of neighbours at scale 1, px.
const OVERLAP_PX: usize = 128;
/// Least overlap unless asked for, px: windows of ties fit into it.
const LEAST_OVERLAP_PX: usize = 64;
/// Height of the flight over Hanzhong, m.
const FLIGHT_HEIGHT_M: f64 = 3900.0;
/// Principal distance, mm, and pixels of the panchromatic detectors and of green, µm.
const PRINCIPAL_DISTANCE_MM: f64 = 170.0;
const PIXEL_UM: f64 = 12.0;
const GREEN_PRINCIPAL_DISTANCE_MM: f64 = 40.0;
const GREEN_PIXEL_UM: f64 = 9.0;

/// Choices of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SceneRequest {
    /// Pixels so many times as wide and so many times fewer, flown so many times lower: the ground
    /// sample distance, and the effect of a metre of relief in pixels, stay.
    pub scale: usize,
    /// Overlap of neighbouring sub-images, px.
    pub overlap_px: Option<usize>,
    /// Distortion of the lens at the corner, part of the radius.
    pub distortion: f64,
    /// The same of green.
    pub green_distortion: f64,
    /// Standard deviation of the heights, m.
    pub relief_m: f64,
    /// Tilt of the exposures, degrees.
    pub tilt_deg: f64,
    /// σ of measured image points, px.
    pub noise_px: f64,
    /// σ of the coordinates of control, m.
    pub control_sigma_m: f64,
    /// Ground marks.
    pub marks: usize,
    /// Ties measured in each overlap.
    pub ties: usize,
    /// Seed of everything random.
    pub seed: u64,
}

impl Default for SceneRequest {
    fn default() -> Self {
        Self {
            scale: 8,
            overlap_px: None,
            distortion: 5e-4,
            green_distortion: 2e-3,
            relief_m: 5.0,
            tilt_deg: 1.0,
            noise_px: 0.25,
            control_sigma_m: 0.05,
            marks: 212,
            ties: 20,
            seed: 1,
        }
    }
}

impl SceneRequest {
    /// Height of the flight above the mean ground, m.
    #[must_use]
    pub fn height_m(&self) -> f64 {
        FLIGHT_HEIGHT_M / real(self.scale.max(1))
    }

    /// Returns the nominal rig: sub-images 1, 3, 5 above 2, 4, 6.
    #[must_use]
    pub fn rig(&self) -> Rig {
        let scale = self.scale.max(1);
        let [width, height] = DETECTOR_PX.map(|side| side / scale);
        let least = LEAST_OVERLAP_PX.min(width / 4);
        let overlap = self
            .overlap_px
            .unwrap_or((OVERLAP_PX / scale).max(least))
            .min(width.min(height) - 1);
        let frame = VirtualSize {
            width_px: COLUMNS * width - (COLUMNS - 1) * overlap,
            height_px: ROWS * height - (ROWS - 1) * overlap,
        };
        let place = |number: usize, count: usize, side: usize| {
            (real(number) - real(count - 1) / 2.0) * real(side - overlap)
        };
        let sub = (0..COLUMNS).flat_map(|column| {
            (0..ROWS).map(move |row| SubImage {
                id: (ROWS * column + row + 1).to_string(),
                width_px: width,
                height_px: height,
                place_px: [place(column, COLUMNS, width), place(row, ROWS, height)],
                polynomial: None,
            })
        });
        let pixel_um = PIXEL_UM * real(scale);
        let green_pixel_um = GREEN_PIXEL_UM * real(scale);
        // Of the same ground cover, with room for its distortion.
        let green_side = |side: usize| {
            let pixels = real(side) * pixel_um / PRINCIPAL_DISTANCE_MM
                * GREEN_PRINCIPAL_DISTANCE_MM
                / green_pixel_um;
            crate::number::whole(pixels.ceil()) + 8
        };
        let mut green = Green {
            principal_distance_mm: GREEN_PRINCIPAL_DISTANCE_MM,
            pixel_um: green_pixel_um,
            width_px: green_side(frame.width_px),
            height_px: green_side(frame.height_px),
            distortion: crate::rig::Distortion::default(),
        };
        let [half_width, half_height] = green.centre_px();
        let corner_mm = half_width.hypot(half_height) * green_pixel_um / 1e3;
        green.distortion = super::true_rig::lens_of(self.green_distortion, corner_mm);
        Rig {
            name: format!("synthetic DMZ, scale {scale}"),
            principal_distance_mm: PRINCIPAL_DISTANCE_MM,
            pixel_um,
            frame,
            calibration: None,
            sub: sub.collect(),
            green: Some(green),
        }
    }
}
