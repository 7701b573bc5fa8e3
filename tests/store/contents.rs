//! Bodies whose CRC-32 is right and whose contents are not those of a record.

use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::flight::grid_memory::{GridMemory, GridMemoryError};
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera::io::link::loading::Upload;
use fmc_camera::io::store::{NothingStored, SEAL_WORDS, SlotFault};

use crate::store::calibrations::{SERIAL, calibration, flash_after, store_in};
use crate::store::flash_model::{FlashModel, WORD};
use crate::store::grids;
use crate::store::images::{cells, image_of, with_crcs};

/// First byte of a body.
const BODY: usize = (1 + SEAL_WORDS as usize) * WORD;

/// Returns a slot with another body, of whole words.
fn with_body(slot: &[u8], body: &[u8]) -> Vec<u8> {
    let words = u16::try_from(body.len() / WORD).unwrap();
    let mut image = [&slot[..BODY], body].concat();
    image[6..8].copy_from_slice(&words.to_le_bytes());
    with_crcs(image)
}

/// Returns a slot whose record has other parameters in the place of its own, which end its head.
fn with_parameters(slot: &[u8], old: &CameraParameters, new: &CameraParameters) -> Vec<u8> {
    let bytes = |parameters| Upload::of(parameters).unwrap().bytes().to_vec();
    // As `postcard` writes them: the number of the bytes before them, seven bits to a byte.
    let counted = |bytes: Vec<u8>| {
        let (low, high) = (bytes.len() % 128, bytes.len() / 128);
        let mut counted = vec![
            u8::try_from(low + 128).unwrap(),
            u8::try_from(high).unwrap(),
        ];
        if high == 0 {
            counted = vec![u8::try_from(low).unwrap()];
        }
        counted.extend(bytes);
        counted
    };
    let [old, new] = [old, new].map(|parameters| counted(bytes(parameters)));
    let length = usize::from(u16::from_le_bytes([slot[BODY], slot[BODY + 1]]));
    let head = &slot[BODY + 2..BODY + 2 + length];
    let files = &slot[BODY + (2 + length).next_multiple_of(WORD)..];
    let before = head.strip_suffix(&old[..]).unwrap();
    let length = u16::try_from(before.len() + new.len()).unwrap();
    let mut body = [&length.to_le_bytes()[..], before, &new].concat();
    body.resize(body.len().next_multiple_of(WORD), 0);
    body.extend(files);
    with_body(slot, &body)
}

/// Returns what is wrong with the slot of these bytes, for a camera with memory for grids.
fn fault_of(slot: &[u8]) -> SlotFault {
    let mut flash = FlashModel::blank();
    flash.sectors[0] = cells(slot);
    let mut memory = Box::new(GridMemory::EMPTY);
    let NothingStored { slots } = store_in(flash).load(Some(&mut memory)).unwrap_err();
    assert_eq!(slots[1], SlotFault::Blank);
    slots[0]
}

#[test]
fn words_behind_the_last_of_a_body_are_not_contents_of_a_record() {
    let slot = image_of(&flash_after(&[7]).sectors[0]);
    let body = &slot[BODY..];
    for more in 1..3 {
        let longer = [body, &vec![0; more * WORD]].concat();
        assert_eq!(fault_of(&with_body(&slot, &longer)), SlotFault::Contents);
    }
    let shorter = &body[..body.len() - WORD];
    assert_eq!(fault_of(&with_body(&slot, shorter)), SlotFault::Contents);
}

#[test]
fn grids_that_are_not_those_of_the_parameters_are_named() {
    let (flash, parameters, _) = grids::stored(2);
    let slot = image_of(&flash.sectors[1]);
    assert_eq!(with_parameters(&slot, &parameters, &parameters), slot);
    let fault = |change: &dyn Fn(&mut CameraParameters)| {
        let mut other = parameters;
        change(&mut other);
        fault_of(&with_parameters(&slot, &parameters, &other))
    };
    for (carrier, change) in [(GridCarrier::Lens, [1, 0]), (GridCarrier::Sensor, [0, 1])] {
        let crc32 = parameters.grids.of(carrier).unwrap() ^ 1;
        let found = fault(&|other| {
            for (place, change) in [
                (&mut other.grids.lens, change[0]),
                (&mut other.grids.sensor, change[1]),
            ] {
                *place = place.map(|crc32| crc32 ^ change);
            }
        });
        let missing = GridMemoryError::Missing { carrier, crc32 };
        assert_eq!(found, SlotFault::Grids(missing));
    }
    // A file of which the parameters state nothing.
    let unstated: [fn(&mut CameraParameters); 3] = [
        |other| other.grids.lens = None,
        |other| other.grids.sensor = None,
        |other| (other.grids.lens, other.grids.sensor) = (None, None),
    ];
    for change in unstated {
        assert_eq!(fault(&change), SlotFault::Contents);
    }
}

#[test]
fn grids_that_the_parameters_state_and_the_slot_does_not_have_are_missing() {
    let slot = image_of(&flash_after(&[7]).sectors[0]);
    let own = calibration(7);
    for (carrier, crc32) in [(GridCarrier::Lens, 0x1234_5678), (GridCarrier::Sensor, 9)] {
        let mut other = own;
        match carrier {
            GridCarrier::Lens => other.grids.lens = Some(crc32),
            GridCarrier::Sensor => other.grids.sensor = Some(crc32),
        }
        let found = fault_of(&with_parameters(&slot, &own, &other));
        let missing = GridMemoryError::Missing { carrier, crc32 };
        assert_eq!(found, SlotFault::Grids(missing));
    }
}

#[test]
fn camera_that_knows_its_own_number_uses_its_own_calibration() {
    let serial = SerialNumber::new(SERIAL).unwrap();
    let mut store = store_in(flash_after(&[7])).of_camera(serial);
    assert_eq!(store.load(None).unwrap().parameters, calibration(7));
}
