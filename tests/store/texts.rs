//! Texts of calibrations that are not stored, and of slots that are not used.

use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::grid_memory::GridMemoryError;
use fmc_camera::geometry::grid::{GridCarrier, GridError};
use fmc_camera::geometry::range::{OutOfRange, Quantity};
use fmc_camera::io::store::{
    LayoutError, MAX_BODY_WORDS, NotStored, NothingStored, OriginError, Permission, PublicKey,
    Signature, SlotFault, StoreStep,
};

use crate::controller::texts::assert_texts;

const TOO_FINE: OutOfRange = OutOfRange {
    quantity: Quantity::PixelUm,
    value: 0.25,
    min: 1.0,
    max: 50.0,
};
const TOO_FINE_TEXT: &str = "pixel_um = 0.25 is outside 1 to 50";

const MISSING: GridMemoryError = GridMemoryError::Missing {
    carrier: GridCarrier::Sensor,
    crc32: 0xab,
};
const MISSING_TEXT: &str =
    "the residual grid of the sensor with CRC-32 000000ab has not been loaded";

const NEWEST: Permission = Permission {
    store: 7,
    crc: 0x00be_ef12,
};

#[test]
fn calibration_that_is_not_stored_says_why() {
    let camera = SerialNumber::new("RC30-5282").unwrap();
    assert_texts(&[
        (
            NotStored::Calibration(TOO_FINE.into()),
            "the calibration is not usable: pixel_um = 0.25 is outside 1 to 50",
        ),
        (
            NotStored::Origin(OriginError::Date),
            "the date is not a day as 2026-05-17",
        ),
        (
            NotStored::OtherCamera { camera },
            "the calibration is of another camera than serial RC30-5282",
        ),
        (NotStored::Unsigned, "it is not signed"),
        (
            NotStored::NoKey,
            "the firmware has no key that verifies signatures",
        ),
        (
            NotStored::NoSerial,
            "it has no serial number: it is signed for no camera",
        ),
        (
            NotStored::WrongSignature,
            "the signature is not that of the camera's key, or is one of something else",
        ),
        (
            NotStored::VersionNotRisen { highest: 9 },
            "its version is not higher than 9, which has been stored, and it has no permission",
        ),
        (
            NotStored::OtherPermission {
                newest: Some(NEWEST),
            },
            "its permission is not for what is stored now: store 7, CRC-32 00beef12",
        ),
        (
            NotStored::OtherPermission { newest: None },
            "it has a permission, and nothing is stored",
        ),
        (NotStored::Grids(MISSING), MISSING_TEXT),
        (
            NotStored::NoGridMemory,
            "the camera has no memory for residual grids",
        ),
        (
            NotStored::Frame(FrameError::NotFitted),
            "the probe point has no frame: the camera has no fitted five-coefficient model",
        ),
        (NotStored::TooLong, "it is longer than a slot"),
    ]);
    let flash = |slot, step| NotStored::Flash { slot, step };
    assert_texts(&[
        (
            flash(0, StoreStep::Erase),
            "the flash of slot 0 is not erased",
        ),
        (
            flash(1, StoreStep::Write { word: 12 }),
            "the flash of slot 1 does not take word 12",
        ),
        (
            flash(0, StoreStep::Compare { word: 3 }),
            "the flash of slot 0 reads word 3 otherwise than it was written",
        ),
    ]);
}

#[test]
fn slot_that_is_not_used_says_why() {
    let (stored, computed) = (0x00ab_cdef, 0x1234_5678);
    let length = format!("a body of 2000 words is not among 1 to {MAX_BODY_WORDS}");
    let long = SlotFault::Length(2000);
    assert_texts(&[
        (SlotFault::Blank, "blank"),
        (SlotFault::Unreadable { word: 5 }, "word 5 cannot be read"),
        (SlotFault::NoRecord, "does not begin as a record"),
        (
            SlotFault::CommitCrc { stored, computed },
            "the commit word has CRC-32 12345678 and states 00abcdef",
        ),
        (
            SlotFault::Format(9),
            "the record has format 9; this firmware reads 2 to 3",
        ),
        (long, &length),
        (
            SlotFault::Crc { stored, computed },
            "the body has CRC-32 12345678, the commit word states 00abcdef",
        ),
        (SlotFault::Contents, "the body is not one of this format"),
        (
            SlotFault::NoKey,
            "the firmware has no key that verifies signatures",
        ),
        (
            SlotFault::WrongSignature,
            "the signature is not that of the camera's key",
        ),
        (
            SlotFault::Calibration(TOO_FINE.into()),
            "the calibration is not usable: pixel_um = 0.25 is outside 1 to 50",
        ),
        (
            SlotFault::OtherCamera(SerialNumber::new("5283").unwrap()),
            "the calibration is of another camera, serial 5283",
        ),
        (
            SlotFault::NoGridMemory,
            "the camera has no memory for its residual grids",
        ),
        (
            SlotFault::Grid {
                carrier: GridCarrier::Lens,
                error: GridError::Version(8),
            },
            "residual grid of the lens: version 8 of the residual grid is unknown; allowed: 1",
        ),
        (SlotFault::Grids(MISSING), MISSING_TEXT),
        (
            SlotFault::Frame(FrameError::OutOfRange(TOO_FINE)),
            "the probe point has no frame: pixel_um = 0.25 is outside 1 to 50",
        ),
        (
            SlotFault::ProbePoint {
                stored: [1, 2, 3, 4],
                computed: [1, 2, 3, 0xbeef],
            },
            "the probe point is corrected to bits [00000001, 00000002, 00000003, 0000beef], \
             stored are [00000001, 00000002, 00000003, 00000004]",
        ),
    ]);
    assert_eq!(FrameError::OutOfRange(TOO_FINE).to_string(), TOO_FINE_TEXT);
    let nothing = NothingStored {
        slots: [SlotFault::Blank, SlotFault::Contents],
    };
    assert_eq!(
        nothing.to_string(),
        "no calibration is stored: first slot: blank; \
         second slot: the body is not one of this format"
    );
}

#[test]
fn flash_without_place_and_origin_that_is_none_name_their_bounds() {
    assert_texts(&[
        (
            LayoutError::NoSector {
                offset: 32,
                sector: 4096,
            },
            "the store begins at byte 32, which is no multiple of a sector of 4096 bytes",
        ),
        (
            LayoutError::NoPlace {
                required: 12288,
                capacity: 8192,
            },
            "the store ends at byte 12288 of a flash of 8192 bytes",
        ),
    ]);
    assert_texts(&[
        (
            OriginError::LensTooLong,
            "the lens has more than 32 bytes of UTF-8",
        ),
        (
            OriginError::LaboratoryTooLong,
            "the laboratory has more than 48 bytes of UTF-8",
        ),
        (
            OriginError::ControlCharacter,
            "lens or laboratory has a control character",
        ),
        (OriginError::Date, "the date is not a day as 2026-05-17"),
    ]);
}

#[test]
fn key_and_signature_are_shown_as_hexadecimal_digits_in_order() {
    let mut bytes = [0; 64];
    for (place, byte) in bytes.iter_mut().zip(0_u8..) {
        *place = byte * 4;
    }
    let digits = |bytes: &[u8]| -> String {
        let digits: Vec<String> = bytes.iter().map(|it| format!("{it:02x}")).collect();
        digits.concat()
    };
    let shown = format!("{:?}", Signature::new(&bytes));
    assert_eq!(shown, digits(&bytes));
    assert_eq!(&shown[..8], "0004080c");
    let key = PublicKey::new([0x0b; 32]);
    assert_eq!(format!("{key:?}"), "0b".repeat(32));
}
