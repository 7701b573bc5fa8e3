//! A budget for the tests.

use fmc_camera_file::CameraFile;
use fmc_simulation::budget::assumptions::Assumptions;
use fmc_simulation::budget::result::Budget;
use fmc_simulation::budget::run;

/// Returns the budget of a small camera.
pub(super) fn budget() -> Budget {
    let text = "name = \"Small <&>\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 1000\nheight_px = 500\npixel_um = 80.0\n[distortion]\nk1 = 1e-7\n";
    let camera = CameraFile::parse("small.toml", text).unwrap().0;
    let assumptions = Assumptions {
        height_m: 1000.0,
        focus_mm: 0.005,
        vh_error: 0.01,
        relief: 0.1,
        drift_deg: 1.0,
        rate_deg_s: 1.0,
        encoder_mm: 0.001,
        timing_s: 1e-4,
    };
    run::budget(&camera, assumptions).unwrap()
}
