//! Exposures of a synthetic camera.

use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_simulation::noise::Noise;

use super::detector::{Detector, FULL_SCALE_DN};
use super::marks::{Mark, marks};
use super::request::SceneRequest;
use super::terrain::Terrain;
use super::texture::Texture;
use super::true_rig::TrueRig;
use crate::image::Plane;
use crate::number::real;
use crate::rig::Rig;

/// Base of the two exposures over the height of the flight: 60 % overlap.
const BASE_OVER_HEIGHT: f64 = 0.40;
/// Part of the full scale that the brightest ground has on the axis.
const BRIGHTEST: f64 = 0.75;
/// Part of the light that the lens loses at the corner beside cos⁴.
const VIGNETTE: f64 = 0.06;
/// Levels of the flats, mean grey over the virtual image, parts of the full scale.
const LOWEST_LEVEL: f64 = 0.2;
const HIGHEST_LEVEL: f64 = 0.9;
/// Sets of flats.
pub(super) const FLATS: usize = 19;
/// Places along a side at which the mean of the falloff is taken.
const MEAN_PLACES: usize = 40;

/// An exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// Name, that of its folder.
    pub name: String,
    /// True orientation.
    pub orientation: ExteriorOrientation,
}

/// A synthetic camera over ground of known relief and grey values.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Choices that were asked for.
    pub request: SceneRequest,
    /// Nominal rig.
    pub rig: Rig,
    /// Rig as it is.
    pub truth: TrueRig,
    /// Relief.
    pub terrain: Terrain,
    /// Ground marks.
    pub marks: Vec<Mark>,
    /// The two exposures, named as in the publication.
    pub exposures: Vec<Exposure>,
    texture: Texture,
}

impl Scene {
    /// Draws a scene.
    #[must_use]
    pub fn new(request: SceneRequest) -> Self {
        let rig = request.rig();
        let height_m = request.height_m();
        let ground_sample_m = height_m / rig.principal_distance_px();
        let half_m = [rig.frame.width_px, rig.frame.height_px]
            .map(|side| real(side) * ground_sample_m / 2.0);
        let base_m = BASE_OVER_HEIGHT * height_m;
        let seed = |part: u64| request.seed.wrapping_mul(1000).wrapping_add(part);
        let mut noise = Noise::new(seed(1), 0);
        let tilt = request.tilt_deg.to_radians();
        let exposures = ["8_10", "8_11"]
            .into_iter()
            .zip([0.0, base_m])
            .map(|(name, y_m)| {
                let [pitch, roll, yaw] = noise.next([tilt, tilt, tilt / 2.0]);
                // No larger than twice the tilt that was asked for: the ground stays in view.
                let [pitch, roll, yaw] =
                    [pitch, roll, yaw].map(|angle| angle.clamp(-2.0 * tilt, 2.0 * tilt));
                Exposure {
                    name: name.to_owned(),
                    orientation: ExteriorOrientation {
                        position_m: [0.0, y_m, height_m],
                        attitude: [pitch, roll, yaw],
                    },
                }
            });
        let exposures = exposures.collect();
        let places = marks(
            request.marks,
            [-half_m[0], -half_m[1]],
            [half_m[0], half_m[1] + base_m],
        );
        let extent_m = 2.0 * half_m[0].max(half_m[1]);
        let terrain = Terrain::new(&places, extent_m, request.relief_m, seed(2));
        let marks = places.iter().zip(1..).map(|(place, number)| Mark {
            id: format!("M{number:03}"),
            ground_m: [place[0], place[1], terrain.height_m(*place)],
        });
        Self {
            request,
            truth: TrueRig::new(&rig, request.distortion, seed(3)),
            marks: marks.collect(),
            terrain,
            exposures,
            texture: Texture::new(ground_sample_m, seed(4)),
            rig,
        }
    }

    /// Ground sample distance at the mean height, m.
    #[must_use]
    pub fn ground_sample_m(&self) -> f64 {
        self.request.height_m() / self.rig.principal_distance_px()
    }

    /// Seed of a part of the scene.
    pub(super) fn seed(&self, part: u64) -> u64 {
        self.request.seed.wrapping_mul(1000).wrapping_add(part)
    }

    /// Returns the detector of a sub-image.
    #[must_use]
    pub fn detector(&self, number: usize) -> Detector {
        let size = self
            .rig
            .sub
            .get(number)
            .map_or([1, 1], crate::rig::SubImage::size_px);
        Detector::new(size, self.seed(100 + number as u64))
    }

    /// Returns the light that is left at a tangent of the field angle, 1 on the axis: cos⁴ and the
    /// vignette.
    #[must_use]
    pub fn falloff(&self, field: f64) -> f64 {
        let [half_width, half_height] = self.rig.frame.centre_px();
        let corner = half_width.hypot(half_height) / self.rig.principal_distance_px();
        let cos_squared = 1.0 / (1.0 + field * field);
        cos_squared * cos_squared * (1.0 - VIGNETTE * (field / corner).powi(2))
    }

    /// Returns what a sub-image records of an exposure.
    #[must_use]
    pub fn sub_image(&self, exposure: usize, number: usize, detector: &Detector) -> Plane {
        let frame = 1000 + exposure as u64;
        self.recorded(number, detector, frame, |pixel| {
            self.light_dn(exposure, number, pixel)
        })
    }

    /// Returns a flat of a sub-image; `None` beyond the last set.
    #[must_use]
    pub fn flat(&self, set: usize, number: usize, detector: &Detector) -> Option<Plane> {
        let signal_dn = self.flat_signal_dn(set)?;
        let frame = 2000 + set as u64;
        Some(self.recorded(number, detector, frame, |_| signal_dn))
    }

    /// Returns a dark frame of a sub-image.
    #[must_use]
    pub fn dark(&self, set: usize, number: usize, detector: &Detector) -> Plane {
        self.recorded(number, detector, 3000 + set as u64, |_| 0.0)
    }

    /// Signal of a flat on the axis, DN; `None` beyond the last set.
    #[must_use]
    pub fn flat_signal_dn(&self, set: usize) -> Option<f64> {
        let part = real(set) / real(FLATS - 1);
        (set < FLATS).then(|| {
            let level = LOWEST_LEVEL + (HIGHEST_LEVEL - LOWEST_LEVEL) * part;
            level * FULL_SCALE_DN / self.mean_falloff()
        })
    }

    /// Sets of flats.
    #[must_use]
    pub const fn flats(&self) -> usize {
        FLATS
    }

    fn mean_falloff(&self) -> f64 {
        let [half_width, half_height] = self.rig.frame.centre_px();
        let part = |number: usize| (real(number) + 0.5) / real(MEAN_PLACES);
        let sum: f64 = (0..MEAN_PLACES * MEAN_PLACES)
            .map(|number| {
                let x = part(number % MEAN_PLACES) * half_width;
                let y = part(number / MEAN_PLACES) * half_height;
                self.falloff(x.hypot(y) / self.rig.principal_distance_px())
            })
            .sum();
        sum / real(MEAN_PLACES * MEAN_PLACES)
    }

    fn recorded(
        &self,
        number: usize,
        detector: &Detector,
        frame: u64,
        light_dn: impl Fn([f64; 2]) -> f64 + Sync,
    ) -> Plane {
        let [width, height] = self
            .rig
            .sub
            .get(number)
            .map_or([1, 1], crate::rig::SubImage::size_px);
        Plane::of_rows(width, height, |row| {
            detector.row_dn(row, frame, |col| {
                let pixel = [real(col), real(row)];
                self.falloff(self.truth.field(number, pixel)) * light_dn(pixel)
            })
        })
    }

    /// Signal of the ground that a pixel sees, without the falloff, DN.
    fn light_dn(&self, exposure: usize, number: usize, pixel: [f64; 2]) -> f64 {
        let place = self.truth.virtual_px(number, pixel);
        place.map_or(0.0, |place| self.ground_dn(exposure, place))
    }

    /// Signal of the ground at a place of the true virtual image, DN; 0 beside the ground.
    fn ground_dn(&self, exposure: usize, place: [f64; 2]) -> f64 {
        self.true_dn(exposure, place).unwrap_or(0.0)
    }

    /// Returns the value of the true virtual image at a place, DN; `None` beside the ground.
    #[must_use]
    pub fn true_dn(&self, exposure: usize, place: [f64; 2]) -> Option<f64> {
        let seen = self.ground_seen(exposure, place)?;
        Some(brightness_dn(self.texture.pan(seen)))
    }

    /// Place of the ground that is seen at a place of the true virtual image, m.
    #[must_use]
    pub fn ground_seen(&self, exposure: usize, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let [centre_u, centre_v] = self.rig.frame.centre_px();
        let f_px = self.rig.principal_distance_px();
        let direction = [(u - centre_u) / f_px, (v - centre_v) / f_px];
        let exposure = self.exposures.get(exposure)?;
        self.terrain.seen(&exposure.orientation, direction)
    }

    /// Returns the true virtual image of an exposure: no noise, no falloff, no distortion.
    #[must_use]
    pub fn true_image(&self, exposure: usize) -> Plane {
        let frame = self.rig.frame;
        Plane::of_rows(frame.width_px, frame.height_px, |row| {
            let places = (0..frame.width_px).map(|col| [real(col), real(row)]);
            places
                .map(|place| crate::number::grey(self.ground_dn(exposure, place)))
                .collect()
        })
    }

    /// Returns what green records of an exposure: a perfect detector with noise; `None` of a rig
    /// without green.
    #[must_use]
    pub fn green_image(&self, exposure: usize) -> Option<Plane> {
        let green = self.rig.green.as_ref()?;
        let orientation = self.exposures.get(exposure)?.orientation;
        Some(Plane::of_rows(green.width_px, green.height_px, |row| {
            let mut noise = Noise::new(self.seed(50 + exposure as u64), row as u64);
            let samples = (0..green.width_px).map(|col| {
                let direction = green.direction([real(col), real(row)]);
                let seen = self.terrain.seen(&orientation, direction);
                let signal = seen.map_or(0.0, |place| brightness_dn(self.texture.green(place)));
                let [deviate] = noise.next([(30.0 + 0.27 * signal).sqrt()]);
                crate::number::grey(signal + deviate)
            });
            samples.collect()
        }))
    }
}

/// Returns the signal of a grey value of the ground, DN.
fn brightness_dn(grey: f64) -> f64 {
    BRIGHTEST * FULL_SCALE_DN * grey.max(0.02)
}
