//! Part of the sensor that calibrations observed, and the part in which they are extrapolated.

use fmc_camera_file::CameraFile;
use serde::Serialize;

use crate::calibration_summary::{CalibrationSummary, ObservedRegion};
use crate::stated::Stated;

/// Points along each side of the sensor for the share that is extrapolated.
const SIDE_POINTS: u32 = 201;

/// Part of the sensor with observed points, over all calibrations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Observed {
    /// Largest distance of a point from the principal point, mm.
    pub radius_mm: Option<Stated>,
    /// Smallest and largest x of a point, mm.
    pub x_mm: [Option<Stated>; 2],
    /// Smallest and largest y of a point, mm.
    pub y_mm: [Option<Stated>; 2],
    /// Distance of the farthest corner of the sensor from the principal point, mm.
    pub corner_radius_mm: Option<Stated>,
    /// Share of the sensor's area beyond that radius or outside these ranges: there the polynomial
    /// is extrapolated; per cent.
    pub extrapolated_percent: Option<Stated>,
    /// `true` if all points lie on one row or column of the sensor.
    pub is_a_line: bool,
}

/// Returns the distance of the farthest corner of the sensor from the principal point, mm.
pub(super) fn corner_radius_mm(camera: &CameraFile) -> f64 {
    let [x0, y0] = camera.principal_point_mm;
    let [half_width, half_height] = camera.half_format_mm();
    (half_width + x0.abs()).hypot(half_height + y0.abs())
}

impl Observed {
    /// Collects the regions of the calibrations; `None` if none states one.
    pub(super) fn new(camera: &CameraFile, calibrations: &[CalibrationSummary]) -> Option<Self> {
        let regions: Vec<ObservedRegion> =
            calibrations.iter().filter_map(|one| one.observed).collect();
        let first = *regions.first()?;
        let region = regions.iter().fold(first, |all, one| ObservedRegion {
            radius_mm: all.radius_mm.max(one.radius_mm),
            x_mm: around(all.x_mm, one.x_mm),
            y_mm: around(all.y_mm, one.y_mm),
        });
        let mm = |value: f64| Stated::decimals(value, 2);
        Some(Self {
            radius_mm: mm(region.radius_mm),
            x_mm: region.x_mm.map(mm),
            y_mm: region.y_mm.map(mm),
            corner_radius_mm: mm(corner_radius_mm(camera)),
            extrapolated_percent: Stated::decimals(extrapolated_percent(camera, &region), 1),
            is_a_line: [region.x_mm, region.y_mm]
                .into_iter()
                .any(|[least, most]| most - least <= camera.sensor.pixel_um / 1e3),
        })
    }
}

fn around([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.min(c), b.max(d)]
}

/// Returns the share of the sensor that lies beyond the observed points, per cent.
fn extrapolated_percent(camera: &CameraFile, region: &ObservedRegion) -> f64 {
    let [x0, y0] = camera.principal_point_mm;
    let [half_width, half_height] = camera.half_format_mm();
    let is_within = |value: f64, [least, most]: [f64; 2]| value >= least && value <= most;
    let (mut beyond, mut all) = (0.0, 0.0);
    for row in 0..SIDE_POINTS {
        for column in 0..SIDE_POINTS {
            let middle = |index: u32| (2.0 * f64::from(index) + 1.0) / f64::from(SIDE_POINTS) - 1.0;
            let [x, y] = [half_width * middle(column), half_height * middle(row)];
            all += 1.0;
            if !(is_within(x, region.x_mm)
                && is_within(y, region.y_mm)
                && (x - x0).hypot(y - y0) <= region.radius_mm)
            {
                beyond += 1.0;
            }
        }
    }
    100.0 * beyond / all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> CameraFile {
        let text = "name = \"t\"\nprincipal_distance_mm = 50.0\n[sensor]\nwidth_px = 4000\n\
                    height_px = 3000\npixel_um = 10.0\n";
        CameraFile::parse("t", text).unwrap().0
    }

    #[test]
    fn extrapolated_share_is_that_of_the_area() {
        let region = |radius_mm: f64, x: f64, y: f64| ObservedRegion {
            radius_mm,
            x_mm: [-x, x],
            y_mm: [-y, y],
        };
        let camera = camera();
        assert!((corner_radius_mm(&camera) - 25.0).abs() < 1e-12);
        assert!(extrapolated_percent(&camera, &region(26.0, 20.0, 15.0)) < 1e-9);
        let half = extrapolated_percent(&camera, &region(26.0, 10.0, 15.0));
        assert!((half - 50.0).abs() < 0.5, "{half}");
        // A disc of 15 mm: 706.9 of 1200 mm².
        let disc = extrapolated_percent(&camera, &region(15.0, 20.0, 15.0));
        assert!((disc - 41.1).abs() < 0.3, "{disc}");
    }
}
