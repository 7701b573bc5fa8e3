//! Scale, axis angle and run-out of the stage from flights: without bias, covered by their σ, and
//! what the flight has to vary for it.

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions};
use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::eliminated_point::WeightedRay;
use fmc_adjustment::bundle::error::BundleCalibrationError;
use fmc_adjustment::bundle::interior::{INTERIOR_ELEMENTS, InteriorElement};
use fmc_adjustment::bundle::layout::Layout;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::stage::{Stage, StageElement};
use fmc_adjustment::bundle::state::State;
use fmc_camera_file::CameraFile;

use crate::aerial::{CROSSED, F_MM, Flight, Platform, Strip, oriented, strip};
use crate::data::ideal;

const ALL: [Parameter; 3] = [
    Parameter::Stage(StageElement::Scale),
    Parameter::Stage(StageElement::AxisAngle),
    Parameter::Stage(StageElement::RunOut),
];
const Y0: Parameter = Parameter::Interior(InteriorElement::Y0);
const X0: Parameter = Parameter::Interior(InteriorElement::X0);
const F: Parameter = Parameter::Interior(InteriorElement::PrincipalDistance);

const CAMERA: &str = "name = \"Block\"\nprincipal_distance_mm = 50.0\n\
                      [sensor]\nwidth_px = 14204\nheight_px = 10652\npixel_um = 3.76\n\
                      [fmc]\nstroke_mm = 1.0\n";

/// Larger than any real one, so that a flight sees it.
const LARGE: Stage = Stage {
    scale: 0.4,
    axis_angle_rad: -0.25,
    run_out_mm_per_mm: 0.15,
};

fn flight(strips: Vec<Strip>, stage: Stage) -> Flight {
    Flight {
        strips,
        platform: Platform::default(),
        tilt_rad: 0.02,
        control: 6,
        stage: Some(stage),
    }
}

/// Cross strips at two heights 1 : 1.4, with speeds and exposures that vary.
fn varied() -> Vec<Strip> {
    let speeds = [60.0, 90.0, 75.0, 90.0, 60.0, 75.0, 90.0, 60.0];
    let strips = speeds
        .into_iter()
        .zip([0.0, 180.0, 90.0, 270.0].into_iter().cycle());
    strips
        .enumerate()
        .map(|(number, (speed, heading))| Strip {
            height_m: if number < 4 { 700.0 } else { 980.0 },
            exposure_s: if number % 2 == 0 {
                1.0 / 300.0
            } else {
                1.0 / 1000.0
            },
            ..strip(heading, speed)
        })
        .collect()
}

/// Flights of the test of bias and coverage.
const SEEDS: u32 = 150;

/// Largest distance of a count from 68.27 % of [`SEEDS`] with 99.9 % probability:
/// 3.29·√(150·0.6827·0.3173).
const COUNT: f64 = 18.8;

fn unknowns(more: &[Parameter], priors: &[(Parameter, f64)]) -> Unknowns {
    Unknowns {
        estimated: [&ALL[..], more].concat(),
        priors: priors.to_vec(),
    }
}

/// Returns errors and σ of the unknowns of the stage.
fn errors(flight: &Flight, seed: u64, unknowns: &Unknowns) -> [[f64; 2]; 3] {
    let network = oriented(&flight.with_records(seed), unknowns);
    let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    let cofactors = Cofactors::of(&network, &solution).unwrap();
    let truth = flight.stage.unwrap();
    StageElement::ALL.map(|element| {
        let column = solution.layout.column(Parameter::Stage(element)).unwrap();
        let error = solution.state.parameters.stage.value(element) - truth.value(element);
        [error, cofactors.border[(column, column)].sqrt()]
    })
}

#[test]
fn scale_angle_and_run_out_are_found_without_bias_and_covered_by_their_sigma() {
    let flight = flight(varied(), LARGE);
    let unknowns = unknowns(&[F, X0, Y0], &[]);
    let mut sums = [0.0; 3];
    let mut inside = [0_u32; 3];
    for seed in 1..=u64::from(SEEDS) {
        let found = errors(&flight, seed, &unknowns);
        for (([error, sigma], sum), count) in found.iter().zip(&mut sums).zip(&mut inside) {
            if seed == 1 {
                assert!(error.abs() < 3.0 * sigma, "{error} ± {sigma}");
            }
            *sum += error / sigma;
            *count += u32::from(error.abs() < *sigma);
        }
    }
    eprintln!("{sums:?} {inside:?}");
    for (sum, count) in sums.into_iter().zip(inside) {
        // Errors in units of their σ: the standard error of their mean is 1/√n.
        assert!(sum.abs() / f64::from(SEEDS).sqrt() < 4.0, "{sum}");
        let expected = 0.6827 * f64::from(SEEDS);
        assert!((f64::from(count) - expected).abs() <= COUNT, "{count}");
    }
}

/// σ of s, α and z1 of the camera without error of its stage.
fn sigmas(strips: Vec<Strip>, control: usize, more: &[Parameter]) -> [f64; 3] {
    let flight = Flight {
        control,
        ..flight(strips, Stage::default())
    };
    errors(&flight, 1, &unknowns(more, &[])).map(|[_, sigma]| sigma)
}

#[test]
fn flight_determines_the_scale_to_3_percent_at_two_heights_and_to_7_at_one() {
    let to_and_fro = || [90.0, 60.0].into_iter().zip([0.0, 180.0]).cycle().take(4);
    let to_and_fro: Vec<Strip> = to_and_fro()
        .map(|(speed, heading)| strip(heading, speed))
        .collect();
    let with_arm: Vec<Parameter> = [F, X0, Y0, Parameter::TimeOffset]
        .into_iter()
        .chain((0..3).map(Parameter::LeverArm))
        .collect();
    for (strips, control, more, expected) in [
        (varied(), 6, &[F, X0, Y0][..], [0.0305, 0.0308, 0.0237]),
        (varied(), 6, &with_arm, [0.0423, 0.0319, 0.0378]),
        (CROSSED.to_vec(), 6, &[F, X0, Y0], [0.0913, 0.0953, 0.0634]),
        (CROSSED.to_vec(), 6, &with_arm, [0.184, 0.0976, 0.0634]),
        (
            to_and_fro.clone(),
            6,
            &[F, X0, Y0],
            [0.0726, 0.0824, 0.0365],
        ),
        (to_and_fro, 0, &[F, X0, Y0], [0.510, 0.374, 0.0366]),
    ] {
        let found = sigmas(strips, control, more);
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
        }
    }
}

/// Strips with the same c̄ in every exposure.
fn constant() -> Vec<Strip> {
    [0.0, 180.0, 90.0, 270.0]
        .map(|heading| strip(heading, 75.0))
        .to_vec()
}

const PRIORS: [(Parameter, f64); 3] = [(ALL[0], 0.1), (ALL[1], 0.05), (ALL[2], 0.02)];

fn calibrated(
    strips: Vec<Strip>,
    more: &[Parameter],
    priors: &[(Parameter, f64)],
) -> Result<BundleCalibration, BundleCalibrationError> {
    let options = CalibrationOptions {
        unknowns: unknowns(more, priors),
        ..CalibrationOptions::default()
    };
    let tables = flight(strips, Stage::default()).with_records(2);
    BundleCalibration::new(&tables, ideal(F_MM), &options)
}

#[test]
fn constant_travel_leaves_scale_and_angle_to_their_priors() {
    let calibration = calibrated(constant(), &[F, X0, Y0], &PRIORS).unwrap();
    let (camera, _) = CameraFile::parse("camera.toml", CAMERA).unwrap();
    let result = calibration.result("bundle", &camera, Vec::new());
    for (name, prior) in [("stage_scale", 0.1), ("stage_axis_angle_rad", 0.05)] {
        let parameter = result.parameter(name).unwrap();
        assert_eq!(parameter.prior_sigma, Some(prior));
        let sigma = result.sigma_a_priori(name).unwrap();
        assert!(
            sigma > 0.9 * prior && sigma <= prior * (1.0 + 1e-9),
            "{sigma}"
        );
        let words = format!("the observations say nothing about {name}");
        assert!(
            result.warnings.iter().any(|one| one.starts_with(&words)),
            "{words}"
        );
    }
    let warned = |words: &[&str]| {
        let mut warnings = result.warnings.iter();
        warnings.any(|one| words.iter().all(|words| one.contains(words)))
    };
    assert!(warned(&[
        "stage_scale",
        "y0_mm",
        "correlated",
        "so that c̄ varies"
    ]));
    assert!(warned(&["stage_axis_angle_rad", "x0_mm", "correlated"]));
    assert!(warned(&[
        "stage_scale, stage_axis_angle_rad",
        "not go into the camera file"
    ]));
    // A flight that varies V/H says something.
    let calibration = calibrated(varied(), &[F, X0, Y0], &PRIORS).unwrap();
    let result = calibration.result("bundle", &camera, Vec::new());
    let warnings = result.warnings.join("\n");
    assert!(
        !warnings.contains("say nothing about stage_scale"),
        "{warnings}"
    );
}

#[test]
fn scale_and_principal_point_of_constant_travel_are_named_without_priors() {
    let error = calibrated(constant(), &[Y0], &[]).unwrap_err().to_string();
    for words in ["cannot tell", "stage_scale", "y0_mm"] {
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn derivatives_by_the_stage_agree_with_central_differences() {
    let network = oriented(
        &flight(varied(), LARGE).with_records(3),
        &unknowns(&[], &[]),
    );
    let layout = Layout::new(&network).unwrap();
    let mut state = State::initial(&network);
    state.parameters.stage = LARGE;
    state.parameters.interior.k[1] = -2e-5;
    state.parameters.interior.p = [3e-6, -2e-6];
    for observed in network.image_points.iter().step_by(40) {
        let ray = |state: &State| WeightedRay::new(&network, &layout, state, observed).unwrap();
        let exact = ray(&state).by_camera;
        for (place, element) in StageElement::ALL.into_iter().enumerate() {
            let step = 1e-4;
            let at = |sign: f64| {
                let mut moved = state.clone();
                moved.parameters.stage.add(element, sign * step);
                ray(&moved).residual
            };
            let numeric = (at(1.0) - at(-1.0)) / (2.0 * step);
            let column = exact.column(INTERIOR_ELEMENTS + place);
            // Residuals of 2e4 σ lose 1e-12 of themselves over the step.
            let most = 1e-6 * column.norm() + 1e-6;
            assert!((numeric - column).norm() < most, "{element:?}");
        }
    }
}
