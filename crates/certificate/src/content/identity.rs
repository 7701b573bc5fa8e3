//! Identity of a certificate: camera, instruments, laboratory, persons, dates, hashes.

use fmc_camera_file::{CameraFile, InputError, MechanismName};
use fmc_report::hash;
use serde::Serialize;

use super::inputs::Inputs;
use crate::details::{Date, Details, Instrument, Laboratory, Person};

/// Who, what and when.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Identity {
    /// Number of the certificate.
    pub number: Option<String>,
    /// Name of the camera, from its file.
    pub name: String,
    /// Camera.
    pub camera: Instrument,
    /// Lens.
    pub lens: Instrument,
    /// Stage that moves the detector.
    pub stage: Instrument,
    /// Encoder of the stage.
    pub encoder: Instrument,
    /// Version of the calibration, from the camera file.
    pub calibration_version: Option<u32>,
    /// Laboratory.
    pub laboratory: Laboratory,
    /// Day of the calibration.
    pub calibrated_on: Option<Date>,
    /// Day of issue.
    pub issued_on: Option<Date>,
    /// Last day of validity.
    pub valid_until: Option<Date>,
    /// Persons who sign.
    pub persons: Vec<Person>,
    /// Method and set-up.
    pub procedure: Option<String>,
    /// Standards to which lengths and angles are traced.
    pub traceability: Option<String>,
    /// Conditions.
    pub environment: Option<String>,
    /// Remarks.
    pub remarks: Option<String>,
    /// Program that made the certificate.
    pub software: String,
    /// The camera file.
    pub camera_file: CameraFileIdentity,
    /// SHA-256 of the public key of the signature, DER.
    pub signing_key_sha256: Option<String>,
}

/// The camera file by name and hashes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CameraFileIdentity {
    /// Name, without folders.
    pub name: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// CRC-32 that every frame record carries.
    pub crc32: String,
    /// `true` if the file states no largest V/H: a flight with other than the default settings may
    /// then carry another CRC-32.
    pub crc32_depends_on_settings: bool,
}

impl Identity {
    /// Collects the identity.
    ///
    /// # Errors
    /// [`InputError`] for a serial number that contradicts that of the camera file.
    pub(super) fn new(inputs: &Inputs<'_>) -> Result<Self, InputError> {
        let Inputs {
            camera, details, ..
        } = *inputs;
        let Details {
            number,
            calibrated_on,
            issued_on,
            valid_until,
            laboratory,
            lens,
            stage,
            encoder,
            persons,
            procedure,
            traceability,
            environment,
            remarks,
            ..
        } = details.clone();
        let mut body = details.camera.clone();
        let in_file = Some(camera.serial.clone()).filter(|serial| !serial.is_empty());
        if let (Some(stated), Some(in_file)) = (&body.serial, &in_file)
            && stated != in_file
        {
            return Err(InputError::invalid(format!(
                "details: camera.serial = {stated:?}, and the camera file has {in_file:?}"
            )));
        }
        body.serial = body.serial.or(in_file);
        Ok(Self {
            number,
            name: camera.name.clone(),
            camera: body,
            lens,
            stage,
            encoder,
            calibration_version: u32::try_from(camera.version).ok().filter(|it| *it != 0),
            laboratory,
            calibrated_on,
            issued_on,
            valid_until,
            persons,
            procedure,
            traceability,
            environment,
            remarks,
            software: inputs.software.to_owned(),
            camera_file: CameraFileIdentity {
                name: inputs.file_name.to_owned(),
                sha256: hash::sha256(inputs.bytes),
                crc32: hash::crc32(camera),
                crc32_depends_on_settings: camera.limits.is_vh_default(),
            },
            signing_key_sha256: inputs.signing_key.map(str::to_owned),
        })
    }
}

/// Returns the conventions of the numbers: sign, direction, frame, and the stage position that the
/// principal point belongs to.
pub(super) fn conventions(camera: &CameraFile) -> [String; 4] {
    let position = match camera.fmc.mechanism {
        MechanismName::Stage => "when the stage stands at its calibrated position",
        MechanismName::Tdi => "for charge that has not been moved",
    };
    [
        "Sign: distortion is measured minus ideal; a barrel lens has K1 below zero.".to_owned(),
        "Direction: the polynomial is a function of the measured point, about the principal point; \
         the ideal point is the measured one less the distortion."
            .to_owned(),
        "Frame: the upright positive image, origin at the centre of the pixel array, x to the \
         right, y up, in millimetres; the centre of the first pixel is column 0, row 0."
            .to_owned(),
        format!(
            "Position: the principal point stated is its place {position}; in a frame it lies c̄ \
             further along {}, as its record says.",
            camera.fmc.axis.name()
        ),
    ]
}
