//! Files that are written and read again.

use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::comparison;
use fmc_exchange::export::{Choices, export};
use fmc_exchange::found::Formula;
use fmc_exchange::program::{Container, Program};

use crate::support::{all_terms, cameras, difference_um, ixm, pinhole, rc30, read, written};

const EXACT: [Program; 4] = [
    Program::OpenTrackIo,
    Program::MicMac,
    Program::Australis,
    Program::PhotoModeler,
];

#[test]
fn coefficients_of_exact_formats_come_back_to_1e_12() {
    for program in EXACT {
        for camera in cameras() {
            if camera.name == "all terms" && program != Program::MicMac {
                continue;
            }
            let exported = written(&camera, program, "");
            assert!(
                exported.residual.largest_um < 1e-6,
                "{:?}",
                exported.residual
            );
            let imported = read(&camera, program, &exported.files[0].1);
            assert!(imported.is_exact);
            let (found, expected) = (imported.camera, camera.without_k0());
            let numbers = |camera: &Calibrated| {
                let mut all = vec![camera.principal_distance_mm];
                all.extend(camera.lens.k);
                all.extend(camera.lens.p);
                all.extend(camera.lens.b);
                all
            };
            for (found, expected) in numbers(&found).into_iter().zip(numbers(&expected)) {
                let off = (found - expected).abs();
                assert!(
                    off <= 1e-12 * expected.abs(),
                    "{program:?}: {found} {expected}"
                );
            }
            for axis in 0..2 {
                let off = found.principal_point_mm[axis] - expected.principal_point_mm[axis];
                assert!(off.abs() < 1e-12, "{program:?}: {off} mm");
            }
        }
    }
}

#[test]
fn every_program_reads_back_the_formula_that_it_was_given() {
    for (program, model) in [
        (Program::OpenCv, "opencv5"),
        (Program::OpenCv, "opencv14"),
        (Program::Ros, "rational_polynomial"),
        (Program::Kalibr, "radtan"),
        (Program::Colmap, "FULL_OPENCV"),
        (Program::Colmap, "SIMPLE_RADIAL"),
        (Program::Metashape, "frame"),
        (Program::OpenSfm, "brown"),
        (Program::Opf, "perspective"),
        (Program::Pix4d, "perspective"),
    ] {
        for camera in [ixm(), all_terms()] {
            let exported = written(&camera, program, model);
            assert!(!exported.files.is_empty());
            for (name, bytes) in &exported.files {
                if name.starts_with("images") || name.starts_with("points3D") {
                    continue;
                }
                let imported = read(&camera, program, bytes);
                assert!(!imported.is_exact);
                // The residuals of the two fits add up, there and back.
                let left = exported.residual.largest_um + imported.residual.largest_um;
                let difference = difference_um(&camera, &imported.camera);
                assert!(
                    difference < 2.0 * left + 1e-3,
                    "{name} {model}: {difference} {left}"
                );
            }
        }
    }
}

#[test]
fn containers_of_opencv_hold_the_same_numbers() {
    let mut formulas = Vec::new();
    for container in [Container::Yaml, Container::Json, Container::Xml] {
        let choices = Choices {
            model: Some("opencv14"),
            container: Some(container),
            ..Choices::default()
        };
        let exported = export(&rc30(), Program::OpenCv, &choices).unwrap();
        assert_eq!(exported.files[0].0, container.file());
        formulas.push(pinhole(&exported));
    }
    assert_eq!(formulas[0], formulas[2]);
    let off = |a: f64, b: f64| (a - b).abs() <= 1e-15 * a.abs();
    assert!(off(formulas[0].tilt[0], formulas[1].tilt[0]));
    assert!(off(formulas[0].centre_px[1], formulas[1].centre_px[1]));
}

#[test]
fn binary_and_text_of_colmap_are_the_same_camera() {
    let write = |is_binary| {
        let choices = Choices {
            is_binary,
            ..Choices::default()
        };
        export(&ixm(), Program::Colmap, &choices).unwrap()
    };
    let (text, binary) = (write(false), write(true));
    assert_eq!(pinhole(&text), pinhole(&binary));
    // One camera: count, id, model, width, height and twelve parameters.
    assert_eq!(binary.files[0].1.len(), 8 + 4 + 4 + 8 + 8 + 12 * 8);
    assert_eq!(binary.files[0].1[12..16], 6_i32.to_le_bytes());
}

#[test]
fn imports_leave_no_more_than_independent_fits() {
    // Largest and RMS residual, µm, of fits of K0..K3, P1, P2, B1, B2 elsewhere.
    for (program, model, largest_um, rms_um) in [
        (Program::OpenCv, "opencv5", 0.37, 0.037),
        (Program::OpenCv, "opencv8", 0.47, 0.043),
        (Program::Metashape, "frame", 0.28, 0.036),
    ] {
        let exported = written(&ixm(), program, model);
        let residual = read(&ixm(), program, &exported.files[0].1).residual;
        assert!(
            residual.largest_um <= 1.25 * largest_um,
            "{model}: {residual:?}"
        );
        assert!(residual.rms_um <= 1.25 * rms_um, "{model}: {residual:?}");
    }
}

#[test]
fn import_is_the_minimum_of_the_squares() {
    let file = "1 RADIAL 14204 10652 13662.553191 7117.531915 5332.356383 -0.0403 0.0308\n";
    let imported = read(&ixm(), Program::Colmap, file.as_bytes());
    let Formula::Pinhole(formula) = imported.found.formula else {
        panic!("a correction");
    };
    // Differences of measured points are those of ideal ones but for the distortion's slope.
    let rms = |camera: &Calibrated| comparison::measured(camera, &formula).rms_um;
    let best = rms(&imported.camera);
    assert!(
        (best / imported.residual.rms_um - 1.0).abs() < 0.1,
        "{best}"
    );
    for (index, change) in [3e-6, 3e-9, 3e-12, 3e-15].into_iter().enumerate() {
        for sign in [-1.0, 1.0] {
            let mut other = imported.camera.clone();
            other.lens.k[index] += sign * change;
            assert!(rms(&other) > best, "K{index} {sign}");
        }
    }
    for index in 0..2 {
        let mut other = imported.camera.clone();
        other.lens.p[index] += 1e-7;
        other.lens.b[index] -= 1e-6;
        assert!(rms(&other) > best, "P, B {index}");
    }
}
