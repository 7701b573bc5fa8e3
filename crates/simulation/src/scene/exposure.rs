//! One exposure of a scene: positions, attitude and image points while the shutter is open.

use std::sync::OnceLock;

use fmc_camera::geometry::principal_point::StageSample;
use nalgebra::{Point3, Rotation3, Vector3};

use super::Scene;
use super::image_point::ImagePoint;

/// Nodes and weights of Gauss-Legendre quadrature on [-1, 1], both signs of each.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// One exposure of a scene.
///
/// # Model
/// Every quantity is integrated over the time for which the shutter is open, weighted by the
/// transmission. Each stretch has 8 nodes: within a stretch the transmission is linear, no charge
/// is transferred, the path of the stage has no knot, and the turbulence runs through a quarter of
/// its shortest wave.
#[derive(Debug, Clone)]
pub struct ExposedScene<'a> {
    scene: &'a Scene,
    opening_s: f64,
    nodes: Vec<Node>,
}

impl Scene {
    /// Returns the exposure whose shutter opens at a time, s.
    #[must_use]
    pub fn expose(&self, opening_s: f64) -> ExposedScene<'_> {
        ExposedScene::new(self, opening_s)
    }
}

/// An instant with its share of the light.
#[derive(Debug, Clone)]
struct Node {
    share: f64,
    after_opening_s: f64,
    offset_mm: f64,
    /// Made for the first point that is looked at: means of the stage alone do not need it.
    instant: OnceLock<Instant>,
}

/// Positions and attitude at an instant.
#[derive(Debug, Clone)]
struct Instant {
    position: Point3<f64>,
    camera_from_ground: Rotation3<f64>,
    offset_mm: f64,
    /// 1 + κ.
    enlargement: f64,
}

impl<'a> ExposedScene<'a> {
    fn new(scene: &'a Scene, opening_s: f64) -> Self {
        let exposure_s = scene.shutter.exposure_s;
        let mut edges: Vec<f64> = scene.shutter.edges_s().to_vec();
        edges.extend(scene.stage.breaks_s(exposure_s));
        edges.sort_by(f64::total_cmp);
        let highest_hz = scene
            .trajectory
            .highest_hz()
            .max(scene.attitude.highest_hz());
        let mut nodes = Vec::new();
        for (from, to) in edges.iter().zip(edges.iter().skip(1)) {
            let parts = parts(4.0 * highest_hz * (to - from));
            for part in 0..parts {
                let half = (to - from) / f64::from(parts) / 2.0;
                let middle = from + half * (2.0 * f64::from(part) + 1.0);
                for (place, weight) in GAUSS {
                    for after_opening_s in [middle - half * place, middle + half * place] {
                        let light = scene.shutter.transmission(after_opening_s);
                        nodes.push(Node {
                            share: weight * half * light,
                            after_opening_s,
                            offset_mm: scene.stage.offset_mm(after_opening_s),
                            instant: OnceLock::new(),
                        });
                    }
                }
            }
        }
        let light: f64 = nodes.iter().map(|node| node.share).sum();
        for node in &mut nodes {
            node.share /= light;
        }
        Self {
            scene,
            opening_s,
            nodes,
        }
    }

    /// Time at which the shutter opened, s.
    #[must_use]
    pub const fn opening_s(&self) -> f64 {
        self.opening_s
    }

    /// Centroid time: the mean over the light, s.
    #[must_use]
    pub fn centroid_s(&self) -> f64 {
        self.opening_s + self.mean(|node| node.after_opening_s)
    }

    /// c̄: mean offset of the principal point over the light, mm along the FMC axis.
    #[must_use]
    pub fn centroid_offset_mm(&self) -> f64 {
        self.mean(|node| node.offset_mm)
    }

    /// Centroid principal point, mm of the sensor frame.
    #[must_use]
    pub fn principal_point_mm(&self) -> [f64; 2] {
        self.principal_point_at(self.centroid_offset_mm())
    }

    /// Projection centre at the centroid time, m.
    #[must_use]
    pub fn projection_centre_m(&self) -> [f64; 3] {
        self.scene.trajectory.position_at(self.centroid_s())
    }

    /// Rotation from camera axes (right, forward, up) to the ground frame at the centroid time.
    #[must_use]
    pub fn ground_from_camera(&self) -> Rotation3<f64> {
        self.scene.attitude.ground_from_camera(self.centroid_s())
    }

    /// Readings of the encoder, from before the exposure to after it.
    #[must_use]
    pub fn encoder_samples(&self) -> Vec<StageSample> {
        let exposure_s = self.scene.shutter.exposure_s;
        self.scene.stage.encoder_samples(exposure_s)
    }

    /// Returns the image of a ground point at a time after first light, mm of the sensor frame;
    /// `None` if it has none. The image may lie beside the pixel array.
    #[must_use]
    pub fn place_at(&self, ground_m: [f64; 3], after_opening_s: f64) -> Option<[f64; 2]> {
        self.place(&self.instant(after_opening_s), ground_m)
    }

    /// Returns the images of ground points at a time after first light, as [`Self::place_at`] does.
    #[must_use]
    pub fn places_at(&self, grounds_m: &[[f64; 3]], after_opening_s: f64) -> Vec<Option<[f64; 2]>> {
        let instant = self.instant(after_opening_s);
        let places = grounds_m
            .iter()
            .map(|ground_m| self.place(&instant, *ground_m));
        places.collect()
    }

    /// Returns the image of a ground point; `None` if it has none at some instant, or if its
    /// centroid lies beside the pixel array. Terrain does not hide it.
    #[must_use]
    pub fn image_point(&self, ground_m: [f64; 3]) -> Option<ImagePoint> {
        let mut centroid = [0.0; 2];
        for node in &self.nodes {
            let instant = node
                .instant
                .get_or_init(|| self.instant(node.after_opening_s));
            let place = self.place(instant, ground_m)?;
            for (sum, coordinate) in centroid.iter_mut().zip(place) {
                *sum += node.share * coordinate;
            }
        }
        let [first_x, first_y] = self.place_at(ground_m, 0.0)?;
        let [last_x, last_y] = self.place_at(ground_m, self.scene.shutter.exposure_s)?;
        self.scene
            .interior
            .contains(centroid)
            .then_some(ImagePoint {
                point_mm: centroid,
                smear_mm: [last_x - first_x, last_y - first_y],
            })
    }

    /// Returns the ground point that a point of the sensor frame sees at the centroid time, with
    /// the centroid principal point; `None` above the horizon.
    #[must_use]
    pub fn ground_point(&self, sensor_mm: [f64; 2]) -> Option<[f64; 3]> {
        let interior = &self.scene.interior;
        let after_opening_s = self.centroid_s() - self.opening_s;
        let instant = self.instant(after_opening_s);
        let [x0, y0] = self.principal_point_mm();
        let [x, y] = sensor_mm;
        let measured = [x - x0, y - y0].map(|part| part / instant.enlargement);
        let [right, forward] = interior.camera_from_sensor(self.scene.lens.ideal(measured)?);
        let ray = instant
            .camera_from_ground
            .inverse_transform_vector(&Vector3::new(
                right,
                forward,
                -interior.principal_distance_mm,
            ));
        let eye = instant.position.coords.into();
        self.scene.terrain.seen_along(eye, ray.into())
    }

    fn instant(&self, after_opening_s: f64) -> Instant {
        Instant::of(self.scene, self.opening_s, after_opening_s)
    }

    fn mean(&self, quantity: impl Fn(&Node) -> f64) -> f64 {
        self.nodes
            .iter()
            .map(|node| node.share * quantity(node))
            .sum()
    }

    fn principal_point_at(&self, offset_mm: f64) -> [f64; 2] {
        let interior = &self.scene.interior;
        let ([x0, y0], [ex, ey]) = (interior.principal_point_mm, interior.axis.unit());
        [x0 + offset_mm * ex, y0 + offset_mm * ey]
    }

    /// Applies collinearity, then the lens, the enlargement by the focus shift and the detector's
    /// offset.
    fn place(&self, instant: &Instant, ground_m: [f64; 3]) -> Option<[f64; 2]> {
        let interior = &self.scene.interior;
        let seen = instant.camera_from_ground * (Point3::from(ground_m) - instant.position);
        if seen.z >= 0.0 || seen.z.is_nan() {
            return None;
        }
        let scale = interior.principal_distance_mm / -seen.z;
        let ideal = interior.sensor_from_camera([scale * seen.x, scale * seen.y]);
        let [x, y] = self.scene.lens.measured(ideal)?;
        let [x0, y0] = self.principal_point_at(instant.offset_mm);
        Some([x0 + instant.enlargement * x, y0 + instant.enlargement * y])
    }
}

impl Instant {
    fn of(scene: &Scene, opening_s: f64, after_opening_s: f64) -> Self {
        let time_s = opening_s + after_opening_s;
        let focus_shift_mm = scene.stage.focus_shift_mm(after_opening_s);
        Self {
            position: scene.trajectory.position_at(time_s).into(),
            camera_from_ground: scene.attitude.ground_from_camera(time_s).inverse(),
            offset_mm: scene.stage.offset_mm(after_opening_s),
            enlargement: 1.0 + focus_shift_mm / scene.interior.exit_pupil_mm,
        }
    }
}

/// Rounds up to a number of parts, at least one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the cast saturates; what is less than 1 becomes 1"
)]
fn parts(wanted: f64) -> u32 {
    (wanted.ceil() as u32).clamp(1, 10_000)
}
