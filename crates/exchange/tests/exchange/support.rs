//! Cameras for the tests, and the files that are written of them.

use fmc_camera_file::CameraFile;
use fmc_camera_file::published::CAMERA_FILES;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{Choices, Exported, export};
use fmc_exchange::found::{Formula, Stated};
use fmc_exchange::import::{Imported, import};
use fmc_exchange::pinhole::Pinhole;
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;

/// A camera in which no term is zero and nothing is symmetric.
pub(crate) const ALL_TERMS: &str = "name = \"all terms\"\nprincipal_distance_mm = 100\n\
                         principal_point_mm = [0.35, -0.21]\n\
                         [sensor]\nwidth_px = 9216\nheight_px = 6144\npixel_um = 8.75\n\
                         [distortion]\nk0 = 2e-4\nk1 = -8e-6\nk2 = 3e-9\nk3 = -4e-13\n\
                         p1 = 3e-6\np2 = -5e-6\nb1 = 1e-4\nb2 = -6e-5\n";

/// The strong lens of the published cameras.
pub(crate) const IXM: &str =
    include_str!("../../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml");

pub(crate) fn camera(text: &str) -> Calibrated {
    Calibrated::of(&CameraFile::parse("camera.toml", text).unwrap().0)
}

pub(crate) fn published(file: &str) -> Calibrated {
    let (_, text) = CAMERA_FILES.iter().find(|(name, _)| *name == file).unwrap();
    camera(text)
}

pub(crate) fn ixm() -> Calibrated {
    published("phase-one-ixm-rs150f-50.toml")
}

pub(crate) fn rc30() -> Calibrated {
    published("rc30-5324.toml")
}

pub(crate) fn all_terms() -> Calibrated {
    camera(ALL_TERMS)
}

/// Every published camera, and the one with all terms.
pub(crate) fn cameras() -> Vec<Calibrated> {
    CAMERA_FILES
        .iter()
        .map(|(_, text)| camera(text))
        .chain([all_terms()])
        .collect()
}

/// Writes with a model.
pub(crate) fn written(camera: &Calibrated, program: Program, model: &str) -> Exported {
    let choices = Choices {
        model: (!model.is_empty()).then_some(model),
        ..Choices::default()
    };
    export(camera, program, &choices).unwrap()
}

pub(crate) fn pinhole(exported: &Exported) -> Pinhole {
    match exported.formula {
        Formula::Pinhole(pinhole) => pinhole,
        Formula::Correction(_) => panic!("a correction"),
    }
}

/// Text of the first file.
pub(crate) fn text(exported: &Exported) -> String {
    String::from_utf8(exported.files[0].1.clone()).unwrap()
}

/// Reads a file again that was written of a camera.
pub(crate) fn read(camera: &Calibrated, program: Program, bytes: &[u8]) -> Imported {
    let stated = Stated {
        pixel_mm: Some(camera.pixel_mm),
        size_px: Some(camera.size_px),
        is_correction: Some(true),
        ..Stated::default()
    };
    let source = Source {
        file: "file",
        bytes,
    };
    import(program, &source, &stated).unwrap()
}

/// Returns the largest difference of the rays of two cameras over the sensor, µm at the principal
/// distance.
pub(crate) fn difference_um(one: &Calibrated, other: &Calibrated) -> f64 {
    let mut largest = 0.0_f64;
    for point in one.grid_mm(41) {
        let [ax, ay] = one.ray_from_measured(point);
        let [bx, by] = other.ray_from_measured(point);
        let distance_um = 1e3 * one.principal_distance_mm;
        largest = largest.max((ax - bx).abs().max((ay - by).abs()) * distance_um);
    }
    largest
}
