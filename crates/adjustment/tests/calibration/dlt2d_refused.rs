//! Targets that have no 2-D direct linear transformation.

use fmc_adjustment::calibration::dlt2d::request::PlaneTarget;

use crate::plane::{corners, nominal, request, tabulated, targets, tilted};

fn refusal(targets: &[PlaneTarget], corners: Option<&[String; 4]>) -> String {
    tabulated(targets, &nominal(&tilted()), corners)
        .map(|found| found.gauge)
        .unwrap_err()
        .to_string()
}

#[test]
fn targets_on_a_line_are_refused() {
    let mut row = targets(&tilted(), 0.0, 1);
    row.truncate(15);
    assert!(
        refusal(&row, None).contains("on a line"),
        "{}",
        refusal(&row, None)
    );
}

#[test]
fn collinear_unknown_and_repeated_corners_are_refused_by_name() {
    let all = targets(&tilted(), 0.0, 1);
    let named = |names: [&str; 4]| refusal(&all, Some(&names.map(str::to_owned)));
    let text = named(["001", "015", "136", "008"]);
    assert!(text.contains("001, 015 and 008 lie on a line"), "{text}");
    assert!(named(["001", "015", "136", "999"]).contains("no target 999"));
    assert!(named(["001", "015", "136", "001"]).contains("001 is named twice"));
}

#[test]
fn mirror_image_and_too_few_targets_are_refused() {
    let mut mirrored = targets(&tilted(), 0.0, 1);
    for target in &mut mirrored {
        target.measured_mm[1] *= -1.0;
    }
    assert!(refusal(&mirrored, None).contains("mirror image"));
    let all = targets(&tilted(), 0.0, 1);
    let few: Vec<PlaneTarget> = [0, 14, 40, 70, 135, 149]
        .map(|index: usize| all[index].clone())
        .to_vec();
    assert!(refusal(&few, None).contains("12 observations do not suffice for 13 unknowns"));
}

#[test]
fn wrong_target_is_named_and_not_in_the_table() {
    let camera = tilted();
    let mut all = targets(&camera, 0.2, 3);
    all[70].measured_mm[1] += 0.004;
    all[0].measured_mm[0] += 0.01;
    let nominal = nominal(&camera);
    let names = corners();
    let found =
        fmc_adjustment::calibration::dlt2d::dlt2d(&request(&all, &nominal, Some(&names))).unwrap();
    assert_eq!(found.rows.len(), 148);
    assert!(found.rows.iter().all(|row| &*row.target != "071"));
    assert!(
        found
            .result
            .warnings
            .iter()
            .any(|text| text.contains("corner 001 does not fit")),
        "{:?}",
        found.result.warnings
    );
}
