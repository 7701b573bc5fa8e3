//! `calibrate angles`.

use std::fs;

use crate::command_line::calibration_files::{
    INTERIOR, K1, angles_csv, assert_complete, calibrated, parameter, summary,
};

#[test]
fn line_gives_methods_bands_and_camera_file() {
    let (bench, answer) = calibrated("angles", &angles_csv(), &["--sigma-l-um", "0.2"]);
    let answer = answer.ok();
    assert!(answer.stdout.contains("quartic (6)"), "{}", answer.stdout);
    assert_complete(&bench, &answer, "out");
    let summary = summary(&bench, "out/summary.json");
    let [f, x0, _] = INTERIOR;
    for (name, truth) in [("principal_distance_mm", f), ("x0_mm", x0), ("k1", K1)] {
        let (value, sigma) = parameter(&summary, name);
        assert!(
            (value - truth).abs() < 5.0 * sigma,
            "{name} {value} ± {sigma}"
        );
    }
    let methods = summary["methods"].as_array().unwrap();
    let names: Vec<&str> = methods
        .iter()
        .map(|one| one["name"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        ["(2)", "(3)", "(4)", "quartic (6)", "direct", "exact"]
    );
    assert_eq!(summary["bands"].as_array().unwrap().len(), 2);
    assert!(summary["repeatability_um"].as_f64().unwrap() < 0.5);
    let table = fs::read_to_string(bench.path("out/distortion.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 116 + 2 * 58);
}

#[test]
fn bad_angles_are_refused() {
    let good = angles_csv();
    let refused = |text: &str, words: &[&str]| {
        let (_, answer) = calibrated("angles", text, &[]);
        answer.refused(words);
    };
    refused(
        &good.replacen("-18.0", "-91.0", 1),
        &["line 2", "angle_deg = -91", "-89 to 89"],
    );
    let few: Vec<&str> = good.lines().take(5).collect();
    refused(
        &few.join("\n"),
        &["4 observations do not suffice for 5 unknowns"],
    );
    refused(
        &good.replacen("l_mm", "l_um", 1),
        &["column l_mm is missing"],
    );
    let radians: String = good
        .lines()
        .enumerate()
        .map(|(index, line)| match line.split_once(',') {
            Some((angle, rest)) if index > 0 => {
                format!("{},{rest}\n", angle.parse::<f64>().unwrap().to_radians())
            }
            _ => format!("{line}\n"),
        })
        .collect();
    refused(&radians, &["radians"]);
}
