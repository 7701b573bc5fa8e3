//! Detached Ed25519 signatures, with keys in the files that `openssl genpkey` writes.

use ed25519_dalek::pkcs8::spki::der::pem::LineEnding;
use ed25519_dalek::pkcs8::{
    DecodePrivateKey, DecodePublicKey, EncodePrivateKey, EncodePublicKey, KeypairBytes,
};
use ed25519_dalek::{Signature, Signer, SigningKey, VerifyingKey};
use fmc_camera_file::InputError;
use fmc_report::hash;

/// Length of a signature, bytes.
pub const LENGTH: usize = Signature::BYTE_SIZE;

/// A private key.
#[derive(Debug, Clone)]
pub struct PrivateKey(SigningKey);

/// A public key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

impl PrivateKey {
    /// Number of secret bytes.
    pub const BYTES: usize = ed25519_dalek::SECRET_KEY_LENGTH;

    /// Returns the key of these bytes, which have to be random and secret.
    #[must_use]
    pub fn of_random(bytes: &[u8; Self::BYTES]) -> Self {
        Self(SigningKey::from_bytes(bytes))
    }

    /// Returns the key as PEM, as `openssl genpkey` writes it; `None` only if it cannot be written.
    #[must_use]
    pub fn pem(&self) -> Option<String> {
        let bytes = KeypairBytes {
            secret_key: self.0.to_bytes(),
            // OpenSSL reads no private key with its public key behind it.
            public_key: None,
        };
        Some(bytes.to_pkcs8_pem(LineEnding::LF).ok()?.to_string())
    }

    /// Reads a private key, PEM as PKCS #8 has it; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] for a file that is none, or is encrypted.
    pub fn parse(file: &str, text: &str) -> Result<Self, InputError> {
        if text.contains("BEGIN ENCRYPTED PRIVATE KEY") {
            return Err(
                InputError::invalid(format!("{file}: the key is encrypted")).with_help(
                    "openssl pkey -in ENCRYPTED.pem -out KEY.pem, on a disk that nobody else reads",
                ),
            );
        }
        SigningKey::from_pkcs8_pem(text).map(Self).map_err(|_| {
            InputError::invalid(format!("{file}: no private key of Ed25519 (PKCS #8, PEM)"))
                .with_help("openssl genpkey -algorithm ed25519 -out KEY.pem writes one")
        })
    }

    /// Returns the public key that belongs to it.
    #[must_use]
    pub fn public(&self) -> PublicKey {
        PublicKey(self.0.verifying_key())
    }

    /// Signs bytes: the same bytes have the same signature (RFC 8032).
    #[must_use]
    pub fn sign(&self, bytes: &[u8]) -> [u8; LENGTH] {
        self.0.sign(bytes).to_bytes()
    }
}

impl PublicKey {
    /// Reads a public key, PEM; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] for a file that is none.
    pub fn parse(file: &str, text: &str) -> Result<Self, InputError> {
        VerifyingKey::from_public_key_pem(text)
            .map(Self)
            .map_err(|_| {
                InputError::invalid(format!("{file}: no public key of Ed25519 (PEM)"))
                    .with_help("openssl pkey -in KEY.pem -pubout writes that of a private key")
            })
    }

    /// The bytes.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; 32] {
        self.0.to_bytes()
    }

    /// Returns the key of these bytes; `None` if they are none.
    #[must_use]
    pub fn of_bytes(bytes: &[u8; 32]) -> Option<Self> {
        VerifyingKey::from_bytes(bytes).ok().map(Self)
    }

    /// Returns the key as PEM; `None` only if it cannot be written.
    #[must_use]
    pub fn pem(&self) -> Option<String> {
        self.0.to_public_key_pem(LineEnding::LF).ok()
    }

    /// Returns the SHA-256 of the key as DER, in hexadecimal digits.
    #[must_use]
    pub fn sha256(&self) -> Option<String> {
        let der = self.0.to_public_key_der().ok()?;
        Some(hash::sha256(der.as_bytes()))
    }

    /// Returns true if a signature of bytes is that of this key.
    #[must_use]
    pub fn verifies(&self, bytes: &[u8], signature: &[u8]) -> bool {
        Signature::from_slice(signature)
            .is_ok_and(|signature| self.0.verify_strict(bytes, &signature).is_ok())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Key of RFC 8410, section 10.3.
    const KEY: &str = "-----BEGIN PRIVATE KEY-----\n\
                       MC4CAQAwBQYDK2VwBCIEINTuctv5E1hK1bbY8fdp+K06/nwoy/HU++CXqI9EdVhC\n\
                       -----END PRIVATE KEY-----\n";
    /// Public key of RFC 8410, section 10.1.
    const PUBLIC: &str = "-----BEGIN PUBLIC KEY-----\n\
                          MCowBQYDK2VwAyEAGb9ECWmEzf6FQbrBZ9w7lshQhqowtrbLDFw4rXAxZuE=\n\
                          -----END PUBLIC KEY-----\n";

    #[test]
    fn signature_is_that_of_its_key_and_bytes_alone() {
        let key = PrivateKey::parse("key.pem", KEY).unwrap();
        assert_eq!(key.pem().unwrap(), KEY);
        assert_eq!(
            PublicKey::of_bytes(&key.public().to_bytes()),
            Some(key.public())
        );
        let public = PublicKey::parse("public.pem", PUBLIC).unwrap();
        assert_eq!(key.public(), public);
        assert_eq!(public.pem().unwrap(), PUBLIC);
        let signature = key.sign(b"certificate");
        assert_eq!(signature, key.sign(b"certificate"));
        assert!(public.verifies(b"certificate", &signature));
        assert!(!public.verifies(b"Certificate", &signature));
        assert!(!public.verifies(b"certificate", &signature[1..]));
        let mut other = signature;
        other[5] ^= 1;
        assert!(!public.verifies(b"certificate", &other));
    }

    #[test]
    fn what_is_no_key_is_refused_with_advice() {
        let encrypted = KEY.replace("PRIVATE", "ENCRYPTED PRIVATE");
        for text in ["", "key", PUBLIC, &encrypted] {
            let error = PrivateKey::parse("key.pem", text).unwrap_err();
            assert!(error.to_string().contains("key.pem") && error.help().is_some());
        }
        assert!(PublicKey::parse("p", KEY).is_err());
    }
}
