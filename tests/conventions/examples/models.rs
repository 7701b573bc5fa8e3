//! Section 7: one point with the three models.

use super::{Example, Given, Results};
use fmc_camera::flight::camera::{Camera, Frame};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::five_coefficient::FiveCoefficients;

pub(super) const EXAMPLES: &[Example] = &[("one point, three models", three_models)];

fn three_models(given: &Given) -> Results {
    let mut interior = given.stage_camera(RunUp::FromRest);
    let k1 = given.number("K1", "mm⁻²");
    interior.calibration.distortion.k1 = k1;
    interior.calibration.fitted = Some(FiveCoefficients {
        km1: k1,
        kd1: given.number("Kd1", "mm⁻²"),
        pm1: given.number("Pm1", "mm⁻²"),
        ..FiveCoefficients::default()
    });
    let camera = Camera::new(interior).unwrap();
    [
        ("static", CorrectionModel::Static),
        ("exact", CorrectionModel::Exact),
        ("fitted", CorrectionModel::Fitted),
    ]
    .map(|(name, model)| {
        let exposure = Exposure {
            model,
            ..given.exposure()
        };
        let Frame {
            interior,
            correction,
        } = camera.frame(&exposure).unwrap();
        assert!(
            (interior.principal_point.y_mm - interior.motion.centroid_mm).abs() < 1e-9,
            "every model reports the centroid"
        );
        let dy_mm = correction.distortion(given.point("x", "y")).dy_mm;
        (name, "µm", f64::from(dy_mm) * 1000.0)
    })
    .to_vec()
}
