//! True exposure of a frame while the shutter was open.

use fmc_camera_file::CameraFile;
use fmc_reference::exposure::ExposureRequest;

use super::aircraft::Aircraft;
use super::clock::seconds;
use super::shutter::Opening;
use crate::scene::Scene;
use crate::scene::exposure::ExposedScene;
use crate::scene::shutter::Shutter;
use crate::scene::stage_path::StagePath;

/// Number of intervals of an exposure, at whose ends the place of the image is compared.
const INSTANTS: u32 = 8;
/// Spacing of the path's knots for the image, s; the principal point is computed from all knots.
const KNOT_SPACING_S: f64 = 0.5e-3;

/// Light through the shutter and the path of the stage meanwhile.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueExposure {
    /// Times of the light.
    pub opening: Opening,
    /// Positions of the stage; times from first light.
    pub path: StagePath,
    /// `true` if the path is that of the charge of a TDI sensor, which moves in steps.
    pub is_of_rows: bool,
}

/// True exposure of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameTruth {
    /// First light, s.
    pub opened_s: f64,
    /// t: first light to last, s.
    pub exposure_s: f64,
    /// Centroid of the exposure, s.
    pub centroid_s: f64,
    /// c̄: transmission-weighted mean offset of the principal point, mm along the FMC axis.
    pub centroid_offset_mm: f64,
    /// Δδ: offset at first light, mm.
    pub opening_offset_mm: f64,
    /// δ: travel from first light to last, mm.
    pub travel_mm: f64,
    /// V/H over the ground below at the centroid, 1/s.
    pub vh_per_s: f64,
    /// Image motion along the FMC axis at the principal point that compensation leaves, without
    /// attitude: f·η·t - δ, mm; η is negative in reverse.
    pub compensation_smear_mm: f64,
    /// Distance that an image point moves on the detector, the largest of centre and corners, mm.
    pub smear_mm: f64,
}

/// Physical exposure of a mission's frames.
#[derive(Debug, Clone)]
pub struct Oracle {
    scene: Scene,
    camera: CameraFile,
    aircraft: Aircraft,
}

impl Oracle {
    /// Creates the oracle of a camera on an aircraft. The run-out that the camera file does not
    /// know of is a polynomial of the offset in mm, lowest power first, µm away from the lens.
    #[must_use]
    pub fn new(camera: &CameraFile, aircraft: &Aircraft, run_out_um: &[f64]) -> Self {
        let request =
            ExposureRequest::planned(camera.limits.vh_per_s[0], camera.limits.exposure_s[0]);
        let mut scene = Scene::still(camera, &request, 1000.0);
        scene.trajectory = aircraft.trajectory.clone();
        scene.attitude = aircraft.attitude.clone();
        scene.terrain = aircraft.terrain.clone();
        let known_um = &mut scene.stage.flatness_um;
        known_um.resize(known_um.len().max(run_out_um.len()), 0.0);
        for (known, more) in known_um.iter_mut().zip(run_out_um) {
            *known += more;
        }
        Self {
            scene,
            camera: camera.clone(),
            aircraft: aircraft.clone(),
        }
    }

    /// Computes the true exposure.
    ///
    /// # Model
    /// c̄ is the integral of the recorded path, straight between its knots, over the transmission.
    /// The smear is the largest distance between any two of nine places, evenly spaced in time, of
    /// the image of a ground point, through collinearity, lens and stage.
    pub fn truth(&mut self, exposure: &TrueExposure) -> FrameTruth {
        let opened_s = seconds(exposure.opening.opened_us);
        let closed_us = exposure
            .opening
            .closed_us
            .max(exposure.opening.opened_us + 1);
        let exposure_s = seconds(closed_us - exposure.opening.opened_us);
        let shutter = Shutter::of(&self.camera, exposure_s);
        let path = &exposure.path;
        let [centroid_after_s, centroid_offset_mm] = weighted_means(path, &shutter);
        let travel_mm = path.offset_mm(exposure_s) - path.offset_mm(0.0);
        let centroid_s = opened_s + centroid_after_s;
        let vh_per_s = self.aircraft.speed_and_height(centroid_s).vh_per_s();
        let [_, along_m_s, _] = self.aircraft.trajectory.velocity_m_s;
        let track_mm =
            self.camera.principal_distance_mm * vh_per_s.copysign(along_m_s) * exposure_s;
        self.scene.shutter = shutter;
        self.scene.stage.path = Some(if exposure.is_of_rows {
            path.clone()
        } else {
            path.thinned(KNOT_SPACING_S)
        });
        let frame = self.scene.expose(opened_s);
        FrameTruth {
            opened_s,
            exposure_s,
            centroid_s,
            centroid_offset_mm,
            opening_offset_mm: path.offset_mm(0.0),
            travel_mm,
            vh_per_s,
            compensation_smear_mm: track_mm - travel_mm,
            smear_mm: self.largest_smear_mm(&frame, exposure_s),
        }
    }

    fn largest_smear_mm(&self, frame: &ExposedScene<'_>, exposure_s: f64) -> f64 {
        let [half_x, half_y] = self.camera.half_format_mm();
        let inside = 0.99;
        let grounds_m: Vec<[f64; 3]> = [
            [0.0, 0.0],
            [-half_x, -half_y],
            [half_x, -half_y],
            [-half_x, half_y],
            [half_x, half_y],
        ]
        .into_iter()
        .filter_map(|corner| frame.ground_point(corner.map(|part| inside * part)))
        .collect();
        let places: Vec<Vec<Option<[f64; 2]>>> = (0..=INSTANTS)
            .map(|instant| {
                let after_s = exposure_s * f64::from(instant) / f64::from(INSTANTS);
                frame.places_at(&grounds_m, after_s)
            })
            .collect();
        let of_point = |point: usize| {
            let places = places.iter();
            let places = places.map(|places| places.get(point).copied().flatten());
            places.collect::<Option<Vec<[f64; 2]>>>()
        };
        (0..grounds_m.len())
            .filter_map(of_point)
            .map(|places| farthest_mm(&places))
            .fold(0.0, f64::max)
    }
}

/// Returns the largest distance between places of an image point, mm.
fn farthest_mm(places: &[[f64; 2]]) -> f64 {
    let mut farthest: f64 = 0.0;
    for (index, [x, y]) in places.iter().enumerate() {
        for [other_x, other_y] in places.iter().skip(index + 1) {
            farthest = farthest.max((x - other_x).hypot(y - other_y));
        }
    }
    farthest
}

/// Returns the means of time and offset over the transmission. Both are straight between
/// neighbouring knots and edges, so Simpson's rule is exact.
fn weighted_means(path: &StagePath, shutter: &Shutter) -> [f64; 2] {
    let mut knots: Vec<f64> = shutter.edges_s().to_vec();
    knots.extend(
        path.times_s()
            .filter(|time| (0.0..shutter.exposure_s).contains(time)),
    );
    knots.sort_by(f64::total_cmp);
    let (mut light, mut time_sum, mut offset_sum) = (0.0, 0.0, 0.0);
    for (from, to) in knots.iter().zip(knots.iter().skip(1)) {
        // The transmission may jump at the ends of the stretch, but not inside.
        let middle = 0.5 * (from + to);
        let inside = 1e-9 * (to - from);
        for (time, part) in [
            (from + inside, 1.0 / 6.0),
            (middle, 4.0 / 6.0),
            (to - inside, 1.0 / 6.0),
        ] {
            let share = part * (to - from) * shutter.transmission(time);
            light += share;
            time_sum += share * time;
            offset_sum += share * path.offset_mm(time);
        }
    }
    [time_sum / light, offset_sum / light]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::attitude::Attitude;
    use crate::scene::terrain::Terrain;
    use crate::scene::trajectory::Trajectory;

    const F_MM: f64 = 100.0;

    fn camera() -> CameraFile {
        let text = "name = \"square\"\nprincipal_distance_mm = 100.0\n\
                    [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n\
                    [shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n";
        CameraFile::parse("square.toml", text).unwrap().0
    }

    fn oracle() -> Oracle {
        let aircraft = Aircraft {
            trajectory: Trajectory::level(1000.0, 100.0),
            attitude: Attitude::level(),
            terrain: Terrain::Plane { height_m: 0.0 },
        };
        Oracle::new(&camera(), &aircraft, &[])
    }

    fn exposure(offset_mm: impl Fn(f64) -> f64) -> TrueExposure {
        let knots = (-10..=90).map(|knot| {
            let time = 5e-5 * f64::from(knot);
            (time, offset_mm(time))
        });
        TrueExposure {
            opening: Opening {
                opened_us: 7_000_000,
                closed_us: 7_004_000,
            },
            path: StagePath::new(knots.collect()).unwrap(),
            is_of_rows: false,
        }
    }

    #[test]
    fn stage_at_the_right_speed_leaves_nothing_and_the_centroid_is_that_of_the_light() {
        let mut oracle = oracle();
        let truth = oracle.truth(&exposure(|time| 0.1 + F_MM * 0.1 * time));
        assert!(truth.compensation_smear_mm.abs() < 1e-12);
        assert!(truth.smear_mm < 1e-9, "{}", truth.smear_mm);
        // docs/conventions.md, section 5: E[τ]/t = 1/2 + (r₁ - r₂)(3 - 2r₁ - 2r₂)/(6(2 - r₁ - r₂))
        // for r₁ = 0.3, r₂ = 0.1.
        let centroid = 0.5 + 0.2 * (3.0 - 0.6 - 0.2) / (6.0 * 1.6);
        let expected_mm = 0.1 + 10.0 * 0.004 * centroid;
        // The ends of stretches are left out by 1e-9 of them: 1e-9 of 40 µm.
        assert!((truth.centroid_offset_mm - expected_mm).abs() < 1e-10);
        assert!((truth.centroid_s - 7.0 - 0.004 * centroid).abs() < 1e-10);
    }

    #[test]
    fn centroid_is_that_of_the_physical_scene_for_a_stage_that_oscillates() {
        let mut oracle = oracle();
        let wobble = |time: f64| 10.0 * time + 2e-3 * (1500.0 * time).sin();
        let shaken = exposure(wobble);
        let truth = oracle.truth(&shaken);
        let mut scene = oracle.scene.clone();
        scene.stage.path = Some(shaken.path.clone());
        let frame = scene.expose(7.0);
        let difference = truth.centroid_offset_mm - frame.centroid_offset_mm();
        assert!(difference.abs() < 1e-9, "{difference}");
        // The image moves by twice the amplitude, peak to peak, on a detector that shakes.
        assert!((truth.smear_mm - 4e-3).abs() < 2e-4, "{}", truth.smear_mm);
    }

    #[test]
    fn stage_that_stands_smears_by_the_whole_travel() {
        let truth = oracle().truth(&exposure(|_| 0.0));
        assert!((truth.compensation_smear_mm - 0.04).abs() < 1e-9);
        assert!((truth.smear_mm - 0.04).abs() < 1e-6);
    }
}
