//! Flashes of any contents: a start names what is wrong, or uses a record that is whole.

use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::geometry::focus_table::{FocusRow, FocusTable};
use fmc_camera::io::store::{
    FORMAT_VERSION, NothingStored, OLDEST_FORMAT, Origin, SEAL_WORDS, SlotFault,
};
use proptest::prelude::*;

use crate::store::calibrations::{SERIAL, calibration, flash_after, order, origin, store_in};
use crate::store::flash_model::{Bytes, Cell, FlashModel, WORD};

/// Bytes of a record's first slot, seals included.
fn image() -> Vec<u8> {
    image_of(&flash_after(&[7]).sectors[0])
}

/// Returns the bytes of words that have been written or are blank.
pub(crate) fn image_of(cells: &[Cell]) -> Vec<u8> {
    let words = cells.iter().map(|cell| match cell {
        Cell::Holding(bytes) => *bytes,
        Cell::Blank => [0xff; WORD],
        other => panic!("{other:?}"),
    });
    words.flatten().collect()
}

/// Returns a flash with these bytes in its first slot.
fn flash_of(image: &[u8]) -> FlashModel {
    let mut flash = FlashModel::blank();
    flash.sectors[0] = cells(image);
    flash
}

pub(crate) fn cells(image: &[u8]) -> Vec<Cell> {
    let words = image.chunks(WORD);
    words
        .map(|word| Cell::Holding(Bytes::try_from(word).unwrap()))
        .collect()
}

/// Returns what is wrong with the first slot; `None` if its calibration, whole, is used.
fn fault_of(image: &[u8]) -> Option<SlotFault> {
    match store_in(flash_of(image)).load(None) {
        Ok(stored) => {
            assert_eq!(stored.parameters, calibration(7));
            assert_eq!(stored.identity.origin, origin(7));
            None
        }
        Err(NothingStored { slots: [fault, _] }) => Some(fault),
    }
}

/// Returns `true` for the bits of seals, which no start needs.
fn is_of_a_seal(bit: usize) -> bool {
    (1..=usize::from(SEAL_WORDS)).contains(&(bit / 8 / WORD))
}

fn flip(image: &mut [u8], bits: &[usize]) {
    for bit in bits {
        image[bit / 8] ^= 1 << (bit % 8);
    }
}

pub(crate) fn crc_of(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

/// Writes the CRC-32 of the body and of the commit word anew.
pub(crate) fn with_crcs(mut image: Vec<u8>) -> Vec<u8> {
    let body = (1 + usize::from(SEAL_WORDS)) * WORD;
    let crc = crc_of(&image[body..]);
    image[12..16].copy_from_slice(&crc.to_le_bytes());
    let crc = crc_of(&image[..28]);
    image[28..32].copy_from_slice(&crc.to_le_bytes());
    image
}

#[test]
fn every_single_bit_that_is_wrong_is_found() {
    let whole = image();
    assert_eq!(fault_of(&whole), None);
    let bits = 8 * whole.len();
    for bit in 0..bits {
        let mut image = whole.clone();
        flip(&mut image, &[bit]);
        assert_eq!(fault_of(&image).is_none(), is_of_a_seal(bit), "bit {bit}");
    }
    assert!(bits > 4000, "{bits}");
}

/// Checks every `step`th pair of wrong bits in commit word and body.
fn check_pairs(step: usize) -> usize {
    let whole = image();
    let bits: Vec<usize> = (0..8 * whole.len())
        .filter(|bit| !is_of_a_seal(*bit))
        .collect();
    let mut image = whole;
    let pairs = bits.iter().enumerate().flat_map(|(index, first)| {
        let behind = bits[index + 1..].iter();
        behind.map(move |second| [*first, *second])
    });
    let mut tried = 0;
    for pair in pairs.step_by(step) {
        flip(&mut image, &pair);
        assert!(fault_of(&image).is_some(), "{pair:?}");
        flip(&mut image, &pair);
        tried += 1;
    }
    tried
}

#[test]
fn two_wrong_bits_are_found() {
    assert!(check_pairs(499) > 5_000);
}

#[test]
#[ignore = "all pairs: a minute; docs/store.md has the command"]
fn any_two_wrong_bits_are_found() {
    let tried = check_pairs(1);
    println!("{tried} pairs");
    // docs/store.md has this number.
    assert_eq!(tried, 4_717_056);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2048))]

    #[test]
    fn three_wrong_bits_are_found(places in prop::array::uniform3(any::<prop::sample::Index>())) {
        let mut image = image();
        let seals = 8 * WORD * usize::from(SEAL_WORDS);
        let mut bits = places.map(|place| match place.index(8 * image.len() - seals) {
            bit if bit < 8 * WORD => bit,
            bit => bit + seals,
        });
        bits.sort_unstable();
        prop_assume!(bits[0] != bits[1] && bits[1] != bits[2]);
        flip(&mut image, &bits);
        prop_assert!(fault_of(&image).is_some(), "{bits:?}");
    }

    #[test]
    fn random_image_is_a_named_fault_and_takes_a_store(
        first in prop::collection::vec(any::<u8>(), 0..40 * WORD),
        second in prop::collection::vec(any::<u8>(), 0..40 * WORD),
        is_record: bool,
        is_crc_right: bool,
    ) {
        let whole = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            bytes.resize(bytes.len().next_multiple_of(WORD), 0xff);
            if is_record && bytes.len() > 8 * WORD {
                bytes[..4].copy_from_slice(b"FMCS");
                bytes[4..6].copy_from_slice(&FORMAT_VERSION.to_le_bytes());
                let words = u16::try_from(bytes.len() / WORD - 8).unwrap();
                bytes[6..8].copy_from_slice(&words.to_le_bytes());
                if is_crc_right {
                    return with_crcs(bytes);
                }
            }
            bytes
        };
        let mut flash = FlashModel::blank();
        flash.sectors = [cells(&whole(&first)), cells(&whole(&second))];
        let mut store = store_in(flash);
        prop_assert!(store.load(None).is_err());
        let stored = store.store(&calibration(7), &order(7), None);
        prop_assert!(stored.is_ok(), "{:?}", stored);
        prop_assert_eq!(store.load(None).unwrap().parameters, calibration(7));
    }

    #[test]
    fn body_of_any_bytes_with_the_right_crc_is_refused_or_is_a_camera(
        at in any::<prop::sample::Index>(),
        bytes in prop::collection::vec(any::<u8>(), 1..64),
    ) {
        let mut image = image();
        let body = 8 * WORD;
        let at = body + at.index(image.len() - body);
        for (place, byte) in image[at..].iter_mut().zip(&bytes) {
            *place = *byte;
        }
        is_refused_or_a_camera(image);
    }
}

/// Writes the CRCs of an image anew and starts with it; `true` if it is refused. Otherwise it is
/// checked to be a camera with an origin.
fn is_refused_or_a_camera(image: Vec<u8>) -> bool {
    let Ok(stored) = store_in(flash_of(&with_crcs(image))).load(None) else {
        return true;
    };
    assert!(Camera::new(stored.parameters).is_ok());
    let texts = &stored.identity.origin;
    let origin = Origin::new(texts.lens(), texts.laboratory(), texts.date());
    assert_eq!(origin.as_ref(), Ok(texts));
    false
}

#[test]
fn body_of_which_a_byte_is_changed_with_the_right_crc_is_refused_or_is_a_camera() {
    let whole = image();
    let (mut refused, mut cameras) = (0, 0);
    for at in (1 + usize::from(SEAL_WORDS)) * WORD..whole.len() {
        for change in [0x01, 0x20, 0x80, 0xff] {
            let mut image = whole.clone();
            image[at] ^= change;
            if is_refused_or_a_camera(image) {
                refused += 1;
            } else {
                cameras += 1;
            }
        }
    }
    // Texts of the origin take other letters, numbers of the camera other values.
    assert!(refused > 400 && cameras > 100, "{refused}, {cameras}");
}

#[test]
fn record_of_another_format_is_named_and_the_other_slot_is_used() {
    let mut newer = image();
    newer[4..6].copy_from_slice(&(FORMAT_VERSION + 1).to_le_bytes());
    let newer = with_crcs(newer);
    let fault = SlotFault::Format(FORMAT_VERSION + 1);
    assert_eq!(fault_of(&newer), Some(fault));
    let mut flash = flash_after(&[6]);
    flash.sectors[1] = cells(&newer);
    let stored = store_in(flash).load(None).unwrap();
    assert_eq!(stored.parameters, calibration(6));
    assert_eq!(
        (stored.identity.slot, stored.identity.other),
        (0, Some(fault))
    );
}

#[test]
fn probe_point_that_is_corrected_to_other_bits_is_named() {
    let image = image();
    let stored = store_in(flash_of(&image)).load(None).unwrap();
    let mut other = stored.parameters;
    other.calibration.distortion.k1 *= 1.000_001;
    let bytes = |parameters| {
        let upload = fmc_camera::io::link::loading::Upload::of(parameters).unwrap();
        upload.bytes().to_vec()
    };
    let [old, new] = [&stored.parameters, &other].map(bytes);
    let at = image.windows(old.len()).position(|window| window == old);
    let mut changed = image;
    let at = at.unwrap();
    changed[at..at + new.len()].copy_from_slice(&new);
    let fault = fault_of(&with_crcs(changed));
    let Some(SlotFault::ProbePoint { stored, computed }) = fault else {
        panic!("{fault:?}");
    };
    assert_ne!(stored, computed);
}

#[test]
fn calibration_of_another_camera_is_named() {
    let own = SerialNumber::new("RC30-5283").unwrap();
    let mut store = store_in(flash_of(&image())).of_camera(own);
    let NothingStored { slots } = store.load(None).unwrap_err();
    let other = SlotFault::OtherCamera(SerialNumber::new(SERIAL).unwrap());
    assert_eq!(slots, [other, SlotFault::Blank]);
    assert_eq!(
        slots[0].to_string(),
        "the calibration is of another camera, serial RC30-5282"
    );
}

#[test]
fn word_that_cannot_be_read_is_a_fault_of_its_slot_alone() {
    let whole = flash_after(&[6, 7]);
    for word in 0..whole.sectors[1].len() {
        let mut flash = whole.clone();
        flash.sectors[1][word] = Cell::Failing;
        let stored = store_in(flash).load(None).unwrap();
        if (1..=usize::from(SEAL_WORDS)).contains(&word) {
            assert_eq!(stored.parameters, calibration(7));
        } else {
            let word = u16::try_from(word).unwrap();
            assert_eq!(stored.parameters, calibration(6));
            assert_eq!(stored.identity.other, Some(SlotFault::Unreadable { word }));
        }
    }
}

#[test]
fn record_of_the_format_before_is_read_as_it_is() {
    let mut before = image();
    before[4..6].copy_from_slice(&OLDEST_FORMAT.to_le_bytes());
    let before = with_crcs(before);
    let stored = store_in(flash_of(&before)).load(None).unwrap();
    assert_eq!(stored.parameters, calibration(7));
    let mut older = image();
    older[4..6].copy_from_slice(&(OLDEST_FORMAT - 1).to_le_bytes());
    let fault = SlotFault::Format(OLDEST_FORMAT - 1);
    assert_eq!(fault_of(&with_crcs(older)), Some(fault));
    assert_eq!(
        fault.to_string(),
        "the record has format 1; this firmware reads 2 to 3"
    );
}

#[test]
fn calibration_is_stored_with_its_focus_table() {
    let rows: Vec<FocusRow> = (0..16_u8)
        .map(|row| FocusRow {
            temperature_c: f32::from(row) - 8.0,
            focus_shift_um: 2.5 * f32::from(row),
        })
        .collect();
    let parameters = CameraParameters {
        focus: FocusTable::new(&rows).unwrap(),
        ..calibration(7)
    };
    let mut store = store_in(flash_after(&[6]));
    let stored = store.store(&parameters, &order(7), None).unwrap();
    assert_eq!(stored.parameters, parameters);
    let mut again = store_in(store.into_flash());
    assert_eq!(again.load(None).unwrap().parameters, parameters);
}

#[test]
fn blank_flash_is_told_from_a_damaged_one() {
    let nothing = store_in(FlashModel::blank()).load(None).unwrap_err();
    assert!(nothing.is_blank());
    let mut damaged = image();
    damaged[0] = 0;
    let nothing = store_in(flash_of(&damaged)).load(None).unwrap_err();
    assert!(!nothing.is_blank());
    assert_eq!(
        nothing.to_string(),
        "no calibration is stored: first slot: does not begin as a record; second slot: blank"
    );
}

/// The format may not change unnoticed: a camera that starts with other firmware has to read it, or
/// to name its version.
#[test]
fn image_of_this_format_has_these_bytes() {
    let image = image();
    assert_eq!(&image[..4], b"FMCS");
    assert_eq!((FORMAT_VERSION, image.len() / WORD), (3, 19));
    assert_eq!(crc_of(&image), 0xa801_c27e);
}
