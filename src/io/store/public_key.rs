//! Public key of a laboratory, by which a camera knows its signatures.

use core::fmt;

use curve25519_dalek::edwards::{CompressedEdwardsY, EdwardsPoint};
use curve25519_dalek::scalar::Scalar;
use sha2::{Digest as _, Sha512};

use super::authentication::{Signature, SignatureVerifier};

/// Public key of Ed25519 (RFC 8032).
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct PublicKey([u8; Self::BYTES]);

impl PublicKey {
    /// Number of bytes.
    pub const BYTES: usize = 32;

    /// Returns the key of these bytes. Bytes that are no key verify no signature.
    #[must_use]
    pub const fn new(bytes: [u8; Self::BYTES]) -> Self {
        Self(bytes)
    }

    /// Reads a key as `host-sim sign key` and `openssl pkey -pubout` write it (PEM, RFC 8410);
    /// `None` for another text. A firmware includes such a file and reads it when it is compiled.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::io::store::PublicKey;
    ///
    /// const KEY: Option<PublicKey> = PublicKey::from_pem(
    ///     "-----BEGIN PUBLIC KEY-----\n\
    ///      MCowBQYDK2VwAyEAGb9ECWmEzf6FQbrBZ9w7lshQhqowtrbLDFw4rXAxZuE=\n\
    ///      -----END PUBLIC KEY-----\n",
    /// );
    /// assert!(KEY.is_some_and(|key| key.bytes()[..2] == [0x19, 0xbf]));
    /// ```
    #[must_use]
    pub const fn from_pem(text: &str) -> Option<Self> {
        let mut rest = text.as_bytes();
        // Lines that explain the key may stand in front.
        while let [_, behind @ ..] = rest {
            if let Some(key) = strip(rest, BEGIN) {
                return Self::from_base64(strip_line_end(key));
            }
            rest = behind;
        }
        None
    }

    /// Reads the line between the first and the last.
    const fn from_base64(text: &[u8]) -> Option<Self> {
        let Some(mut rest) = strip(text, ALGORITHM) else {
            return None;
        };
        let mut key = [0; Self::BYTES];
        let mut left: &mut [u8] = &mut key;
        loop {
            let (digits, behind) = match rest {
                [first, second, third, fourth, behind @ ..] => {
                    ([*first, *second, *third, *fourth], behind)
                }
                _ => return None,
            };
            let [first, second, third, fourth] = digits;
            let (Some(first), Some(second), Some(third)) =
                (six_bits(first), six_bits(second), six_bits(third))
            else {
                return None;
            };
            let start = [first << 2 | second >> 4, second << 4 | third >> 2];
            match left {
                [high, middle, low, others @ ..] => {
                    let Some(fourth) = six_bits(fourth) else {
                        return None;
                    };
                    [*high, *middle] = start;
                    *low = third << 6 | fourth;
                    left = others;
                }
                // 32 bytes end with two, and two bits that are zero.
                [high, low] => {
                    [*high, *low] = start;
                    let is_end = fourth == b'=' && third % 4 == 0;
                    let is_whole = is_end && strip(strip_line_end(behind), END).is_some();
                    return if is_whole { Some(Self(key)) } else { None };
                }
                _ => return None,
            }
            rest = behind;
        }
    }

    /// The bytes.
    #[must_use]
    pub const fn bytes(&self) -> &[u8; Self::BYTES] {
        &self.0
    }

    /// Returns R as it has to be.
    fn expected(&self, message: &[&[u8]], signature: &Signature) -> Option<[u8; 32]> {
        let key = CompressedEdwardsY(self.0).decompress()?;
        let s = Scalar::from_canonical_bytes(signature.s).into_option()?;
        let mut hash = Sha512::new();
        hash.update(signature.r);
        hash.update(self.0);
        for piece in message {
            hash.update(piece);
        }
        let k = Scalar::from_bytes_mod_order_wide(&hash.finalize().into());
        let r = EdwardsPoint::mul_base(&s) - key * k;
        let is_weak = key.is_small_order() || r.is_small_order();
        (!is_weak).then(|| r.compress().to_bytes())
    }
}

impl SignatureVerifier for PublicKey {
    /// Returns `true` if a signature of a message, in pieces, is that of this key.
    ///
    /// # Model
    /// RFC 8032, section 5.1.7, without the cofactor: k = SHA-512(R ‖ A ‖ message), and S·B − k·A
    /// has to be encoded as R is. As `verify_strict` of `ed25519-dalek`, it refuses an S that is
    /// not below the order of the group, and a key or an R of small order. Group, field and hash
    /// are those of `curve25519-dalek` and `sha2`.
    ///
    /// # Accuracy
    /// A test compares it with `ed25519-dalek` for every bit of signature, key and message.
    fn verifies(&self, message: &[&[u8]], signature: &Signature) -> bool {
        self.expected(message, signature)
            .is_some_and(|r| r == signature.r)
    }
}

impl fmt::Debug for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// First line of a public key in PEM.
const BEGIN: &[u8] = b"-----BEGIN PUBLIC KEY-----";

/// Beginning of the last line.
const END: &[u8] = b"-----END PUBLIC KEY-----";

/// The 12 bytes in front of a key of Ed25519 (DER, RFC 8410, section 4), in base 64.
const ALGORITHM: &[u8] = b"MCowBQYDK2VwAyEA";

/// Returns what stands behind a beginning; `None` if the text begins otherwise.
const fn strip<'a>(mut text: &'a [u8], mut beginning: &[u8]) -> Option<&'a [u8]> {
    while let [expected, others @ ..] = beginning {
        match text {
            [first, rest @ ..] if *first == *expected => text = rest,
            _ => return None,
        }
        beginning = others;
    }
    Some(text)
}

/// Returns a text without the end of a line in front of it.
const fn strip_line_end(text: &[u8]) -> &[u8] {
    match text {
        [b'\r', b'\n', rest @ ..] | [b'\n', rest @ ..] => rest,
        _ => text,
    }
}

/// Value of a digit of base 64 (RFC 4648).
const fn six_bits(digit: u8) -> Option<u8> {
    match digit {
        b'A'..=b'Z' => Some(digit - b'A'),
        b'a'..=b'z' => Some(digit - b'a' + 26),
        b'0'..=b'9' => Some(digit - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    }
}
