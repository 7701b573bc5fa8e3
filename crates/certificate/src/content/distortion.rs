//! Distortion of the camera at rest: profiles, tables at field angles and at radii.

use fmc_camera_file::CameraFile;
use fmc_reference::lens::Lens;
use fmc_reference::residual_splines::ResidualSplines;
use serde::Serialize;

use super::inputs::Inputs;
use super::observed::corner_radius_mm;
use super::radial::{PROFILE_POINTS, Radial, RadialRow, share};
use crate::stated::Stated;

/// Points along each side of the sensor for the largest distortion.
const SIDE_POINTS: u32 = 41;

/// Distortion of the camera at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticDistortion {
    /// Largest length of the distortion over the sensor, residual grids included, µm.
    pub largest_um: Option<Stated>,
    /// Place of the largest, mm in the sensor frame.
    pub largest_at_mm: [Option<Stated>; 2],
    /// Principal distance of rays without K0, f/(1 - K0), mm.
    pub principal_distance_without_k0_mm: Option<Stated>,
    /// Principal distance at which the largest radial distortion over the sensor is least, mm.
    pub balanced_principal_distance_mm: Option<Stated>,
    /// Largest radial distortion over the sensor at f, µm.
    pub gaussian_largest_um: Option<Stated>,
    /// Largest radial distortion over the sensor at the balanced principal distance, µm.
    pub balanced_largest_um: Option<Stated>,
    /// Angle of the decentring's axis in the sensor frame, from +x towards +y, degrees; `None`
    /// without decentring.
    pub decentring_axis_deg: Option<Stated>,
    /// Largest effect of B1 and B2 over the sensor, µm.
    pub affinity_largest_um: Option<Stated>,
    /// Rows at even field angles.
    pub at_angles: Vec<RadialRow>,
    /// Rows at even radii, and at the farthest corner.
    pub at_radii: Vec<RadialRow>,
    /// Radial profile from the principal point to the farthest corner.
    pub profile: Vec<RadialRow>,
}

impl StaticDistortion {
    /// Computes the distortion; but for the largest, the figures are those of the polynomial.
    pub(super) fn new(inputs: &Inputs<'_>, splines: &ResidualSplines) -> Self {
        let camera = inputs.camera;
        let corner_mm = corner_radius_mm(camera);
        let radial = Radial::new(camera, corner_mm, inputs.calibrations);
        let (largest_mm, at_mm) = largest(camera, &radial.lens, splines);
        let affinity = Lens {
            k: [0.0; 4],
            p: [0.0; 2],
            ..radial.lens
        };
        let none = ResidualSplines::default();
        let [p1, p2] = radial.lens.p;
        let radii = || (0..PROFILE_POINTS).map(|index| corner_mm * share(index));
        let most = |function: &dyn Fn(f64) -> f64| {
            let values = radii().map(|r| function(r).abs());
            Stated::decimals(1e3 * values.fold(0.0, f64::max), 3)
        };
        let f = camera.principal_distance_mm;
        let [k0, ..] = radial.lens.k;
        Self {
            largest_um: Stated::decimals(1e3 * largest_mm, 3),
            largest_at_mm: at_mm.map(|mm| Stated::decimals(mm, 2)),
            principal_distance_without_k0_mm: Stated::decimals(f / (1.0 - k0), 5),
            balanced_principal_distance_mm: Stated::decimals(f * (1.0 + radial.balance), 5),
            gaussian_largest_um: most(&|r| radial.gaussian_mm(r)),
            balanced_largest_um: most(&|r| radial.balanced_mm(r)),
            decentring_axis_deg: (p1.hypot(p2) > 0.0)
                .then(|| Stated::decimals(p2.atan2(p1).to_degrees(), 1))
                .flatten(),
            affinity_largest_um: Stated::decimals(1e3 * largest(camera, &affinity, &none).0, 3),
            at_angles: radial.at_angles(corner_mm),
            at_radii: radial.at_radii(corner_mm),
            profile: radii().map(|r| radial.row(r)).collect(),
        }
    }
}

/// Returns the largest length of a lens's distortion with residual grids over the sensor, mm, and
/// its place.
fn largest(camera: &CameraFile, lens: &Lens, splines: &ResidualSplines) -> (f64, [f64; 2]) {
    let [x0, y0] = camera.principal_point_mm;
    let [half_width, half_height] = camera.half_format_mm();
    let part = |index: u32| 2.0 * f64::from(index) / f64::from(SIDE_POINTS - 1) - 1.0;
    let mut found = (0.0, [0.0, 0.0]);
    for row in 0..SIDE_POINTS {
        for column in 0..SIDE_POINTS {
            let point = [half_width * part(column), half_height * part(row)];
            let [x, y] = point;
            let [dx, dy] = lens.displacement([x - x0, y - y0]);
            let [more_x, more_y] = splines.calibrated(point);
            let length = (dx + more_x).hypot(dy + more_y);
            if length > found.0 {
                found = (length, point);
            }
        }
    }
    found
}
