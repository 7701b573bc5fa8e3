//! Physical exposure in double precision: aircraft, terrain, lens, stage and shutter, and what the
//! detector records of a ground point.
//!
//! The scene holds nothing of the camera's correction: an image point is the transmission-weighted
//! mean of the places at which collinearity, lens and detector put it while the shutter is open. It
//! is the truth with which models are compared.
//!
//! # Examples
//! ```
//! use fmc_camera_file::CameraFile;
//! use fmc_reference::exposure::ExposureRequest;
//! use fmc_simulation::scene::Scene;
//!
//! let text = "name = \"bare\"\nprincipal_distance_mm = 100.0\n\
//!             [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";
//! let (camera, _) = CameraFile::parse("bare.toml", text).unwrap();
//! // V/H 0.1 1/s at 1000 m, 1/300 s: the camera compensates 33.3 µm.
//! let mut scene = Scene::still(&camera, &ExposureRequest::planned(0.1, 1.0 / 300.0), 1000.0);
//! let still = scene.expose(0.0).image_point([100.0, 200.0, 0.0]).unwrap();
//! assert!(still.smear_length_mm() < 1e-12);
//!
//! scene.stage.speed_error_percent = 1.0; // 1 % of 33.3 µm is left
//! let frame = scene.expose(0.0);
//! let smeared = frame.image_point([100.0, 200.0, 0.0]).unwrap();
//! assert!((smeared.smear_mm[1] - 0.3333e-3).abs() < 1e-7);
//! ```

pub mod attitude;
pub mod exposure;
pub mod field_table;
pub mod image_point;
pub mod interior;
pub mod lens;
pub mod shutter;
pub mod stage;
pub mod stage_path;
pub mod terrain;
pub mod trajectory;
pub mod turbulence;

use fmc_camera_file::CameraFile;
use fmc_reference::exposure::ExposureRequest;
use fmc_reference::lens::Lens;

use attitude::Attitude;
use interior::InteriorOrientation;
use lens::LensMapping;
use shutter::Shutter;
use stage::Stage;
use terrain::Terrain;
use trajectory::Trajectory;

/// Everything that an image depends on. Every field may be changed; each type has its own
/// documentation.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Path of the projection centre.
    pub trajectory: Trajectory,
    /// Attitude of the camera.
    pub attitude: Attitude,
    /// The ground.
    pub terrain: Terrain,
    /// Interior orientation, sensor and FMC axis.
    pub interior: InteriorOrientation,
    /// The lens.
    pub lens: LensMapping,
    /// The mechanism and its faults.
    pub stage: Stage,
    /// The shutter.
    pub shutter: Shutter,
}

impl Scene {
    /// Creates a camera in still air, level over flat ground at height 0, perfectly compensated. It
    /// flies along the ground frame's y, or against it, and is over the origin at time 0.
    #[must_use]
    pub fn still(camera: &CameraFile, request: &ExposureRequest, height_m: f64) -> Self {
        Self {
            trajectory: Trajectory::level(height_m, request.signed_vh_per_s() * height_m),
            attitude: Attitude::level(),
            terrain: Terrain::Plane { height_m: 0.0 },
            interior: InteriorOrientation::of(camera),
            lens: LensMapping::Polynomial(Lens::of(camera)),
            stage: Stage::planned(camera, request),
            shutter: Shutter::of(camera, request.exposure_s),
        }
    }
}
