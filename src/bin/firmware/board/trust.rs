//! Key by which the camera knows the signatures of calibrations.

use embedded_storage::nor_flash::NorFlash;
use fmc_camera::io::store::{CalibrationStore, PublicKey};

const KEY: Option<PublicKey> = PublicKey::from_pem(include_str!(env!("FMC_PUBLIC_KEY_FILE")));

/// Returns the store at the beginning of a flash that trusts the key; `None` if two slots have no
/// place there.
pub(super) fn store_in<F: NorFlash>(flash: F) -> Option<CalibrationStore<F>> {
    const {
        assert!(
            KEY.is_some(),
            "FMC_PUBLIC_KEY names no public key of Ed25519"
        );
    }
    let store = CalibrationStore::new(flash, 0).ok()?;
    Some(store.trusting(KEY?))
}
