//! Signature of a calibration, and permission to store one that is older.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::origin::Origin;

/// Signature of Ed25519 (RFC 8032) over a [`Statement`](super::Statement).
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Signature {
    /// Point R, encoded.
    pub(super) r: [u8; 32],
    /// Scalar S, little endian.
    pub(super) s: [u8; 32],
}

impl Signature {
    /// Number of bytes.
    pub const BYTES: usize = 64;

    /// Returns the signature of these bytes, R before S.
    #[must_use]
    pub fn new(bytes: &[u8; Self::BYTES]) -> Self {
        let [mut r, mut s] = [[0; 32]; 2];
        let places = r.iter_mut().chain(&mut s);
        for (place, byte) in places.zip(bytes) {
            *place = *byte;
        }
        Self { r, s }
    }

    /// Returns the bytes, R before S.
    #[must_use]
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        for (place, byte) in bytes.iter_mut().zip(self.r.iter().chain(&self.s)) {
            *place = *byte;
        }
        bytes
    }
}

impl fmt::Debug for Signature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.r
            .iter()
            .chain(&self.s)
            .try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Verification of signatures by a public key that a firmware has. With the feature `store`
/// `PublicKey` is one, in code alone; a board may have another, such as a secure element.
pub trait SignatureVerifier {
    /// Returns `true` if a signature of a message, in pieces, is that of the key.
    fn verifies(&self, message: &[&[u8]], signature: &Signature) -> bool;
}

/// Permission to store a calibration whose version is not higher than all that were stored, once:
/// it names the store that it follows. After that store there is another number, so that the same
/// permission has no effect a second time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Permission {
    /// Number of the store whose calibration is stored now
    /// ([`StoredIdentity::store`](super::StoredIdentity::store)).
    pub store: u32,
    /// CRC-32 of that calibration, as its identity has it.
    pub crc: u32,
}

impl fmt::Display for Permission {
    /// `store 7, CRC-32 deadbeef`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "store {}, CRC-32 {:08x}", self.store, self.crc)
    }
}

/// Proof that the owner of the key wants a calibration to be stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Authentication {
    /// Signature of the statement, the permission included.
    pub signature: Signature,
    /// Permission that is a part of the statement; `None` for a version that is higher than all
    /// that were stored.
    pub permission: Option<Permission>,
}

/// Statements about a calibration that is to be stored.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StoreOrder {
    /// Lens, laboratory and date.
    pub origin: Origin,
    /// `None` for a calibration that is not signed: no store takes it.
    pub authentication: Option<Authentication>,
}
