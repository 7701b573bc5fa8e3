//! A camera's calibration in flash: two slots, of which one is always whole.
//!
//! # Layout
//! A slot is a number of whole sectors, in words of [`WORD_BYTES`] bytes that are written once
//! between two erasures. Word 0 is the *commit word*, which is written last and makes a record of
//! what lies behind; the next [`SEAL_WORDS`] are *seals*; then come the words of the record's
//! *body*: origin, signature, probe point and parameters of the camera, and the files of its
//! residual grids.
//!
//! # Writing
//! Only the slot is written that is not the newest good one, in this order: erasure, body, body
//! read back and compared, commit word, read back, first seal, read back. The other slot stays as
//! it is until the next store. A supply that fails in between leaves the old record or the new.
//!
//! A commit word whose write was cut may read as whole now and as damaged later. A seal is begun
//! only after the commit word has been written to its end, so a slot in which any seal is not
//! blank has a sound commit word, and the other slot may be erased; before that is done, a further
//! seal is written, because the one that was seen may have been cut itself. A slot without a seal
//! is written again, and the other stays.
//!
//! # Reading
//! A start only reads, so that no number of starts wears the flash. Every word is read once. The
//! newest record is used whose words can be read, whose CRC-32 is right, whose signature is that of
//! the camera's key, whose camera and grids the library's own checks accept, and whose probe point
//! is corrected to the stored bits. Otherwise that of the other slot is used; otherwise
//! [`NothingStored`] names what is wrong with either.
//!
//! `docs/store.md` has the layout in bytes, what is lost when, and how every cut is tried.
//!
//! # Signatures
//! A [`CalibrationStore`] trusts one public key ([`CalibrationStore::trusting`]), and stores and
//! uses nothing that its owner has not signed: a [`Statement`] of everything that is stored. The
//! private key is never on a camera. Versions rise; one that does not needs a signed
//! [`Permission`] that names the store it follows, so that it has an effect once.
//!
//! # Without the feature `store`
//! The link alone has what its messages tell: [`Origin`], [`StoreOrder`], [`StoredIdentity`] and
//! the faults; and [`Statement`], for who signs.

mod authentication;
#[cfg(feature = "store")]
mod body;
#[cfg(feature = "store")]
mod calibration_store;
#[cfg(feature = "store")]
mod commit;
mod fault;
#[cfg(feature = "store")]
mod head;
#[cfg(feature = "store")]
mod judgement;
mod layout;
mod origin;
#[cfg(feature = "store")]
mod probe_point;
#[cfg(feature = "store")]
mod public_key;
#[cfg(feature = "store")]
pub mod record_flash;
#[cfg(feature = "store")]
pub mod record_ring;
#[cfg(feature = "store")]
mod ring_entry;
#[cfg(feature = "store")]
mod slot;
mod statement;
mod stored_identity;
#[cfg(feature = "store")]
mod succession;

pub use authentication::{Authentication, Permission, Signature, SignatureVerifier, StoreOrder};
#[cfg(feature = "store")]
pub use calibration_store::{CalibrationStore, StoredCalibration};
pub use fault::{NotStored, NothingStored, SlotFault, StoreStep};
pub use layout::{
    FORMAT_VERSION, LayoutError, MAX_BODY_WORDS, MAX_SLOT_BYTES, OLDEST_FORMAT, SEAL_WORDS,
    WORD_BYTES,
};
pub use origin::{DATE_BYTES, LABORATORY_BYTES, LENS_BYTES, Origin, OriginError};
#[cfg(feature = "store")]
pub use probe_point::ProbePoint;
#[cfg(feature = "store")]
pub use public_key::PublicKey;
pub use statement::Statement;
pub use stored_identity::StoredIdentity;
