//! Succession: versions rise, and an older one is stored with a permission, once.

use fmc_camera::io::store::{
    CalibrationStore, NotStored, Permission, SEAL_WORDS, SlotFault, StoreOrder, StoredIdentity,
};

use crate::store::calibrations::calibration;
use crate::store::flash_model::{FlashModel, Operation};
use crate::store::images::{cells, image_of, with_crcs};
use crate::store::signed::{
    NO_GRIDS, laboratory, permitted, signed, signed_by, signed_flash, trusting_store,
};

type Store = CalibrationStore<FlashModel>;

fn stored(store: &mut Store) -> StoredIdentity {
    store.load(None).unwrap().identity
}

fn store_order(store: &mut Store, version: u16, order: &StoreOrder) -> Result<u32, NotStored> {
    let stored = store.store(&calibration(version), order, None);
    stored.map(|stored| stored.parameters.version)
}

/// Stores what is refused, and checks that nothing was written.
fn assert_refused(store: &mut Store, version: u16, order: &StoreOrder, reason: NotStored) {
    let (before, operations) = (stored(store), store.flash_mut().operations.len());
    assert_eq!(store_order(store, version, order), Err(reason));
    assert_eq!(store.flash_mut().operations.len(), operations, "{reason}");
    assert_eq!(stored(store), before);
}

/// Refusal that names what a permission has to name.
fn named(stored: &StoredIdentity) -> NotStored {
    NotStored::OtherPermission {
        newest: Some(Permission {
            store: stored.store,
            crc: stored.id.crc,
        }),
    }
}

#[test]
fn signed_calibration_is_replayed_in_vain_unless_its_version_is_higher_than_all() {
    let mut store = trusting_store(signed_flash(&[3, 5, 7]));
    for version in [0, 3, 5, 6] {
        let older = NotStored::VersionNotRisen { highest: 7 };
        assert_refused(&mut store, version, &signed(version), older);
    }
    // Other numbers under the same version.
    let mut other = calibration(7);
    other.calibration.principal_distance_mm += 1.0;
    let order = signed_by(&laboratory(), &other, None, NO_GRIDS);
    let refused = store.store(&other, &order, None);
    assert_eq!(refused, Err(NotStored::VersionNotRisen { highest: 7 }));
    assert_eq!(store.flash_mut().operations, []);
    // The very calibration that is stored: nothing but seals is written.
    for _ in 0..3 {
        assert_eq!(store_order(&mut store, 7, &signed(7)), Ok(7));
        assert!(store.flash_mut().operations.iter().all(Operation::is_seal));
    }
    assert_eq!(stored(&mut store).store, 3);
    assert_eq!(store_order(&mut store, 8, &signed(8)), Ok(8));
    assert_eq!(stored(&mut store).store, 4);
}

#[test]
fn permission_stores_an_older_version_once() {
    let mut store = trusting_store(signed_flash(&[3, 5, 7]));
    let at_seven = stored(&mut store);
    assert_eq!((at_seven.store, at_seven.highest_version), (3, 7));
    let back = permitted(5, &at_seven);
    assert_eq!(store_order(&mut store, 5, &back), Ok(5));
    let at_five = stored(&mut store);
    assert_eq!((at_five.store, at_five.highest_version), (4, 7));
    assert_eq!(at_five.id.version, 5);
    // A version between the two is not stored without a permission, nor the higher one.
    for version in [6, 7] {
        let older = NotStored::VersionNotRisen { highest: 7 };
        assert_refused(&mut store, version, &signed(version), older);
    }
    // Stored already: nothing is written but a seal.
    assert_eq!(store_order(&mut store, 5, &back), Ok(5));
    assert_eq!(stored(&mut store).store, 4);
    assert_eq!(store_order(&mut store, 8, &signed(8)), Ok(8));
    let at_eight = stored(&mut store);
    assert_refused(&mut store, 5, &back, named(&at_eight));
    // Back at seven, to which the permission was given, by another: its number is another.
    let again = permitted(7, &at_eight);
    assert_eq!(store_order(&mut store, 7, &again), Ok(7));
    let at_seven_again = stored(&mut store);
    assert_eq!(at_seven_again.id.crc, at_seven.id.crc);
    assert_eq!(at_seven_again.highest_version, 8);
    assert_refused(&mut store, 5, &back, named(&at_seven_again));
    assert_refused(
        &mut store,
        7,
        &permitted(7, &at_five),
        named(&at_seven_again),
    );
}

#[test]
fn permission_for_another_store_or_calibration_and_one_of_a_blank_flash_are_refused() {
    let mut store = trusting_store(signed_flash(&[3, 5, 7]));
    let right = stored(&mut store);
    let mut other_number = right.clone();
    other_number.store += 1;
    let mut other_crc = right.clone();
    other_crc.id.crc ^= 1;
    for wrong in [other_number, other_crc] {
        assert_refused(&mut store, 5, &permitted(5, &wrong), named(&right));
        // Nor does it let a higher version pass.
        assert_refused(&mut store, 8, &permitted(8, &wrong), named(&right));
    }
    let mut blank = trusting_store(FlashModel::blank());
    let refused = store_order(&mut blank, 5, &permitted(5, &right));
    assert_eq!(refused, Err(NotStored::OtherPermission { newest: None }));
    assert_eq!(blank.flash_mut().operations, []);
}

/// Returns a flash whose second slot has a probe point with another bit, as it looks to a firmware
/// that computes other bits.
fn computing_otherwise(mut flash: FlashModel) -> FlashModel {
    let whole = image_of(&flash.sectors[1]);
    let body = (1 + usize::from(SEAL_WORDS)) * 32;
    let bit = (8 * body..8 * whole.len()).find(|bit| {
        let mut slot = whole.clone();
        slot[bit / 8] ^= 1 << (bit % 8);
        flash.sectors[1] = cells(&with_crcs(slot));
        let found = trusting_store(flash.clone()).load(None).unwrap();
        matches!(found.identity.other, Some(SlotFault::ProbePoint { .. }))
    });
    assert!(bit.is_some());
    flash
}

#[test]
fn newest_that_a_new_firmware_cannot_use_still_keeps_older_ones_out() {
    let flash = computing_otherwise(signed_flash(&[5, 7]));
    let mut store = trusting_store(flash);
    assert_eq!(stored(&mut store).id.version, 5);
    for version in [5, 6] {
        let refused = store_order(&mut store, version, &signed(version));
        assert_eq!(refused, Err(NotStored::VersionNotRisen { highest: 7 }));
    }
    assert_eq!(store.flash_mut().operations, []);
    // The newest itself may be stored again.
    assert_eq!(store_order(&mut store, 7, &signed(7)), Ok(7));
    assert_eq!(stored(&mut store).id.version, 7);
}
