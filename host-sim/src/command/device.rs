//! The device that a command is asked to use.

use std::num::NonZero;
use std::thread;

use crate::cli::DeviceArgs;
use crate::device::qemu::QemuOptions;
use crate::device::remote::Session;
use crate::device::served::ServedCamera;
use crate::device::{
    Device, DeviceError, DeviceName, FlownCamera, FlyingDevice, InProcess, KeepingCamera,
    OpenError, Opener, RecordSource,
};
use crate::failure::Failure;

const RECORDS: &str =
    "a camera that has flown is needed: name it with --device serial:PATH or tcp:HOST:PORT";
const FLOWN: &str = "a camera on a board is needed: name it with --device serial:PATH or tcp:HOST:PORT; `host-sim mission` flies simulated ones";
const KEEPING: &str = "a camera with a store is needed: name it with --device serial:PATH or tcp:HOST:PORT, or --device qemu with --flash FILE";

/// Devices of one kind.
pub(super) type Devices = Vec<Box<dyn Device>>;

impl DeviceArgs {
    /// Opens the device, without a name the camera's code in this process.
    ///
    /// # Errors
    /// [`Failure`] where it cannot be opened.
    pub(super) fn open(&self) -> Result<Box<dyn Device>, Failure> {
        let name = self.device.as_ref().unwrap_or(&DeviceName::Sil);
        self.check_options(name)?;
        Ok(self.opener().open(name)?)
    }

    /// Opens the device, without a name QEMU. Where there is no QEMU, returns the camera's code in
    /// this process and the reason. Starts as many emulators as this PC has cores, at most `most`.
    ///
    /// # Errors
    /// [`Failure`] where one cannot be opened.
    pub(super) fn open_or_fall_back(
        &self,
        most: usize,
    ) -> Result<(Devices, Option<String>), Failure> {
        let name = self.device.as_ref().unwrap_or(&DeviceName::QEMU);
        self.check_options(name)?;
        let mut devices = match self.opener().open(name) {
            Ok(device) => vec![device],
            Err(OpenError::NotHere { reason, help })
                if self.device.is_none() && self.firmware.is_none() =>
            {
                let reason = format!("{reason}; to mend it: {help}");
                return Ok((vec![self.stand_in()?], Some(reason)));
            }
            Err(error) => return Err(error.into()),
        };
        // A port has one camera, and the logs of two emulators would mix.
        if matches!(name, DeviceName::Qemu(_)) && !self.log {
            let cores = thread::available_parallelism().map_or(1, NonZero::get);
            for _ in 1..most.min(cores) {
                // One emulator is enough.
                let Ok(device) = self.opener().open(name) else {
                    break;
                };
                devices.push(device);
            }
        }
        Ok((devices, None))
    }

    /// Returns the camera's code in this process, in the place of QEMU.
    ///
    /// # Errors
    /// [`Failure`] where an option applies to QEMU alone.
    pub(super) fn stand_in(&self) -> Result<Box<dyn Device>, Failure> {
        self.check_options(&DeviceName::Sil)?;
        Ok(Box::new(InProcess::default()))
    }

    /// Opens the device for a flight, without a name the camera's code in this process.
    ///
    /// # Errors
    /// [`Failure`] where it cannot be opened.
    pub(super) fn open_flying(
        &self,
    ) -> Result<Box<dyn FlyingDevice<Error = DeviceError>>, Failure> {
        let name = self.device.as_ref().unwrap_or(&DeviceName::Sil);
        self.check_options(name)?;
        Ok(self.opener().open_flying(name)?)
    }

    /// Opens a device that may hold records of a flight, beside a program that flies it.
    ///
    /// # Errors
    /// [`Failure`] where none is named, and where it cannot be opened.
    pub(super) fn open_records(&self) -> Result<Box<dyn RecordSource>, Failure> {
        let open = |opener: &Opener, name: &_| opener.open_linked(name, Session::Reading);
        Ok(self.open_one(RECORDS, open)?)
    }

    /// Opens a camera on a board.
    ///
    /// # Errors
    /// As [`Self::open_records`].
    pub(super) fn open_flown(&self, session: Session) -> Result<Box<dyn FlownCamera>, Failure> {
        self.open_one(FLOWN, |opener, name| opener.open_flown(name, session))
    }

    /// Opens a camera that may store its calibration, or be asked what it has stored.
    ///
    /// # Errors
    /// As [`Self::open_records`].
    pub(super) fn open_keeping(&self, session: Session) -> Result<Box<dyn KeepingCamera>, Failure> {
        let open = |opener: &Opener, name: &_| opener.open_linked(name, session);
        Ok(self.open_one(KEEPING, open)?)
    }

    /// Opens a device whose link is served, without a name the camera's code in this process.
    ///
    /// # Errors
    /// [`Failure`] where it cannot be opened.
    pub(super) fn open_served(&self) -> Result<ServedCamera, Failure> {
        let name = self.device.as_ref().unwrap_or(&DeviceName::Sil);
        self.check_options(name)?;
        Ok(ServedCamera::open(name, &self.opener().qemu)?)
    }

    fn open_one<Camera: ?Sized>(
        &self,
        which: &str,
        open: impl FnOnce(&Opener, &DeviceName) -> Result<Option<Box<Camera>>, OpenError>,
    ) -> Result<Box<Camera>, Failure> {
        let name = self
            .device
            .as_ref()
            .ok_or_else(|| Failure::bad_input(which))?;
        self.check_options(name)?;
        open(&self.opener(), name)?
            .ok_or_else(|| Failure::bad_input(format!("--device {name}: {which}")))
    }

    /// Checks that what the firmware in QEMU stores stays after this run.
    ///
    /// # Errors
    /// [`Failure`] where no file is named.
    pub(super) fn check_kept(&self) -> Result<(), Failure> {
        match &self.device {
            Some(name @ DeviceName::Qemu(_)) if self.flash.is_none() => {
                Err(Failure::bad_input(format!(
                    "--device {name}: its flash is lost at the end of this run: name a file with --flash FILE"
                )))
            }
            _ => Ok(()),
        }
    }

    fn opener(&self) -> Opener {
        Opener {
            qemu: QemuOptions {
                firmware: self.firmware.clone(),
                flash: self.flash.clone(),
                print_log: self.log,
            },
        }
    }

    /// Checks that options for QEMU come with the device QEMU.
    fn check_options(&self, name: &DeviceName) -> Result<(), Failure> {
        let option = match self {
            Self {
                firmware: Some(_), ..
            } => "--firmware",
            Self { flash: Some(_), .. } => "--flash",
            Self { log: true, .. } => "--log",
            _ => return Ok(()),
        };
        match name {
            DeviceName::Qemu(_) => Ok(()),
            DeviceName::Sil | DeviceName::Serial(_) | DeviceName::Tcp(_) => {
                Err(Failure::bad_input(format!(
                    "{option} is for the firmware in QEMU, and the device is {name}: add --device qemu"
                )))
            }
        }
    }
}
