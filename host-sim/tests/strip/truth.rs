//! Values that the adjustment finds from observations without errors, compared with the true ones.

use fmc_adjustment::exterior_orientation::ExteriorOrientation;
use fmc_adjustment::model::Model;
use fmc_camera_file::{CameraFile, FittedTable};
use fmc_reference::exposure::{ExposurePath, ExposureRequest};
use fmc_reference::fitted::FittedModel;
use fmc_reference::lens::Lens;
use fmc_simulation::strip_experiment::image_truth::ImageTruth;
use fmc_simulation::strip_experiment::strip::Strip;

use crate::strip::support::{SHIPPED, parsed, scenario, solved, text};

/// Checks position to 1e-6 of the height and attitude to 1e-6 rad: 0.1 µm in the image.
fn assert_same(found: &ExteriorOrientation, truth: &ExteriorOrientation) {
    let height_m = truth.position_m[2];
    for axis in 0..3 {
        let position = (found.position_m[axis] - truth.position_m[axis]) / height_m;
        let attitude = found.attitude[axis] - truth.attitude[axis];
        assert!(position.abs() < 1e-6, "{axis}: {position:e}");
        assert!(attitude.abs() < 1e-6, "{axis}: {attitude:e}");
    }
}

#[test]
fn exact_model_gives_the_orientations_back_from_any_observed_orientation() {
    // The orientation on board is off by metres and degrees, or by hundreds of metres and ten
    // degrees.
    let near = ("[3.0, -2.0, 4.0]", "[0.5, -0.5, 1.0]");
    let far = ("[200.0, -150.0, 250.0]", "[-8.0, 7.0, 10.0]");
    for (name, (position, attitude)) in SHIPPED.iter().flat_map(|name| [(name, near), (name, far)])
    {
        // The points have no errors, and the orientation on board has no weight.
        let biased = text(name)
            .replace(
                "position_bias_m = [0.0, 0.0, 0.0]",
                &format!("position_bias_m = {position}"),
            )
            .replace(
                "attitude_bias_deg = [0.0, 0.0, 0.0]",
                &format!("attitude_bias_deg = {attitude}"),
            );
        let lines: Vec<String> = biased
            .lines()
            .map(|line| match line.split(' ').next() {
                Some("position_sigma_m") => "position_sigma_m = \"free\"".to_owned(),
                Some("attitude_sigma_deg") => "attitude_sigma_deg = \"free\"".to_owned(),
                _ => line.to_owned(),
            })
            .collect();
        let scenario = parsed(&lines.join("\n"));
        let strip = Strip::new(&scenario, 1).unwrap();
        let adjusted = solved(&scenario, &strip, Model::Exact, 0.0).unwrap();
        for (found, frame) in adjusted.orientations.iter().zip(&strip.frames) {
            assert_same(found, &frame.orientation);
        }
        assert!(*adjusted.rms_mm.last().unwrap() < 1e-5);
    }
}

/// The five-coefficient model as the true distortion.
struct Five(FittedModel);

impl ImageTruth for Five {
    fn distortion(&self, measured_mm: [f64; 2]) -> [f64; 2] {
        self.0.distortion(measured_mm)
    }
}

fn five(camera: &CameraFile, path: &ExposurePath, table: &FittedTable) -> Five {
    let camera = CameraFile {
        fitted: Some(table.clone()),
        ..camera.clone()
    };
    Five(FittedModel::new(&camera, path).unwrap())
}

#[test]
fn coefficients_of_the_five_coefficient_model_come_back() {
    for name in SHIPPED {
        let scenario = scenario(name);
        let flight = &scenario.written.flight;
        let request = ExposureRequest::planned(scenario.vh_per_s(), flight.exposure_s);
        let path = ExposurePath::new(&scenario.camera, &request);
        let lens = Lens::of(&scenario.camera);
        let table = FittedTable {
            km0: 3e-4,
            km1: 1.02 * lens.k[1],
            km2: lens.k[2] + 1e-11,
            kd1: 4e-5,
            pm1: -2e-5,
            ..FittedTable::default()
        };
        let truth = five(&scenario.camera, &path, &table);
        let strip = Strip::recorded_by(&truth, &scenario, 1).unwrap();
        let adjusted = solved(&scenario, &strip, Model::FiveCoefficient, 0.0).unwrap();
        for (found, frame) in adjusted.orientations.iter().zip(&strip.frames) {
            assert_same(found, &frame.orientation);
        }
        let found = strip.corrections.in_mm(&adjusted.coefficients);
        let expected = [table.km0, table.km1, table.km2, table.kd1, table.pm1];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{name}: {found:e} {expected:e}"
            );
        }
    }
}

#[test]
fn adjustment_arrives_in_six_iterations_where_the_paper_needs_twenty() {
    for name in SHIPPED {
        let scenario = scenario(name);
        let strip = Strip::new(&scenario, 1).unwrap();
        for model in Model::ALL {
            let adjusted = solved(&scenario, &strip, model, 1.0).unwrap();
            assert!(adjusted.rms_mm.len() <= 1 + 6, "{name} {model:?}");
            assert!(adjusted.iterations_to(1e-3) <= 3);
        }
    }
}
