//! Simulated images of a test field by cameras of known parameters.

use std::sync::Arc;

use fmc_adjustment::calibration::dlt3d::pinhole::Pinhole;
use fmc_adjustment::calibration::dlt3d::{Dlt3d, Dlt3dRequest, FieldPoint, dlt3d};
use fmc_adjustment::calibration::failure::CalibrationFailure;
use fmc_adjustment::calibration::result::InputFile;
use fmc_camera_file::CameraFile;
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{Rotation3, Vector3};

use crate::noise::Noise;

/// Published coefficient set (`cameras.csv` of the conventions), as measured - ideal.
pub(crate) struct Published {
    pub(crate) name: &'static str,
    pub(crate) f: f64,
    pub(crate) point: [f64; 2],
    pub(crate) format: [f64; 2],
    /// K0, K1, K2, K3, P1, P2.
    pub(crate) coefficients: [f64; 6],
}

pub(crate) const IXM_50: Published = Published {
    name: "iXM-RS150F 50 mm",
    f: 51.3712,
    point: [0.0584, -0.0239],
    format: [53.407_04, 40.051_52],
    coefficients: [
        0.0,
        -1.605_600e-5,
        6.189_660e-9,
        -1.313_290e-12,
        2.0419e-6,
        4.512_02e-6,
    ],
};

pub(crate) const PUBLISHED: [Published; 5] = [
    IXM_50,
    Published {
        name: "iXU-RS1000 50 mm",
        f: 51.682_942_548,
        point: [0.0, 0.0],
        format: [53.3968, 40.0568],
        coefficients: [
            0.0,
            -1.456_939_317_67e-5,
            4.059_036_2e-9,
            -4.11e-14,
            3.433_289_555_5e-6,
            4.357_278_545_0e-6,
        ],
    },
    Published {
        name: "RC30 5368",
        f: 153.743,
        point: [-0.009, 0.002],
        format: [228.6, 228.6],
        coefficients: [
            -0.2616e-4,
            0.2295e-8,
            -0.1454e-13,
            0.0,
            0.3015e-7,
            -0.1668e-7,
        ],
    },
    Published {
        name: "RC30 5324",
        f: 153.247,
        point: [0.006, -0.001],
        format: [228.6, 228.6],
        coefficients: [
            -0.3285e-4,
            0.5215e-8,
            -0.1642e-12,
            0.0,
            0.1218e-7,
            0.4426e-7,
        ],
    },
    Published {
        name: "RC30 5282",
        f: 153.527,
        point: [-0.013, 0.008],
        format: [228.6, 228.6],
        coefficients: [
            -0.6404e-4, 0.3587e-8, 0.9784e-13, 0.0, 0.5780e-7, -0.1873e-7,
        ],
    },
];

impl Published {
    /// Camera file with nominal values: no distortion, no principal point, f 2 % off.
    pub(crate) fn nominal(&self) -> CameraFile {
        let [width, height] = self.format.map(|mm| (mm / 0.01).round());
        let text = format!(
            "name = \"{}\"\nprincipal_distance_mm = {}\n[sensor]\nwidth_px = {width}\nheight_px = {height}\npixel_um = 10.0\n",
            self.name,
            1.02 * self.f
        );
        CameraFile::parse("camera.toml", &text).unwrap().0
    }

    /// The camera with K0 taken into f: the same rays without K0.
    pub(crate) fn pinhole(&self, centre_m: [f64; 3], angles: [f64; 3]) -> Pinhole {
        let [k0, k1, k2, k3, p1, p2] = self.coefficients;
        let [a, b, c] = angles;
        let without = |value: f64| value / (1.0 - k0);
        Pinhole {
            principal_distance_mm: self.f / (1.0 - k0),
            principal_point_mm: self.point,
            affinity: [0.0; 2],
            radial: [without(k1), without(k2), without(k3)],
            decentring: [without(p1), without(p2)],
            centre_m: Vector3::from(centre_m),
            camera_from_ground: Rotation3::from_euler_angles(a, b, c).into_inner(),
        }
    }
}

/// Returns the measured point of an object point, by iteration to the last bits.
pub(crate) fn measured(camera: &Pinhole, object_m: [f64; 3]) -> [f64; 2] {
    let direction = camera.in_camera(&Vector3::from(object_m));
    assert!(direction.z < 0.0);
    let scale = -camera.principal_distance_mm / direction.z;
    let ideal = [scale * direction.x, scale * direction.y];
    let [b1, b2] = camera.affinity;
    let mut point = ideal;
    for _ in 0..500 {
        let ([dx, dy], _) = camera.radial_and_decentring(point);
        let [x, y] = point;
        point = [ideal[0] + dx + b1 * x + b2 * y, ideal[1] + dy];
    }
    let [x0, y0] = camera.principal_point_mm;
    [point[0] + x0, point[1] + y0]
}

/// Object points of a field of these sizes about a centre, m.
pub(crate) fn field(
    count: usize,
    size_m: [f64; 3],
    centre_m: [f64; 3],
    seed: u64,
) -> Vec<[f64; 3]> {
    let mut noise = Noise::new(seed);
    (0..count)
        .map(|_| std::array::from_fn(|axis| centre_m[axis] + 0.5 * size_m[axis] * noise.even()))
        .collect()
}

/// Observations of a field by a camera with noise, µm.
pub(crate) fn observed(
    camera: &Pinhole,
    objects: &[[f64; 3]],
    noise_um: f64,
    seed: u64,
) -> Vec<FieldPoint> {
    let mut noise = Noise::new(seed);
    objects
        .iter()
        .enumerate()
        .map(|(index, object_m)| {
            let [x, y] = measured(camera, *object_m);
            FieldPoint {
                line: index as u64 + 2,
                point: Arc::from(format!("{}", index + 1)),
                measured_mm: [
                    x + 1e-3 * noise_um * noise.gaussian(),
                    y + 1e-3 * noise_um * noise.gaussian(),
                ],
                sigma_mm: 1e-3,
                object_m: *object_m,
            }
        })
        .collect()
}

/// Runs the transformation.
pub(crate) fn transformed(
    points: &[FieldPoint],
    camera: &CameraFile,
    is_estimated: [bool; 5],
) -> Result<Dlt3d, CalibrationFailure> {
    dlt3d(&request(points, camera, is_estimated))
}

/// Returns the request of a transformation that rejects gross errors.
pub(crate) fn request<'a>(
    points: &'a [FieldPoint],
    camera: &'a CameraFile,
    is_estimated: [bool; 5],
) -> Dlt3dRequest<'a> {
    Dlt3dRequest {
        input: InputFile {
            file: "points.csv".to_owned(),
            crc32: 0,
        },
        has_sigma: false,
        points,
        camera,
        grids: &ResidualSplines::NONE,
        is_estimated,
        keeps_all: false,
    }
}
