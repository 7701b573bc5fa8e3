//! Calibrations that a laboratory has signed.

use ed25519_dalek::{Signer as _, SigningKey};
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::io::store::{
    Authentication, CalibrationStore, Permission, PublicKey, Signature, Statement, StoreOrder,
    StoredIdentity,
};

use crate::store::calibrations::{calibration, origin};
use crate::store::flash_model::FlashModel;

/// Files of the grids of lens and sensor.
pub(crate) type Files<'a> = [&'a [u8]; 2];

pub(crate) const NO_GRIDS: Files<'static> = [&[]; 2];

/// Key of the laboratory.
pub(crate) fn laboratory() -> SigningKey {
    SigningKey::from_bytes(&[7; 32])
}

pub(crate) fn public(key: &SigningKey) -> PublicKey {
    PublicKey::new(key.verifying_key().to_bytes())
}

/// Returns the store of a camera that trusts the laboratory.
pub(crate) fn trusting_store(flash: FlashModel) -> CalibrationStore<FlashModel> {
    let store = CalibrationStore::new(flash, 0).unwrap();
    store.trusting(public(&laboratory()))
}

/// Signs the calibration of some parameters, with the origin of a version.
pub(crate) fn signed_by(
    key: &SigningKey,
    parameters: &CameraParameters,
    permission: Option<Permission>,
    files: Files<'_>,
) -> StoreOrder {
    let origin = origin(u16::try_from(parameters.version).unwrap());
    let statement = Statement::of(parameters, &origin, permission, files).unwrap();
    let signature = key.sign(&statement.pieces().concat());
    StoreOrder {
        origin,
        authentication: Some(Authentication {
            signature: Signature::new(&signature.to_bytes()),
            permission,
        }),
    }
}

/// Returns the order of a version that the laboratory has signed, without permission and grids.
pub(crate) fn signed(version: u16) -> StoreOrder {
    signed_by(&laboratory(), &calibration(version), None, NO_GRIDS)
}

/// Returns the order of a version with a permission to follow what is stored.
pub(crate) fn permitted(version: u16, stored: &StoredIdentity) -> StoreOrder {
    let permission = Permission {
        store: stored.store,
        crc: stored.id.crc,
    };
    let parameters = calibration(version);
    signed_by(&laboratory(), &parameters, Some(permission), NO_GRIDS)
}

/// Returns a flash into which these versions have been stored.
pub(crate) fn signed_flash(versions: &[u16]) -> FlashModel {
    let mut store = trusting_store(FlashModel::blank());
    for version in versions {
        let stored = store.store(&calibration(*version), &signed(*version), None);
        assert_eq!(stored.unwrap().parameters, calibration(*version));
    }
    store.into_flash().started()
}
