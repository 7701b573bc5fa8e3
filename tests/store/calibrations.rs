//! Calibrations of one camera, told apart by their versions.

use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::geometry::five_coefficient::{FiveCoefficients, Regressor};
use fmc_camera::geometry::shutter::ShutterProfile;
use fmc_camera::io::store::{CalibrationStore, Origin};

use crate::link::pc::camera_parameters;
use crate::store::flash_model::FlashModel;

pub(crate) const SERIAL: &str = "RC30-5282";

/// Returns the calibration of a version.
pub(crate) fn calibration(version: u16) -> CameraParameters {
    let mut parameters = camera_parameters();
    parameters.serial = SerialNumber::new(SERIAL).unwrap();
    parameters.version = version.into();
    parameters.calibration.principal_distance_mm = 51.0 + f32::from(version) / 64.0;
    parameters.shutter = ShutterProfile::Trapezoid {
        opening_fraction: 0.125,
        closing_fraction: 0.25,
    };
    parameters.calibration.fitted = Some(FiveCoefficients {
        km0: 0.0,
        km1: -1.6e-5,
        km2: 6.2e-9,
        kd1: -1.6e-5,
        pm1: 0.0,
        regressor: Regressor::Travel,
    });
    parameters
}

pub(crate) fn origin(version: u16) -> Origin {
    let date = format!("2026-05-{:02}", 1 + version % 28);
    let laboratory = "Institute of Photogrammetry, test range";
    Origin::new("HR Digaron-W 50 mm, No. 1187", laboratory, &date).unwrap()
}

/// Returns the store of a flash.
pub(crate) fn store_in(flash: FlashModel) -> CalibrationStore<FlashModel> {
    CalibrationStore::new(flash, 0).unwrap()
}

/// Returns a flash into which the calibrations of these versions have been stored one after the
/// other.
pub(crate) fn flash_after(versions: &[u16]) -> FlashModel {
    let mut store = store_in(FlashModel::blank());
    for version in versions {
        let stored = store.store(&calibration(*version), &origin(*version), None);
        assert_eq!(stored.unwrap().parameters, calibration(*version));
    }
    store.into_flash()
}
