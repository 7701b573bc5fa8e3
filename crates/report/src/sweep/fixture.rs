//! A sweep for the tests.

use fmc_camera_file::{CameraFile, Per, Strategy};
use fmc_reference::exposure::FocusFormula;
use fmc_reference::strict::{Reading, Weight};
use fmc_simulation::sweep::options::SweepOptions;
use fmc_simulation::sweep::result::Sweep;
use fmc_simulation::sweep::run::Plan;

/// Returns the sweep of a small camera, regressed on the centroid.
pub(super) fn sweep(strategy: &str) -> Sweep {
    let text = "name = \"Small <&>\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 1000\nheight_px = 500\npixel_um = 80.0\n[distortion]\nk1 = 1e-7\n";
    let mut camera = CameraFile::parse("small.toml", text).unwrap().0;
    camera.fmc.strategy = Strategy::ALL
        .into_iter()
        .find(|known| known.name() == strategy);
    let options = SweepOptions {
        noise_mm: 0.001,
        focus_shift_mm: 0.006,
        focus_formula: FocusFormula::Physical,
        seed: 7,
        weight: Weight::Exposure,
        reading: Reading::Consistent,
        tied: false,
        regressor: Per::Centroid,
    };
    Plan::new(&camera, options).unwrap().sweep(|| ()).unwrap()
}
