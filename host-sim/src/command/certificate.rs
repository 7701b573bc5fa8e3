//! `certificate`: what an engineer signs of a calibrated camera, and its check.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, InputError};
use fmc_certificate::bundle::{self, BundleError};
use fmc_certificate::calibration_summary::CalibrationSummary;
use fmc_certificate::check::{self, Files, Stated};
use fmc_certificate::content::Certificate;
use fmc_certificate::content::inputs::Inputs;
use fmc_certificate::details::Details;
use fmc_certificate::flown_calibrations::FlownCalibrations;
use fmc_certificate::requirement::Requirement;
use fmc_certificate::signature::{PrivateKey, PublicKey};
use fmc_frames::FrameCamera;
use fmc_reference::verification::device::CorrectingDevice;
use fmc_reference::verification::grid::{self, GridExposure};
use fmc_reference::verification::run;

use crate::cli::{CertificateAction, CertificateArgs, CertificateFolderArgs, MakeCertificateArgs};
use crate::device::InProcess;
use crate::failure::Failure;
use crate::formats::output::{self, OutputFolder};

/// Program and version, as the certificate states them.
const SOFTWARE: &str = concat!("host-sim ", env!("CARGO_PKG_VERSION"));

/// Largest file that is read whole, bytes: the files of a certificate are far smaller.
const LARGEST: u64 = 64 << 20;

pub(super) fn run(args: &CertificateArgs) -> Result<(), Failure> {
    match (&args.action, &args.make) {
        (Some(CertificateAction::Check(args)), _) => check(args),
        (None, Some(args)) => make(args),
        (None, None) => Err(Failure::bad_input("--camera and --out are missing")),
    }
}

fn make(args: &MakeCertificateArgs) -> Result<(), Failure> {
    let (camera, grids) = super::read_camera_with_grids(&args.camera)?;
    let bytes = read(&args.camera)?;
    let frame_camera = FrameCamera::with_grids(&args.camera.display().to_string(), &camera, grids)?;
    let grids = frame_camera.grid_files();
    let file_name = name(&args.camera);
    let details = match &args.details {
        Some(path) => Details::parse(&path.display().to_string(), &read_text(path)?)?,
        None => Details::default(),
    };
    let calibrations = calibrations(&args.calibration)?;
    let key = match &args.sign {
        Some(path) => Some(PrivateKey::parse(
            &path.display().to_string(),
            &read_text(path)?,
        )?),
        None => None,
    };
    let mut device = InProcess::default();
    let (exposures, forbidden) = exposures(&camera);
    let verification = run::exposures(&mut device, (&camera, grids), &exposures, || {})
        .map_err(|error| Failure::bad_input(format!("{}: {error}", args.camera.display())))?;
    if verification.points > 0 && !verification.passed() {
        return Err(Failure::check(format!(
            "{}: the camera differs from the strict solver by more than the limit; nothing is \
             written",
            args.camera.display()
        )));
    }
    let signing_key = key.as_ref().and_then(|key| key.public().sha256());
    let certificate = Certificate::new(&Inputs {
        file_name: &file_name,
        bytes: &bytes,
        camera: &camera,
        grids,
        checked: frame_camera.camera(),
        details: &details,
        calibrations: &calibrations,
        verification: &verification,
        forbidden,
        software: SOFTWARE,
        device: &device.description(),
        signing_key: signing_key.as_deref(),
    })?;
    if let Some(path) = &args.require {
        require(path, &certificate)?;
    }
    let files =
        bundle::files(&certificate, &bytes, grids, key.as_ref()).map_err(|error| failed(&error))?;
    write(&args.out, &files)
}

/// Reads summaries; where several have the same name, the certificate numbers them.
fn calibrations(paths: &[PathBuf]) -> Result<Vec<CalibrationSummary>, Failure> {
    let mut read_so_far: Vec<CalibrationSummary> = Vec::new();
    for path in paths {
        let mut summary = CalibrationSummary::parse(&path.display().to_string(), &read(path)?)?;
        let name = name(path);
        let labels = (1..).map(|number| match number {
            1 => name.clone(),
            _ => format!("{name} ({number})"),
        });
        let is_free = |label: &String| read_so_far.iter().all(|other| other.label != *label);
        summary.label = labels.take(paths.len()).find(is_free).unwrap_or_default();
        read_so_far.push(summary);
    }
    Ok(read_so_far)
}

/// Returns the exposures of a verification that a camera takes, and the number of the others.
fn exposures(camera: &CameraFile) -> (Vec<GridExposure>, u64) {
    let all = grid::exposures(camera);
    let count = all.len();
    let takes = |exposure: &GridExposure| {
        let mut strategy = camera.clone();
        strategy.fmc.strategy = exposure.strategy;
        let request = Exposure::new(single(exposure.vh_per_s), single(exposure.exposure_s));
        Camera::new(strategy.parameters()).is_ok_and(|camera| camera.frame(&request).is_ok())
    };
    let taken: Vec<GridExposure> = all.into_iter().filter(takes).collect();
    let forbidden = (count - taken.len()) as u64;
    (taken, forbidden)
}

/// Fails if a form demands what a certificate does not state.
fn require(path: &Path, certificate: &Certificate) -> Result<(), Failure> {
    let file = path.display().to_string();
    let form = Requirement::parse(&file, &read_text(path)?)?;
    let missing = form.missing(&file, certificate)?;
    if missing.is_empty() {
        return Ok(());
    }
    Err(Failure::check(format!(
        "{}: not stated, so that nothing is written: {}",
        form.name.as_deref().unwrap_or(&file),
        missing.join(", ")
    )))
}

fn failed(error: &BundleError) -> Failure {
    let text = error.to_string();
    if error.is_of_the_input() {
        Failure::bad_input(text)
    } else {
        Failure::device_or_io(text)
    }
}

/// Writes the files of a certificate; a signature that an earlier one has left is removed.
fn write(out: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    let folder = OutputFolder::create(out)?;
    for name in [bundle::SUMS, bundle::SIGNATURE, bundle::PUBLIC_KEY] {
        let path = out.join(name);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(Failure::writing(path.display(), &error));
            }
            _ => {}
        }
    }
    for (name, bytes) in files {
        folder.write(name, |sink| sink.write_all(bytes))?;
    }
    output::write(None, |sink: &mut dyn Write| {
        for (name, bytes) in files {
            writeln!(sink, "{}: {} bytes", out.join(name).display(), bytes.len())?;
        }
        Ok(())
    })
}

fn check(args: &CertificateFolderArgs) -> Result<(), Failure> {
    let json = args.folder.join(bundle::JSON);
    let stated = Stated::parse(&json.display().to_string(), &read(&json)?)?;
    let key = match &args.key {
        Some(path) => Some(PublicKey::parse(
            &path.display().to_string(),
            &read_text(path)?,
        )?),
        None => None,
    };
    let records = match &args.records {
        Some(path) => {
            let file = fs::File::open(path).map_err(|error| Failure::reading(path, &error))?;
            Some(FlownCalibrations::read(&path.display().to_string(), file)?)
        }
        None => None,
    };
    let mut files = Files::new();
    for name in bundle::NAMES
        .into_iter()
        .chain([stated.camera_file()])
        .chain(stated.grid_files())
    {
        let path = args.folder.join(name);
        if path.exists() {
            files.insert(name.to_owned(), read(&path)?);
        }
    }
    let statements = check::statements(&stated, &files, key.as_ref(), records.as_ref());
    output::write(None, |sink: &mut dyn Write| {
        for statement in &statements {
            let verdict = if statement.passed { "ok    " } else { "FAILED" };
            writeln!(sink, "{verdict}  {}", statement.text)?;
        }
        Ok(())
    })?;
    let failed = statements.into_iter().filter(|statement| !statement.passed);
    let failed: Vec<String> = failed.map(|statement| statement.text).collect();
    if failed.is_empty() {
        Ok(())
    } else {
        Err(Failure::check(failed.join("\n")))
    }
}

/// Returns the last part of a path.
fn name(path: &Path) -> String {
    path.file_name().map_or_else(
        || "camera.toml".to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Reads a file that is not larger than [`LARGEST`].
fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let reading = |error: &_| Failure::reading(path, error);
    let length = fs::metadata(path).map_err(|error| reading(&error))?.len();
    if length > LARGEST {
        return Err(Failure::bad_input(format!(
            "{}: {length} bytes are too many for a file of a certificate",
            path.display()
        )));
    }
    fs::read(path).map_err(|error| reading(&error))
}

fn read_text(path: &Path) -> Result<String, Failure> {
    let not_text = |_| InputError::invalid(format!("{}: not a text file (UTF-8)", path.display()));
    Ok(String::from_utf8(read(path)?).map_err(not_text)?)
}
