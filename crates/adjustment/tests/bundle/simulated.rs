//! Simulated close-range networks with known truth: the camera of the shared numbers, a lens of
//! 50 mm over 53.4 x 40 mm, 12 convergent images of 60 points at 6.5 m.

use fastrand::Rng;
use fmc_adjustment::bundle::image::NetworkImage;
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network::{ImagePoint, Network, ObjectPoint, PointRole};
use fmc_adjustment::bundle::parameters::{Parameter, SharedValues};
use fmc_adjustment::bundle::pose::Pose;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// σ of an image coordinate, mm.
pub(crate) const SIGMA_MM: f64 = 1e-3;

/// Half format, mm.
pub(crate) const HALF_MM: [f64; 2] = [26.7, 20.0];

/// Lens with distortion and all ten elements different from zero.
pub(crate) const LENS: Interior = Interior {
    principal_distance_mm: 50.0,
    principal_point_mm: [0.05, -0.08],
    k: [0.0, -1.2e-5, 6e-9, -1e-12],
    p: [3e-6, -2e-6],
    b: [2e-4, -1e-4],
};

/// A network, and what it was made from.
#[derive(Debug, Clone)]
pub(crate) struct Simulated {
    /// The network, starting at the truth.
    pub(crate) network: Network,
    /// True coordinates.
    pub(crate) points_m: Vec<Vector3<f64>>,
}

/// Shape of a network.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape {
    pub(crate) images: usize,
    /// Points, on a grid of 10 by as many rows.
    pub(crate) points: usize,
    /// Turn of one image against the one before it, degrees.
    pub(crate) roll_deg: f64,
    /// Tilt against the vertical, degrees.
    pub(crate) tilt_deg: f64,
    /// Depth of the field, m.
    pub(crate) depth_m: f64,
    /// `true` for points held as control.
    pub(crate) held: bool,
    /// Side of the square over which the places of the images are moved, m.
    pub(crate) spread_m: f64,
}

impl Shape {
    /// The bundle of CALIBRATIONS.md, section 5.
    pub(crate) const BUNDLE: Self = Self {
        images: 12,
        points: 60,
        roll_deg: 90.0,
        tilt_deg: 25.0,
        depth_m: 1.2,
        held: false,
        spread_m: 0.0,
    };

    /// The resection of section 4.
    pub(crate) const RESECTION: Self = Self {
        images: 3,
        points: 58,
        roll_deg: 90.0,
        tilt_deg: 15.0,
        depth_m: 1.2,
        held: true,
        spread_m: 0.0,
    };
}

fn count(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap())
}

/// Standard normal deviate (Box and Muller 1958).
pub(crate) fn normal(random: &mut Rng) -> f64 {
    let (u, v) = (1.0 - random.f64(), random.f64());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Returns the measured point of an ideal one from the principal point, mm.
pub(crate) fn measured(lens: &Interior, ideal: nalgebra::Vector2<f64>) -> [f64; 2] {
    let mut about = ideal;
    for _ in 0..60 {
        about = ideal + lens.distortion(about.into());
    }
    let [x0, y0] = lens.principal_point_mm;
    [about.x + x0, about.y + y0]
}

/// Returns the pose of a camera that looks from a place at a target, rolled about its axis.
pub(crate) fn looking(from: Vector3<f64>, at: Vector3<f64>, roll: f64) -> Pose {
    let up = (from - at).normalize();
    let right = Vector3::y().cross(&up).normalize();
    let axes = Matrix3::from_columns(&[right, up.cross(&right), up]);
    Pose {
        position_m: from,
        rotation: Rotation3::from_matrix_unchecked(axes)
            * Rotation3::from_axis_angle(&Vector3::z_axis(), roll),
    }
}

impl Simulated {
    /// Makes the network with seeded noise; all ten elements are estimated.
    pub(crate) fn new(shape: Shape, seed: u64) -> Self {
        let mut random = Rng::with_seed(seed);
        // The field does not depend on the seed.
        let mut field = Rng::with_seed(7);
        let rows = shape.points.div_ceil(10);
        let points_m: Vec<Vector3<f64>> = (0..shape.points)
            .map(|number| {
                let (column, row) = (count(number % 10), count(number / 10));
                Vector3::new(
                    (column / 9.0 - 0.5) * 5.0 + 0.2 * (field.f64() - 0.5),
                    (row / count(rows - 1) - 0.5) * 5.0 + 0.2 * (field.f64() - 0.5),
                    shape.depth_m * (field.f64() - 0.5),
                )
            })
            .collect();
        let images: Vec<NetworkImage> = (0..shape.images)
            .map(|number| {
                let around = std::f64::consts::TAU * count(number) / count(shape.images);
                let tilt = shape.tilt_deg.to_radians();
                let from = 6.5
                    * Vector3::new(
                        tilt.sin() * around.cos(),
                        tilt.sin() * around.sin(),
                        tilt.cos(),
                    );
                let moved = Vector3::new(field.f64() - 0.5, field.f64() - 0.5, 0.0);
                let aside = shape.spread_m * moved;
                let roll = (shape.roll_deg * count(number)).to_radians();
                NetworkImage {
                    name: format!("i{number}"),
                    pose: looking(from + aside, aside, roll),
                    observed: None,
                    stage: None,
                }
            })
            .collect();
        let mut image_points = Vec::new();
        for (point, ground) in points_m.iter().enumerate() {
            for (image, camera) in images.iter().enumerate() {
                let u = camera.pose.in_camera(ground);
                let [x, y] = measured(&LENS, -LENS.principal_distance_mm * u.xy() / u.z);
                let [half_x, half_y] = HALF_MM;
                if x.abs() < half_x && y.abs() < half_y {
                    image_points.push(ImagePoint {
                        image,
                        point,
                        measured_mm: [
                            x + SIGMA_MM * normal(&mut random),
                            y + SIGMA_MM * normal(&mut random),
                        ],
                        by_grids_mm: [0.0; 2],
                        sigma_mm: SIGMA_MM,
                        additional: None,
                        accepted: true,
                    });
                }
            }
        }
        let points = points_m
            .iter()
            .enumerate()
            .map(|(number, position)| ObjectPoint {
                name: format!("p{number}"),
                given_m: *position,
                sigmas_m: [Some(0.0); 3],
                role: if shape.held {
                    PointRole::Control
                } else {
                    PointRole::Tie
                },
            })
            .collect();
        Self {
            network: Network {
                images,
                points,
                image_points,
                additional: Vec::new(),
                scale_bars: Vec::new(),
                strips: Vec::new(),
                parameters: SharedValues::new(LENS, 0),
                estimated: InteriorElement::ALL.map(Parameter::Interior).to_vec(),
                priors: Vec::new(),
            },
            points_m,
        }
    }
}
