//! `sign`: the signature by which a camera stores a calibration, and the key for it.

use std::fs;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

use fmc_camera::io::store::{Origin, Permission};
use fmc_camera_file::{CameraFile, InputError};
use fmc_certificate::calibration_signature::{self, CalibrationSignature};
use fmc_certificate::details::Details;
use fmc_certificate::signature::PrivateKey;
use tempfile::NamedTempFile;

use crate::cli::{SignAction, SignArgs, SignCalibrationArgs, SignKeyArgs};
use crate::failure::Failure;
use crate::formats::output::{self, OutputFolder};

/// Name of the private key's file.
const PRIVATE_KEY: &str = "private-key.pem";

/// Name of the public key's file.
const PUBLIC_KEY: &str = "public-key.pem";

/// Largest file that is read whole, bytes.
const LARGEST: u64 = 1 << 20;

pub(super) fn run(args: &SignArgs) -> Result<(), Failure> {
    match (&args.action, &args.calibration) {
        (Some(SignAction::Key(args)), _) => make_key(args),
        (None, Some(args)) => sign(args),
        (None, None) => Err(Failure::bad_input("--camera, --key and --out are missing")),
    }
}

fn sign(args: &SignCalibrationArgs) -> Result<(), Failure> {
    for input in [&args.camera, &args.key]
        .into_iter()
        .chain(&args.details)
        .chain(&args.over)
    {
        output::check_not_an_input(&args.out, input)?;
    }
    let (camera, grids) = super::read_camera_with_grids(&args.camera)?;
    let key = PrivateKey::parse(&name(&args.key), &read(&args.key)?)?;
    let origin = match &args.details {
        Some(path) => {
            let details = Details::parse(&name(path), &read(path)?)?;
            calibration_signature::origin_of(&details).map_err(|error| in_file(path, &error))?
        }
        None => Origin::default(),
    };
    let permission = match &args.over {
        Some(path) => Some(permission(path, &camera)?),
        None => None,
    };
    let parameters = camera.parameters();
    let signed = CalibrationSignature::new(&key, &parameters, &grids, &origin, permission);
    let signed = signed.map_err(|error| in_file(&args.camera, &error))?;
    let text = signed.to_json();
    let text = text.map_err(|error| Failure::writing(args.out.display(), &error.into()))?;
    output::write(Some(&args.out), |sink| sink.write_all(text.as_bytes()))?;
    output::write(None, |sink| {
        let out = args.out.display();
        let (serial, version) = (signed.id().serial, signed.id().version);
        writeln!(
            sink,
            "{out}: serial {serial}, version {version}, CRC-32 {:08x}",
            signed.id().crc
        )?;
        match permission {
            Some(permission) => writeln!(sink, "permitted once, in the place of {permission}"),
            None => Ok(()),
        }
    })
}

/// Returns the permission to follow what the camera of a file has stored.
fn permission(path: &Path, camera: &CameraFile) -> Result<Permission, Failure> {
    let (serial, permission) = calibration_signature::stored_in(&name(path), &read(path)?)?;
    let own = camera.parameters().serial;
    if own.as_str() == serial {
        Ok(permission)
    } else {
        Err(Failure::bad_input(format!(
            "{}: serial {serial:?} is not that of the camera file, {:?}",
            path.display(),
            own.as_str()
        )))
    }
}

fn make_key(args: &SignKeyArgs) -> Result<(), Failure> {
    let mut random = [0; PrivateKey::BYTES];
    getrandom::fill(&mut random)
        .map_err(|error| Failure::device_or_io(format!("no random numbers: {error}")))?;
    let key = PrivateKey::of_random(&random);
    let (Some(private), Some(public)) = (key.pem(), key.public().pem()) else {
        return Err(Failure::device_or_io("the key cannot be written as PEM"));
    };
    let folder = OutputFolder::create(&args.out)?;
    for file in [PRIVATE_KEY, PUBLIC_KEY] {
        let path = args.out.join(file);
        if path.exists() {
            return Err(exists(&path));
        }
    }
    write_private(&args.out.join(PRIVATE_KEY), &private)?;
    folder.write(PUBLIC_KEY, |sink| sink.write_all(public.as_bytes()))?;
    output::write(None, |sink| {
        let [private, public] = [PRIVATE_KEY, PUBLIC_KEY].map(|file| args.out.join(file));
        writeln!(
            sink,
            "{}: signs; keep it secret, and a copy of it",
            private.display()
        )?;
        writeln!(
            sink,
            "{}: for the firmware of the cameras",
            public.display()
        )
    })
}

/// Writes a file that its owner alone can read, and that replaces none.
fn write_private(path: &Path, text: &str) -> Result<(), Failure> {
    let writing = |error: &_| Failure::writing(path.display(), error);
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = NamedTempFile::new_in(folder).map_err(|error| writing(&error))?;
    let written = file.write_all(text.as_bytes());
    written
        .and_then(|()| file.as_file().sync_all())
        .map_err(|error| writing(&error))?;
    match file.persist_noclobber(path) {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Err(exists(path)),
        Err(error) => Err(writing(&error.error)),
    }
}

fn exists(path: &Path) -> Failure {
    Failure::bad_input(format!("{} exists and is not replaced", path.display()))
        .with_help("name another folder with --out")
}

/// Names the file in which an error is.
pub(super) fn in_file(path: &Path, error: &InputError) -> Failure {
    let failure = Failure::bad_input(format!("{}: {error}", path.display()));
    match error.help() {
        Some(help) => failure.with_help(help),
        None => failure,
    }
}

fn name(path: &Path) -> String {
    path.display().to_string()
}

/// Reads a text that is not longer than [`LARGEST`].
pub(super) fn read(path: &Path) -> Result<String, Failure> {
    let reading = |error: &_| Failure::reading(path, error);
    let length = fs::metadata(path).map_err(|error| reading(&error))?.len();
    if length > LARGEST {
        return Err(Failure::bad_input(format!(
            "{}: {length} bytes are too many for such a file",
            path.display()
        )));
    }
    fs::read_to_string(path).map_err(|error| match error.kind() {
        ErrorKind::InvalidData => {
            Failure::bad_input(format!("{}: not a text file (UTF-8)", path.display()))
        }
        _ => reading(&error),
    })
}
