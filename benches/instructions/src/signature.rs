//! Verification of the signature of a calibration without grids.

use core::hint::black_box;

use fmc_camera::io::store::{PublicKey, Signature, SignatureVerifier};

use crate::counter::Counter;

const KEY: Option<PublicKey> = PublicKey::from_pem(include_str!(
    "../../../src/bin/firmware/test-public-key.pem"
));

/// Length of the message: about that of a statement.
const BYTES: usize = 700;

/// Signature of the message by the test key: `openssl pkeyutl -sign -rawin`.
const SIGNATURE: [u8; Signature::BYTES] = [
    0x63, 0xc8, 0x09, 0x03, 0x9b, 0xfe, 0x37, 0xf6, 0x81, 0xc6, 0xf0, 0x70, 0xdf, 0xe8, 0x6a, 0xdd,
    0x9e, 0x20, 0x75, 0x6b, 0x38, 0x6a, 0x04, 0x71, 0xca, 0x12, 0x72, 0x31, 0x37, 0x62, 0xb2, 0xb5,
    0xbc, 0x60, 0x19, 0xa6, 0x30, 0x76, 0xf1, 0xc3, 0x38, 0x10, 0x29, 0x74, 0x84, 0xd2, 0x63, 0x1a,
    0x9b, 0x10, 0x90, 0x68, 0x00, 0x0b, 0x47, 0x1a, 0xaf, 0x55, 0x9f, 0xd4, 0xb5, 0x31, 0xf7, 0x0b,
];

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    let mut message = [0; BYTES];
    for (byte, number) in message.iter_mut().zip(0_u32..) {
        [*byte, ..] = (7 * number + 3).to_le_bytes();
    }
    let (key, signature) = (KEY?, Signature::new(&SIGNATURE));
    counter.count("signature", (1, "signature"), || {
        black_box(key)
            .verifies(&[black_box(&message)], &signature)
            .then_some(())
    })
}
