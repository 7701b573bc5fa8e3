//! `camera store` and `camera stored`: the calibration in a camera's flash.

use fmc_camera::flight::camera::Camera;
use fmc_camera::io::link::message::Refusal;
use fmc_camera::io::store::{NotStored, NothingStored, Origin, OriginError, StoredIdentity};
use fmc_report::stored_calibration;

use crate::cli::{CameraArgs, StoreArgs};
use crate::device::DeviceError;
use crate::device::link_error::LinkError;
use crate::device::remote::Session;
use crate::failure::Failure;
use crate::formats::output;

/// Stores a calibration, and says what is stored then.
pub(super) fn store(args: &CameraArgs, of: &StoreArgs) -> Result<(), Failure> {
    let origin = origin(of)?;
    let camera = match &of.camera {
        Some(path) => {
            let (file, grids) = super::read_camera_with_grids(path)?;
            let parameters = file.parameters();
            Camera::new(parameters)
                .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
            Some((parameters, grids))
        }
        None => None,
    };
    args.device.check_kept()?;
    let mut device = args.device.open_keeping(Session::Whole)?;
    if let Some((parameters, grids)) = &camera {
        device.put_into_use(parameters, grids).map_err(failed)?;
    }
    let record = device.store(&origin).map_err(failed)?;
    say(&Ok(record), false)
}

/// Says what is stored.
pub(super) fn stored(args: &CameraArgs, as_json: bool) -> Result<(), Failure> {
    let mut device = args.device.open_keeping(Session::Reading)?;
    say(&device.stored().map_err(failed)?, as_json)
}

fn say(stored: &Result<StoredIdentity, NothingStored>, as_json: bool) -> Result<(), Failure> {
    output::write(None, |sink| {
        if as_json {
            stored_calibration::write_json(stored, sink)
        } else {
            stored_calibration::write_text(stored, sink)
        }
    })
}

fn origin(of: &StoreArgs) -> Result<Origin, Failure> {
    Origin::new(&of.lens, &of.laboratory, &of.date).map_err(|error| {
        let (option, given) = match error {
            OriginError::LensTooLong => ("--lens", &of.lens),
            OriginError::LaboratoryTooLong => ("--laboratory", &of.laboratory),
            OriginError::Date => ("--date", &of.date),
            OriginError::ControlCharacter if of.lens.chars().any(char::is_control) => {
                ("--lens", &of.lens)
            }
            OriginError::ControlCharacter => ("--laboratory", &of.laboratory),
        };
        Failure::bad_input(format!("{option} {given:?}: {error}"))
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
            Refusal::NotStored(NotStored::Older { .. }) => {
                "give the calibration a higher version in its camera file"
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
