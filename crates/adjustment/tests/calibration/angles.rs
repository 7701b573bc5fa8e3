//! Precise angles: the numbers of the two principal distances, by simulation.

use std::sync::Arc;

use fmc_adjustment::calibration::angles::budget::Uncertainty;
use fmc_adjustment::calibration::angles::line_group::LineGroup;
use fmc_adjustment::calibration::angles::request::{AngleObservation, AnglesRequest, LineAxis};
use fmc_adjustment::calibration::angles::{Angles, angles};
use fmc_adjustment::calibration::failure::CalibrationFailure;
use fmc_adjustment::calibration::result::InputFile;
use fmc_camera_file::CameraFile;

use crate::noise::{Noise, binomial_half_width};

const P: f64 = 0.065;
const SIGMA_L: f64 = 1.3e-3;
/// 0.5".
const SIGMA_W: f64 = 0.5 / 3600.0 * std::f64::consts::PI / 180.0;

fn camera(f: f64) -> CameraFile {
    let text = format!(
        "name = \"line\"\nprincipal_distance_mm = {f}\n[sensor]\nwidth_px = 26000\nheight_px = 12\npixel_um = 13.0\n"
    );
    CameraFile::parse("camera.toml", &text).unwrap().0
}

/// Place on the line of a lens whose distortion is a cubic of the ideal place, 3.7 % at 18°.
fn place(f: f64, angle: f64) -> f64 {
    let edge = f * 18.0_f64.to_radians().tan();
    let cubic = 0.037 / (edge * edge);
    // The zero of the angles is where the target is in the middle of the line.
    let mut zero = -P;
    for _ in 0..50 {
        zero = -P - cubic * zero.powi(3);
    }
    let ideal = f * (angle + (zero / f).atan()).tan();
    P + ideal + cubic * ideal.powi(3)
}

fn observations(f: f64, noise: Option<u64>) -> Vec<AngleObservation> {
    let mut noise = noise.map(Noise::new);
    let mut gaussian = || noise.as_mut().map_or(0.0, Noise::gaussian);
    (0..29_u32)
        .map(|index| {
            let angle = (18.0 * (f64::from(index) / 14.0 - 1.0)).to_radians();
            AngleObservation {
                line: u64::from(index) + 2,
                angle_deg: (angle + SIGMA_W * gaussian()).to_degrees(),
                l_mm: place(f, angle) + SIGMA_L * gaussian(),
                band: None,
                repeat: None,
            }
        })
        .collect()
}

fn calibrated(
    observations: &[AngleObservation],
    camera: &CameraFile,
) -> Result<Angles, CalibrationFailure> {
    angles(&AnglesRequest {
        input: InputFile {
            file: "angles.csv".to_owned(),
            crc32: 0,
        },
        observations,
        camera,
        along: LineAxis::X,
        uncertainty: Uncertainty {
            place_mm: SIGMA_L,
            angle_rad: SIGMA_W,
        },
        keeps_all: true,
    })
}

fn value(group: &LineGroup, method: &str, name: &str) -> (f64, f64) {
    let method = group.methods.iter().find(|one| one.name == method).unwrap();
    let one = method
        .parameters
        .iter()
        .find(|one| one.name == name)
        .unwrap();
    (one.value, one.sigma.unwrap())
}

const F: &str = "principal_distance_mm";

/// Numbers of the table for one principal distance: µm, except the first two, mm.
struct Reference {
    f0: f64,
    best_fit: f64,
    best_fit_sigma: f64,
    largest_best_fit: f64,
    largest_paraxial: f64,
    quartic: [f64; 2],
    direct_sigma: f64,
    exact_sigmas: [f64; 2],
    edge_sigma: f64,
    rms_sigma: f64,
    budget: f64,
}

const REFERENCES: [Reference; 2] = [
    Reference {
        f0: 218.0,
        best_fit: 5.137,
        best_fit_sigma: 1.4,
        largest_best_fit: 0.952,
        largest_paraxial: 2.62,
        quartic: [6.6, 5.6],
        direct_sigma: 5.9,
        exact_sigmas: [5.6, 3.7],
        edge_sigma: 2.0,
        rms_sigma: 1.71,
        budget: 1.49,
    },
    Reference {
        f0: 473.0,
        best_fit: 11.147,
        best_fit_sigma: 1.8,
        largest_best_fit: 2.065,
        largest_paraxial: 5.68,
        quartic: [14.0, 7.0],
        direct_sigma: 7.3,
        exact_sigmas: [7.5, 4.8],
        edge_sigma: 2.6,
        rms_sigma: 2.13,
        budget: 1.90,
    },
];

#[test]
fn noise_free_angles_have_the_biases_of_the_formulas() {
    for reference in REFERENCES {
        let f0 = reference.f0;
        let found = calibrated(&observations(f0, None), &camera(f0)).unwrap();
        let all = &found.all;
        let (f, sigma) = value(all, "(2)", F);
        assert!((f - f0 - reference.best_fit).abs() < 2e-3, "{}", f - f0);
        assert!(
            (1e3 * sigma - reference.best_fit_sigma).abs() < 0.06,
            "{sigma}"
        );
        let (p, sigma) = value(all, "(2)", "p_mm");
        assert!((p - 0.139).abs() < 1e-3, "{p}");
        if f0 < 300.0 {
            assert!((1e3 * sigma - 5.3).abs() < 0.1, "{sigma}");
        }
        let (f, sigma) = value(all, "quartic (6)", F);
        let [bias, expected] = reference.quartic;
        assert!((1e3 * (f - f0) - bias).abs() < 0.5, "{}", 1e3 * (f - f0));
        assert!((1e3 * sigma - expected).abs() < 0.15, "{sigma}");
        let (f, sigma) = value(all, "direct", F);
        assert!((1e3 * (f - f0)).abs() < 0.5, "{}", 1e3 * (f - f0));
        assert!(
            (1e3 * sigma / reference.direct_sigma - 1.0).abs() < 0.03,
            "{sigma}"
        );
        let [of_f, of_p] = reference.exact_sigmas;
        let (f, sigma) = value(all, "exact", F);
        assert!((1e3 * (f - f0)).abs() < 0.05, "{}", f - f0);
        assert!((1e3 * sigma / of_f - 1.0).abs() < 0.06, "{sigma}");
        let (p, sigma) = value(all, "exact", "p_mm");
        assert!((p - P).abs() < 1e-6, "{p}");
        assert!((1e3 * sigma / of_p - 1.0).abs() < 0.12, "{sigma}");
        let edge = all.rows.last().unwrap();
        let largest =
            |of: fn(&fmc_adjustment::calibration::angles::line_group::DistortionRow) -> f64| {
                all.rows.iter().map(|row| of(row).abs()).fold(0.0, f64::max)
            };
        assert!((largest(|row| row.best_fit_mm) - reference.largest_best_fit).abs() < 2e-3);
        assert!((largest(|row| row.paraxial_mm) - reference.largest_paraxial).abs() < 0.01);
        assert!((1e3 * edge.budget.mended_mm - reference.budget).abs() < 0.006);
        let edge_um = 1e3 * edge.budget.covariance_mm;
        assert!((edge_um - reference.edge_sigma).abs() < 0.1, "{edge_um}");
        let squares: f64 = all
            .rows
            .iter()
            .map(|row| row.budget.covariance_mm.powi(2))
            .sum();
        let rms = 1e3 * (squares / 29.0).sqrt();
        assert!((rms / reference.rms_sigma - 1.0).abs() < 0.02, "{rms}");
        assert!(
            (all.largest_relative - 0.037).abs() < 2e-4,
            "{}",
            all.largest_relative
        );
    }
}

#[test]
fn exact_model_has_no_bias_and_its_sigma_covers_the_error() {
    const SEEDS: u32 = 400;
    let f0 = 218.0;
    let camera = camera(f0);
    let mut sums = [[0.0; 2]; 2];
    let mut hits = [0.0; 2];
    for seed in 0..SEEDS {
        let found = calibrated(&observations(f0, Some(u64::from(seed))), &camera).unwrap();
        let names = [(F, f0), ("x0_mm", P)];
        for (index, (name, truth)) in names.into_iter().enumerate() {
            let error = found.result.parameter(name).unwrap().value - truth;
            sums[index][0] += error;
            sums[index][1] += error * error;
            if error.abs() <= found.result.sigma_a_priori(name).unwrap() {
                hits[index] += 1.0;
            }
        }
    }
    let count = f64::from(SEEDS);
    for ([sum, squares], sigma_um) in sums.into_iter().zip([5.6, 3.7]) {
        let mean = sum / count;
        let sigma = (squares / count - mean * mean).sqrt();
        assert!(mean.abs() < 4.0 * sigma / count.sqrt(), "bias {mean} mm");
        assert!((1e3 * sigma / sigma_um - 1.0).abs() < 0.12, "{sigma} mm");
    }
    for hits in hits {
        assert!(
            (hits / count - 0.6827).abs() < binomial_half_width(count),
            "{hits}"
        );
    }
}

#[test]
fn bands_and_repetitions_are_reported_apart() {
    let f0 = 218.0;
    let mut all = Vec::new();
    for (band, shift) in [("B1", 0.0), ("B2", 0.05)] {
        for repeat in 0..3_u64 {
            let seed = repeat + if band == "B1" { 0 } else { 10 };
            let exact = observations(f0, None);
            for (one, exact) in observations(f0, Some(seed)).into_iter().zip(exact) {
                all.push(AngleObservation {
                    angle_deg: exact.angle_deg,
                    l_mm: one.l_mm + shift,
                    band: Some(Arc::from(band)),
                    repeat: Some(Arc::from(format!("{repeat}"))),
                    ..one
                });
            }
        }
    }
    let found = calibrated(&all, &camera(f0)).unwrap();
    assert_eq!(found.bands.len(), 2);
    let points: Vec<f64> = found
        .bands
        .iter()
        .map(|group| value(group, "exact", "p_mm").0)
        .collect();
    // A shift of the line is a shift of the principal point and of the zero of the angles.
    assert!((points[1] - points[0] - 0.05).abs() < 0.015, "{points:?}");
    assert!(
        found
            .result
            .warnings
            .iter()
            .any(|text| text.contains("B1 and B2 differ"))
    );
    for group in &found.bands {
        // Noise of place and, through the frozen angles, of nothing else.
        let sigma = 1e3 * group.repeatability_mm.unwrap();
        assert!((sigma / 1.3 - 1.0).abs() < 0.25, "{sigma}");
        assert!((group.largest_relative - 0.037).abs() < 5e-4);
    }
}

#[test]
fn wrong_units_angles_and_numbers_are_named() {
    let f0 = 218.0;
    let good = observations(f0, None);
    let refusal = |observations: &[AngleObservation]| match calibrated(observations, &camera(f0)) {
        Err(CalibrationFailure::Input(error)) => {
            format!("{error}; {}", error.help().unwrap_or_default())
        }
        other => panic!("{:?}", other.map(|found| found.result.sigma0)),
    };
    let changed = |change: fn(&mut AngleObservation)| {
        let mut all = good.clone();
        all.iter_mut().for_each(change);
        refusal(&all)
    };
    assert!(changed(|one| one.angle_deg = one.angle_deg.to_radians()).contains("radians"));
    assert!(changed(|one| one.l_mm *= 1e3).contains("µm"));
    assert!(changed(|one| one.l_mm /= 0.013).contains("pixels"));
    assert!(changed(|one| one.angle_deg = -one.angle_deg).contains("opposite directions"));
    let mut steep = good.clone();
    steep[3].angle_deg = 89.5;
    assert!(refusal(&steep).contains("line 5: angle_deg = 89.5"));
    assert!(refusal(&good[..4]).contains("4 observations do not suffice for 5 unknowns"));
    let same: Vec<AngleObservation> = good
        .iter()
        .map(|one| AngleObservation {
            angle_deg: 5.0,
            l_mm: 19.0,
            ..one.clone()
        })
        .collect();
    assert!(refusal(&same).contains("cannot tell"), "{}", refusal(&same));
}
