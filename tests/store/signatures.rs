//! Signatures: what is not signed by the owner of the key is neither stored nor used.

use ed25519_dalek::{Signature as DalekSignature, Signer as _, SigningKey};
use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::grid_memory::GridMemory;
use fmc_camera::geometry::grid::{GridCarrier, GridChecksums, ResidualGrid};
use fmc_camera::io::store::{
    CalibrationStore, NotStored, Origin, Permission, PublicKey, SEAL_WORDS, Signature,
    SignatureVerifier as _, SlotFault, StoreOrder,
};

use crate::geometry::spline::wave;
use crate::store::calibrations::calibration;
use crate::store::flash_model::FlashModel;
use crate::store::grids::grid;
use crate::store::images::{cells, crc_of, image_of, with_crcs};
use crate::store::signed::{
    NO_GRIDS, laboratory, public, signed, signed_by, signed_flash, trusting_store,
};

/// Checks that a store of version 7 refuses a calibration, does not touch the flash, and holds
/// version 7 still.
fn assert_refused(
    store: &mut CalibrationStore<FlashModel>,
    parameters: &CameraParameters,
    order: &StoreOrder,
    reason: NotStored,
) {
    let refused = store.store(parameters, order, None);
    assert_eq!(refused, Err(reason));
    assert_eq!(store.flash_mut().operations, [], "{reason}");
    assert_eq!(store.load(None).unwrap().parameters, calibration(7));
}

#[test]
fn calibration_without_signature_or_with_that_of_another_key_is_refused() {
    let mut store = trusting_store(signed_flash(&[7]));
    let next = calibration(8);
    let mut unsigned = signed(8);
    unsigned.authentication = None;
    assert_refused(&mut store, &next, &unsigned, NotStored::Unsigned);
    let stranger = SigningKey::from_bytes(&[8; 32]);
    let foreign = signed_by(&stranger, &next, None, NO_GRIDS);
    assert_refused(&mut store, &next, &foreign, NotStored::WrongSignature);
    let stored = store.store(&next, &signed(8), None).unwrap();
    assert_eq!(stored.parameters, next);
}

#[test]
fn signature_holds_for_its_own_numbers_origin_and_permission_alone() {
    let mut store = trusting_store(signed_flash(&[7]));
    let number = |change: fn(&mut CameraParameters)| {
        let mut parameters = calibration(8);
        change(&mut parameters);
        (parameters, signed(8))
    };
    let said = |change: fn(&mut StoreOrder)| {
        let mut order = signed(8);
        change(&mut order);
        (calibration(8), order)
    };
    for (parameters, order) in [
        number(|parameters| parameters.version = 9),
        number(|parameters| parameters.calibration.principal_distance_mm = 51.5),
        number(|parameters| parameters.limits.exposure_s[1] *= 1.5),
        (calibration(8), signed(9)),
        said(|order| order.origin = Origin::default()),
        said(|order| order.origin = Origin::new("", "", order.origin.date()).unwrap()),
        said(|order| {
            let permission = Permission { store: 1, crc: 0 };
            order.authentication.as_mut().unwrap().permission = Some(permission);
        }),
    ] {
        assert_refused(&mut store, &parameters, &order, NotStored::WrongSignature);
    }
}

#[test]
fn signed_calibration_of_another_camera_or_of_none_is_refused() {
    let mut store = trusting_store(signed_flash(&[7]));
    let camera = calibration(7).serial;
    let mut other = calibration(8);
    other.serial = SerialNumber::new("RC30-5283").unwrap();
    let order = signed_by(&laboratory(), &other, None, NO_GRIDS);
    assert_refused(
        &mut store,
        &other,
        &order,
        NotStored::OtherCamera { camera },
    );
    let mut nameless = calibration(8);
    nameless.serial = SerialNumber::EMPTY;
    let order = signed_by(&laboratory(), &nameless, None, NO_GRIDS);
    assert_refused(&mut store, &nameless, &order, NotStored::NoSerial);
    // A blank store of a camera that knows its own number.
    let mut blank = trusting_store(FlashModel::blank()).of_camera(camera);
    let order = signed_by(&laboratory(), &other, None, NO_GRIDS);
    let refused = blank.store(&other, &order, None);
    assert_eq!(refused, Err(NotStored::OtherCamera { camera }));
    assert_eq!(blank.flash_mut().operations, []);
}

#[test]
fn firmware_without_a_key_uses_and_stores_nothing() {
    let mut store = CalibrationStore::new(signed_flash(&[6, 7]), 0).unwrap();
    let nothing = store.load(None).unwrap_err();
    assert_eq!(nothing.slots, [SlotFault::NoKey; 2]);
    let refused = store.store(&calibration(8), &signed(8), None);
    assert_eq!(refused, Err(NotStored::NoKey));
    assert_eq!(store.flash_mut().operations, []);
    // With the key of another laboratory neither.
    let stranger = public(&SigningKey::from_bytes(&[8; 32]));
    let mut store = store.trusting(stranger);
    let nothing = store.load(None).unwrap_err();
    assert_eq!(nothing.slots, [SlotFault::WrongSignature; 2]);
}

#[test]
fn no_bit_of_a_signed_slot_can_be_changed_even_with_the_right_crcs() {
    let flash = signed_flash(&[6, 7]);
    let second = image_of(&flash.sectors[1]);
    let body = (1 + usize::from(SEAL_WORDS)) * 32;
    let (mut wrong, mut otherwise, mut same) = (0, 0, 0);
    for bit in 8 * body..8 * second.len() {
        let mut slot = second.clone();
        slot[bit / 8] ^= 1 << (bit % 8);
        let mut changed = flash.clone();
        changed.sectors[1] = cells(&with_crcs(slot));
        let found = trusting_store(changed).load(None).unwrap();
        let version = found.parameters.version;
        match found.identity.other {
            Some(SlotFault::WrongSignature) => wrong += 1,
            Some(_) => otherwise += 1,
            // The highest version of all that were stored, and the zeros at the end, are not
            // signed.
            None => same += 1,
        }
        let is_other = found.identity.other.is_some();
        assert_eq!(version, if is_other { 6 } else { 7 }, "bit {bit}");
        assert_eq!(found.parameters, calibration(if is_other { 6 } else { 7 }));
    }
    assert!(
        wrong > 1800 && otherwise > 300,
        "{wrong}, {otherwise}, {same}"
    );
    assert!(same < 8 * 32, "{same}");
}

#[test]
fn wrong_signatures_of_both_slots_are_named_and_the_next_store_mends_them() {
    let mut flash = signed_flash(&[6, 7]);
    for sector in &mut flash.sectors {
        // In the signature, behind length and origin.
        let mut slot = image_of(sector);
        let at = (1 + usize::from(SEAL_WORDS)) * 32 + 2 + 3 + 28 + 39 + 10 + 5;
        slot[at] ^= 1;
        *sector = cells(&with_crcs(slot));
    }
    let mut store = trusting_store(flash);
    let nothing = store.load(None).unwrap_err();
    assert_eq!(nothing.slots, [SlotFault::WrongSignature; 2]);
    let stored = store.store(&calibration(5), &signed(5), None).unwrap();
    assert_eq!(store.load(None).unwrap().parameters, stored.parameters);
}

/// Returns a file with other nodes and the same CRC-32: the last bits of some coefficients are
/// changed so that their contributions, which are linear, cancel.
fn forged(file: &[u8]) -> Vec<u8> {
    let body = file.len() - 4;
    let crc = crc_of(&file[..body]);
    // Last bits of the last 40 coefficients, and the change of the CRC-32 that each makes, with the
    // set of bits that makes it.
    let mut basis: Vec<(u32, u64)> = Vec::new();
    for number in 0..40_u64 {
        let at = body - 2 * (usize::try_from(number).unwrap() + 1);
        let mut changed = file[..body].to_vec();
        changed[at] ^= 1;
        let mut vector = (crc_of(&changed) ^ crc, 1 << number);
        for (change, set) in &basis {
            if vector.0 ^ change < vector.0 {
                vector = (vector.0 ^ change, vector.1 ^ set);
            }
        }
        if vector.0 == 0 {
            let mut forged = file.to_vec();
            for number in (0..40).filter(|number| vector.1 >> number & 1 == 1) {
                forged[body - 2 * (number + 1)] ^= 1;
            }
            return forged;
        }
        basis.push(vector);
        basis.sort_unstable_by(|one, other| other.cmp(one));
    }
    panic!("33 vectors of 32 bits are independent");
}

#[test]
fn grid_with_other_nodes_and_the_same_crc_is_refused_and_not_used() {
    let genuine = grid(GridCarrier::Lens, wave);
    let forged = forged(&genuine);
    let crc32 = ResidualGrid::parse(&genuine).unwrap().crc32();
    assert_eq!(ResidualGrid::parse(&forged).unwrap().crc32(), crc32);
    assert_ne!(forged, genuine);
    let mut parameters = calibration(8);
    parameters.grids = GridChecksums {
        lens: Some(crc32),
        sensor: None,
    };
    let order = signed_by(&laboratory(), &parameters, None, [&genuine, &[]]);
    let in_use = |file: &[u8]| {
        let mut memory = Box::new(GridMemory::EMPTY);
        memory.spare_mut(GridCarrier::Lens).add(file).unwrap();
        memory.spare_mut(GridCarrier::Lens).check().unwrap();
        memory
            .put_into_use(&Camera::new(parameters).unwrap())
            .unwrap();
        memory
    };
    let mut store = trusting_store(signed_flash(&[7]));
    let refused = store.store(&parameters, &order, Some(&mut in_use(&forged)));
    assert_eq!(refused, Err(NotStored::WrongSignature));
    assert_eq!(store.flash_mut().operations, []);
    // While the genuine one is stored, the forged one waits beside it: it is gone afterwards.
    let mut memory = in_use(&genuine);
    memory.spare_mut(GridCarrier::Lens).add(&forged).unwrap();
    memory.spare_mut(GridCarrier::Lens).check().unwrap();
    let stored = store.store(&parameters, &order, Some(&mut memory));
    assert_eq!(stored.unwrap().parameters, parameters);
    assert_ne!(memory.spare_mut(GridCarrier::Lens).bytes(), forged);
    // The forged one in the place of the genuine one in flash.
    let mut flash = store.into_flash().started();
    let mut slot = image_of(&flash.sectors[1]);
    let at = slot
        .windows(32)
        .position(|word| word == &genuine[..32])
        .unwrap();
    slot[at..at + forged.len()].copy_from_slice(&forged);
    flash.sectors[1] = cells(&with_crcs(slot));
    let mut memory = Box::new(GridMemory::EMPTY);
    let found = trusting_store(flash).load(Some(&mut memory)).unwrap();
    assert_eq!(found.identity.other, Some(SlotFault::WrongSignature));
    assert_eq!(found.parameters, calibration(7));
}

/// Tests 1 to 3 of RFC 8032, section 7.1: private key, message, and the first bytes of the
/// signature.
const VECTORS: [(&str, &str, &str); 3] = [
    (
        "9d61b19deffd5a60ba844af492ec2cc44449c5697b326919703bac031cae7f60",
        "",
        "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e06522490155",
    ),
    (
        "4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb",
        "72",
        "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da",
    ),
    (
        "c5aa8df43f9f837bedb7442f31dcb7b166d38535076f094b85ce3a2e0b4458f7",
        "af82",
        "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac",
    ),
];

fn bytes(hex: &str) -> Vec<u8> {
    let digits = hex.as_bytes().chunks(2);
    digits
        .map(|pair| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap())
        .collect()
}

#[test]
fn published_signatures_are_verified_and_none_with_any_other_bit() {
    for (private, message, r) in VECTORS {
        let key = SigningKey::from_bytes(&bytes(private).try_into().unwrap());
        let message = bytes(message);
        let signature = key.sign(&message).to_bytes();
        assert_eq!(signature[..32], bytes(r));
        let (public, verifying) = (public(&key), key.verifying_key());
        assert!(public.verifies(&[&message], &Signature::new(&signature)));
        assert_eq!(Signature::new(&signature).to_bytes(), signature);
        for bit in 0..512 {
            let mut other = signature;
            other[bit / 8] ^= 1 << (bit % 8);
            assert!(
                !public.verifies(&[&message], &Signature::new(&other)),
                "{bit}"
            );
            let other = DalekSignature::from_bytes(&other);
            assert!(verifying.verify_strict(&message, &other).is_err());
        }
        for bit in 0..256 {
            let mut other = *public.bytes();
            other[bit / 8] ^= 1 << (bit % 8);
            let other = PublicKey::new(other);
            assert!(
                !other.verifies(&[&message], &Signature::new(&signature)),
                "{bit}"
            );
        }
        let longer = [&message[..], &[0]];
        assert!(!public.verifies(&longer, &Signature::new(&signature)));
    }
}

#[test]
fn message_in_pieces_has_the_signature_of_the_whole_for_every_length_of_a_block() {
    let key = laboratory();
    let message: Vec<u8> = (0..300_u16).map(|number| number.to_le_bytes()[0]).collect();
    for length in 0..message.len() {
        let message = &message[..length];
        let signature = Signature::new(&key.sign(message).to_bytes());
        let (first, rest) = message.split_at(length / 3);
        let (second, third) = rest.split_at(rest.len() / 2);
        let pieces = [first, second, third];
        assert!(public(&key).verifies(&pieces, &signature), "{length}");
        assert!(!public(&key).verifies(&pieces[..2], &signature) || third.is_empty());
    }
}

/// Order of the group, little endian: an S that is larger by it satisfies the same equation.
const ORDER: &str = "edd3f55c1a631258d69cf7a2def9de1400000000000000000000000000000010";

#[test]
fn key_of_small_order_and_a_scalar_that_is_not_reduced_verify_nothing() {
    let key = laboratory();
    let mut signature = key.sign(b"message").to_bytes();
    let mut carry = 0;
    for (byte, add) in signature[32..].iter_mut().zip(bytes(ORDER)) {
        let sum = u16::from(*byte) + u16::from(add) + carry;
        let [low, high] = sum.to_le_bytes();
        (*byte, carry) = (low, high.into());
    }
    assert_eq!(carry, 0);
    assert!(!public(&key).verifies(&[b"message"], &Signature::new(&signature)));
    // With the neutral element as key and as R, and with S = 0, the equation holds for every
    // message.
    let mut neutral = [0; 32];
    neutral[0] = 1;
    let mut signature = [0; 64];
    signature[0] = 1;
    let weak = PublicKey::new(neutral);
    assert!(!weak.verifies(&[b"message"], &Signature::new(&signature)));
    for bytes in [[0xff; 32], [2; 32]] {
        assert!(!PublicKey::new(bytes).verifies(&[b"message"], &Signature::new(&signature)));
    }
}

#[test]
fn public_key_is_read_from_the_file_that_openssl_writes_and_from_no_other() {
    // RFC 8410, section 10.1.
    let line = "MCowBQYDK2VwAyEAGb9ECWmEzf6FQbrBZ9w7lshQhqowtrbLDFw4rXAxZuE=";
    let of = |begin: &str, line: &str, end: &str| PublicKey::from_pem(&[begin, line, end].concat());
    let (begin, end) = (
        "-----BEGIN PUBLIC KEY-----\n",
        "\n-----END PUBLIC KEY-----\n",
    );
    let key = "19bf44096984cdfe8541bac167dc3b96c85086aa30b6b6cb0c5c38ad703166e1";
    let key: [u8; 32] = bytes(key).try_into().unwrap();
    assert_eq!(of(begin, line, end), Some(PublicKey::new(key)));
    let windows = begin.replace('\n', "\r\n");
    let explained = format!("a key\n{windows}");
    assert_eq!(
        of(&explained, line, "\r\n-----END PUBLIC KEY-----"),
        Some(PublicKey::new(key))
    );
    let short = &line[4..];
    let private = begin.replace("PUBLIC", "PRIVATE");
    for (begin, line, end) in [
        ("", "", ""),
        ("", line, end),
        (begin, "", ""),
        (begin, line, ""),
        (begin, short, end),
        (&private, line, end),
        (begin, &line.replace("VwA", "VuA"), end),
        (begin, &line.replace('b', "!"), end),
        (begin, &line.replace("E=", "F="), end),
        (begin, &line.replace('=', ""), end),
        (begin, &format!("{line}="), end),
    ] {
        assert_eq!(of(begin, line, end), None, "{line}");
    }
    // The text ends within a group of four digits, or a group ends with none.
    for cut in 0..line.len() {
        assert_eq!(of(begin, &line[..cut], ""), None, "{cut}");
        let other = format!("{}!{}", &line[..cut], &line[cut + 1..]);
        assert_eq!(of(begin, &other, end), None, "{cut}");
    }
}

#[test]
fn public_key_is_read_with_every_digit_of_base_64() {
    let key: Vec<u8> = [0xfb, 0xef, 0xbf].repeat(11);
    let mut key: [u8; 32] = key[..32].try_into().unwrap();
    key[30..].fill(0xff);
    let digits = ["+++/".repeat(10), "//8=".to_owned()].concat();
    let text =
        format!("-----BEGIN PUBLIC KEY-----\nMCowBQYDK2VwAyEA{digits}\n-----END PUBLIC KEY-----\n");
    assert_eq!(PublicKey::from_pem(&text), Some(PublicKey::new(key)));
}
