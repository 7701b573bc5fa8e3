//! Calibrations that are not stored, and flashes that do not take them: what a start finds then.

use core::ops::Range;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fmc_camera::flight::calibration_id::{SerialNumber, Storage};
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::grid_memory::{GridMemory, GridMemoryError};
use fmc_camera::geometry::grid::{GridCarrier, GridChecksums};
use fmc_camera::geometry::range::Quantity;
use fmc_camera::io::link::digest;
use fmc_camera::io::store::{
    CalibrationStore, LayoutError, MAX_SLOT_BYTES, NotStored, ProbePoint, SEAL_WORDS, SlotFault,
    StoreStep,
};

use crate::store::calibrations::{Credulous, calibration, flash_after, order, origin, store_in};
use crate::store::flash_model::{Cell, FlashModel, Operation, SECTOR};

/// Checks that a store of version 7 holds it still.
fn assert_holds_seven<F: NorFlash>(store: &mut CalibrationStore<F, Credulous>) {
    assert_eq!(store.load(None).unwrap().parameters, calibration(7));
}

#[test]
fn stored_calibration_is_found_with_its_identity_and_the_one_before_in_the_other_slot() {
    let mut store = store_in(FlashModel::blank());
    for version in 1..=5 {
        let stored = store.store(&calibration(version), &order(version), None);
        let stored = stored.unwrap();
        assert_eq!(
            stored.identity.slot,
            u8::try_from((version - 1) % 2).unwrap()
        );
        let found = store.load(None).unwrap();
        assert_eq!(
            (found.identity.slot, found.parameters),
            (stored.identity.slot, stored.parameters)
        );
        assert_eq!(
            found.identity.other,
            (version == 1).then_some(SlotFault::Blank)
        );
        assert!(stored.identity.is_sealed && found.identity.is_sealed);
        let id = stored.identity.id;
        assert_eq!((id.version, id.storage), (version.into(), Storage::Stored));
        assert_eq!(id.crc, digest::of_camera(&calibration(version)));
        assert_eq!(
            [&stored.identity.origin, &found.identity.origin],
            [&origin(version); 2]
        );
    }
    let mut flash = store.into_flash();
    flash.sectors[0].clear();
    let before = store_in(flash).load(None).unwrap();
    assert_eq!(before.parameters, calibration(4));
    assert_eq!(before.identity.other, Some(SlotFault::Blank));
}

#[test]
fn calibration_that_is_stored_already_is_not_written_again() {
    let mut store = store_in(flash_after(&[6, 7]).started());
    for repeat in 0..10 {
        let stored = store.store(&calibration(7), &order(7), None).unwrap();
        assert_eq!(stored.parameters, calibration(7));
        let operations = &store.flash_mut().operations;
        assert!(
            operations.iter().all(Operation::is_seal),
            "{repeat}: {operations:?}"
        );
        assert!(operations.len() < usize::from(SEAL_WORDS));
    }
}

/// Checks that a store of version 7 refuses a calibration and does not touch the flash.
fn assert_refused(
    store: &mut CalibrationStore<FlashModel, Credulous>,
    parameters: &CameraParameters,
    memory: Option<&mut GridMemory>,
    reason: NotStored,
) {
    let refused = store.store(parameters, &order(8), memory);
    assert_eq!(refused, Err(reason));
    assert_eq!(store.flash_mut().operations, [], "{reason}");
}

#[test]
fn calibration_of_another_camera_or_of_a_lower_version_is_refused() {
    let mut store = store_in(flash_after(&[7]).started());
    let mut other = calibration(8);
    other.serial = SerialNumber::new("RC30-5283").unwrap();
    let camera = calibration(7).serial;
    assert_refused(&mut store, &other, None, NotStored::OtherCamera { camera });
    let older = NotStored::VersionNotRisen { highest: 7 };
    assert_refused(&mut store, &calibration(6), None, older);
    assert_holds_seven(&mut store);
    // A camera that knows its own number compares that, also before anything is stored.
    let mut store = store_in(FlashModel::blank()).of_camera(camera);
    assert_refused(&mut store, &other, None, NotStored::OtherCamera { camera });
    assert!(store.load(None).unwrap_err().is_blank());
}

#[test]
fn calibration_that_is_not_usable_or_whose_grids_are_not_in_use_is_refused() {
    let mut store = store_in(flash_after(&[7]).started());
    let mut bad = calibration(8);
    bad.calibration.pixel_um = -1.0;
    let error = Quantity::PixelUm.check(-1.0).unwrap_err();
    let unusable = NotStored::Calibration(error.into());
    assert_refused(&mut store, &bad, None, unusable);
    // A stage so far from its plane that its image is out of focus.
    let mut unfocused = calibration(8);
    unfocused.calibration.flatness.coefficients_um[0] = 900.0;
    let error = ProbePoint::of(&Camera::new(unfocused).unwrap(), None).unwrap_err();
    assert_refused(&mut store, &unfocused, None, NotStored::Frame(error));
    let mut gridded = calibration(8);
    gridded.grids = GridChecksums {
        lens: Some(1),
        sensor: None,
    };
    assert_refused(&mut store, &gridded, None, NotStored::NoGridMemory);
    let mut memory = Box::new(GridMemory::EMPTY);
    let missing = GridMemoryError::Missing {
        carrier: GridCarrier::Lens,
        crc32: 1,
    };
    let missing = NotStored::Grids(missing);
    assert_refused(&mut store, &gridded, Some(&mut memory), missing);
    assert_holds_seven(&mut store);
}

/// A flash of which an operation fails at every attempt, or a word keeps a bit.
#[derive(Debug)]
struct Worn {
    model: FlashModel,
    fails_to_erase: bool,
    /// Indices of the words that it does not take.
    refused: Range<usize>,
    /// Index of the word in which a bit stays 1.
    stuck: Option<usize>,
}

impl Worn {
    /// Returns a flash with versions 6 and 7, in the second slot, that does everything.
    fn sound() -> Self {
        Self {
            model: flash_after(&[6, 7]),
            fails_to_erase: false,
            refused: 0..0,
            stuck: None,
        }
    }

    fn index(offset: u32) -> usize {
        usize::try_from(offset).unwrap() % SECTOR / 32
    }
}

impl ErrorType for Worn {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Worn {
    const READ_SIZE: usize = 32;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.model.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.model.capacity()
    }
}

impl NorFlash for Worn {
    const WRITE_SIZE: usize = FlashModel::WRITE_SIZE;
    const ERASE_SIZE: usize = FlashModel::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        if self.fails_to_erase {
            return Err(NorFlashErrorKind::Other);
        }
        self.model.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        let word = Self::index(offset);
        if self.refused.contains(&word) {
            return Err(NorFlashErrorKind::Other);
        }
        let mut bytes = bytes.to_vec();
        if self.stuck == Some(word) {
            let byte = bytes.iter_mut().find(|byte| **byte != 0xff).unwrap();
            *byte |= !*byte & byte.wrapping_add(1);
        }
        self.model.write(offset, &bytes)
    }
}

#[test]
fn flash_that_is_worn_is_named_and_what_was_stored_stays() {
    let refused = |worn: Worn| {
        let mut store = store_in(worn);
        let refused = store.store(&calibration(8), &order(8), None).unwrap_err();
        assert_holds_seven(&mut store);
        match refused {
            NotStored::Flash { slot, step } => {
                assert_eq!(slot, 0);
                step
            }
            other => panic!("{other:?}"),
        }
    };
    let step = refused(Worn {
        fails_to_erase: true,
        ..Worn::sound()
    });
    assert_eq!(step, StoreStep::Erase);
    let words = Worn::sound().model.sectors[0].len();
    let body = 1 + usize::from(SEAL_WORDS);
    for index in (0..1).chain(body..words) {
        let word = u16::try_from(index).unwrap();
        let step = refused(Worn {
            refused: index..index + 1,
            ..Worn::sound()
        });
        assert_eq!(step, StoreStep::Write { word });
        let step = refused(Worn {
            stuck: Some(index),
            ..Worn::sound()
        });
        assert_eq!(step, StoreStep::Compare { word });
    }
}

#[test]
fn seal_that_the_flash_does_not_take_is_written_into_the_next_word() {
    let worn = Worn {
        refused: 1..2,
        stuck: Some(2),
        ..Worn::sound()
    };
    let mut worn = store_in(worn);
    assert!(worn.store(&calibration(8), &order(8), None).is_ok());
    let flash = worn.into_flash().model;
    assert_eq!(flash.sectors[0][1], Cell::Blank);
    let stored = store_in(flash).load(None).unwrap();
    assert!(stored.identity.is_sealed);
    assert_eq!(stored.parameters, calibration(8));
}

#[test]
fn flash_that_takes_no_seal_is_named_and_a_start_finds_the_new_calibration() {
    let worn = Worn {
        refused: 1..1 + usize::from(SEAL_WORDS),
        ..Worn::sound()
    };
    let mut worn = store_in(worn);
    let refused = worn.store(&calibration(8), &order(8), None);
    let step = StoreStep::Write { word: 1 };
    assert_eq!(refused, Err(NotStored::Flash { slot: 0, step }));
    let stored = worn.load(None).unwrap();
    assert_eq!(stored.parameters, calibration(8));
    assert!(!stored.identity.is_sealed);
    // The next store is written over it; cut before its commit word, it leaves version 7.
    worn.flash_mut().refused = 8..9;
    let refused = worn.store(&calibration(9), &order(9), None);
    let step = StoreStep::Write { word: 8 };
    assert_eq!(refused, Err(NotStored::Flash { slot: 0, step }));
    assert_holds_seven(&mut worn);
}

#[test]
fn flash_without_place_for_two_slots_is_refused() {
    let layout = |offset| CalibrationStore::new(FlashModel::blank(), offset).map(|_| ());
    assert_eq!(layout(0), Ok(()));
    let sector = SECTOR;
    let offset = 32;
    assert_eq!(layout(32), Err(LayoutError::NoSector { offset, sector }));
    let required = 3 * SECTOR;
    let capacity = 2 * SECTOR;
    let offset = u32::try_from(SECTOR).unwrap();
    let no_place = LayoutError::NoPlace { required, capacity };
    assert_eq!(layout(offset), Err(no_place));
    const { assert!(MAX_SLOT_BYTES < SECTOR) };
}
