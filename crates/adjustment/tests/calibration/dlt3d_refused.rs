//! Configurations of points that have no 3-D direct linear transformation.

use fmc_adjustment::calibration::dlt3d::FieldPoint;

use crate::scene::{IXM_50, field, observed, transformed};

fn refusal(points: &[FieldPoint]) -> String {
    transformed(points, &IXM_50.nominal(), [false; 5])
        .map(|found| found.camera)
        .unwrap_err()
        .to_string()
}

fn seen(objects: &[[f64; 3]]) -> Vec<FieldPoint> {
    let camera = IXM_50.pinhole([0.0, 0.0, 6.5], [0.02, 0.03, 0.2]);
    observed(&camera, objects, 0.0, 1)
}

#[test]
fn too_few_points_are_refused_with_their_number() {
    let points = seen(&field(5, [4.0, 3.0, 2.0], [0.0; 3], 1));
    assert!(
        refusal(&points).contains("5 points"),
        "{}",
        refusal(&points)
    );
}

#[test]
fn plane_and_line_are_refused_by_name() {
    let plane: Vec<[f64; 3]> = field(12, [4.0, 3.0, 0.0], [0.0; 3], 1)
        .into_iter()
        .map(|[x, y, _]| [x, y, 0.3 * x - 0.1 * y])
        .collect();
    assert!(refusal(&seen(&plane)).contains("all points lie in a plane"));
    let mut with_one = plane.clone();
    with_one.push([0.1, 0.2, 1.0]);
    let text = refusal(&seen(&with_one));
    assert!(text.contains("all points but 13 lie in a plane"), "{text}");
    let mut five_of_six: Vec<[f64; 3]> = plane.iter().take(5).copied().collect();
    five_of_six.insert(2, [0.1, 0.2, 1.0]);
    let text = refusal(&seen(&five_of_six));
    assert!(text.contains("all points but 3 lie in a plane"), "{text}");
    let line: Vec<[f64; 3]> = (0..8)
        .map(|index| [0.3 * f64::from(index) - 1.0, 0.1, 0.2])
        .collect();
    assert!(refusal(&seen(&line)).contains("on a line"));
}

#[test]
fn twisted_cubic_through_the_projection_centre_is_refused_by_name() {
    // (t, t², t³)/(1 + t³/10), which passes through the centre at t = 0.
    let camera = IXM_50.pinhole([0.0, 0.0, 0.0], [0.0; 3]);
    let objects: Vec<[f64; 3]> = (0..20)
        .map(|index| {
            let t = -0.3 + 0.03 * f64::from(index - 10);
            [0.6 * t * t, t.powi(3), 1.5 * t]
        })
        .collect();
    let text = refusal(&observed(&camera, &objects, 0.0, 1));
    assert!(text.contains("twisted cubic"), "{text}");
}

#[test]
fn mirror_image_is_refused_by_name() {
    let mut points = seen(&field(20, [4.0, 3.0, 2.0], [0.0; 3], 1));
    for point in &mut points {
        point.measured_mm[1] *= -1.0;
    }
    assert!(
        refusal(&points).contains("mirror image"),
        "{}",
        refusal(&points)
    );
}

#[test]
fn gross_error_is_rejected_and_named() {
    let camera = IXM_50.pinhole([0.0, 0.0, 6.5], [0.02, 0.03, 0.2]);
    let objects = field(60, [5.2, 3.8, 3.0], [0.0; 3], 4);
    let mut points = observed(&camera, &objects, 1.0, 5);
    points[17].measured_mm[0] += 0.012;
    points[41].measured_mm[1] -= 0.4;
    let found = transformed(&points, &IXM_50.nominal(), [true; 5]).unwrap();
    let rejected: Vec<&str> = found
        .result
        .image_residuals
        .iter()
        .filter(|one| one.is_rejected)
        .map(|one| &*one.point)
        .collect();
    assert_eq!(rejected, ["18", "42"]);
}
