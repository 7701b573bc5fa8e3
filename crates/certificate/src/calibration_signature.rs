//! File of the signature by which a camera stores a calibration.

use fmc_camera::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
use fmc_camera::flight::camera::CameraParameters;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera::io::link::digest;
use fmc_camera::io::store::{Authentication, Origin, Permission, Signature, Statement, StoreOrder};
use fmc_camera_file::{GridFiles, InputError};
use fmc_report::hash;
use serde::{Deserialize, Serialize};

use crate::details::Details;
use crate::signature::{PrivateKey, PublicKey};

/// First entry of the file.
const FORMAT: &str = "signature of a calibration for the store of a camera, 1";

/// Signature of a calibration, with what is signed but the numbers, which are in the camera file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalibrationSignature {
    id: CalibrationId,
    origin: Origin,
    authentication: Authentication,
    key: PublicKey,
}

impl CalibrationSignature {
    /// Signs a calibration.
    ///
    /// # Errors
    /// [`InputError`] for a calibration without serial number or version.
    pub fn new(
        key: &PrivateKey,
        camera: &CameraParameters,
        grids: &GridFiles,
        origin: &Origin,
        permission: Option<Permission>,
    ) -> Result<Self, InputError> {
        let lacks = |key: &str| {
            InputError::invalid(format!("{key} is missing")).with_help(
                "a camera stores the calibration of its own serial number alone, and versions rise",
            )
        };
        if camera.serial.is_empty() {
            return Err(lacks("serial"));
        }
        if camera.version == 0 {
            return Err(lacks("version"));
        }
        let message = message(camera, grids, origin, permission)?;
        let authentication = Authentication {
            signature: Signature::new(&key.sign(&message)),
            permission,
        };
        Ok(Self {
            id: identity(camera),
            origin: origin.clone(),
            authentication,
            key: key.public(),
        })
    }

    /// Reads a file; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] for a file that is none.
    pub fn parse(file: &str, text: &str) -> Result<Self, InputError> {
        let invalid = |what: &str| InputError::invalid(format!("{file}: {what}"));
        let of_json = |error: serde_json::Error| {
            invalid(&format!("no signature of a calibration: {error}"))
                .with_help("`host-sim sign` writes one")
        };
        let stated: Stated = serde_json::from_str(text).map_err(of_json)?;
        if stated.format != FORMAT {
            return Err(invalid(&format!(
                "format {:?} is not {FORMAT:?}",
                stated.format
            )));
        }
        let serial = SerialNumber::new(&stated.serial);
        let serial = serial.map_err(|error| invalid(&format!("serial {error}")))?;
        let crc = crc_of(&stated.crc32).ok_or_else(|| invalid("crc32 is no CRC-32"))?;
        let origin = Origin::new(&stated.lens, &stated.laboratory, &stated.date);
        let origin = origin.map_err(|error| invalid(&error.to_string()))?;
        let permission = match &stated.permission {
            Some(StatedPermission { store, crc32 }) => Some(Permission {
                store: *store,
                crc: crc_of(crc32).ok_or_else(|| invalid("permission.crc32 is no CRC-32"))?,
            }),
            None => None,
        };
        let signature = bytes_of(&stated.signature);
        let signature = signature.ok_or_else(|| invalid("signature is not 128 digits"))?;
        let key = bytes_of(&stated.public_key).and_then(|bytes| PublicKey::of_bytes(&bytes));
        let authentication = Authentication {
            signature: Signature::new(&signature),
            permission,
        };
        Ok(Self {
            id: CalibrationId {
                serial,
                version: stated.version,
                crc,
                storage: Storage::Stored,
            },
            origin,
            authentication,
            key: key.ok_or_else(|| invalid("public_key is no key of Ed25519"))?,
        })
    }

    /// Returns the text of the file.
    ///
    /// # Errors
    /// That of the library, for a text that cannot be written.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let origin = &self.origin;
        let permission = self.authentication.permission;
        let stated = Stated {
            format: FORMAT.to_owned(),
            serial: self.id.serial.to_string(),
            version: self.id.version,
            crc32: format!("{:08x}", self.id.crc),
            lens: origin.lens().to_owned(),
            laboratory: origin.laboratory().to_owned(),
            date: origin.date().to_owned(),
            permission: permission.map(|permission| StatedPermission {
                store: permission.store,
                crc32: format!("{:08x}", permission.crc),
            }),
            signature: hash::digits(&self.authentication.signature.to_bytes()),
            public_key: hash::digits(&self.key.to_bytes()),
        };
        Ok(serde_json::to_string_pretty(&stated)? + "\n")
    }

    /// Identity of the calibration that is signed.
    #[must_use]
    pub fn id(&self) -> &CalibrationId {
        &self.id
    }

    /// Order to a camera to store the calibration.
    #[must_use]
    pub fn order(&self) -> StoreOrder {
        StoreOrder {
            origin: self.origin.clone(),
            authentication: Some(self.authentication),
        }
    }

    /// Checks that the signature is that of a calibration, by the public key in the file: a camera
    /// has one of its own.
    ///
    /// # Errors
    /// [`InputError`] for another calibration, and for a file that was changed.
    pub fn check(&self, camera: &CameraParameters, grids: &GridFiles) -> Result<(), InputError> {
        let id = identity(camera);
        if id != self.id {
            return Err(InputError::invalid(format!(
                "the signature is of another calibration: {}, not {id}",
                self.id
            ))
            .with_help("`host-sim sign` signs a camera file as it is now"));
        }
        let Authentication {
            signature,
            permission,
        } = self.authentication;
        let message = message(camera, grids, &self.origin, permission)?;
        if self.key.verifies(&message, &signature.to_bytes()) {
            Ok(())
        } else {
            Err(InputError::invalid(
                "the signature is not that of this calibration, lens, laboratory, date and \
                 permission by the public key beside it",
            ))
        }
    }
}

/// Returns lens, laboratory and date of details as a camera stores them; what is not stated is
/// empty. The lens is its model and serial number.
///
/// # Errors
/// [`InputError`] with what is too long.
pub fn origin_of(details: &Details) -> Result<Origin, InputError> {
    let lens = match (&details.lens.model, &details.lens.serial) {
        (Some(model), Some(serial)) => format!("{model} No. {serial}"),
        (Some(text), None) | (None, Some(text)) => text.clone(),
        (None, None) => String::new(),
    };
    let laboratory = details.laboratory.name.as_deref().unwrap_or_default();
    let date = details.calibrated_on.map(|date| date.to_string());
    Origin::new(&lens, laboratory, &date.unwrap_or_default())
        .map_err(|error| InputError::invalid(error.to_string()))
}

/// Reads which calibration a camera has stored, from what `host-sim camera stored --json` printed;
/// `file` is the name that messages use. Returns the serial number, and the permission to follow
/// that calibration.
///
/// # Errors
/// [`InputError`] for another text, and where nothing is stored.
pub fn stored_in(file: &str, text: &str) -> Result<(String, Permission), InputError> {
    let invalid = |what: &str| {
        InputError::invalid(format!("{file}: {what}"))
            .with_help("`host-sim camera stored --json` prints what a camera has stored")
    };
    let report: StoredReport =
        serde_json::from_str(text).map_err(|error| invalid(&error.to_string()))?;
    let (Some(calibration), Some(store)) = (report.calibration, report.store) else {
        return Err(invalid("no calibration is stored"));
    };
    let crc = crc_of(&calibration.crc32);
    let crc = crc.ok_or_else(|| invalid("calibration.crc32 is no CRC-32"))?;
    Ok((
        calibration.serial.unwrap_or_default(),
        Permission { store, crc },
    ))
}

/// The signature as the file states it.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stated {
    format: String,
    serial: String,
    version: u32,
    crc32: String,
    lens: String,
    laboratory: String,
    date: String,
    permission: Option<StatedPermission>,
    signature: String,
    public_key: String,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StatedPermission {
    store: u32,
    crc32: String,
}

/// Part of a camera's report that a permission needs.
#[derive(Debug, Deserialize)]
struct StoredReport {
    calibration: Option<StoredCalibration>,
    store: Option<u32>,
}

#[derive(Debug, Deserialize)]
struct StoredCalibration {
    serial: Option<String>,
    crc32: String,
}

fn identity(camera: &CameraParameters) -> CalibrationId {
    CalibrationId {
        serial: camera.serial,
        version: camera.version,
        crc: digest::of_camera(camera),
        storage: Storage::Stored,
    }
}

/// Returns the bytes that are signed.
fn message(
    camera: &CameraParameters,
    grids: &GridFiles,
    origin: &Origin,
    permission: Option<Permission>,
) -> Result<Vec<u8>, InputError> {
    let files = [GridCarrier::Lens, GridCarrier::Sensor];
    let files = files.map(|carrier| grids.bytes(carrier).unwrap_or_default());
    Statement::of(camera, origin, permission, files)
        .map(|statement| statement.pieces().concat())
        .ok_or_else(|| InputError::invalid("the calibration is longer than a camera can store"))
}

fn crc_of(digits: &str) -> Option<u32> {
    bytes_of(digits).map(u32::from_be_bytes)
}

/// Returns the bytes of hexadecimal digits; `None` for another number of them.
fn bytes_of<const BYTES: usize>(digits: &str) -> Option<[u8; BYTES]> {
    let digits = digits.as_bytes();
    let value = |digit: &u8| {
        char::from(*digit)
            .to_digit(16)
            .and_then(|value| u8::try_from(value).ok())
    };
    let pairs = digits.chunks(2).map(|pair| match pair {
        [high, low] => Some(value(high)? << 4 | value(low)?),
        _ => None,
    });
    pairs.collect::<Option<Vec<u8>>>()?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use fmc_camera::CalibrationParameters;

    use super::*;

    fn camera() -> CameraParameters {
        CameraParameters {
            serial: SerialNumber::new("5282").unwrap(),
            version: 3,
            ..CameraParameters::new(CalibrationParameters::new(100.0, [8000, 6000], 10.0))
        }
    }

    fn signed(permission: Option<Permission>) -> CalibrationSignature {
        let key = PrivateKey::of_random(&[3; 32]);
        let origin = Origin::new("HR 50", "Prüffeld", "2026-05-17").unwrap();
        let grids = GridFiles::default();
        CalibrationSignature::new(&key, &camera(), &grids, &origin, permission).unwrap()
    }

    #[test]
    fn file_comes_back_and_holds_for_its_calibration_alone() {
        let permission = Permission {
            store: 7,
            crc: 0xbeef,
        };
        for permission in [None, Some(permission)] {
            let signed = signed(permission);
            let text = signed.to_json().unwrap();
            let read = CalibrationSignature::parse("s.json", &text).unwrap();
            assert_eq!(read, signed);
            assert!(read.check(&camera(), &GridFiles::default()).is_ok());
            let mut other = camera();
            other.calibration.pixel_um = 9.0;
            let error = read.check(&other, &GridFiles::default()).unwrap_err();
            assert!(error.to_string().contains("another calibration"), "{error}");
            for (part, by) in [
                ("HR 50", "HR 70"),
                ("2026-05-17", "2026-05-18"),
                ("\"store\": 7", "\"store\": 8"),
            ] {
                let changed = text.replace(part, by);
                if changed == text {
                    continue;
                }
                let read = CalibrationSignature::parse("s.json", &changed).unwrap();
                let error = read.check(&camera(), &GridFiles::default()).unwrap_err();
                assert!(error.to_string().contains("is not that of"), "{error}");
            }
        }
    }

    #[test]
    fn what_is_no_signature_is_refused_by_name() {
        let text = signed(None).to_json().unwrap();
        for (part, by, said) in [
            ("{", "[", "no signature of a calibration"),
            ("camera, 1", "camera, 2", "format"),
            ("\"5282\"", "\"Nº\"", "serial"),
            ("2026-05-17", "17.5.2026", "date"),
            ("\"crc32\": \"", "\"crc32\": \"0", "crc32"),
            ("\"signature\": \"", "\"signature\": \"g", "signature"),
            ("\"public_key\": \"", "\"public_key\": \"00", "public_key"),
            ("\"version\"", "\"colour\"", "colour"),
        ] {
            let error = CalibrationSignature::parse("s.json", &text.replacen(part, by, 1));
            let error = error.unwrap_err().to_string();
            assert!(
                error.starts_with("s.json: ") && error.contains(said),
                "{error}"
            );
        }
    }

    #[test]
    fn calibration_without_serial_number_or_version_is_not_signed() {
        let key = PrivateKey::of_random(&[3; 32]);
        let sign = |camera: &CameraParameters| {
            let grids = GridFiles::default();
            CalibrationSignature::new(&key, camera, &grids, &Origin::default(), None)
        };
        let mut nameless = camera();
        nameless.serial = SerialNumber::EMPTY;
        assert_eq!(
            sign(&nameless).unwrap_err().to_string(),
            "serial is missing"
        );
        let mut unversioned = camera();
        unversioned.version = 0;
        assert_eq!(
            sign(&unversioned).unwrap_err().to_string(),
            "version is missing"
        );
    }

    #[test]
    fn origin_is_that_of_the_details() {
        let details = Details::parse(
            "d.toml",
            "calibrated_on = 2026-03-14\n[laboratory]\nname = \"Range\"\n\
             [lens]\nmodel = \"HR 50\"\nserial = \"7\"\n",
        );
        let origin = origin_of(&details.unwrap()).unwrap();
        assert_eq!(
            origin,
            Origin::new("HR 50 No. 7", "Range", "2026-03-14").unwrap()
        );
        assert_eq!(origin_of(&Details::default()).unwrap(), Origin::default());
        let long = format!("[lens]\nmodel = \"{}\"\n", "x".repeat(33));
        let error = origin_of(&Details::parse("d.toml", &long).unwrap()).unwrap_err();
        assert!(
            error.to_string().contains("lens has more than 32"),
            "{error}"
        );
    }

    #[test]
    fn permission_is_read_from_what_the_camera_said() {
        let text =
            r#"{"calibration": {"serial": "5282", "crc32": "0000beef"}, "store": 7, "slot": 1}"#;
        let permission = Permission {
            store: 7,
            crc: 0xbeef,
        };
        assert_eq!(
            stored_in("s.json", text).unwrap(),
            ("5282".to_owned(), permission)
        );
        for (text, said) in [
            ("", "s.json"),
            (
                r#"{"calibration": null, "store": null}"#,
                "no calibration is stored",
            ),
            (
                r#"{"calibration": {"serial": null, "crc32": "x"}, "store": 1}"#,
                "crc32",
            ),
        ] {
            let error = stored_in("s.json", text).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
