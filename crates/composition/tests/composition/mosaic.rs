//! Sub-images composed to the virtual image, against truth.

use fmc_camera_kernel::resampling::Kernel;
use fmc_composition::image::Plane;
use fmc_composition::mosaic::registration::{Pair, Registration};
use fmc_composition::mosaic::{Geometry, Layer, compose, green_pairs, steps};
use fmc_composition::rig::calibration::{RigOptions, calibrate};
use fmc_composition::rig::control::Measurements;
use fmc_composition::rig::{Heights, Rig};
use fmc_composition::scene::{Scene, SceneRequest};

/// Sub-images without the radiometric errors of their detectors.
fn images(scene: &Scene) -> Vec<Plane> {
    let truth = scene.true_image(0);
    // A sub-image is what the true virtual image shows at its true places: bilinear is enough for
    // the tests of seams.
    (0..scene.rig.sub.len())
        .map(|number| {
            let detector = scene.detector(number);
            let mut raw = scene.sub_image(0, number, &detector);
            let [width, height] = scene.rig.sub[number].size_px();
            for row in 0..height {
                for col in 0..width {
                    let pixel = [
                        f64::from(u32::try_from(col).unwrap()),
                        f64::from(u32::try_from(row).unwrap()),
                    ];
                    let light = scene.falloff(scene.truth.field(number, pixel));
                    let offset = detector.expected_dn([col, row], 0.0);
                    let response = detector.expected_dn([col, row], 1.0) - offset;
                    let value = &mut raw.values_mut()[row * width + col];
                    *value =
                        fmc_composition::grey((f64::from(*value) - offset) / (response * light))
                            .max(1);
                }
            }
            assert!(truth.width() > width);
            raw
        })
        .collect()
}

fn calibrated(scene: &Scene, heights: Heights) -> Rig {
    let measurements = Measurements {
        control_file: "control.csv".to_owned(),
        control: scene.control(0),
        ties: scene.ties(0),
    };
    let options = RigOptions {
        degree: 3,
        heights,
        sigma_px: 0.25,
    };
    calibrate(&scene.rig, &measurements, &options).unwrap().rig
}

fn layers(rig: &Rig, images: &[Plane]) -> Vec<Layer> {
    let each = rig.sub.iter().zip(images);
    each.map(|(sub, image)| {
        let geometry = Geometry {
            size_px: sub.size_px(),
            polynomial: rig.polynomial(sub),
            registration: None,
        };
        Layer::resampled(rig.frame, image, &geometry, Kernel::Bicubic).unwrap()
    })
    .collect()
}

#[test]
fn six_sub_images_become_one_whose_seams_are_steps_of_less_than_0_2_px() {
    let scene = Scene::new(SceneRequest::default());
    let rig = calibrated(&scene, Heights::Use);
    let images = images(&scene);
    let layers = layers(&rig, &images);
    let found = steps(&layers);
    assert_eq!(found.len(), 7, "neighbours along an edge");
    for step in &found {
        println!(
            "{:?} {} {:?} {:.4}",
            step.layers,
            step.ties.len(),
            step.step_px,
            step.grey_part
        );
        assert!(
            step.ties.len() >= 12,
            "{:?}: {}",
            step.layers,
            step.ties.len()
        );
        assert!(step.step_px.unwrap() < 0.35, "{:?}", step.step_px);
        assert!(step.grey_part.abs() < 0.005, "{}", step.grey_part);
    }
    let all: Vec<f64> = found
        .iter()
        .flat_map(|step| &step.ties)
        .flat_map(|[a, b]| [b[0] - a[0], b[1] - a[1]])
        .collect();
    assert!(fmc_composition::rms(all).unwrap() < 0.2);
    let composite = compose(&rig, layers, 5).unwrap();
    let plane = &composite.layer.plane;
    assert_eq!(
        [plane.width(), plane.height()],
        [rig.frame.width_px, rig.frame.height_px]
    );
    let empty = plane.values().iter().filter(|value| **value == 0).count();
    assert!(
        empty * 50 < plane.values().len(),
        "{empty} pixels without content"
    );
    let seen: std::collections::BTreeSet<u8> = composite.labels.iter().copied().collect();
    assert!((1..=6).all(|label| seen.contains(&label)), "{seen:?}");

    let green = scene.rig.green.clone().unwrap();
    let recorded = scene.green_image(0).unwrap();
    let matched = green_pairs(&rig, &green, &recorded, plane).unwrap();
    assert!(
        matched.pairs.len() > 300,
        "{} of {}",
        matched.pairs.len(),
        matched.windows
    );
    let size = [rig.frame.width_px, rig.frame.height_px];
    let registration = Registration::fit(size, 3, &matched.pairs).unwrap();
    println!(
        "green: {} {} {}",
        registration.kept, registration.residual_px, registration.polynomial.sigma_px
    );
    assert!(
        registration.residual_px < 0.5,
        "{}",
        registration.residual_px
    );
}

#[test]
fn registration_inverts_and_leaves_outliers_out() {
    let size = [1000, 800];
    let place = |number: u32| {
        [
            f64::from(number % 10) * 100.0,
            f64::from(number / 10) * 100.0,
        ]
    };
    let moved = |[x, y]: [f64; 2]| [x + 3.0 + 1e-5 * x * y, y - 2.0 + 2e-6 * x * x];
    let mut pairs: Vec<Pair> = (0..80)
        .map(|number| Pair {
            from_px: place(number),
            to_px: moved(place(number)),
        })
        .collect();
    pairs[13].to_px[0] += 25.0;
    let found = Registration::fit(size, 3, &pairs).unwrap();
    assert_eq!(found.outliers, 1);
    assert!(found.residual_px < 1e-6, "{}", found.residual_px);
    let back = found.inverse(moved([420.0, 310.0])).unwrap();
    assert!((back[0] - 420.0).hypot(back[1] - 310.0) < 1e-5, "{back:?}");
    assert!(
        Registration::fit(size, 3, &pairs[..10]).is_none(),
        "ten pairs for ten coefficients"
    );
}
