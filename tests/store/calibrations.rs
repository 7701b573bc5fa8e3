//! Calibrations of one camera, told apart by their versions.

use embedded_storage::nor_flash::NorFlash;
use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::geometry::five_coefficient::{FiveCoefficients, Regressor};
use fmc_camera::geometry::shutter::ShutterProfile;
use fmc_camera::io::store::{
    Authentication, CalibrationStore, Origin, Signature, SignatureVerifier, StoreOrder,
};

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

/// A verifier to which every signature is right: a million cuts and contents of any kind are tried
/// with it, `signatures` has real keys.
#[derive(Debug)]
pub(crate) struct Credulous;

impl SignatureVerifier for Credulous {
    fn verifies(&self, _: &[&[u8]], _: &Signature) -> bool {
        true
    }
}

/// Returns the order to store the calibration of a version, with a signature of its own.
pub(crate) fn order(version: u16) -> StoreOrder {
    let [low, high] = version.to_le_bytes();
    let mut signature = [high; Signature::BYTES];
    signature[0] = low;
    StoreOrder {
        origin: origin(version),
        authentication: Some(Authentication {
            signature: Signature::new(&signature),
            permission: None,
        }),
    }
}

/// Returns the store of a flash.
pub(crate) fn store_in<F: NorFlash>(flash: F) -> CalibrationStore<F, Credulous> {
    CalibrationStore::new(flash, 0).unwrap().trusting(Credulous)
}

/// Returns a flash into which the calibrations of these versions have been stored one after the
/// other.
pub(crate) fn flash_after(versions: &[u16]) -> FlashModel {
    let mut store = store_in(FlashModel::blank());
    for version in versions {
        let stored = store.store(&calibration(*version), &order(*version), None);
        assert_eq!(stored.unwrap().parameters, calibration(*version));
    }
    store.into_flash()
}
