//! The budget of the page against that of `host-sim budget`, which computes in double precision.

use std::fs;
use std::path::Path;

use fmc::flight::camera::Camera;
use fmc::flight::exposure::Exposure;
use fmc_camera_c::{
    FMC_ERROR_NULL, FMC_ERROR_OUT_OF_RANGE, FMC_ERROR_STROKE, FMC_OK, fmc_camera_record,
    fmc_camera_record_defaults, fmc_error, fmc_exposure, fmc_exposure_defaults,
};
use fmc_camera_file::CameraFile;
use fmc_camera_web::{Added, Assumptions, Budget, POINTS, SOURCES, fmc_web_added, fmc_web_budget};
use fmc_simulation::budget::assumptions;
use fmc_simulation::budget::result::Source;
use fmc_simulation::budget::run::budget;

/// Largest difference of an effect: 2 nm, the rounding of coordinates in single precision, and a
/// ten-thousandth of it.
const TOLERANCE_UM: f64 = 0.002;
const RELATIVE_TOLERANCE: f64 = 1e-4;

const ASSUMED: Assumptions = Assumptions {
    focus_um: 5.0,
    vh_error_percent: 1.0,
    relief_percent: 10.0,
    drift_deg: 1.0,
    rate_deg_s: 1.0,
    encoder_um: 1.0,
    timing_ms: 0.1,
};

const OF_HOST_SIM: assumptions::Assumptions = assumptions::Assumptions {
    height_m: 1000.0,
    focus_mm: 0.005,
    vh_error: 0.01,
    relief: 0.1,
    drift_deg: 1.0,
    rate_deg_s: 1.0,
    encoder_mm: 0.001,
    timing_s: 1e-4,
};

fn record() -> fmc_camera_record {
    let mut record = core::mem::MaybeUninit::uninit();
    let size = u32::try_from(size_of::<fmc_camera_record>()).unwrap();
    // SAFETY: the record is written before it is read.
    unsafe {
        let status = fmc_camera_record_defaults(
            record.as_mut_ptr(),
            size,
            fmc_camera_c::FMC_CAMERA_VERSION,
            core::ptr::null_mut(),
        );
        assert_eq!(status, FMC_OK);
        record.assume_init()
    }
}

/// Returns the record of a camera file with the keys that these tests need.
fn record_of(file: &CameraFile) -> fmc_camera_record {
    let calibration = file.parameters().calibration;
    let limits = file.parameters().limits;
    let distortion = calibration.distortion;
    let is_tdi = file.fmc.mechanism == fmc_camera_file::MechanismName::Tdi;
    let from_rest = file.fmc.strategy == Some(fmc_camera_file::Strategy::FromRest);
    fmc_camera_record {
        principal_distance_mm: calibration.principal_distance_mm,
        exit_pupil_mm: calibration.exit_pupil_mm,
        principal_point_x_mm: calibration.principal_point.x_mm,
        principal_point_y_mm: calibration.principal_point.y_mm,
        width_px: calibration.width_px,
        height_px: calibration.height_px,
        pixel_um: calibration.pixel_um,
        k0: distortion.k0,
        k1: distortion.k1,
        k2: distortion.k2,
        k3: distortion.k3,
        p1: distortion.p1,
        p2: distortion.p2,
        flatness_um: calibration.flatness.coefficients_um,
        stroke_mm: calibration.stroke_mm,
        first_transfer: 0.25,
        mechanism: if is_tdi { 2 } else { i32::from(from_rest) },
        limits_vh_per_s: limits.vh_per_s,
        limits_exposure_s: limits.exposure_s,
        ..record()
    }
}

fn cameras() -> Vec<CameraFile> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-sim/cameras");
    let mut cameras: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap())
        .collect();
    let body = "name = \"t\"\nprincipal_distance_mm = 60.0\nexit_pupil_mm = 48.0\n[sensor]\n\
                width_px = 4000\nheight_px = 3000\npixel_um = 6.0\n[distortion]\nk1 = -2e-7\n";
    for end in [
        "[fmc]\nmechanism = \"tdi\"\nfirst_transfer = 0.25\n",
        "[fmc]\nstrategy = \"from-rest\"\nflatness_um = [2.0, -3.0]\nstroke_mm = 1.5\n",
    ] {
        cameras.push(format!("{body}{end}"));
    }
    cameras
        .iter()
        .map(|text| CameraFile::parse("camera", text).unwrap().0)
        .collect()
}

/// Returns the largest bound of what frames over the limits leave out, µm.
fn left_out_um(file: &CameraFile) -> f64 {
    let parameters = file.parameters();
    let camera = Camera::new(parameters).unwrap();
    let limits = parameters.limits;
    let bound = |vh_per_s, exposure_s| {
        let frame = camera.frame(&Exposure::new(vh_per_s, exposure_s));
        frame.map_or(0.0, |frame| f64::from(frame.interior.left_out_nm) / 1e3)
    };
    let share = |[from, to]: [f32; 2], index: u8| from + (to - from) * f32::from(index) / 9.0;
    (0..10)
        .flat_map(|vh| (0..10).map(move |time| (vh, time)))
        .map(|(vh, time)| bound(share(limits.vh_per_s, vh), share(limits.exposure_s, time)))
        .fold(0.0, f64::max)
}

fn computed(record: &fmc_camera_record, assumed: &Assumptions) -> Result<Budget, fmc_error> {
    let mut budget = Budget::default();
    let mut error = fmc_error::of_status(FMC_OK);
    let status = fmc_web_budget(
        Some(record),
        Some(assumed),
        Some(&mut budget),
        Some(&mut error),
    );
    assert_eq!(status, error.status);
    if status == FMC_OK {
        Ok(budget)
    } else {
        Err(error)
    }
}

#[test]
fn budget_is_that_of_host_sim() {
    assert_eq!(SOURCES, Source::ALL.len());
    let cameras = cameras();
    assert!(cameras.len() >= 8);
    for file in cameras {
        let record = record_of(&file);
        let found = computed(&record, &ASSUMED).unwrap();
        let expected = budget(&file, OF_HOST_SIM).unwrap();
        let counts = [found.accepted, found.refused].map(|count| usize::try_from(count).unwrap());
        assert_eq!(
            counts,
            [expected.limits.accepted, expected.limits.refused],
            "{}",
            file.name
        );
        let left_out_um = left_out_um(&file);
        for (source, um) in Source::ALL.into_iter().zip(found.effects_um) {
            if !source.is_of(file.fmc.mechanism) {
                assert!(um < 0.0, "{source:?}");
                continue;
            }
            let expected_um = 1e3 * expected.effect_mm(source);
            let difference = (f64::from(um) - expected_um).abs();
            // Of the exposure mean the camera leaves out what its frames state, in either axis.
            let left_out_um = match source {
                Source::StaticDistortion | Source::SecondOrder => 2.0_f64.sqrt() * left_out_um,
                _ => 0.0,
            };
            assert!(
                difference <= TOLERANCE_UM + RELATIVE_TOLERANCE * expected_um + left_out_um,
                "{}, {source:?}: {um} µm, host-sim {expected_um} µm",
                file.name
            );
        }
    }
}

#[test]
fn budget_is_refused_where_a_camera_takes_no_exposure_or_an_assumption_is_out_of_range() {
    let record = record_of(&cameras()[0]);
    let short = fmc_camera_record {
        stroke_mm: 0.01,
        ..record
    };
    let refused = computed(&short, &ASSUMED).unwrap_err();
    assert_eq!(refused.status, FMC_ERROR_STROKE);
    let steep = Assumptions {
        relief_percent: 400.0,
        ..ASSUMED
    };
    let refused = computed(&record, &steep).unwrap_err();
    assert_eq!(refused.status, FMC_ERROR_OUT_OF_RANGE);
    let status = fmc_web_budget(None, Some(&ASSUMED), None, None);
    assert_eq!(status, FMC_ERROR_NULL);
}

#[test]
fn motion_adds_the_derivative_of_the_distortion_times_the_offset() {
    let text = "name = \"t\"\nprincipal_distance_mm = 100.0\n[sensor]\nwidth_px = 9216\n\
                height_px = 9216\npixel_um = 8.75\n[distortion]\nk1 = 9.2268e-8\n";
    let record = record_of(&CameraFile::parse("t", text).unwrap().0);
    let mut exposure = core::mem::MaybeUninit::uninit();
    let size = u32::try_from(size_of::<fmc_exposure>()).unwrap();
    // SAFETY: the exposure is written before it is read.
    let mut exposure: fmc_exposure = unsafe {
        fmc_exposure_defaults(
            exposure.as_mut_ptr(),
            size,
            fmc_camera_c::FMC_CAMERA_VERSION,
            core::ptr::null_mut(),
        );
        exposure.assume_init()
    };
    exposure.vh_per_s = 0.1;
    exposure.exposure_s = 0.01;
    exposure.has_opening_offset = 1;
    exposure.opening_offset_mm = 0.2;
    let mut added = [Added::default(); POINTS];
    let status = fmc_web_added(Some(&record), Some(&exposure), Some(&mut added), None);
    assert_eq!(status, FMC_OK);
    // The offset at the centroid: 0.2 mm and half of 0.1 mm of travel.
    let offset_mm = 0.25_f64;
    let k1 = 9.2268e-8_f64;
    let mut largest = 0.0_f64;
    for point in added {
        let [x, y] = [point.x_mm, point.y_mm].map(f64::from);
        // ∂D/∂y of D = K1·r²·(x, y), against the motion; the second order is 3K1·r·c².
        let expected =
            [-2.0 * k1 * x * y, -k1 * (x * x + 3.0 * y * y)].map(|slope| slope * offset_mm);
        for (found, expected) in [point.dx_mm, point.dy_mm].into_iter().zip(expected) {
            let second_order = 3.0 * k1 * 57.1 * offset_mm * offset_mm;
            assert!((f64::from(found) - expected).abs() < 1.1 * second_order);
            largest = largest.max(expected.abs());
        }
    }
    assert!((1e3 * largest - 0.15).abs() < 0.01, "{largest} mm");
}
