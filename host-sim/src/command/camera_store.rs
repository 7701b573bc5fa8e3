//! `camera store` and `camera stored`: the calibration in a camera's flash.

use fmc_camera::flight::camera::Camera;
use fmc_camera::io::link::message::{Counters, Refusal};
use fmc_camera::io::store::{NotStored, NothingStored, StoredIdentity};
use fmc_certificate::calibration_signature::CalibrationSignature;
use fmc_report::stored_calibration;

use crate::cli::{CameraArgs, StoreArgs};
use crate::device::DeviceError;
use crate::device::link_error::LinkError;
use crate::device::remote::Session;
use crate::failure::Failure;
use crate::formats::output;

/// Stores a calibration, and says what is stored then.
pub(super) fn store(args: &CameraArgs, of: &StoreArgs) -> Result<(), Failure> {
    let text = super::sign::read(&of.signature)?;
    let file = of.signature.display().to_string();
    let signature = CalibrationSignature::parse(&file, &text)?;
    let camera = match &of.camera {
        Some(path) => {
            let (file, grids) = super::read_camera_with_grids(path)?;
            let parameters = file.parameters();
            Camera::new(parameters)
                .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
            signature
                .check(&parameters, &grids)
                .map_err(|error| super::sign::in_file(&of.signature, &error))?;
            Some((parameters, grids))
        }
        None => None,
    };
    args.device.check_kept()?;
    let mut device = args.device.open_keeping(Session::Whole)?;
    if let Some((parameters, grids)) = &camera {
        device.put_into_use(parameters, grids).map_err(failed)?;
    }
    let record = device.store(&signature.order()).map_err(failed)?;
    let counters = device.counters().map_err(failed)?;
    say(&Ok(record), counters, of.json)
}

/// Says what is stored.
pub(super) fn stored(args: &CameraArgs, as_json: bool) -> Result<(), Failure> {
    let mut device = args.device.open_keeping(Session::Reading)?;
    let stored = device.stored().map_err(failed)?;
    let counters = device.counters().map_err(failed)?;
    say(&stored, counters, as_json)
}

fn say(
    stored: &Result<StoredIdentity, NothingStored>,
    counters: Option<Counters>,
    as_json: bool,
) -> Result<(), Failure> {
    output::write(None, |sink| {
        if as_json {
            stored_calibration::write_json(stored, counters, sink)
        } else {
            stored_calibration::write_text(stored, sink)
        }
    })
}

/// Turns an error into a failure, with advice.
fn failed(error: DeviceError) -> Failure {
    let help = match &error {
        DeviceError::Link {
            error: LinkError::Refused { refusal, .. },
            ..
        } => match refusal {
            Refusal::NoCalibration => "name one with --camera FILE",
            Refusal::FrameInFlight => "`host-sim camera disarm` comes first",
            Refusal::NotStandby(_) => "`host-sim camera clear-fault` comes first",
            Refusal::NotStored(NotStored::WrongSignature) => {
                "the camera's firmware has the public key of another, or another calibration is in \
                 use than was signed"
            }
            Refusal::NotStored(NotStored::VersionNotRisen { .. }) => {
                "give the calibration a higher version in its camera file, or sign it with --over"
            }
            Refusal::NotStored(NotStored::OtherPermission { .. }) => {
                "sign it again with --over and what `host-sim camera stored --json` prints now"
            }
            Refusal::NotStored(NotStored::Flash { .. }) => {
                "docs/store.md says what a start finds; `host-sim camera stored` asks the camera"
            }
            _ => return error.into(),
        },
        _ => return error.into(),
    };
    Failure::from(error).with_help(help)
}
