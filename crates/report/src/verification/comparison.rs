//! The comparison of the treatments of distortion, camera by camera, in words.

use fmc_reference::verification::result::{CameraResult, Treatment, Verification};

use crate::length::{self, Scale};

/// Largest and root mean square error of a camera with one treatment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ErrorCell {
    pub(super) max: String,
    pub(super) rms: String,
}

/// Table row of one camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) camera: String,
    pub(super) principal_distance_mm: String,
    pub(super) axis: &'static str,
    pub(super) points: u64,
    pub(super) travel_um: String,
    pub(super) distortion_um: String,
    /// Errors of every treatment.
    pub(super) errors: [ErrorCell; 4],
    pub(super) coordinate_max_nm: String,
    pub(super) passed: bool,
}

/// Table with a row per camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Comparison {
    /// Label and unit of every treatment.
    pub(super) treatments: [(&'static str, &'static str); 4],
    pub(super) rows: Vec<Row>,
}

impl Comparison {
    pub(super) fn of(verification: &Verification) -> Self {
        let scales = Treatment::ALL.map(|treatment| {
            let scale = Scale::fitting(verification.cameras.iter().flat_map(|camera| {
                let errors = camera.errors(treatment);
                [errors.max_mm(), errors.rms_mm()]
            }));
            (treatment, scale)
        });
        Self {
            treatments: scales.map(|(treatment, scale)| (treatment.label(), scale.unit.symbol())),
            rows: verification
                .cameras
                .iter()
                .map(|camera| row(camera, scales))
                .collect(),
        }
    }
}

fn row(camera: &CameraResult, scales: [(Treatment, Scale); 4]) -> Row {
    let cell = |(treatment, scale): (Treatment, Scale)| {
        let errors = camera.errors(treatment);
        ErrorCell {
            max: scale.number(errors.max_mm()),
            rms: scale.number(errors.rms_mm()),
        }
    };
    Row {
        camera: camera.name.clone(),
        principal_distance_mm: format!("{:.2}", camera.principal_distance_mm),
        axis: camera.axis,
        points: camera.points,
        travel_um: length::range_um(camera.travel_mm()),
        distortion_um: length::range_um(camera.distortion_mm),
        errors: scales.map(cell),
        coordinate_max_nm: format!("{:.2}", 1e6 * camera.coordinate_errors().max_mm()),
        passed: camera.passed(),
    }
}
